"""Table, CSV, picture and summary.json of `scripts/study views`: error and sigma against the number
of views, beside the bound."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib import ticker  # noqa: E402

import trials  # noqa: E402
from trials import CAMERAS, COLOURS, METHOD_COLOURS, column, figure, mean, median, pick, rms

ERRORS = (("rotation_deg", "rotation_deg", "deg"), ("translation_mm", "centre_mm", "mm"))
# The bound is a mean over possible errors: what is reached keeps near it at any number of views.
MOST_OVER_BOUND = 1.5


def counts_of(rows):
    return sorted({r["views"] for r in rows})


def figures_of(rows):
    for count in counts_of(rows):
        for camera in CAMERAS:
            auto = pick(rows, method="auto", camera=camera, views=count)
            for name, key, unit in ERRORS:
                start = f"views{count:.0f}_{camera}_{name}"
                yield figure(f"{start}_rms", rms(column(auto, key)), unit)
                yield figure(f"{start}_rms_bound", rms(column(auto, f"bound_{key}")), unit)
                yield figure(f"{start}_median", median(column(auto, key)), unit)
                sigma = column(auto, f"sigma_{key}")
                if sigma:
                    yield figure(f"{start}_sigma", rms(sigma), unit)
        auto = pick(rows, method="auto", views=count)
        over = max(
            rms(column(pick(auto, camera=c), key)) / rms(column(pick(auto, camera=c), f"bound_{key}"))
            for c in CAMERAS
            for _, key, _ in ERRORS
        )
        yield figure(f"views{count:.0f}_rms_over_bound", over)
        if column(auto, "chi2"):
            yield figure(f"views{count:.0f}_nees_mean", mean(column(auto, "chi2")))
        yield figure(f"views{count:.0f}_solved", mean(column(auto, "converged")))
        yield figure(f"views{count:.0f}_sessions", len(pick(auto, camera="rgb")))


def targets_of(rows):
    return {f"views{c:.0f}_rms_over_bound": ("<=", MOST_OVER_BOUND) for c in counts_of(rows)}


def table(rows, figures):
    """RGB, a line a number of views; thermal is solved for together with it."""
    value = {f["name"]: f["value"] for f in figures}
    lines = []
    for count in counts_of(rows):
        start = f"views{count:.0f}_"
        line = [f"{count:.0f}"]
        for name, _, _ in ERRORS:
            for kind in ("rms", "sigma", "rms_bound"):
                line.append(value.get(f"{start}rgb_{name}_{kind}", "-"))
        line += [value.get(f"{start}nees_mean", "-"), value[f"{start}rms_over_bound"]]
        line += [f"{value[f'{start}sessions']:.0f}"]
        lines.append(line)
    head = ("views", "error deg", "sigma", "bound", "error mm", "sigma", "bound", "nees", "over bound")
    return trials.grid((*head, "sessions"), lines) + "\n"


def draw_one(axes, rows, key, unit):
    counts = counts_of(rows)
    for camera in CAMERAS:
        mine = [pick(rows, method="auto", camera=camera, views=c) for c in counts]
        shift = 0.985 if camera == "rgb" else 1.015
        for count, own in zip(counts, mine):
            errors = column(own, key)
            axes.scatter([shift * count] * len(errors), errors, s=5, c=COLOURS[camera], alpha=0.25)
        axes.plot(
            counts, [rms(column(own, key)) for own in mine], "-o", c=COLOURS[camera], ms=4,
            label=f"{camera}: RMS error",
        )
        if all(column(own, f"sigma_{key}") for own in mine):
            sigma = [rms(column(own, f"sigma_{key}")) for own in mine]
            axes.plot(counts, sigma, ":", c=COLOURS[camera], lw=2, label=f"{camera}: stated sigma")
    auto = [pick(rows, method="auto", camera="rgb", views=c) for c in counts]
    axes.plot(counts, [rms(column(o, f"bound_{key}")) for o in auto], "k--", label="bound")
    plane = [pick(rows, method="plane", camera="rgb", views=c) for c in counts]
    if all(plane):
        axes.plot(
            counts, [rms(column(o, key)) for o in plane], "-", c=METHOD_COLOURS["plane"],
            label="rgb, plane: RMS error",
        )
    axes.set(xscale="log", yscale="log", xlabel="views", ylabel=unit)
    axes.set_xticks(counts)
    axes.set_xticklabels([f"{c:.0f}" for c in counts])
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    trials.plain_log(axes.yaxis)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(13, 5.5))
    draw_one(axes[0], rows, "rotation_deg", "rotation error [deg]")
    draw_one(axes[1], rows, "centre_mm", "camera centre's error [mm]")
    plot.suptitle("How many views? Sampled sessions of the turned scanner; each dot is a session")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "views-")
    if not rows:
        sys.exit(f"study: no views in {out / 'parts'}")
    draw(rows, out / "views.png")
    figures = list(figures_of(rows))
    targets = targets_of(rows)
    judged = [f for f in figures if f["name"] in targets]
    trials.write(out, "views", rows, figures, table(rows, figures) + trials.table(judged, targets))


main()
