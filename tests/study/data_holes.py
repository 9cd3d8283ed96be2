"""The rows of `scripts/study data` about boards with holes: in how many views they are found, how far
calibrations are off, and whether the covariance says so."""

import math

import trials
from trials import CAMERAS, COLOURS, column, figure, mean, median, pick

TARGETS = {}


def read(parts):
    trials.TEXT.update({"why"})
    return trials.read(parts, "holes-")


def figures(parts):
    rows = read(parts)
    if not rows:
        return
    once = pick(rows, camera=CAMERAS[0])
    yield figure("holes_sessions", len(once))
    yield figure("holes_cloud_found", sum(column(once, "clouds")) / sum(column(once, "views")))
    for camera in CAMERAS:
        mine = pick(rows, camera=camera)
        good = pick(mine, converged=1)
        lost = [math.inf] * (len(mine) - len(good))
        yield figure(f"holes_{camera}_found", sum(column(mine, "images")) / sum(column(mine, "views")))
        yield figure(f"holes_{camera}_calibrated", len(good))
        yield figure(f"holes_{camera}_deg_median", median(column(good, "rotation_deg") + lost), "deg")
        yield figure(f"holes_{camera}_mm_median", median(column(good, "translation_mm") + lost), "mm")
        if good:
            yield figure(f"holes_{camera}_nees", mean(column(good, "nees")))


def draw(parts, axis):
    for camera in CAMERAS:
        rows = pick(read(parts), camera=camera, converged=1)
        axis.plot(column(rows, "rotation_deg"), column(rows, "translation_mm"), ".",
                  color=COLOURS[camera], label=camera)
    axis.set_xlabel("with a board with holes, off by [deg]")
    axis.set_ylabel("and by [mm]")
    axis.legend()
    axis.grid(alpha=0.3)
