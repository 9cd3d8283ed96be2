"""Table, CSV, picture and summary.json of `scripts/study methods`: the literature's methods side by
side on the same simulated sessions, from first guesses that are off."""

import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, median, pick

METHODS = ("auto", "plane", "line-scan", "bearing-angle", "single-shot", "paper", "natural", "mi", "nmi",
           "gom", "edge-grid")
# A success: what a person who fuses the two would hardly see, 5 px at f = 570 px.
WITHIN_DEG, WITHIN_MM = 0.5, 50
SCENES = ("indoor", "outdoor")
LIDARS = ("turned", "32")


def place_of(row):
    """("indoor", "32")"""
    _, scene, lidar, _ = row["part"].split("-")
    return scene, lidar


def is_right(row):
    """Called converged, and near the truth."""
    return bool(row["converged"]) and row["rotation_deg"] <= WITHIN_DEG and row["translation_mm"] <= WITHIN_MM


def is_silent(row):
    """Called converged, and not near the truth."""
    return bool(row["converged"]) and not is_right(row)


def share(rows, what):
    return sum(map(what, rows)) / len(rows)


def middle(rows, key):
    values = column([r for r in rows if r["converged"]], key)
    return median(values) if values else math.nan


def cells(rows):
    """What the table says of rows."""
    wrong = [r for r in rows if not is_right(r)]
    return [f"{len(rows)}", f"{share(rows, is_right):.0%}", f"{sum(map(is_silent, rows))}",
            f"{share(wrong, lambda r: not r['converged']):.0%}" if wrong else "-",
            middle(rows, "rotation_deg"), middle(rows, "translation_mm"),
            median([r["detect_s"] for r in rows]), median([r["solve_s"] for r in rows])]


HEAD = ("cases", "right", "silent", "knew", "deg", "mm", "detect s", "solve s")


def guesses(rows):
    """Sizes of guess that a method was given; [None] where it needs none."""
    return sorted({r["guess_deg"] for r in rows}, key=lambda deg: deg or 0)


def table(rows):
    text = (f"right: converged, within {WITHIN_DEG} deg and {WITHIN_MM} mm of the truth. silent: converged,\n"
            "and it is not. knew: share of what is not right that said so. deg, mm: medians of what\n"
            "converged. Times of one camera on one core, all views.\n\n")
    lines = [[method, camera, *cells(pick(rows, method=method, camera=camera))]
             for method in METHODS for camera in trials.CAMERAS if pick(rows, method=method, camera=camera)]
    text += "All sessions and guesses\n" + trials.grid(("method", "camera", *HEAD), lines) + "\n"
    lines = []
    for method in METHODS:
        own = pick(rows, method=method)
        for deg in guesses(own):
            at = pick(own, guess_deg=deg)
            lines.append([method, "none" if deg is None else f"{deg:g} deg", *cells(at)])
    text += "By the first guess's size\n" + trials.grid(("method", "guess", *HEAD), lines) + "\n"
    lines = []
    for method in METHODS:
        for scene in SCENES:
            for lidar in LIDARS:
                own = [r for r in pick(rows, method=method) if place_of(r) == (scene, lidar)]
                if own:
                    lines.append([method, scene, lidar, *cells(own)])
    return text + "By scene and LIDAR\n" + trials.grid(("method", "scene", "lidar", *HEAD), lines)


def figures_of(rows):
    for method in METHODS:
        own = pick(rows, method=method)
        if not own:
            continue
        name = "methods_" + method.replace("-", "_")
        yield figure(f"{name}_success", share(own, is_right))
        yield figure(f"{name}_silent_failures", sum(map(is_silent, own)))
        yield figure(f"{name}_cases", len(own))
        for camera in trials.CAMERAS:
            seen = [r for r in pick(own, camera=camera) if r["converged"]]
            if seen:
                yield figure(f"{name}_{camera}_rotation_deg_median", median(column(seen, "rotation_deg")), "deg")
                yield figure(f"{name}_{camera}_translation_mm_median", median(column(seen, "translation_mm")), "mm")
        yield figure(f"{name}_solve_s_median", median([r["solve_s"] for r in own]), "s")


def curve(axis, rows, value, label, colour, marker):
    """A method over the size of its guess; one that needs none all along."""
    sizes = guesses(rows)
    if sizes == [None]:
        y = value(rows)
        axis.plot([1, 10], [y, y], "--", c=colour, marker=marker, ms=4, lw=1, label=label)
        return
    sizes = [deg for deg in sizes if deg is not None]
    axis.plot(sizes, [value(pick(rows, guess_deg=deg)) for deg in sizes], c=colour, marker=marker, ms=4,
              lw=1.2, label=label)


def draw(rows, path):
    figure_, grid = plt.subplots(2, 2, figsize=(12, 8.5), sharex=True)
    markers = "osD^v<>Pp*h"
    for axes, camera in zip(grid, trials.CAMERAS):
        for k, method in enumerate(METHODS):
            own = pick(rows, method=method, camera=camera)
            if not own:
                continue
            colour = plt.get_cmap("tab20")(2 * k % 20 + (k >= 10))
            curve(axes[0], own, lambda r: middle(r, "rotation_deg"), method, colour, markers[k])
            # Shares are often alike: each method a little beside, so that none hides another.
            curve(axes[1], own, lambda r, k=k: share(r, is_right) + 0.008 * (k - 5), method, colour, markers[k])
        axes[0].set(xscale="log", yscale="log", ylabel=f"{camera}: median error of what converged [deg]")
        axes[1].set(ylabel=f"{camera}: share right", ylim=(-0.07, 1.07))
        trials.plain_log(axes[0].yaxis)
    for axis in grid[1]:
        axis.set_xlabel("first guess off by [deg] (and 25 mm a degree); dashed: needs none")
        axis.xaxis.set_major_locator(matplotlib.ticker.FixedLocator([1, 2, 5, 10]))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure_.legend(handles, labels, loc="upper center", ncols=6, fontsize=9)
    figure_.tight_layout(rect=(0, 0, 1, 0.93))
    figure_.savefig(path, dpi=110)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "methods-")
    if not rows:
        sys.exit(f"study: no session in {out}/parts")
    draw(rows, out / "methods.png")
    trials.write(out, "methods", rows, list(figures_of(rows)), table(rows))


main()
