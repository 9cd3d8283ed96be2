"""The rows of `scripts/study data` about two LIDARs in one rig: how far the pose of one relative to
the other is off, and whether its covariance says so."""

import math

import trials
from trials import column, figure, mean, median, pick

INSIDE_95 = 12.59  # chi-square of six degrees of freedom
# With beams as the noise model has them; with all off that is off in real rigs.
SUFFIX = {"sampled": "", "physics": "_physics"}
TARGETS = {"lidar_lidar_deg_median": ("<=", 0.03), "lidar_lidar_mm_median": ("<=", 2)}


def read(parts):
    trials.TEXT.update({"how", "why"})
    return trials.read(parts, "lidars-")


def figures(parts):
    rows = read(parts)
    for how, suffix in SUFFIX.items():
        mine = [r for r in pick(rows, how=how) if r["has_sigma"] == 1]
        if not mine:
            continue
        # A session without a pose is off by more than any other.
        lost = [math.inf] * (len(pick(rows, how=how)) - len(mine))
        turns, moves = column(mine, "rotation_deg"), column(mine, "translation_mm")
        yield figure(f"lidar_lidar_deg_median{suffix}", median(turns + lost), "deg")
        yield figure(f"lidar_lidar_mm_median{suffix}", median(moves + lost), "mm")
        yield figure(f"lidar_lidar_nees{suffix}", mean(column(mine, "nees")))
        yield figure(f"lidar_lidar_inside95{suffix}", mean([r["nees"] <= INSIDE_95 for r in mine]))
        yield figure(f"lidar_lidar_sessions{suffix}", len(pick(rows, how=how)))
        yield figure(f"lidar_lidar_calibrated{suffix}", len(mine))


def draw(parts, axis):
    for how in SUFFIX:
        rows = [r for r in pick(read(parts), how=how) if r["has_sigma"] == 1]
        axis.plot(column(rows, "rotation_deg"), column(rows, "translation_mm"), ".", label=how)
    axis.set_xlabel("LIDAR against LIDAR, off by [deg]")
    axis.set_ylabel("and by [mm]")
    axis.legend()
    axis.grid(alpha=0.3)
