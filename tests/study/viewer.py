"""Table, CSV, picture and summary.json of `scripts/study viewer`: how soon the bus is on the screen,
how fast the cloud is drawn by software, and what browsers cost the bus and the machine."""

import csv
import pathlib
import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import figure

TARGETS = {
    "viewer_screen_p50_ms": ("<=", 400),
    "viewer_screen_p95_ms": ("<=", 400),
    "viewer_fps": (">=", 5),
    "viewer_stalled_p99_ratio": ("<=", 1.5),
}
TRAFFIC = {"scanner": "turned scanner", "sweeps": "sweeps of 100,000 points, 5 Hz"}


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def column(rows, name):
    return [float(row[name]) for row in rows if row[name] != ""]


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def screen_figures(screens):
    """Each second's figure is over the newest 200 frames; of the traffics the slower one counts."""
    medians = {
        (name, of): statistics.median(column(rows, f"{of}_ms"))
        for name, rows in screens.items()
        for of in ("p50", "p95")
    }
    for of in ("p50", "p95"):
        yield figure(f"viewer_screen_{of}_ms", max(medians[name, of] for name in screens), "ms")
    for (name, of), value in medians.items():
        yield figure(f"viewer_screen_{of}_ms_{name}", value, "ms")


def orbit_figures(orbit):
    yield figure("viewer_fps", statistics.median(column(orbit, "frames")), "1/s")
    yield figure("viewer_points_while_turning", statistics.median(column(orbit, "points")))


def latency_figures(latencies):
    p99 = {name: percentile(column(rows, "latency_ms"), 0.99) for name, rows in latencies.items()}
    yield figure("viewer_stalled_p99_ratio", p99["stalled"] / p99["none"])
    yield figure("viewer_bus_p99_ms_without", p99["none"], "ms")
    yield figure("viewer_bus_p99_ms_stalled", p99["stalled"], "ms")
    for name, rows in latencies.items():
        lost = sum(row["latency_ms"] == "" for row in rows)
        yield figure(f"viewer_lines_lost_{name}", lost)


def draw(screens, orbit, latencies, path):
    plot, axes = plt.subplots(1, 3, figsize=(15, 4))
    for name, rows in screens.items():
        for of, line in (("p50", "-"), ("p95", "--")):
            axes[0].plot(column(rows, "second"), column(rows, f"{of}_ms"), line,
                         label=f"{TRAFFIC[name]}, {'median' if of == 'p50' else '95 %'}")
    axes[0].axhline(400, color="k", ls=":", lw=1)
    axes[0].set_xlabel("time [s]")
    axes[0].set_ylabel("from the bus to the screen [ms]")
    axes[0].legend(fontsize=8)
    axes[1].plot(column(orbit, "second"), column(orbit, "frames"), "o-")
    axes[1].axhline(5, color="k", ls=":", lw=1)
    axes[1].set_ylim(bottom=0)
    axes[1].set_xlabel("time [s]")
    axes[1].set_ylabel("frames a second while turning, by software")
    for name, rows in latencies.items():
        values = sorted(column(rows, "latency_ms"))
        shares = [(i + 1) / len(values) for i in range(len(values))]
        axes[2].plot(values, shares, label={"none": "no browser", "stalled": "a stalled browser"}[name])
    axes[2].set_xscale("log")
    trials.plain_log(axes[2].xaxis)
    axes[2].set_xlabel("a line until it is back fused, on the bus [ms]")
    axes[2].set_ylabel("share of lines")
    axes[2].legend(fontsize=8)
    for axis in axes:
        axis.grid(alpha=0.3)
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    parts = out / "parts"
    screens = {name: read(parts / f"screen-{name}.csv") for name in TRAFFIC}
    orbit = read(parts / "orbit.csv")
    latencies = {
        name: [row for part in sorted(parts.glob(f"latency-{name}-*.csv")) for row in read(part)]
        for name in ("none", "stalled")
    }
    figures = [*screen_figures(screens), *orbit_figures(orbit), *latency_figures(latencies)]
    figures.append(figure("viewer_idle_cpu_percent", column(read(parts / "idle.csv"), "cpu_percent")[0], "%"))
    draw(screens, orbit, latencies, out / "viewer.png")
    with open(out / "viewer.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=("name", "value", "unit"))
        writer.writeheader()
        writer.writerows(figures)
    trials.write_summary(out, "viewer", figures, trials.table(figures, TARGETS))


main()
