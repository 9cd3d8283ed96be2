"""The rows of `scripts/study data` about recorded packets: points that are those of the clouds that the
sensor's own software, or nebula, makes of them. Measured by tests/real/ouster_test.cc and
nebula_test.cc, robosense_test.cc, of firing times by hesai_times_test.cc, which say what has to be the same."""

import trials
from trials import figure

SENSORS = ("ouster", "hesai", "robosense", "velodyne")
TARGETS = {f"{sensor}_agree": (">=", 0.9999) for sensor in SENSORS}
TARGETS.update(hesai_times_agree=(">=", 0.9999), ouster_direction_agree=(">=", 0.9999), ouster_time_us=("<=", 1))
NEEDS = "no such recordings (ouster, nebula, hesai) in RGBDT_REAL_DATA"


def figures(parts):
    trials.TEXT.update({"name", "unit"})
    for row in trials.read(parts, "decoders"):
        yield figure(row["name"], row["value"], row["unit"])


def draw(parts, axis):
    agree = [f for f in figures(parts) if f["name"].endswith("_agree")]
    axis.barh([f["name"] for f in agree], [1 - f["value"] for f in agree])
    axis.axvline(1e-4, color="k", ls="--", lw=1)
    axis.set_xlabel("share of points that do not agree")
    axis.grid(alpha=0.3)
