"""Table, CSV, picture and summary.json of `scripts/study sync`: how exactly a waved board tells each
camera's time offset, its shutter's read-out and its pose, and whether the stated sigma is right,
against the synthetic truth. Corners are sampled with the detector's noise, sweeps are by rays."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, mean, median, pick  # noqa: E402

TARGETS = {
    "sync_rgb_us_median": ("<=", 300),
    "sync_thermal_us_median": ("<=", 1000),
    "sync_rolling_us_median": ("<=", 300),
    "sync_nees_mean": ("in", 0.7, 1.5),
    "sync_extrinsic_deg_median": ("<=", 0.03),
    "sync_not_given": ("<=", 0),
}


def off(rows, what):
    """Errors [us]."""
    return [1e6 * (r[f"{what}_s"] - r[f"true_{what}_s"]) for r in rows]


def nees(rows, what):
    return [((r[f"{what}_s"] - r[f"true_{what}_s"]) / r[f"{what}_sigma_s"]) ** 2 for r in rows]


def figures_of(rows):
    given = pick(rows, given=1)
    for camera in ("rgb", "thermal"):
        own = pick(given, camera=camera)
        errors = [abs(e) for e in off(own, "offset")]
        yield figure(f"sync_{camera}_us_median", median(errors), "us")
        yield figure(f"sync_{camera}_us_worst", max(errors), "us")
    rolling = pick(given, case="rolling")
    yield figure("sync_rolling_us_median", median([abs(e) for e in off(rolling, "rolling")]), "us")
    # Of one log both cameras share the LIDAR's error: they are not two.
    yield figure("sync_nees_mean", mean(nees(pick(given, camera="rgb"), "offset")))
    yield figure("sync_rolling_nees_mean", mean(nees(given, "rolling")))
    yield figure("sync_extrinsic_deg_median", median(column(given, "rotation_deg")), "deg")
    yield figure("sync_extrinsic_mm_median", median(column(given, "translation_mm")), "mm")
    yield figure("sync_extrinsic_nees_mean", mean([n / 6 for n in column(given, "pose_nees")]))
    yield figure("sync_not_given", sum(r["given"] == 0 for r in rows))
    yield figure("sync_false_alarms", sum(r["drift"] != 0 or r["jump"] != 0 for r in rows))
    yield figure("sync_logs", len(pick(rows, camera="rgb")))


def table(rows):
    head = ["case", "camera", "logs", "offset us", "sigma us", "read-out us", "deg", "mm"]
    lines = []
    for case in ("global", "rolling"):
        for camera in ("rgb", "thermal"):
            own = pick(rows, case=case, camera=camera, given=1)
            if not own:
                continue
            lines.append(
                [
                    case,
                    camera,
                    len(own),
                    median([abs(e) for e in off(own, "offset")]),
                    1e6 * median(column(own, "offset_sigma_s")),
                    median([abs(e) for e in off(own, "rolling")]),
                    median(column(own, "rotation_deg")),
                    median(column(own, "translation_mm")),
                ]
            )
    return trials.grid(head, lines) + "\n"


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(12, 5))
    for place, what in enumerate(("offset", "rolling")):
        for number, camera in enumerate(("rgb", "thermal")):
            own = pick(rows, camera=camera, given=1)
            axes[place].errorbar(
                [i + 0.2 * number for i in range(len(own))],
                off(own, what),
                yerr=[1e6 * s for s in column(own, f"{what}_sigma_s")],
                fmt="o",
                label=camera,
            )
        axes[place].axhline(0, color="k", lw=0.7)
        axes[place].set(xlabel="log", ylabel=f"error of the {what} [us], 1 sigma")
        axes[place].legend()
    plot.suptitle("Time offsets and read-outs from a waved board")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "sync-")
    if not pick(rows, given=1):
        sys.exit(f"study: no offset was given in {out / 'parts'}")
    draw(rows, out / "sync.png")
    figures = list(figures_of(rows))
    trials.write(out, "sync", rows, figures, table(rows) + trials.table(figures, TARGETS))


main()
