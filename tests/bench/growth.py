"""Table, picture and summary.json of `scripts/bench growth` from its two CSV files."""

import csv
import json
import pathlib
import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

CURVES = {  # file, size's column, time's column, title, colour
    "calibrate": ("solve", "views", "calibrate_ms", "Calibrate, judging included", "#0b2f5b"),
    "solve": ("solve", "views", "solve_ms", "of that, first guess and joint solve", "#d1495b"),
    "growth_solve": ("solve", "views", "growth_solve_ms", "first guess, joint solve, all checks",
                     "#6b4fa0"),
    "first_guess": ("solve", "views", "guess_ms", "of that, the first guess", "#e0a458"),
    "detect": ("detection", "points", "organised_ms", "as the LIDAR saw it", "#0b2f5b"),
    "detect_bare": ("detection", "points", "bare_ms", "bare points, not organised", "#3b9e6b"),
}
TARGETS = {"growth_solve_slope": 1.15}
LINEAR = 1.05  # a slope up to here is called linear: times are not that exact


def read(out):
    tables = {}
    for name in ("solve", "detection"):
        with open(out / f"growth_{name}.csv") as file:
            tables[name] = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    for row in tables["solve"]:
        row["solve_ms"] = row["guess_ms"] + row["joint_ms"]
        row["growth_solve_ms"] = row["guess_ms"] + row["checked_ms"]
    return tables


def curve(tables, name):
    """Sizes and times [ms]; the median where a size was timed on several clouds."""
    table, size, time, _, _ = CURVES[name]
    times = {}
    for row in tables[table]:
        times.setdefault(row[size], []).append(row[time])
    sizes = sorted(times)
    return numpy.array(sizes), numpy.array([statistics.median(times[s]) for s in sizes])


def fit(sizes, times):
    """Slope and offset in log-log, by least squares."""
    return numpy.polyfit(numpy.log10(sizes), numpy.log10(times), 1)


def slope(sizes, times):
    return float(fit(sizes, times)[0])


def last_decade(sizes, times):
    late = sizes >= 0.0999 * sizes[-1]
    return slope(sizes[late], times[late])


def draw_curves(axes, tables, names, label):
    for name in names:
        sizes, times = curve(tables, name)
        title, colour = CURVES[name][3:]
        axes.plot(sizes, times, "o", color=colour, ms=5)
        a, b = fit(sizes, times)
        axes.plot(sizes, 10 ** (a * numpy.log10(sizes) + b), color=colour, lw=1.6,
                  label=f"{title}: slope {a:.2f}, last decade {last_decade(sizes, times):.2f}")
    sizes, times = curve(tables, names[0])
    guide = 2.2 * times[-1] * sizes / sizes[-1]
    axes.plot(sizes, guide, color="grey", lw=1, ls="--", label="linear")
    axes.set(xscale="log", yscale="log", xlabel=label, ylabel="time on one core [ms]")
    axes.grid(alpha=0.3, which="both", lw=0.5)
    axes.legend(fontsize=8.5, loc="upper left")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * 6)  # room for the legend


def draw(tables, path):
    plot, axes = plt.subplots(1, 2, figsize=(14, 6))
    draw_curves(axes[0], tables, ("calibrate", "growth_solve", "solve", "first_guess"),
                "views of two cameras")
    axes[0].set_title("Solving")
    draw_curves(axes[1], tables, ("detect", "detect_bare"), "points of the cloud")
    axes[1].set_title("Finding the board in a cloud")
    plot.suptitle("How cost grows")
    plot.tight_layout()
    plot.savefig(path, dpi=110)


def figures(tables):
    for name in CURVES:
        sizes, times = curve(tables, name)
        yield f"{name}_slope", slope(sizes, times), "1"
        yield f"{name}_slope_last_decade", last_decade(sizes, times), "1"
        yield f"{name}_ms_most", float(times[-1]), "ms"
    ten = [r for r in tables["solve"] if r["views"] == 10]
    if ten:
        yield "solve_ms_10_views", ten[0]["solve_ms"], "ms"
        yield "calibrate_ms_10_views", ten[0]["calibrate_ms"], "ms"
    yield "views_most", max(r["views"] for r in tables["solve"]), "1"
    yield "points_most", max(r["points"] for r in tables["detection"]), "1"
    found = [r[k] for r in tables["detection"] for k in ("organised_found", "bare_found")]
    yield "board_found", statistics.mean(found), "1"


def rows(tables, name):
    sizes, times = curve(tables, name)
    return "".join(f"  {s:>10.0f} {t:>12.4g} ms\n" for s, t in zip(sizes, times))


def table(tables, summary):
    text = "Slopes in log-log: 1 is linear\n"
    for f in summary:
        missed = "_slope" in f["name"] and f["value"] > TARGETS.get(f["name"], LINEAR)
        text += f"{f['name']:<36}{f['value']:>12.4g} {f['unit']:<3}"
        text = (text + ("more than linear" if missed else "")).rstrip() + "\n"
    for name, (_, size, _, title, _) in CURVES.items():
        text += f"\n{name}: {title}, by {size}\n{rows(tables, name)}"
    return text


def main():
    out = pathlib.Path(sys.argv[1])
    tables = read(out)
    summary = [{"name": n, "value": v, "unit": u} for n, v, u in figures(tables)]
    (out / "summary.json").write_text(json.dumps({"figures": summary}, indent=2) + "\n")
    draw(tables, out / "growth.png")
    text = table(tables, summary)
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, growth_solve.csv, growth_detection.csv, growth.png, summary.json")


main()
