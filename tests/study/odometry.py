"""Table, CSV, picture and summary.json of `scripts/study odometry`: how far a LIDAR's odometry
drifts, how fast it is, and whether it says what it is not told, against the synthetic truth. How
thick the walls of a map are whose drive came back to where it began, with its loops closed; how many
loops are false. Whether points are coloured as if the rig stood still. KITTI's relative error (Geiger, Lenz and Urtasun 2012), here over 100 m, from every tenth
sweep on; TUM's absolute trajectory error (Sturm et al. 2012), aligned with the truth."""

import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, mean, median, pick  # noqa: E402

DRIVES = {"street-32": "street, 32 rings", "street-16": "street, 16 rings", "room-32": "room, 32",
          "stops-0": "room, turned scanner",
          "turning-0": "room, turned scanner that drives"}
NAMES = {"street-32": "odometry", "stops-0": "odometry_turned",
         "turning-0": "odometry_driving"}  # of figures
NOT_TOLD = {"corridor-32": "corridor", "plain-32": "plain"}
WALLS = {"true_mm": "true poses", "open_mm": "odometry alone", "closed_mm": "loops closed"}
PERIOD = 0.1  # [s] of a sweep
TARGETS = {
    "odometry_percent": ("<=", 0.3),
    "odometry_realtime_factor": (">=", 5),
    "odometry_degenerate_found": (">=", 1),
    "odometry_degenerate_false": ("<=", 0),
    "odometry_lost": ("<=", 0),
    "odometry_turned_percent": ("<=", 0.5),
    "odometry_turned_lost": ("<=", 0),
    "odometry_driving_percent": ("<=", 0.5),
    "odometry_driving_lost": ("<=", 0),
    "moving_colour_share": (">=", 0.97),
    "odometry_way_over_sigma": ("in", 0.5, 1.5),
    "map_wall_mm": ("<=", 30),
    "map_false_loops": ("<=", 0),
    "map_drives_without_loop": ("<=", 0),
}


def rotation(q):
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def poses(rows, prefix):
    """4x4 matrices."""
    found = []
    for row in rows:
        pose = np.eye(4)
        pose[:3, :3] = rotation([row[f"{prefix}q{k}"] for k in "xyzw"])
        pose[:3, 3] = [row[f"{prefix}{k}"] for k in "xyz"]
        found.append(pose)
    return found


def relative_errors(truth, found, length_m):
    """Of stretches of this length: error of the way over its length, and its turn [deg/m]."""
    steps = [np.linalg.norm(b[:3, 3] - a[:3, 3]) for a, b in zip(truth, truth[1:])]
    way = np.concatenate([[0], np.cumsum(steps)])
    errors = []
    for first in range(0, len(truth), 10):
        last = int(np.searchsorted(way, way[first] + length_m))
        if last >= len(truth):
            break
        true_step = np.linalg.inv(truth[first]) @ truth[last]
        step = np.linalg.inv(found[first]) @ found[last]
        off = np.linalg.inv(step) @ true_step
        turn = math.acos(min(1, max(-1, (np.trace(off[:3, :3]) - 1) / 2)))
        errors.append((np.linalg.norm(off[:3, 3]) / length_m, math.degrees(turn) / length_m))
    return errors


def absolute_error(truth, found):
    """RMS [m] after the rotation and shift that fit best (Kabsch)."""
    a = np.array([p[:3, 3] for p in truth])
    b = np.array([p[:3, 3] for p in found])
    u, _, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    flip = np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))])
    turned = (b - b.mean(0)) @ (vt.T @ flip @ u.T).T
    return math.sqrt(((turned - (a - a.mean(0))) ** 2).sum(1).mean())


