"""Table, CSV, picture and summary.json of `scripts/study mistakes`: what people give wrong, and
whether it is found, named, or silent."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import figure, mean, pick

MATTERS = 12.85  # chi-square of six that is as unlikely as 2 sigma of one
TRUSTED = ("good", "usable")
SIZES = (1, 2, 3)
KINDS = ("sampled", "recorded")
TARGETS = {
    "silent_wrong": ("<=", 0),
    "named_share": (">=", 0.9),
    "false_alarm_share": ("<=", 0.01),
    "false_alarms_recorded": ("<=", 0),
}


def kind_of(row):
    return "recorded" if row["part"].startswith("recorded-") else "sampled"


def is_silent(row):
    return row["grade"] in TRUSTED and row["chi2"] is not None and row["chi2"] > trials.FOUR_SIGMA


def matters(row):
    """No result at all, or one that is off by more than 2 sigma."""
    return row["chi2"] is None or row["chi2"] > MATTERS


def figures_of(rows):
    wrong = [r for r in rows if r["mistake"] != "none"]
    right = pick(rows, mistake="none")
    yield figure("silent_wrong", sum(is_silent(r) for r in rows))
    mattering = [r for r in wrong if matters(r)]
    if mattering:
        yield figure("named_share", mean(r["named"] for r in mattering))
    yield figure("mattering", len(mattering))
    alarms = {kind: [r for r in right if kind_of(r) == kind] for kind in KINDS}
    doubtful = {kind: sum(r["grade"] not in TRUSTED for r in alarms[kind]) for kind in KINDS}
    if alarms["sampled"]:
        yield figure("false_alarm_share", doubtful["sampled"] / len(alarms["sampled"]))
    yield figure("false_alarms_recorded", doubtful["recorded"])
    yield figure("right_sessions", len(right))
    yield figure("cameras", len(rows))


def line_of(name, size, own):
    with_pose = [r for r in own if r["chi2"] is not None]
    mattering = [r for r in own if matters(r)]
    grades = [sum(r["grade"] == grade for r in own) for grade in ("good", "usable", "doubtful", "bad")]
    return [name, f"{size:.0f}", f"{len(own)}", f"{len(with_pose)}",
            trials.median(r["chi2"] for r in with_pose) if with_pose else "-",
            *[f"{g}" for g in grades], f"{len(mattering)}",
            f"{sum(r['named'] for r in mattering):.0f}", f"{sum(is_silent(r) for r in own)}"]


def table(rows):
    text = ""
    for kind in KINDS:
        own = [r for r in rows if kind_of(r) == kind]
        if not own:
            continue
        names = sorted({(r["mistake"], r["size"]) for r in own}, key=lambda n: (n[0] != "none", n))
        text += f"{kind} sessions, a camera each\n"
        text += trials.grid(("mistake", "size", "cases", "with a pose", "chi2", "good", "usable",
                             "doubtful", "do not use", "matter", "named", "silent"),
                            [line_of(*name, pick(own, mistake=name[0], size=name[1]))
                             for name in names]) + "\n"
    return text


def draw(rows, path):
    names = sorted({r["mistake"] for r in rows} - {"none"})
    plot, axes = plt.subplots(figsize=(11, 6))
    colours = {"good": "tab:green", "usable": "tab:olive", "doubtful": "tab:orange", "bad": "tab:red"}
    for grade, colour in colours.items():
        own = [r for r in rows if r["grade"] == grade and r["chi2"] is not None]
        places = [(-1 if r["mistake"] == "none" else names.index(r["mistake"])) + 0.2 * (r["size"] - 2)
                  for r in own]
        axes.scatter(places, [max(r["chi2"], 0.1) for r in own], s=9, c=colour, alpha=0.6,
                     label="do not use" if grade == "bad" else grade)
    axes.axhline(trials.FOUR_SIGMA, c="k", lw=0.8, label="4 sigma")
    axes.set_yscale("log")
    axes.set_xticks(range(-1, len(names)), ["none", *names])
    axes.set(ylabel="chi-square of the result, 6 expected", title="Mistakes: small, middling, large")
    axes.legend(fontsize=8)
    plot.tight_layout()
    plot.savefig(path, dpi=120)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "mistakes-", "recorded-")
    if not rows:
        sys.exit(f"study: no session in {out}/parts")
    draw(rows, out / "mistakes.png")
    figures = list(figures_of(rows))
    trials.write(out, "mistakes", rows, figures, table(rows) + trials.table(figures, TARGETS))


main()
