"""Table, CSV, picture and summary.json of `scripts/bench` from what its parts left in DIR/parts:
Google Benchmark's JSON, latency.csv, memory.csv, replay.csv and growth.json."""

import csv
import json
import math
import pathlib
import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "study"))
import trials  # noqa: E402
from trials import figure  # noqa: E402

OURS = "rgbdt"
SETTLED_S = 20  # memory is watched from here on, or in a short run from its first third on
SWEEP_POINTS = 1e6  # throughput and ratio are told at this size, or at the largest below
TARGETS = {
    "assemble_points_per_s": (">=", 30e6),
    "detect_image_over_sb": ("<=", 0.25),
    "fuse_points_per_s": (">=", 10e6),
    "fuse_ratio_in_view": (">=", 1.3),
    "fuse_ratio_360": (">=", 2.5),
    "fuse_latency_ms_p99": ("<=", 15),
    "fuse_lost": ("<=", 0),
    "fuse_rss_mb": ("<=", 400),
    "fuse_rss_growth_mb": ("<=", 5),
    "replay_speed": (">=", 10),
}
STAGES = (
    "assemble",
    "detect_image_rgb",
    "detect_image_thermal",
    "detect_cloud",
    "solve",
    "demosaic",
    "project",
    "visibility",
    "fuse_in_view",
    "fuse_360",
    "fuse_by_cameras",
    "replay",
)
COLOURS = {
    "assemble": "tab:blue",
    "project": "tab:olive",
    "fuse_in_view": "tab:red",
    "fuse_360": "tab:purple",
    "detect_cloud": "tab:green",
}


def parse(name):
    row, who, size, unit, cameras = name.split("|")[:5]
    cameras = cameras.split("/")[0]  # Google Benchmark adds "/repeats:3"
    return row, who, int(size), unit, int(cameras)


def read_json(paths):
    """Of each row and side the least time of all repetitions: what else runs only adds."""
    sides = {}
    for path in paths:
        for run in json.loads(path.read_text())["benchmarks"]:
            if run["run_type"] != "iteration":
                continue
            key = parse(run["name"])
            if run.get("error_occurred"):
                sys.exit(f"bench: {run['name']}: {run['error_message']}")
            seconds = run["cpu_time"] * {"ns": 1e-9, "us": 1e-6, "ms": 1e-3}[run["time_unit"]]
            side = sides.setdefault(key, {"seconds": math.inf, "peak_mb": 0})
            side["seconds"] = min(side["seconds"], seconds)
            side["peak_mb"] = max(side["peak_mb"], run["peak_mb"])
    return sides


def rows_of(sides):
    """One for each side, a row's own before its rivals'; a rival's ratio is its time over ours."""
    rows = []
    for (row, who, size, unit, cameras), side in sides.items():
        ours = sides.get((row, OURS, size, unit, cameras))
        ratio = side["seconds"] / ours["seconds"] if ours and who != OURS else None
        rows.append(
            {
                "row": row,
                "who": who,
                "size": size,
                "unit": unit,
                "cameras": cameras,
                "milliseconds": 1e3 * side["seconds"],
                "per_second": size / side["seconds"],
                "ratio": ratio,
                "peak_mb": side["peak_mb"],
            }
        )
    return sorted(rows, key=place_of)


def place_of(row):
    """Stages first, as the data flows; then messages by name."""
    name = row["row"]
    stage = STAGES.index(name) if name in STAGES else len(STAGES)
    message = "" if name in STAGES else name.split("_", 1)[-1]
    return stage, message, name, row["size"], row["cameras"], row["who"] != OURS, row["who"]


def read_table(path):
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return [{k: float(v) if v else None for k, v in r.items()} for r in csv.DictReader(file)]


