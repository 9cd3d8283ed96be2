"""Table, CSV, picture and summary.json of `scripts/study hardware`: what the drivers cost, lose and
miss, with both cameras behind network cables and a servo on a pseudo-terminal."""

import csv
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import figure

TARGETS = {
    "camera_cpu_percent": ("<=", 40),
    "camera_frames_lost": ("<=", 0),
    "camera_reconnect_s": ("<=", 3),
    "motor_stamp_95_ms": ("<=", 0.2),
    "motor_readings_per_s": (">=", 100),
}
STAMPS = re.compile(r"readings/s (\d+), stamps off by median (\d+) us, 95% (\d+) us, max (\d+) us")


def camera_figures(text):
    values = {name: float(value) for name, value in (line.split() for line in text.splitlines())}
    of = lambda start: {k: v for k, v in values.items() if k.startswith(start)}  # noqa: E731
    lost = {**of("camera_frames_incomplete_"), **of("camera_messages_missing_")}
    away = of("camera_reconnect_s_after_")
    yield figure("camera_cpu_percent", sum(of("camera_cpu_percent_").values()), "%")
    yield figure("camera_frames_lost", sum(lost.values()))
    yield figure("camera_reconnect_s", max(away.values()), "s")
    yield from (figure(name, value, "%") for name, value in of("camera_cpu_percent_").items())
    yield from (figure(name, value, "s") for name, value in away.items())


def motor_figures(text):
    runs = [[float(x) for x in found] for found in STAMPS.findall(text)]
    if not runs:
        sys.exit("study: the motor's test printed no stamps")
    yield figure("motor_readings_per_s", min(run[0] for run in runs), "1/s")
    yield figure("motor_stamp_median_ms", max(run[1] for run in runs) / 1e3, "ms")
    yield figure("motor_stamp_95_ms", max(run[2] for run in runs) / 1e3, "ms")
    yield figure("motor_stamp_worst_ms", max(run[3] for run in runs) / 1e3, "ms")


def draw(figures, path):
    plot, axes = plt.subplots(1, 2, figsize=(11, 4))
    value = {f["name"]: f["value"] for f in figures}
    start = "camera_reconnect_s_after_"
    away = sorted((float(name[len(start):]), v) for name, v in value.items() if name.startswith(start))
    axes[0].plot(*zip(*away), "o-")
    axes[0].axhline(3, color="k", ls="--", lw=1)
    axes[0].set_xlabel("cable unplugged for [s]")
    axes[0].set_ylabel("from its return to the first frame [s]")
    kinds = ("median", "95", "worst")
    axes[1].bar(kinds, [value[f"motor_stamp_{kind}_ms"] for kind in kinds])
    axes[1].axhline(0.2, color="k", ls="--", lw=1)
    axes[1].set_ylabel("encoder's stamps off the truth by [ms]")
    for axis in axes:
        axis.grid(alpha=0.3)
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    figures = list(camera_figures((out / "parts/camera.txt").read_text()))
    figures += motor_figures((out / "parts/motor.txt").read_text())
    draw(figures, out / "hardware.png")
    with open(out / "hardware.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=("name", "value", "unit"))
        writer.writeheader()
        writer.writerows(figures)
    trials.write_summary(out, "hardware", figures, trials.table(figures, TARGETS))


main()
