"""Table, CSV, picture and summary.json of `scripts/study terrain`: how much of the ground is
judged, and rightly, against the synthetic truth."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, pick

SCENES = tuple(s + rings for s in ("course", "outdoor", "indoor", "night") for rings in ("", ":64"))
NOISES = (10, 30)
TARGETS = {
    "terrain_cells_right": (">=", 0.95),
    "terrain_cells_right_worst": (">=", 0.95),
    "terrain_sites_on_obstacle": ("<=", 0),
}


def share(rows, part, whole):
    return sum(column(rows, part)) / max(1, sum(column(rows, whole)))


def cases(rows):
    """Scene, noise and the sweeps of both."""
    for scene in SCENES:
        for noise in NOISES:
            yield scene, noise, pick(rows, scene=scene, range_sigma_mm=noise)


def figures_of(rows):
    yield figure("terrain_cells_right", share(rows, "right", "known"))
    worst = min(share(own, "right", "known") for _, _, own in cases(rows))
    yield figure("terrain_cells_right_worst", worst)
    yield figure("terrain_cells_known", share(rows, "seen_known", "seen"))
    yield figure("terrain_obstacles_missed", share(rows, "missed", "known"))
    yield figure("terrain_obstacles_invented", share(rows, "invented", "known"))
    yield figure("terrain_cells", sum(column(rows, "known")))
    yield figure("terrain_sites", sum(column(rows, "sites")))
    yield figure("terrain_sites_on_obstacle", sum(column(rows, "sites_on_obstacle")))
    yield figure("terrain_sweeps", len(rows))


def table(rows):
    head = ("scene", "noise mm", "cells", "right %", "missed %", "invented %", "known %", "sites")
    head += ("on obstacle",)
    lines = []
    for scene, noise, own in cases(rows):
        percent = [100 * share(own, part, "known") for part in ("right", "missed", "invented")]
        lines.append([scene, str(noise), f"{sum(column(own, 'known')):.0f}", *percent])
        lines[-1] += [100 * share(own, "seen_known", "seen")]
        lines[-1] += [f"{sum(column(own, key)):.0f}" for key in ("sites", "sites_on_obstacle")]
    return trials.grid(head, lines) + "\n"


def draw(rows, path):
    plot, axes = plt.subplots(figsize=(11, 5))
    labels = []
    for place, (scene, noise, own) in enumerate(cases(rows)):
        right = [100 * r["right"] / r["known"] for r in own]
        axes.bar(place, 100 * share(own, "right", "known"), color="#2a7f3f", alpha=0.5)
        axes.scatter([place] * len(right), right, s=6, c="k", alpha=0.4)
        labels.append(f"{scene}\n{noise} mm")
    axes.axhline(95, color="k", linestyle="--", label="95%")
    axes.set_xticks(range(len(labels)), labels, fontsize=7)
    axes.set(ylim=(85, 100), ylabel="cells judged rightly [%]")
    axes.set_title("Terrain against truth; bars: all cells, dots: single sweeps; :64 is 64 rings")
    axes.legend()
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "terrain-")
    missing = [f"{scene} {noise} mm" for scene, noise, own in cases(rows) if not own]
    if missing:
        sys.exit(f"study: no {', '.join(missing)} in {out / 'parts'}")
    draw(rows, out / "terrain.png")
    figures = list(figures_of(rows))
    trials.write(out, "terrain", rows, figures, table(rows) + trials.table(figures, TARGETS))


main()