def replay_row(runs):
    best = min(runs, key=lambda r: r["wall_s"])
    row = {"row": "replay", "unit": "s of a log", "cameras": 2, "size": best["log_s"]}
    ours = {
        **row,
        "who": OURS,
        "milliseconds": 1e3 * best["wall_s"],
        "per_second": best["log_s"] / best["wall_s"],
        "ratio": None,
        "peak_mb": max(r["peak_mb"] for r in runs),
    }
    live = {
        **row,
        "who": "real time",
        "milliseconds": 1e3 * best["log_s"],
        "per_second": 1,
        "ratio": best["log_s"] / best["wall_s"],
        "peak_mb": None,
    }
    return [ours, live]


def pick(rows, row, who=None):
    return [r for r in rows if r["row"] == row and (r["who"] == who if who else r["who"] != OURS)]


def at_a_sweep(rows, row, who=None):
    """The largest size up to SWEEP_POINTS; of several rivals the quickest."""
    mine = [r for r in pick(rows, row, who) if r["size"] <= SWEEP_POINTS] or pick(rows, row, who)
    if not mine:
        return None
    largest = max(r["size"] for r in mine)
    return min((r for r in mine if r["size"] == largest), key=lambda r: r["milliseconds"])


def last_decade_slope(rows, row):
    mine = sorted(pick(rows, row, OURS), key=lambda r: r["size"])
    if len(mine) < 2:
        return None
    first, last = mine[-2:]
    return math.log(last["milliseconds"] / first["milliseconds"]) / math.log(
        last["size"] / first["size"]
    )


def stage_figures(rows):
    names = {"assemble": "assemble_points_per_s", "fuse_in_view": "fuse_points_per_s"}
    for row, name in names.items():
        ours = at_a_sweep(rows, row, OURS)
        if ours:
            yield figure(name, ours["per_second"], "1/s")
    for row in dict.fromkeys(r["row"] for r in rows):
        rival = at_a_sweep(rows, row)
        if row == "fuse_by_cameras":
            for side in pick(rows, row, OURS):
                name = f"fuse_points_per_s_{side['cameras']}_cameras"
                yield figure(name, side["per_second"], "1/s")
        elif rival and row != "replay":
            words = row.split("_")
            name = "_".join([words[0], "ratio", *words[1:]])
            yield figure(name, rival["ratio"])
        if rival and row == "detect_image_rgb":
            yield figure("detect_image_over_sb", 1 / rival["ratio"])
        if row in COLOURS:
            slope = last_decade_slope(rows, row)
            if slope is not None:
                yield figure(f"{row}_slope_last_decade", slope)
            largest = max(pick(rows, row, OURS), key=lambda r: r["size"])
            yield figure(f"{row}_peak_mb", largest["peak_mb"], "MB")


