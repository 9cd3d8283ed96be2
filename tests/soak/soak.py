"""What soak's runs say (load.sh's CSV files): soak.py [--holds] DIR.
--holds: exit code 0 where DIR's run lost nothing and was in time, and why not. Otherwise DIR/run is
the run, DIR/default one with the kernel's default buffers, if it is there: DIR gets table.txt,
summary.json and a picture; figures are printed as "NAME VALUE UNIT". Exit code 1: one is out of its
bounds."""

import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Who hears what, of what the load publishes.
HEARS = {
    "fuser": ("RIG", "CALIBRATION", "CLOUD", "_IMAGE"),
    "detector": ("RIG", "CLOUD", "_IMAGE", "SESSION_COMMAND"),
    "solver": ("RIG", "SESSION_COMMAND"),
}
POINTS_HZ = 128_000 * 10  # soak_rig.cc, at a load of 1
# Detector and viewer grow until they have what they keep (services/README.md, view_collector.h):
KEPT_POINTS = 6_000_000  # of sweeps
KEPT_SECONDS = 60  # of images
LATE_MS = 100  # a sweep's time at a load of 1
BOUNDS = {
    "soak_rss_growth_mb": ("<=", 5),
    "soak_descriptor_growth": ("<=", 0),
    "soak_clouds_missed": ("<=", 0),
    "commands_lost": ("<=", 0),
    "held_images_dropped": (">=", 1),  # or it was no overload
    "held_clouds_dropped": ("<=", 0),
    "held_old_clouds": (">=", 1),
    "stopped_messages_dropped": (">=", 1),
    "dropped_counted_share": (">=", 0.999),
    "recovery_s": ("<=", 1),
    "soak_p99_ratio": ("<=", 1.5),
}


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def p99(values):
    values = sorted(values)
    return values[int(0.99 * (len(values) - 1))] if values else float("nan")


def of_kind(channel, kind):
    return channel == kind or (kind.startswith("_") and channel.endswith(kind))


class Run:
    def __init__(self, folder, load=None):
        self.load = load
        self.status = [(float(r["second"]), r["process"], r["counter"], int(r["value"]))
                       for r in rows_of(folder / "status.csv")]
        self.sent = {r["channel"]: int(r["messages"]) for r in rows_of(folder / "sent.csv")}
        self.latency = [(float(r["second"]), float(r["late_ms"]),
                         float(r["latency_ms"]) if r["latency_ms"] else None)
                        for r in rows_of(folder / "latency.csv")]
        self.memory = [(float(r["second"]), r["process"], int(r["rss_kb"]) / 1024,
                        int(r["descriptors"])) for r in rows_of(folder / "memory.csv")]
        self.overloads = {r["what"]: (float(r["begin"]), float(r["end"]))
                          for r in rows_of(folder / "overloads.csv")}
        self.begin, self.end = self.latency[0][0], self.latency[-1][0]
        self.steady_end = min((b for b, _ in self.overloads.values()), default=self.end)

    def counter(self, process, name, until=float("inf")):
        values = [v for t, p, c, v in self.status if p == process and c == name and t <= until]
        return values[-1] if values else 0

    def missed(self, process, kind, begin=0.0, end=float("inf")):
        """Messages of a kind that the process counted as missed between two moments."""
        names = {c for _, p, c, _ in self.status if p == process and c.startswith("gaps ")}
        return sum(self.counter(process, n, end) - self.counter(process, n, begin)
                   for n in names if of_kind(n[5:], kind))

    def missed_by_all(self, kind, begin=0.0, end=float("inf")):
        return sum(self.missed(p, kind, begin, end) for p, kinds in HEARS.items() if kind in kinds)

    def sent_of(self, *kinds):
        return sum(n for c, n in self.sent.items() if any(of_kind(c, k) for k in kinds))

    def counted_share(self):
        """Of what was sent and did not arrive, what STATUS counts; the worst process."""
        shares = []
        for process, kinds in HEARS.items():
            lost = self.sent_of(*kinds) - self.counter(process, "received")
            counted = self.counter(process, "gaps")
            shares.append(1 - abs(lost - counted) / max(lost, counted, 1))
        return min(shares)

    def latencies(self, begin, end):
        return [ms for t, _, ms in self.latency if begin <= t < end and ms is not None]

    def recovery(self, what):
        """From the overload's end until each CLOUD of a whole second came back in time [s]."""
        _, released = self.overloads[what]
        after = [(t, ms) for t, _, ms in self.latency if t >= released]
        since = released
        for t, ms in after:
            if t >= since + 1:
                return since - released
            if ms is None or ms > LATE_MS:
                since = t + (0 if ms is None else 1e-3 * ms)
        return since - released if after and after[-1][0] >= since + 1 else 1e9


def why_not_held(run):
    lost = {kind: run.missed_by_all(kind) for kind in ("_IMAGE", "CLOUD", "SESSION_COMMAND")}
    if any(lost.values()):
        return "missed " + ", ".join(f"{n} of {kind}" for kind, n in lost.items() if n)
    if run.sent["SESSION_COMMAND"] != run.sent["answered"]:
        return "commands were not answered"
    late = p99([late for _, late, _ in run.latency])
    if late > LATE_MS:
        return f"the load itself was late: p99 {late:.0f} ms"
    latency = p99([ms for _, _, ms in run.latency if ms is not None])
    if latency > LATE_MS:
        return f"latency p99 {latency:.0f} ms"
    return None