def way_over_sigma(run):
    """Of the way from each sweep to the next: its squared error over both places' variances. What
    the map is off by is common to both, so that an honest covariance gives 1 or less."""
    placed = [r for r in run if r["converged"]]
    truth, found = poses(placed, "true_"), poses(placed, "")
    ratios = []
    for i in range(1, len(placed)):
        step = (np.linalg.inv(found[i - 1]) @ found[i])[:3, 3]
        true_step = (np.linalg.inv(truth[i - 1]) @ truth[i])[:3, 3]
        variance = placed[i - 1]["sigma_m"] ** 2 + placed[i]["sigma_m"] ** 2
        ratios.append(((step - true_step) ** 2).sum() / variance)
    return mean(ratios)


def runs(rows, kind):
    parts = sorted({r["part"] for r in rows if r["part"].startswith(f"odometry-{kind}-")})
    return [pick(rows, part=part) for part in parts]


def summary(run):
    truth, found = poses(run, "true_"), poses(run, "")
    way = sum(np.linalg.norm(b[:3, 3] - a[:3, 3]) for a, b in zip(truth, truth[1:]))
    length = min(100, 0.5 * way)  # a room's way is shorter
    errors = relative_errors(truth, found, length)
    placed = run[1:]  # the first sweep tells nothing
    return {
        "way_m": way,
        "percent": 100 * mean([e[0] for e in errors]),
        "deg_per_100m": 100 * mean([e[1] for e in errors]),
        "ate_m": absolute_error(truth, found),
        "realtime": mean(column(placed, "lasts")) / mean(column(placed, "seconds")),
        "slowest_ms": 1000 * max(column(placed, "seconds")),
        "lost": sum(r["converged"] == 0 for r in placed),
        "degenerate": sum(r["degenerate"] > 0 for r in placed),
        "over_sigma": way_over_sigma(placed),
        "way_off_mm": 1000 * max(column(placed, "way_off_m")),
    }


def told(run):
    """Whether every sweep whose place was found said that something is not told."""
    placed = [r for r in run[1:] if r["converged"]]
    return bool(placed) and all(r["degenerate"] > 0 for r in placed)


def figures_of(rows):
    for kind in DRIVES:
        own = [summary(run) for run in runs(rows, kind)]
        if not own:
            continue
        name = NAMES.get(kind, f"odometry_{kind.replace('-', '_')}")
        yield figure(f"{name}_percent", mean([s["percent"] for s in own]), "%")
        yield figure(f"{name}_percent_worst", max(s["percent"] for s in own), "%")
        yield figure(f"{name}_deg_per_100m", mean([s["deg_per_100m"] for s in own]), "deg")
        yield figure(f"{name}_ate_m", median([s["ate_m"] for s in own]), "m")
        yield figure(f"{name}_realtime_factor", min(s["realtime"] for s in own))
        yield figure(f"{name}_way_over_sigma", mean([s["over_sigma"] for s in own]))
        yield figure(f"{name}_lost", sum(s["lost"] for s in own))
        yield figure(f"{name}_degenerate_false", sum(s["degenerate"] for s in own))
        if kind == "turning-0":
            yield figure(f"{name}_way_off_mm", max(s["way_off_mm"] for s in own), "mm")
        yield figure(f"{name}_drives", len(own))
    for kind, label in NOT_TOLD.items():
        own = [told(run) for run in runs(rows, kind)]
        name = "odometry_degenerate" if label == "corridor" else f"odometry_{label}"
        yield figure(f"{name}_found", mean([float(t) for t in own]))
        yield figure(f"{name}_drives", len(own))


def map_figures_of(rows):
    """Of drives round a block; false loops of those through twins, too."""
    own = [r for r in rows if r["part"].startswith("map-block-")]
    yield figure("map_wall_mm", median(column(own, "closed_mm")), "mm")
    yield figure("map_wall_worst_mm", max(column(own, "closed_mm")), "mm")
    yield figure("map_wall_open_mm", median(column(own, "open_mm")), "mm")
    yield figure("map_wall_true_mm", median(column(own, "true_mm")), "mm")
    yield figure("map_end_off_m", median(column(own, "closed_end_m")), "m")
    yield figure("map_end_off_open_m", median(column(own, "open_end_m")), "m")
    yield figure("map_ate_m", median(column(own, "closed_rms_m")), "m")
    yield figure("map_ate_open_m", median(column(own, "open_rms_m")), "m")
    yield figure("map_close_s", max(column(own, "seconds")), "s")
    yield figure("map_drives_without_loop", sum(r["loops"] == 0 for r in own))
    yield figure("map_drives", len(own))
    yield figure("map_false_loops", sum(column(rows, "false_loops")))
    yield figure("map_twin_drives", len(rows) - len(own))