def share(values, part):
    """The value that this part of all does not exceed."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, math.ceil(part * len(ordered)) - 1)]


def latency_figures(lines):
    came = [r["latency_ms"] for r in lines if r["latency_ms"] is not None]
    yield figure("fuse_lost", len(lines) - len(came))
    yield figure("fuse_lines", len(lines))
    if not came:
        return
    for name, value in (("p50", 0.5), ("p99", 0.99), ("max", 1)):
        yield figure(f"fuse_latency_ms_{name}", share(came, value), "ms")
    seen = sum(r["seen_by_all"] for r in lines) / sum(r["points"] for r in lines)
    yield figure("fuse_seen_by_both", seen)


def settled_from(memory):
    return min(SETTLED_S, memory[-1]["second"] / 3)


def memory_figures(memory):
    settled = [r["rss_mb"] for r in memory if r["second"] >= settled_from(memory)]
    few = max(1, min(5, len(settled) // 3))
    yield figure("fuse_rss_mb", max(r["rss_mb"] for r in memory), "MB")
    growth = statistics.median(settled[-few:]) - statistics.median(settled[:few])
    yield figure("fuse_rss_growth_mb", growth, "MB")
    yield figure("fuse_rss_growth_s", memory[-1]["second"] - settled_from(memory), "s")


def growth_figures(path):
    if not path.exists():
        return
    for f in json.loads(path.read_text())["figures"]:
        yield {**f, "name": "growth_" + f["name"]}


def human(value):
    for factor, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= factor:
            return f"{value / factor:.3g}{letter} "
    return f"{value:.3g} "


def duration(milliseconds):
    for factor, unit in ((1e3, "s"), (1, "ms"), (1e-3, "us")):
        if milliseconds >= factor:
            return f"{milliseconds / factor:.3g} {unit}"
    return f"{1e6 * milliseconds:.3g} ns"


def table(rows, figures):
    text = trials.table([f for f in figures if f["name"] in TARGETS], TARGETS)
    text += "\nTime on one core, least of all repetitions; ratio: the rival's time over ours\n"
    lines = []
    for r in rows:
        if r["who"] != OURS:
            continue
        same = [o for o in rows if all(o[k] == r[k] for k in ("row", "size", "unit", "cameras"))]
        rivals = [o for o in same if o["who"] != OURS]
        for i, rival in enumerate(rivals or [None]):
            mine = [r["row"], human(r["size"]) + r["unit"], f"{r['cameras'] or ''}"]
            mine += [duration(r["milliseconds"]), human(r["per_second"]) + "/s"]
            mine += [f"{r['peak_mb']:.0f} MB"]
            theirs = ["", "", ""]
            if rival:
                theirs = [rival["who"], duration(rival["milliseconds"]), f"{rival['ratio']:.3g}"]
            lines.append((mine if i == 0 else [""] * len(mine)) + theirs)
    head = ("row", "input", "cameras", "time", "throughput", "memory", "rival", "its time", "ratio")
    text += trials.grid(head, lines) + "\nAll other figures\n"
    return text + trials.table([f for f in figures if f["name"] not in TARGETS], {})


def draw_growth(axes, rows, key, label):
    for row, colour in COLOURS.items():
        mine = sorted(pick(rows, row, OURS), key=lambda r: r["size"])
        if not mine:
            continue
        axes.plot([r["size"] for r in mine], [key(r) for r in mine], "-o", c=colour, ms=4, label=row)
        for style, who in zip(("--", ":"), dict.fromkeys(r["who"] for r in pick(rows, row))):
            theirs = sorted(pick(rows, row, who), key=lambda r: r["size"])
            axes.plot(
                [r["size"] for r in theirs], [key(r) for r in theirs], style, c=colour, lw=1,
                label=f"  {who}",
            )
    axes.set(xscale="log", yscale="log", xlabel="points", ylabel=label)
    axes.grid(alpha=0.3, which="both", lw=0.5)


def draw_cameras(axes, rows):
    sides = dict.fromkeys(r["who"] for r in rows if r["row"] == "fuse_by_cameras")
    for who in sides:
        mine = pick(rows, "fuse_by_cameras", who)
        nanoseconds = [1e6 * r["milliseconds"] / r["size"] for r in mine]
        style = "-o" if who == OURS else "--o"
        axes.plot([r["cameras"] for r in mine], nanoseconds, style, c="tab:red", ms=4, label=who)
    axes.set(xlabel="cameras, all points in view of all", ylabel="ns a point", ylim=(0, None))
    axes.set_title("Fusing against cameras")
    axes.grid(alpha=0.3)
    if sides:
        axes.legend(fontsize=8)


def draw_ratios(axes, rows, names, title):
    bars = []
    for row in names:
        rival = at_a_sweep(rows, row)
        if rival:
            whose = "" if rival["who"] == "memcpy" else f"\n{rival['who']}"
            bars.append((row.replace("_", " ") + whose, rival["ratio"]))
    bars.reverse()
    colours = ["tab:green" if ratio >= 1 else "tab:orange" for _, ratio in bars]
    axes.barh([name for name, _ in bars], [ratio for _, ratio in bars], color=colours)
    for i, (_, ratio) in enumerate(bars):
        axes.text(ratio, i, f" {ratio:.2g}", va="center", fontsize=7)
    axes.axvline(1, c="k", lw=1)
    axes.set(xscale="log", xlabel="rival's time over ours: right of 1 is quicker", title=title)
    axes.tick_params(axis="y", labelsize=7)
    axes.margins(x=0.15, y=0.01)
    axes.grid(alpha=0.3, axis="x")


def draw_live(axes, lines, memory):
    came = [r for r in lines if r["latency_ms"] is not None]
    if came:
        axes.plot([r["second"] for r in came], [r["latency_ms"] for r in came], ".", ms=2)
        p99 = share([r["latency_ms"] for r in came], 0.99)
        axes.axhline(p99, c="tab:blue", lw=1, ls="--", label=f"99% within {p99:.2g} ms")
        axes.legend(fontsize=8, loc="lower right")
    axes.set(xlabel="second", ylabel="line in to chunk out [ms]", yscale="log")
    trials.plain_log(axes.yaxis)
    axes.set_title("Live: latency and the fuser's memory")
    axes.grid(alpha=0.3)
    if memory:
        right = axes.twinx()
        right.plot([r["second"] for r in memory], [r["rss_mb"] for r in memory], c="tab:red")
        right.set_ylabel("resident [MB]", color="tab:red")
        right.set_ylim(0, None)


def draw(rows, lines, memory, path):
    plot, axes = plt.subplots(2, 3, figsize=(20, 12), layout="constrained")
    draw_growth(axes[0][0], rows, lambda r: 1e6 * r["milliseconds"] / r["size"], "ns a point")
    low, high = axes[0][0].get_ylim()
    axes[0][0].set_ylim(low, high * 5)  # room for the legend
    axes[0][0].set_title("Time of a point against points: level is linear")
    if any(r["row"] in COLOURS for r in rows):
        axes[0][0].legend(fontsize=7, ncol=2, loc="upper right")
    stages = [name for name in STAGES if name != "fuse_by_cameras"]
    draw_ratios(axes[0][1], rows, stages, "Stages beside the plain library call")
    messages = [r for r in dict.fromkeys(r["row"] for r in rows) if r not in STAGES]
    draw_ratios(axes[0][2], rows, messages, "Messages beside memcpy of their bytes")
    draw_growth(axes[1][0], rows, lambda r: r["peak_mb"], "MB, program and input included")
    axes[1][0].set_title("Most memory")
    draw_cameras(axes[1][1], rows)
    draw_live(axes[1][2], lines, memory)
    plot.savefig(path, dpi=90)


def main():
    out = pathlib.Path(sys.argv[1])
    parts = out / "parts"
    rows = rows_of(read_json(sorted(parts.glob("stages-*.json")) + sorted(parts.glob("codec.json"))))
    replays = read_table(parts / "replay.csv")
    lines = read_table(parts / "latency.csv")
    memory = read_table(parts / "memory.csv")
    if replays:
        rows = sorted(rows + replay_row(replays), key=place_of)
    figures = list(stage_figures(rows))
    if lines:
        figures += latency_figures(lines)
    if memory:
        figures += memory_figures(memory)
    if replays:
        best = min(replays, key=lambda r: r["wall_s"])
        figures.append(figure("replay_speed", best["log_s"] / best["wall_s"]))
        figures.append(figure("replay_peak_mb", max(r["peak_mb"] for r in replays), "MB"))
    figures += growth_figures(parts / "growth.json")
    draw(rows, lines, memory, out / "bench.png")
    with open(out / "bench.csv", "w", newline="") as file:
        columns = ("row", "who", "size", "unit", "cameras", "milliseconds", "per_second", "ratio")
        writer = csv.DictWriter(file, fieldnames=(*columns, "peak_mb"))
        writer.writeheader()
        writer.writerows(rows)
    (out / "summary.json").write_text(json.dumps({"figures": figures}, indent=2) + "\n")
    text = table(rows, figures)
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, bench.csv, bench.png, summary.json")


main()
