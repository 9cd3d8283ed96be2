"""The rows of `scripts/study data` about boards with markers of which two fifths are hidden."""

import trials
from trials import column, figure, mean, median, pick

BOARDS = ("charuco", "aprilgrid")
TARGETS = {"charuco_found": (">=", 0.98), "charuco_wrong": ("<=", 0)}


def read(parts):
    trials.TEXT.update({"board", "why"})
    return trials.read(parts, "markers-")


def figures(parts):
    for board in BOARDS:
        rows = pick(read(parts), board=board)
        if not rows:
            continue
        found = [r for r in rows if r["found"] == 1]
        right = [r for r in found if r["wrong"] == 0]
        yield figure(f"{board}_found", mean([r["found"] == 1 and r["wrong"] == 0 for r in rows]))
        yield figure(f"{board}_wrong", len(found) - len(right))
        yield figure(f"{board}_scenes", len(rows))
        if right:
            yield figure(f"{board}_corner_px_median", median(column(right, "rms_px")), "px")


def draw(parts, axis):
    for board in BOARDS:
        rows = [r for r in pick(read(parts), board=board) if r["found"] == 1]
        axis.plot(column(rows, "range_m"), column(rows, "rms_px"), ".", label=board)
    axis.set_xlabel("board's distance [m]")
    axis.set_ylabel("its corners are off by [px], RMS")
    axis.legend()
    axis.grid(alpha=0.3)
