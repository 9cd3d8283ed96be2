"""The rows of `scripts/study data` about Livox's clouds: is the board found, and is the calibration
honest."""

import trials
from trials import column, figure, mean, median, pick

MOST_MM, MOST_DEG = 30, 2  # of a board that is named
INSIDE_95 = 12.59  # chi-square of six degrees of freedom
MODELS = ("mid360", "avia")
TARGETS = {"livox_board_found": (">=", 0.95), "livox_board_wrong": ("<=", 0)}


def is_right(row):
    return row["named"] == 1 and row["centre_mm"] <= MOST_MM and row["normal_deg"] <= MOST_DEG


def is_wrong(row):
    return row["named"] == 1 and not is_right(row)


def scenes_of(rows):
    yield figure("livox_board_found", mean([is_right(r) for r in rows]))
    yield figure("livox_board_wrong", sum(is_wrong(r) for r in rows))
    yield figure("livox_scenes", len(rows))
    for model in MODELS:
        mine = pick(rows, model=model)
        if not mine:
            continue
        right = [r for r in mine if is_right(r)]
        yield figure(f"livox_board_found_{model}", mean([is_right(r) for r in mine]))
        yield figure(f"livox_board_wrong_{model}", sum(is_wrong(r) for r in mine))
        yield figure(f"livox_centre_mm_median_{model}", median(column(right, "centre_mm")), "mm")
        yield figure(f"livox_normal_deg_median_{model}", median(column(right, "normal_deg")), "deg")


def sessions_of(rows):
    for model in MODELS:
        mine = [r for r in pick(rows, model=model) if r["has_sigma"] == 1]
        if not mine:
            continue
        yield figure(f"livox_session_deg_median_{model}", median(column(mine, "rotation_deg")), "deg")
        yield figure(f"livox_session_mm_median_{model}", median(column(mine, "translation_mm")), "mm")
        yield figure(f"livox_session_nees_{model}", mean(column(mine, "nees")))
        yield figure(f"livox_session_inside95_{model}",
                     mean([r["nees"] <= INSIDE_95 for r in mine]))
        yield figure(f"livox_sessions_{model}", len({r["seed"] for r in mine}))


def read(parts, prefix):
    trials.TEXT.update({"model", "scenery", "form", "why"})
    return trials.read(parts, prefix)


def figures(parts):
    return list(scenes_of(read(parts, "livox-scenes-"))) + list(
        sessions_of(read(parts, "livox-sessions-")))


def draw(parts, axis):
    for model in MODELS:
        rows = [r for r in pick(read(parts, "livox-scenes-"), model=model) if r["named"] == 1]
        axis.plot(column(rows, "range_m"), column(rows, "centre_mm"), ".", label=model)
    axis.axhline(MOST_MM, color="k", ls="--", lw=1)
    axis.set_yscale("log")
    axis.set_xlabel("board's distance [m]")
    axis.set_ylabel("its centre is off by [mm]")
    axis.legend()
    axis.grid(alpha=0.3)
