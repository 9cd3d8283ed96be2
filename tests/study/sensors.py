"""Table, CSV, picture and summary.json of `scripts/study sensors`: the same sessions with LIDARs of
16 to 128 rings and the turned scanner, beside the bound."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import METHOD_COLOURS, column, figure, mean, median, pick, rms

ERRORS = (("rotation_deg", "rotation_deg", "deg"), ("translation_mm", "centre_mm", "mm"))
SENSORS = ("dense", "128", "64", "32", "16")
METHODS = ("auto", "plane", "first_guess")
MOST_OVER_BOUND = 1.5


def name_of(sensor):
    return sensor if sensor == "dense" else f"beams{sensor}"


def figures_of(rows):
    for sensor in SENSORS:
        own = pick(rows, sensor=sensor)
        auto = pick(own, method="auto")
        for name, key, unit in ERRORS:
            start = f"{name_of(sensor)}_{name}"
            yield figure(f"{start}_median", median(column(auto, key)), unit)
            yield figure(f"{start}_median_bound", median(column(auto, f"bound_{key}_median")), unit)
            yield figure(f"{start}_rms", rms(column(auto, key)), unit)
            yield figure(f"{start}_rms_bound", rms(column(auto, f"bound_{key}")), unit)
            if column(auto, f"sigma_{key}"):
                yield figure(f"{start}_sigma", rms(column(auto, f"sigma_{key}")), unit)
            for method in METHODS[1:]:
                value = rms(column(pick(own, method=method), key))
                yield figure(f"{start}_rms_{method}", value, unit)
        over = max(rms(column(auto, k)) / rms(column(auto, f"bound_{k}")) for _, k, _ in ERRORS)
        yield figure(f"{name_of(sensor)}_rms_over_bound", over)
        if column(auto, "chi2"):
            yield figure(f"{name_of(sensor)}_nees_mean", mean(column(auto, "chi2")))
        yield figure(f"{name_of(sensor)}_sessions", len(pick(auto, camera="rgb")))


def table(figures):
    """Both cameras together, a line a LIDAR."""
    value = {f["name"]: f["value"] for f in figures}
    lines = []
    for sensor in SENSORS:
        line = ["turned" if sensor == "dense" else f"{sensor} rings"]
        for name, _, _ in ERRORS:
            for kind in ("rms", "rms_plane", "sigma", "rms_bound"):
                line.append(value.get(f"{name_of(sensor)}_{name}_{kind}", "-"))
        line += [value.get(f"{name_of(sensor)}_nees_mean", "-")]
        line += [value[f"{name_of(sensor)}_rms_over_bound"]]
        lines.append(line)
    head = ["LIDAR"]
    for unit in ("deg", "mm"):
        head += [f"error {unit}", "plane", "sigma", "bound"]
    return trials.grid((*head, "nees", "over bound"), lines) + "\n"


def draw_one(axes, rows, key, unit):
    for k, method in enumerate(METHODS):
        for i, sensor in enumerate(SENSORS):
            errors = column(pick(rows, sensor=sensor, method=method), key)
            place = i + 0.25 * (k - 1)
            label = method.replace("_", " ") if i == 0 else None
            axes.bar(place, rms(errors), 0.22, color=METHOD_COLOURS[method], alpha=0.6, label=label)
            axes.scatter([place] * len(errors), errors, s=3, c="k", alpha=0.25)
    for i, sensor in enumerate(SENSORS):
        bound = rms(column(pick(rows, sensor=sensor, method="auto"), f"bound_{key}"))
        axes.plot([i - 0.4, i + 0.4], [bound, bound], "k--", label=None if i else "bound")
    axes.set_xticks(range(len(SENSORS)))
    axes.set_xticklabels(["turned" if s == "dense" else f"{s} rings" for s in SENSORS])
    axes.set(yscale="log", ylabel=unit)
    trials.plain_log(axes.yaxis)
    axes.grid(alpha=0.3, axis="y")
    axes.legend(fontsize=8)


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(13, 5.5))
    draw_one(axes[0], rows, "rotation_deg", "rotation error [deg]")
    draw_one(axes[1], rows, "centre_mm", "camera centre's error [mm]")
    views = rows[0]["views"]
    plot.suptitle(f"Which LIDAR? Sampled sessions of {views:.0f} views; bars: RMS, dots: both cameras")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "sensor-")
    missing = [s for s in SENSORS if not pick(rows, sensor=s)]
    if missing:
        sys.exit(f"study: no {', '.join(missing)} in {out / 'parts'}")
    draw(rows, out / "sensors.png")
    targets = {f"{name_of(s)}_rms_over_bound": ("<=", MOST_OVER_BOUND) for s in SENSORS}
    figures = list(figures_of(rows))
    judged = [f for f in figures if f["name"] in targets]
    trials.write(out, "sensors", rows, figures, table(figures) + trials.table(judged, targets))


main()
