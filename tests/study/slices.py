"""Table, CSV, pictures and summary.json of `scripts/study slices`: the paper's Figure 8."""

import csv
import json
import pathlib
import shutil
import sys

import matplotlib

matplotlib.use("Agg")
sys.dont_write_bytecode = True  # no __pycache__ beside the sources
import matplotlib.pyplot as plt  # noqa: E402
from objective_minima import SHARE, of_curve  # noqa: E402

METHODS = {
    "paper": ("paper", "RMS distance from the edges [px]"),
    "paper_smooth": ("paper, smooth field", "RMS distance from the edges [px]"),
    "auto": ("auto", "RMS robust residual [sigmas]"),
}
PARAMETERS = {"roll": "deg", "pitch": "deg", "yaw": "deg", "x": "m", "y": "m", "z": "m"}
COLOURS = {1: "#c6c6c6", 2: "#8fb4d9", 5: "#3b78b5", 10: "#0b2f5b"}  # the more views the darker


def read(path):
    """Curves by (camera, method, views, parameter): offsets and values."""
    curves = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            for method in METHODS:
                key = (row["camera"], method, int(row["views"]), row["parameter"])
                curve = curves.setdefault(key, ([], []))
                curve[0].append(float(row["offset"]))
                curve[1].append(float(row[method]))
    return curves


def lowest_at(curve):
    offsets, values = curve
    return offsets[min(range(len(values)), key=values.__getitem__)]


def minima(curve, share=SHARE):
    values = curve[1]
    return of_curve(values, share * (max(values) - min(values)))


def draw(curves, camera, path):
    plot, axes = plt.subplots(len(METHODS), len(PARAMETERS), figsize=(19, 9), sharex="col")
    for line, (method, (title, unit)) in enumerate(METHODS.items()):
        for a, (parameter, of) in zip(axes[line], PARAMETERS.items()):
            for (c, m, views, p), (offsets, values) in curves.items():
                if (c, m, p) != (camera, method, parameter):
                    continue
                label = f"{views} view" + ("s" if views > 1 else "")
                a.plot(offsets, values, color=COLOURS[views], lw=1.6, label=label)
            a.axvline(0, color="grey", lw=0.6, ls=":")
            a.grid(alpha=0.25)
            a.set_ylim(bottom=0)
            a.margins(x=0)
            if line == 0:
                a.set_title(parameter)
            if line == len(METHODS) - 1:
                a.set_xlabel(f"off the truth [{of}]")
        axes[line, 0].set_ylabel(f"{title}\n{unit}")
    axes[0, 0].legend(fontsize=8, loc="upper center")
    plot.suptitle(f"The objectives about the truth, {camera} (the paper's Figure 8)")
    plot.tight_layout()
    plot.savefig(path, dpi=110)
    plt.close(plot)


def figures(curves):
    keys = sorted({k[:3] for k in curves})
    for camera, method, views in keys:
        mine = {k[3]: c for k, c in curves.items() if k[:3] == (camera, method, views)}
        name = f"{camera}_{method}_{views}"
        yield f"minima_most_{name}", max(minima(c) for c in mine.values()), "1"
        for unit, of in (("deg", ("roll", "pitch", "yaw")), ("m", ("x", "y", "z"))):
            yield f"lowest_off_{unit}_{name}", max(abs(lowest_at(mine[p])) for p in of), unit


def table(curves):
    lines = [
        f"Local minima of each curve, deeper than {SHARE:.0%} of its range (in brackets: any, where"
        " there are more)",
        f"{'camera':<9}{'method':<14}{'views':>5}  " + "".join(f"{p:>9}" for p in PARAMETERS),
    ]
    for camera, method, views in sorted({k[:3] for k in curves}):
        line = f"{camera:<9}{method:<14}{views:>5}  "
        for parameter in PARAMETERS:
            curve = curves[camera, method, views, parameter]
            counts, every = minima(curve), minima(curve, 1e-9)
            line += f"{counts:>9}" if every == counts else f"{f'{counts} ({every})':>9}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def main():
    out = pathlib.Path(sys.argv[1])
    curves = read(out / "parts" / "slices.csv")
    shutil.copy(out / "parts" / "slices.csv", out / "slices.csv")
    cameras = sorted({k[0] for k in curves})
    pictures = []
    for camera in cameras:
        pictures.append("slices.png" if camera == cameras[0] else f"slices_{camera}.png")
        draw(curves, camera, out / pictures[-1])
    summary = [{"name": n, "value": v, "unit": u} for n, v, u in figures(curves)]
    (out / "summary.json").write_text(json.dumps({"figures": summary}, indent=2) + "\n")
    text = table(curves)
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, slices.csv, {', '.join(pictures)}, summary.json")


main()