def growth(run, begin, end, column):
    """Of the process that grew most, from the first to the last tenth of its samples."""
    most = -float("inf")
    for process in {m[1] for m in run.memory}:
        values = [m[column] for m in run.memory if m[1] == process and begin <= m[0] <= end]
        if len(values) < 10:
            sys.exit(f"soak: the machine has no time: {len(values)} looks at the memory of {process}")
        tenth = len(values) // 10
        most = max(most, (sum(values[-tenth:]) - sum(values[:tenth])) / tenth)
    return most


def figures_of(run, default):
    warm = run.begin + 5 + max(KEPT_SECONDS, KEPT_POINTS / (POINTS_HZ * run.load))
    if run.steady_end - warm < 15:
        sys.exit(f"soak: too short: {run.steady_end - run.begin:.0f} s, of which "
                 f"{warm - run.begin:.0f} s fill buffers")
    fifth = (run.steady_end - warm) / 5
    first = p99(run.latencies(warm, warm + fifth))
    last = p99(run.latencies(run.steady_end - fifth, run.steady_end))
    yield "soak_load", run.load, "1"
    yield "soak_s", run.steady_end - run.begin, "s"
    sent = sum(n for c, n in run.sent.items() if c != "answered")
    yield "soak_messages_s", sent / (run.end - run.begin), "1/s"
    yield "soak_rss_growth_mb", growth(run, warm, run.steady_end, 2), "MB"
    yield "soak_descriptor_growth", growth(run, warm, run.steady_end, 3), "1"
    yield "soak_p99_first_ms", first, "ms"
    yield "soak_p99_last_ms", last, "ms"
    yield "soak_p99_ratio", max(last, 10) / max(first, 10), "1"  # below 10 ms all is well
    yield "soak_images_missed", run.missed_by_all("_IMAGE", 0, run.steady_end), "1"
    yield "soak_clouds_missed", run.missed_by_all("CLOUD", 0, run.steady_end), "1"
    if "handler" in run.overloads:
        yield from figures_of_overloads(run)
    yield "dropped_counted_share", run.counted_share(), "1"
    if default:
        for kind, name in (("_IMAGE", "images"), ("CLOUD", "clouds"), ("SESSION_COMMAND", "commands")):
            heard = [p for p, kinds in HEARS.items() if kind in kinds]
            sent = default.sent_of(kind) * len(heard)
            yield f"default_{name}_missed_share", default.missed_by_all(kind) / sent, "1"


def figures_of_overloads(run):
    held, released = run.overloads["handler"]
    stopped, _ = run.overloads["process"]
    # What a stopped process's socket could not hold is lost, whatever it is: the session asks again.
    yield "commands_lost", run.missed_by_all("SESSION_COMMAND", 0, stopped), "1"
    yield "held_s", released - held, "s"
    yield "held_images_dropped", run.missed_by_all("_IMAGE", held, stopped), "1"
    # The detector needs every cloud; the fuser wants the newest.
    yield "held_clouds_dropped", run.missed("detector", "CLOUD", held, stopped), "1"
    yield "held_old_clouds", run.missed("fuser", "CLOUD", held, stopped), "1"
    kinds = ("_IMAGE", "CLOUD", "SESSION_COMMAND", "RIG", "CALIBRATION")
    yield "stopped_s", run.overloads["process"][1] - stopped, "s"
    yield "stopped_messages_dropped", sum(run.missed_by_all(k, stopped) for k in kinds), "1"
    yield "stopped_commands_dropped", run.missed_by_all("SESSION_COMMAND", stopped), "1"
    both = {what: run.recovery(what) for what in ("handler", "process")}
    yield "recovery_held_s", both["handler"], "s"
    yield "recovery_stopped_s", both["process"], "s"
    yield "recovery_s", max(both.values()), "s"


def is_out(name, value):
    sign, bound = BOUNDS.get(name, ("", 0))
    return (sign == "<=" and not value <= bound) or (sign == ">=" and not value >= bound)


def table(figures):
    lines = []
    for name, value, unit in figures:
        sign, bound = BOUNDS.get(name, ("", ""))
        mark = "  OUT OF BOUNDS" if is_out(name, value) else ""
        lines.append(f"{name:32} {value:10.3f} {unit:8} {sign} {bound}".rstrip() + mark)
    return "\n".join(lines) + "\n"


def draw(run, path):
    plot, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(9, 6))
    came = [(t - run.begin, ms) for t, _, ms in run.latency if ms is not None]
    above.semilogy(*zip(*came), ".", markersize=2)
    above.set_ylabel("CLOUD to RGBDT_CLOUD [ms]")
    for process in sorted({m[1] for m in run.memory}):
        mine = [(t - run.begin, mb) for t, p, mb, _ in run.memory if p == process]
        below.plot(*zip(*mine), label=process)
    below.set_ylabel("memory [MB]")
    below.set_xlabel("time [s]")
    below.legend()
    for axes in (above, below):
        for begin, end in run.overloads.values():
            axes.axvspan(begin - run.begin, end - run.begin, color="tab:red", alpha=0.2)
    plot.tight_layout()
    plot.savefig(path)


def main():
    if sys.argv[1] == "--holds":
        why = why_not_held(Run(pathlib.Path(sys.argv[2])))
        sys.exit(why)
    out = pathlib.Path(sys.argv[1])
    run = Run(out / "run", float((out / "load.txt").read_text()))
    default = Run(out / "default") if (out / "default" / "sent.csv").exists() else None
    figures = list(figures_of(run, default))
    (out / "table.txt").write_text(table(figures))
    summary = {"figures": [{"name": n, "value": v, "unit": u} for n, v, u in figures]}
    (out / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
    draw(run, out / "soak.png")
    for name, value, unit in figures:
        print(f"{name} {value:.6g} {unit}")
    sys.exit(any(is_out(n, v) for n, v, _ in figures))


main()
