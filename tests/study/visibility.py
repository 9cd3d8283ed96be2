"""Table, CSV, picture and summary.json of `scripts/study visibility`: whether the fuser colours what
a camera sees and nothing else, against shadow rays into the synthetic scenes."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, pick

SENSORS = ("turned", "dense", "128", "64", "32", "16")
JUDGED = (("whole", "a sweep at its end"), ("live", "chunk by chunk"))
TARGETS = {
    "hidden_coloured": ("<=", 0.005),
    "visible_coloured": (">=", 0.98),
}


def name_of(sensor):
    return sensor if sensor in ("turned", "dense") else f"beams{sensor}"


def share(rows, what):
    return sum(column(rows, f"{what}_coloured")) / max(1, sum(column(rows, what)))


def figures_of(rows):
    for sensor in SENSORS:
        for judged, _ in JUDGED:
            own = pick(rows, sensor=sensor, judged=judged)
            start = "" if sensor == "turned" else name_of(sensor) + "_"
            start += "" if judged == "whole" else "live_"
            for what in ("hidden", "visible"):
                yield figure(f"{start}{what}_coloured", share(own, what))
                yield figure(f"{start}{what}_points", sum(column(own, what)))


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(11, 4.5))
    for k, (judged, label) in enumerate(JUDGED):
        for axis, what in zip(axes, ("hidden", "visible")):
            values = [100 * share(pick(rows, sensor=s, judged=judged), what) for s in SENSORS]
            axis.bar([i + 0.4 * k - 0.2 for i in range(len(SENSORS))], values, 0.38, label=label)
    for axis, what, limit in zip(axes, ("hidden", "visible"), (0.5, 98)):
        axis.axhline(limit, color="k", ls="--", lw=1, label="asked of the turned scanner")
        axis.set_xticks(range(len(SENSORS)))
        axis.set_xticklabels([s if s in ("turned", "dense") else f"{s} rings" for s in SENSORS])
        axis.set_ylabel(f"{what} points that are coloured [%]")
        axis.grid(alpha=0.3, axis="y")
    axes[1].set_ylim(80, 100)
    axes[0].legend(fontsize=8)
    plot.suptitle("What a camera cannot see gets no colour: against shadow rays")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "visibility-")
    missing = [s for s in SENSORS if not pick(rows, sensor=s)]
    if missing:
        sys.exit(f"study: no {', '.join(missing)} in {out / 'parts'}")
    draw(rows, out / "visibility.png")
    figures = list(figures_of(rows))
    trials.write(out, "visibility", rows, figures, trials.table(figures, TARGETS))


main()
