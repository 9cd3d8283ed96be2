"""Table, CSV, pictures and summary.json of `scripts/study surfaces`: the paper's Figure 9."""

import csv
import json
import pathlib
import shutil
import sys

import matplotlib

matplotlib.use("Agg")
sys.dont_write_bytecode = True  # no __pycache__ beside the sources
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402
from objective_minima import SHARE, hollows_of  # noqa: E402

METHODS = {
    "paper": "paper: RMS distance from the edges [px]",
    "paper_smooth": "paper, smooth field: RMS distance from the edges [px]",
    "auto": "auto: RMS robust residual [sigmas]",
}
UNITS = {"roll": "deg", "pitch": "deg", "yaw": "deg", "x": "m", "y": "m", "z": "m"}


def read(path):
    """Surfaces by pair of parameters: offsets, other offsets, and values by method."""
    rows = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            rows.setdefault((row["parameter"], row["other"]), []).append(row)
    surfaces = {}
    for pair, mine in rows.items():
        first = sorted({float(r["offset"]) for r in mine})
        second = sorted({float(r["other_offset"]) for r in mine})
        shape = (len(first), len(second))  # rows are written in this order
        values = {m: numpy.array([float(r[m]) for r in mine]).reshape(shape) for m in METHODS}
        surfaces[pair] = (numpy.array(first), numpy.array(second), values)
    return surfaces


def read_ends(path):
    """Where one ends who goes downhill from a cell, by pair, method and cell."""
    ends = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            key = (row["parameter"], row["other"]), row["method"], (int(row["i"]), int(row["j"]))
            ends[key] = (float(row["offset"]), float(row["other_offset"]))
    return ends


class Minima:
    """Counts them: hollows of the grid that end at the same place are one minimum."""

    def __init__(self, surfaces, ends):
        self.counts = {}
        for pair, (first, second, values) in surfaces.items():
            for method, grid in values.items():
                least = SHARE * float(grid.max() - grid.min())
                places = [ends[pair, method, cell] for cell in hollows_of(grid, least)]
                self.counts[pair, method] = self.count(places, first, second)

    @staticmethod
    def count(places, first, second):
        apart = []
        for u, v in places:
            if abs(u) > first[-1] or abs(v) > second[-1]:
                continue  # downhill leads out of the surface
            size = 1.5 * (first[1] - first[0]), 1.5 * (second[1] - second[0])
            if all(abs(u - a) > size[0] or abs(v - b) > size[1] for a, b in apart):
                apart.append((u, v))
        return len(apart)


def lowest_at(surface, method):
    first, second, values = surface
    i, j = numpy.unravel_index(values[method].argmin(), values[method].shape)
    return first[i], second[j]


def draw(surfaces, minima, method, path):
    plot = plt.figure(figsize=(20, 12.5))
    for k, (pair, surface) in enumerate(surfaces.items()):
        first, second, values = surface
        a = plot.add_subplot(3, 5, k + 1, projection="3d")
        x, y = numpy.meshgrid(first, second, indexing="ij")
        z = values[method]
        floor = z.min() - 0.35 * (z.max() - z.min())
        a.plot_surface(x, y, z, cmap="viridis", rcount=61, ccount=61, lw=0, antialiased=True)
        a.contour(x, y, z, levels=18, zdir="z", offset=floor, cmap="viridis", linewidths=0.8)
        u, v = lowest_at(surface, method)
        a.plot([u], [v], [floor], marker="+", color="crimson", ms=9, mew=1.8, zorder=9)
        a.set_zlim(floor, z.max())
        a.set_zticks([tick for tick in a.get_zticks() if 0 <= tick <= z.max()])
        a.set_xlabel(f"{pair[0]} [{UNITS[pair[0]]}]")
        a.set_ylabel(f"{pair[1]} [{UNITS[pair[1]]}]")
        a.tick_params(labelsize=7, pad=0)
        a.view_init(elev=32, azim=-55)
        count = minima.counts[pair, method]
        a.set_title(f"{pair[0]}, {pair[1]}: {count} minim{'um' if count == 1 else 'a'}", y=0.98)
    plot.suptitle(
        f"{METHODS[method]}, about the truth (the paper's Figure 9); + lowest value", fontsize=14
    )
    plot.subplots_adjust(left=0.01, right=0.98, bottom=0.03, top=0.93, wspace=0.06, hspace=0.1)
    plot.savefig(path, dpi=90)
    plt.close(plot)


def figures(surfaces, minima):
    for method in METHODS:
        counts = [minima.counts[pair, method] for pair in surfaces]
        yield f"minima_most_{method}", max(counts), "1"
        yield f"surfaces_with_one_minimum_{method}", counts.count(1), "1"
    yield "surfaces", len(surfaces), "1"


def table(surfaces, minima):
    lines = [f"Local minima of each surface, deeper than {SHARE:.0%} of its range; lowest value at"]
    lines.append(f"{'pair':<14}" + "".join(f"{m:>30}" for m in METHODS))
    for pair, surface in surfaces.items():
        line = f"{', '.join(pair):<14}"
        for method in METHODS:
            u, v = lowest_at(surface, method)
            at = f"{u:.3g} {UNITS[pair[0]]}, {v:.3g} {UNITS[pair[1]]}"
            line += f"{minima.counts[pair, method]:>6}  {at:>22}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def main():
    out = pathlib.Path(sys.argv[1])
    surfaces = read(out / "parts" / "surfaces.csv")
    minima = Minima(surfaces, read_ends(out / "parts" / "hollows.csv"))
    shutil.copy(out / "parts" / "surfaces.csv", out / "surfaces.csv")
    pictures = {m: "surfaces.png" if m == "paper" else f"surfaces_{m}.png" for m in METHODS}
    for method, picture in pictures.items():
        draw(surfaces, minima, method, out / picture)
    summary = [{"name": n, "value": v, "unit": u} for n, v, u in figures(surfaces, minima)]
    (out / "summary.json").write_text(json.dumps({"figures": summary}, indent=2) + "\n")
    text = table(surfaces, minima)
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, surfaces.csv, {', '.join(pictures.values())}, summary.json")


main()