def colour_figures_of(rows):
    for poses, name in (("odometry", "moving_colour"), ("true", "moving_colour_true_poses")):
        own = pick(rows, poses=poses)
        yield figure(f"{name}_share", sum(column(own, "alike")) / sum(column(own, "seen")))
        yield figure(f"{name}_share_worst", min(r["alike"] / r["seen"] for r in own))
    yield figure("moving_colour_scenes", len(pick(rows, poses="odometry")))


def map_table(rows):
    head = ["drive", "way m", "loops", "false", "tried", "refused", "end off m, open", "closed"]
    head += ["walls", *(f"{label} mm" for label in WALLS.values())]
    keys = ("part", "way_m", "loops", "false_loops", "tried", "refused", "open_end_m")
    keys += ("closed_end_m", "walls", *WALLS)
    lines = [["" if r[key] is None else r[key] for key in keys] for r in rows]
    return trials.grid(head, lines) + "\n"


def table(rows):
    head = ["drive", "way m", "%", "deg/100 m", "ATE m", "realtime", "slowest ms", "lost"]
    keys = ("way_m", "percent", "deg_per_100m", "ate_m", "realtime", "slowest_ms", "lost")
    lines = []
    for kind, label in DRIVES.items():
        for run in runs(rows, kind):
            found = summary(run)
            lines.append([label, *(found[key] for key in keys)])
    return trials.grid(head, lines) + "\n"


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(12, 5))
    for place, kind in enumerate(DRIVES):
        for number, run in enumerate(runs(rows, kind)):
            truth, found = poses(run, "true_"), poses(run, "")
            spins = column(run, "lasts")[0] < 2 * PERIOD
            steps = [np.linalg.norm(b[:3, 3] - a[:3, 3]) for a, b in zip(truth, truth[1:])]
            way = np.concatenate([[0], np.cumsum(steps)])
            off = [np.linalg.norm(b[:3, 3] - a[:3, 3]) for a, b in zip(truth, found)]
            label = None if number else DRIVES[kind]
            axes[0].plot(way, off, c=f"C{place}", label=label)
            if spins:
                axes[1].plot(1000 * np.array(column(run, "seconds")), c=f"C{place}", lw=0.7)
    axes[0].set(xlabel="way [m]", ylabel="error since the start [m]")
    axes[0].legend()
    axes[1].axhline(1000 * PERIOD / 5, color="r", linestyle="--")
    axes[1].set(xlabel="sweep", ylabel="one core's time [ms]", ylim=(0, None))
    plot.suptitle("Odometry from sweeps alone; red: a fifth of a sweep's time")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "odometry-")
    missing = [kind for kind in (*DRIVES, *NOT_TOLD) if not runs(rows, kind)]
    if missing:
        sys.exit(f"study: no {', '.join(missing)} in {out / 'parts'}")
    maps = trials.read(out / "parts", "map-")
    if not any(r["part"].startswith("map-block-") for r in maps):
        sys.exit(f"study: no drive round a block in {out / 'parts'}")
    trials.TEXT.add("poses")
    colours = trials.read(out / "parts", "colour-")
    if not colours:
        sys.exit(f"study: nothing coloured in {out / 'parts'}")
    draw(rows, out / "odometry.png")
    figures = [*figures_of(rows), *map_figures_of(maps), *colour_figures_of(colours)]
    tables = table(rows) + map_table(maps) + trials.table(figures, TARGETS)
    trials.write(out, "odometry", rows, figures, tables)


main()
