"""The row of `scripts/study data` about `rgbdt export --mcap`: messages that a reader which shares no
code with it decodes."""

import trials
from trials import column, figure

TARGETS = {"mcap_decoded": (">=", 1)}
NEEDS = "no node, or no @mcap/core"


def read(parts):
    trials.TEXT.update({"log"})
    return trials.read(parts, "mcap")


def figures(parts):
    rows = read(parts)
    messages = sum(column(rows, "messages"))
    if messages:
        yield figure("mcap_decoded", sum(column(rows, "decoded")) / messages)
        yield figure("mcap_messages", messages)


def draw(parts, axis):
    rows = read(parts)
    axis.barh([r["log"] for r in rows], column(rows, "messages"), color="tab:red", label="not decoded")
    axis.barh([r["log"] for r in rows], column(rows, "decoded"), color="tab:blue", label="decoded")
    axis.set_xlabel("messages of an MCAP")
    if rows:
        axis.legend()
    axis.grid(alpha=0.3)
