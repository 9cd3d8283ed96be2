"""Table, CSV, picture and summary.json of `scripts/study basin`."""

import csv
import json
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

REACHED = "within 1 deg and 100 mm of the truth"
METHODS = {  # title, colour
    "auto": ("auto", "#0b2f5b"),
    "paper_smooth": ("paper, smooth field", "#3b9e6b"),
    "paper": ("paper", "#d1495b"),
    "refine": ("the joint solve alone", "#9aa5b1"),
}
DEG_STEP, M_STEP = 20, 0.5
MOST_DEG, MOST_M = 180, 3


def read(folder, prefix):
    rows = []
    for path in sorted(folder.glob(f"{prefix}-*.csv")):
        with open(path) as file:
            rows += list(csv.DictReader(file))
    return rows


def of_method(rows, method):
    return [r for r in rows if r["method"] == method]


def share(rows):
    return sum(r["success"] == "1" for r in rows) / len(rows) if rows else math.nan


def spread(rows):
    """Wilson's interval of one sigma: of few guesses little is known."""
    n, p = len(rows), share(rows)
    middle = (p + 0.5 / n) / (1 + 1 / n)
    half = math.sqrt(p * (1 - p) / n + 0.25 / n**2) / (1 + 1 / n)
    return p - (middle - half), (middle + half) - p


def bins(rows, key, step, most):
    """Middles and rows of each bin that has any."""
    for k in range(round(most / step)):
        mine = [r for r in rows if k * step <= float(r[key]) < (k + 1) * step]
        if mine:
            yield (k + 0.5) * step, mine


def draw_against(axes, rows, key, step, most, label):
    for method, (title, colour) in METHODS.items():
        points = list(bins(of_method(rows, method), key, step, most))
        heights = [share(mine) for _, mine in points]
        errors = list(zip(*(spread(mine) for _, mine in points)))
        errors = [[max(0, e) for e in side] for side in errors]
        axes.errorbar(
            [x for x, _ in points], heights, yerr=errors, color=colour, label=title, marker="o",
            ms=4, lw=1.8, capsize=2, zorder=9 - list(METHODS).index(method),
        )
    axes.set(xlim=(0, most), ylim=(-0.03, 1.03), xlabel=label, ylabel="share that succeeds")
    axes.grid(alpha=0.3)


def draw_map(plot, axes, rows, method):
    columns, lines = MOST_DEG // DEG_STEP, round(MOST_M / M_STEP)
    cells = [[[] for _ in range(columns)] for _ in range(lines)]
    for r in of_method(rows, method):
        column = min(columns - 1, int(float(r["guess_deg"]) / DEG_STEP))
        line = min(lines - 1, int(float(r["guess_m"]) / M_STEP))
        cells[line][column].append(r)
    values = [[share(cell) for cell in line] for line in cells]
    image = axes.imshow(
        values, origin="lower", aspect="auto", extent=(0, MOST_DEG, 0, MOST_M), vmin=0, vmax=1,
        cmap="RdYlGn",
    )
    axes.set(xlabel="guess off [deg]", ylabel="guess off [m]")
    axes.set_title(METHODS[method][0])
    return image


def draw(rows, path):
    plot = plt.figure(figsize=(15, 9), constrained_layout=True)
    grid = plot.add_gridspec(2, 12)
    left, right = plot.add_subplot(grid[0, :6]), plot.add_subplot(grid[0, 6:])
    draw_against(left, rows, "guess_deg", DEG_STEP, MOST_DEG, "first guess off in rotation [deg]")
    draw_against(right, rows, "guess_m", M_STEP, MOST_M, "first guess off in place [m]")
    left.legend(fontsize=9, loc="lower left")
    maps = [plot.add_subplot(grid[1, 3 * k : 3 * k + 3]) for k in range(4)]
    for axes, method in zip(maps, METHODS):
        image = draw_map(plot, axes, rows, method)
    plot.colorbar(image, ax=maps, label="share that succeeds", aspect=25, pad=0.01)
    guesses = len(of_method(rows, "auto"))
    plot.suptitle(
        f"{guesses} random first guesses, 0 to 180 deg and 0 to 3 m off: "
        f"share that ends {REACHED}\n"
        "auto takes no guess; the joint solve alone starts from it"
    )
    plot.savefig(path, dpi=110)


def figures(rows, starts):
    for method in METHODS:
        mine = of_method(rows, method)
        yield f"basin_success_{method}", share(mine), "1"
        wrong = [r for r in mine if r["converged"] == "1" and r["success"] == "0"]
        yield f"basin_wrong_but_converged_{method}", len(wrong) / len(mine), "1"
        for low, high in ((0, 30), (30, 90), (90, 180)):
            between = [r for r in mine if low <= float(r["guess_deg"]) < high]
            if between:
                yield f"basin_success_{method}_{low}_to_{high}_deg", share(between), "1"
    yield "basin_guesses", len(of_method(rows, "auto")), "1"
    for method, start, name in (
        ("auto", "30_40", "basin_30_40_success"),
        ("auto", "none", "no_guess_success"),
        ("paper", "30_40", "paper_30_40_success"),
        ("paper_smooth", "30_40", "paper_smooth_30_40_success"),
    ):
        mine = [r for r in starts if (r["method"], r["start"]) == (method, start)]
        if mine:
            yield name, share(mine), "1"
            yield name.replace("success", "sessions"), len(mine), "1"


def write(rows, path):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main():
    out = pathlib.Path(sys.argv[1])
    rows, starts = read(out / "parts", "random"), read(out / "parts", "starts")
    if not rows or not starts:
        sys.exit(f"study: no guesses or no sessions in {out / 'parts'}")
    write(rows, out / "basin.csv")
    write(starts, out / "parts" / "basin.csv")
    draw(rows, out / "basin.png")
    summary = [{"name": n, "value": v, "unit": u} for n, v, u in figures(rows, starts)]
    (out / "summary.json").write_text(json.dumps({"figures": summary}, indent=2) + "\n")
    text = f"Success: {REACHED}\n"
    text += "".join(f"{f['name']:<44}{f['value']:>10.4g} {f['unit']}\n" for f in summary)
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, basin.csv, basin.png, summary.json")


main()
