"""Table, CSV, picture and summary.json of `scripts/study natural`: calibration without a target, in
simulated streets and rooms, from starts that are off, and in recorded ones (tests/real/natural_test.cc),
where there are any."""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, mean, median, pick

TARGETS = {
    "natural_rgb_rotation_deg_median": ("<=", 0.05),
    "natural_rgb_translation_mm_median": ("<=", 10),
    "natural_thermal_rotation_deg_median": ("<=", 0.15),
    "natural_thermal_translation_mm_median": ("<=", 30),
    "natural_32_rgb_rotation_deg_median": ("<=", 0.1),
    "natural_nees_mean": ("in", 5, 8),
    "natural_silent_failures": ("<=", 0),
    "natural_search_success": (">=", 0.95),
    "natural_search_wrong": ("<=", 0),
    "natural_real_rotation_deg": ("<=", 0.4),
}
TOLD = "natural_real_told_"  # and a session's name: 1 where its result is called good
SEARCHED_DEG = 0.3


def kind_of(row):
    """dense, 32 or search."""
    return row["part"].split("-")[1]


def is_silent(row):
    """Called converged, and off by more than 4 stated sigma."""
    return bool(row["converged"]) and row["chi2"] > trials.FOUR_SIGMA


def figures_of(rows):
    refined = [r for r in rows if kind_of(r) != "search"]
    for kind, prefix in (("dense", "natural"), ("32", "natural_32")):
        for camera in ("rgb", "thermal"):
            own = [r for r in pick(refined, camera=camera) if kind_of(r) == kind]
            if not own:
                continue
            yield figure(f"{prefix}_{camera}_rotation_deg_median", median(column(own, "rotation_deg")), "deg")
            yield figure(f"{prefix}_{camera}_translation_mm_median",
                         median(column(own, "translation_mm")), "mm")
    converged = [r for r in refined if r["converged"]]
    yield figure("natural_nees_mean", mean(column(converged, "chi2")))
    yield figure("natural_converged_share", len(converged) / len(refined))
    yield figure("natural_silent_failures", sum(is_silent(r) for r in rows))
    yield figure("natural_cases", len(rows))
    searched = [r for r in rows if kind_of(r) == "search" and r["camera"] == "rgb"]
    if searched:
        yield figure("natural_search_success",
                     mean(r["converged"] and r["rotation_deg"] <= SEARCHED_DEG for r in searched))
        yield figure("natural_search_wrong",
                     sum(bool(r["converged"]) and r["rotation_deg"] > SEARCHED_DEG for r in searched))


def recorded_figures(parts):
    """Of recorded sessions: the worst of those that are told, off the board's own calibration."""
    trials.TEXT.update({"name", "unit"})
    values = {row["name"]: row["value"] for row in trials.read(parts, "recorded-natural")}
    sessions = [name[len(TOLD):] for name in values if name.startswith(TOLD)]
    if not sessions:
        return
    told = [session for session in sessions if values[TOLD + session]]
    yield figure("natural_real_sessions", len(sessions))
    yield figure("natural_real_cannot_tell", len(sessions) - len(told))
    for name, unit in (("natural_real_rotation_deg", "deg"), ("natural_real_translation_mm", "mm")):
        if told:
            yield figure(name, max(values[f"{name}_{session}"] for session in told), unit)


def why_not_recorded(figures):
    """In a line, where natural_real_rotation_deg was not measured."""
    values = {f["name"]: f["value"] for f in figures}
    if "natural_real_rotation_deg" in values:
        return ""
    if "natural_real_sessions" not in values:
        why = "no acfr_vlp16 and no acfr_os64 in RGBDT_REAL_DATA"
    else:
        why = ("each recorded session says why it tells no pose, or not all of it"
               " (parts/recorded-natural.log)")
    return f"left out: natural_real_rotation_deg: {why}\n"


def table(rows):
    lines = []
    for kind in ("dense", "32", "search"):
        for camera in ("rgb", "thermal"):
            own = [r for r in pick(rows, camera=camera) if kind_of(r) == kind]
            if not own:
                continue
            lines.append([kind, camera, f"{len(own)}", f"{sum(bool(r['converged']) for r in own)}",
                          median(column(own, "start_deg")), median(column(own, "rotation_deg")),
                          max(column(own, "rotation_deg")), median(column(own, "translation_mm")),
                          mean(column(own, "chi2")), median(column(own, "solve_s"))])
    head = ("sweeps", "camera", "cases", "converged", "start deg", "deg", "worst", "mm",
            "chi2 of 6", "solve s")
    return "Medians of errors against truth\n" + trials.grid(head, lines) + "\n"


def draw(rows, path):
    figure_, axes = plt.subplots(1, 2, figsize=(11, 5))
    for axis, key, unit in zip(axes, ("rotation_deg", "translation_mm"), ("deg", "mm")):
        for camera, colour in (("rgb", "tab:green"), ("thermal", "tab:red")):
            own = pick(rows, camera=camera)
            axis.scatter(column(own, "sigma_deg" if unit == "deg" else "sigma_mm"), column(own, key),
                         s=14, c=colour, alpha=0.6, label=camera)
        axis.set(xscale="log", yscale="log", xlabel=f"stated sigma [{unit}]", ylabel=f"error [{unit}]")
        limits = axis.get_xlim()
        axis.plot(limits, limits, c="k", lw=0.8, label="one sigma")
        axis.legend(fontsize=8)
    figure_.tight_layout()
    figure_.savefig(path, dpi=110)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = trials.read(out / "parts", "natural-")
    if not rows:
        sys.exit(f"study: no session in {out}/parts")
    draw(rows, out / "natural.png")
    figures = list(figures_of(rows)) + list(recorded_figures(out / "parts"))
    text = table(rows) + trials.table(figures, TARGETS) + why_not_recorded(figures)
    trials.write(out, "natural", rows, figures, text)


main()
