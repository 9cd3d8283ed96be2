"""Table, CSV, picture and summary.json of `scripts/study scanner`: how exactly the turned scanner's
geometry is found, against the synthetic truth."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, mean, median, pick, rms

TURNS = {
    "small": "5 mm, 0.5 deg off",
    "large": "20 mm, 2 deg off",
    "short": "270 of 360 deg",
    "dense": "4 x the points",
}
ERRORS = (("lever_mm", ("tx", "ty"), "mm"), ("tilt_deg", ("rx", "ry"), "deg"))
# Of a guess that is 5 mm and 0.5 degrees off. The NEES is of four unknowns: 4 is exact, and the mean
# of 20 sweeps scatters by 0.63.
TARGETS = {
    "scanner_lever_mm": ("<=", 0.5),
    "scanner_tilt_deg": ("<=", 0.02),
    "scanner_converged": (">=", 1),
    "scanner_nees": ("in", 2.1, 5.9),
}


def errors(rows, keys):
    """The larger of two components, of each sweep."""
    return [max(abs(r[key]) for key in keys) for r in rows]


def figures_of(rows):
    for turn in TURNS:
        own = pick(rows, sensor=turn)
        name = "scanner" if turn == "small" else f"scanner_{turn}"
        for what, keys, unit in ERRORS:
            yield figure(f"{name}_{what}", max(errors(own, keys)), unit)
            yield figure(f"{name}_{what}_median", median(errors(own, keys)), unit)
        yield figure(f"{name}_nees", mean(column(own, "chi2")))
        yield figure(f"{name}_converged", mean(column(own, "converged")))
        yield figure(f"{name}_gap_before_mm", rms(column(own, "gap_before_mm")), "mm")
        yield figure(f"{name}_gap_after_mm", rms(column(own, "gap_after_mm")), "mm")
        yield figure(f"{name}_sweeps", len(own))


def table(rows):
    head = ["guess, sweep", "converged"]
    for key, unit in (("rx", "deg"), ("ry", "deg"), ("tx", "mm"), ("ty", "mm")):
        head += [f"{key} {unit}", "sigma", "worst"]
    head += ["nees", "gap mm", "after"]
    lines = []
    for turn, label in TURNS.items():
        own = pick(rows, sensor=turn)
        line = [label, mean(column(own, "converged"))]
        for key in ("rx", "ry", "tx", "ty"):
            found = column(own, key)
            line += [rms(found), rms(column(own, f"sigma_{key}")), max(map(abs, found))]
        line += [mean(column(own, "chi2"))]
        line += [rms(column(own, key)) for key in ("gap_before_mm", "gap_after_mm")]
        lines.append(line)
    return trials.grid(head, lines) + "\n"


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(12, 5))
    for axis, (what, keys, unit) in zip(axes, ERRORS):
        for place, turn in enumerate(TURNS):
            own = pick(rows, sensor=turn)
            for k, key in enumerate(keys):
                found = [abs(e) for e in column(own, key)]
                x = place + 0.3 * (k - 0.5)
                colour = ("tab:blue", "tab:orange")[k]
                axis.scatter([x] * len(found), found, s=8, c=colour, label=None if place else key)
                sigma = rms(column(own, f"sigma_{key}"))
                axis.plot([x - 0.12, x + 0.12], [sigma, sigma], c="k")
        axis.axhline(TARGETS[f"scanner_{what}"][1], color="r", linestyle="--", label="asked for")
        axis.set_xticks(range(len(TURNS)), TURNS.values(), fontsize=8)
        axis.set(yscale="log", ylabel=f"error [{unit}]")
        trials.plain_log(axis.yaxis)
        axis.legend()
    plot.suptitle("The scanner on its motor: dots are sweeps, black the stated sigma")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "scanner-")
    missing = [turn for turn in TURNS if not pick(rows, sensor=turn)]
    if missing:
        sys.exit(f"study: no {', '.join(missing)} in {out / 'parts'}")
    draw(rows, out / "scanner.png")
    figures = list(figures_of(rows))
    trials.write(out, "scanner", rows, figures, table(rows) + trials.table(figures, TARGETS))


main()
