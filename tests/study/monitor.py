"""Table, CSV, picture and summary.json of `scripts/study monitor`: mounts watched while a rig drives
through simulated streets and rooms, holding, knocked and drifting."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, mean, median, pick

HOLDS, MOVED, LOST = 2, 3, 4
# As WatchOptions has it: of the mounts that are looked at, so many have moved.
MOVED_SHARE = 0.02
# Every two seconds, as rgbdt-monitor does, and both cameras.
EVERY_S = 2
KNOCKS = {"rgb": 0.3, "thermal": 0.6}
TARGETS = {
    "monitor_detection_rate": (">=", 0.98),
    "monitor_false_alarm_rate": ("<=", 1 / 2000),
    "monitor_drift_deg": ("<=", 0.03),
    "monitor_core_share": ("<=", 0.25),
}


def is_alarm(row):
    return row["state"] in (MOVED, LOST)


def told(rows):
    return [r for r in rows if r["holds"] >= 0]


def runs(rows):
    by_run = {}
    for row in rows:
        by_run.setdefault((row["part"], row["camera"], row["run"]), []).append(row)
    return list(by_run.values())


def noticed(run):
    """Of the sweeps since the knock, the first with an alarm; 99: none."""
    return min((r["since"] for r in run if r["since"] > 0 and r["state"] == MOVED), default=99)


def knocked(rows, camera):
    return [run for run in runs(pick(rows, mode="knock", camera=camera))
            if abs(run[0]["size_deg"] - KNOCKS[camera]) < 1e-9]


def before(rows):
    """Sweeps of mounts that hold, looked at."""
    return [r for r in rows if (r["mode"] == "still" or r["mode"] in ("knock", "random") and r["since"] <= 0)]


def reliability(rows):
    """By what was said: how often it was so, each case by how often it occurs."""
    moved = told([r for r in pick(rows, mode="random") if r["since"] == 5])
    holds = told(before(rows))
    if not moved or not holds:
        return []
    weighed = [(r["holds"], 1, (1 - MOVED_SHARE) / len(holds)) for r in holds]
    weighed += [(r["holds"], 0, MOVED_SHARE / len(moved)) for r in moved]
    out = []
    for least, most in ((0, 0.1), (0.1, 0.5), (0.5, 0.9), (0.9, 0.99), (0.99, 1.0001)):
        own = [w for w in weighed if least <= w[0] < most]
        weight = sum(w for _, _, w in own)
        if own:
            out.append((sum(p * w for p, _, w in own) / weight, sum(h * w for _, h, w in own) / weight, len(own)))
    return out


def figures_of(rows):
    for camera in trials.CAMERAS:
        own = [noticed(run) for run in knocked(rows, camera)]
        if own:
            yield figure(f"monitor_detection_rate_{camera}", mean(n <= 5 for n in own))
            yield figure(f"monitor_sweeps_to_notice_{camera}", median(own), "sweeps")
    both = [noticed(run) for camera in trials.CAMERAS for run in knocked(rows, camera)]
    yield figure("monitor_detection_rate", mean(n <= 5 for n in both))
    yield figure("monitor_knocks", len(both))
    quiet = before(rows)
    yield figure("monitor_false_alarm_rate", sum(is_alarm(r) for r in quiet) / len(quiet), "a sweep")
    yield figure("monitor_sweeps_unmoved", len(quiet))
    yield figure("monitor_told_share", len(told(quiet)) / len([r for r in quiet if r["edges"] > 0]))
    drifting = told(pick(rows, mode="drift"))
    if drifting:
        yield figure("monitor_drift_deg", median([abs(r["yaw_error_deg"]) for r in drifting]), "deg")
        yield figure("monitor_drift_deg_worst", max(abs(r["yaw_error_deg"]) for r in drifting), "deg")
    seconds = {camera: column(pick(quiet, camera=camera), "seconds") for camera in trials.CAMERAS}
    yield figure("monitor_core_share", sum(mean(s) for s in seconds.values() if s) / EVERY_S)
    yield figure("monitor_nees_mean", mean(column(told(quiet), "chi2")))
    for said, held, count in reliability(rows):
        yield figure(f"monitor_holds_when_said_{said:.3g}", held)


def table(rows):
    lines = []
    for mode in ("still", "knock", "random", "drift"):
        for camera in trials.CAMERAS:
            for size in sorted({r["size_deg"] for r in pick(rows, mode=mode)}):
                own = pick(rows, mode=mode, camera=camera, size_deg=size)
                if not own:
                    continue
                known = told(own)
                late = [noticed(run) for run in runs(own)] if mode in ("knock", "random") else []
                lines.append([mode, camera, f"{size:g}", f"{len(own)}", f"{len(known)}",
                              f"{sum(is_alarm(r) for r in own)}",
                              f"{sum(n <= 5 for n in late)} of {len(late)}" if late else "",
                              median(column(known, "rotation_deg")) if known else "",
                              median(column(known, "translation_mm")) if known else "",
                              mean(column(known, "chi2")) if known else ""])
    head = ("mode", "camera", "deg", "sweeps", "told", "alarms", "noticed in 5", "error deg", "mm", "chi2 of 6")
    return trials.grid(head, lines) + "\n"


def draw(rows, path):
    figure_, axes = plt.subplots(1, 3, figsize=(15, 4.5))
    for camera in trials.CAMERAS:
        colour = trials.COLOURS[camera]
        late = [min(noticed(run), 6) for run in knocked(rows, camera)]
        if late:
            steps = range(1, 6)
            axes[0].plot(steps, [mean(n <= k for n in late) for k in steps], "o-", c=colour,
                         label=f"{camera}, {KNOCKS[camera]} deg")
        for run in runs(pick(rows, mode="drift", camera=camera)):
            known = told(run)
            axes[1].plot(column(known, "sweep"), column(known, "yaw_error_deg"), c=colour, lw=0.8)
    axes[0].set(xlabel="sweeps since the knock", ylabel="share noticed", ylim=(0, 1.05))
    axes[0].legend(fontsize=8)
    axes[1].set(xlabel="sweep", ylabel="error of yaw while it drifts [deg]")
    axes[1].axhspan(-0.03, 0.03, color="0.9")
    said = reliability(rows)
    axes[2].plot([0, 1], [0, 1], c="k", lw=0.8)
    axes[2].plot([s for s, _, _ in said], [h for _, h, _ in said], "o")
    for s, h, count in said:
        axes[2].annotate(f"{count}", (s, h), textcoords="offset points", xytext=(4, -10), fontsize=7)
    axes[2].set(xlabel="probability that it holds, as said", ylabel="share of those that do")
    figure_.tight_layout()
    figure_.savefig(path, dpi=110)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "monitor-")
    if not rows:
        sys.exit(f"study: no session in {out}/parts")
    draw(rows, out / "monitor.png")
    figures = list(figures_of(rows))
    trials.write(out, "monitor", rows, figures, table(rows) + trials.table(figures, TARGETS))


main()
