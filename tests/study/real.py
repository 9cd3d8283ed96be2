"""Table, CSV, picture and summary.json of `scripts/study real`: how recorded sessions agree with
themselves, as there is no truth."""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import column, figure, mean, median, pick

UNLIKELY = 22.5  # chi-square of six: beyond it once in a thousand times
CASES = {"random": "halves", "random_exact_lens": "halves_exact_lens",
         "random_own_lens": "halves_own_lens", "in_order": "in_order"}
SIDES = (("top", "tab:blue"), ("right", "tab:orange"), ("bottom", "tab:green"), ("left", "tab:red"))
DIFFERENCES = (("rotation_deg", "deg"), ("translation_mm", "mm"))
COLUMNS = (*(key for key, _ in DIFFERENCES), "px")
SINGLE = ("used", "sigma_deg", "sigma_mm", "variance_factor", "edge_plane_deg", "edge_plane_mm",
          "edge_plane_chi2", "edge_plane_sigma_enlarged", "lens_deg", "lens_mm", "lens_chi2", "range_sd_ratio")


class Rig:
    """What study_real wrote of one session."""

    def __init__(self, parts, name):
        self.name = name
        self.splits = pick(trials.read(parts, f"real-{name}"), part=f"real-{name}")
        self.rings = pick(trials.read(parts, f"rings-{name}"), part=f"rings-{name}")
        self.views = pick(trials.read(parts, f"views-{name}"), part=f"views-{name}")
        self.sides = pick(trials.read(parts, f"sides-{name}"), part=f"sides-{name}")
        with open(parts / f"facts-{name}.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.facts = {row["fact"]: (float(row["value"]), row["unit"]) for row in rows}

    def fact(self, name):
        return self.facts.get(name, (None, ""))[0]

    def solved(self, case):
        return [r for r in pick(self.splits, case=case) if r["chi2"] is not None]

    def silent_failures(self):
        """Results farther apart than chance does, of which none said that it may be wrong."""
        count = sum(r["chi2"] > UNLIKELY and not r["doubtful"]
                    for case in CASES for r in self.solved(case) if case != "random_exact_lens")
        # Edges and planes lie this far apart by the sigma that the solve states, which it enlarges
        # where they contradict each other.
        edge_plane = self.fact("edge_plane_chi2")
        if edge_plane is not None:
            edge_plane /= self.fact("edge_plane_sigma_enlarged") ** 2
        apart = [edge_plane, self.fact("lens_chi2")]
        return count + (not self.fact("doubtful")) * sum(c is not None and c > UNLIKELY for c in apart)


def figures_of_rig(rig):
    for case, name in CASES.items():
        own = rig.solved(case)
        if not own:
            continue
        for key, unit in DIFFERENCES:
            yield figure(f"{rig.name}_{name}_{unit}", median(column(own, key)), unit)
        yield figure(f"{rig.name}_{name}_px", median(column(own, "px")), "px")
        if case == "in_order":
            yield figure(f"{rig.name}_{name}_chi2", own[0]["chi2"])
        else:
            yield figure(f"{rig.name}_{name}_coverage95", mean(column(own, "inside95")))
            yield figure(f"{rig.name}_{name}_solved", len(own) / len(pick(rig.splits, case=case)))
    for name in SINGLE:
        if name in rig.facts:
            yield figure(f"{rig.name}_{name}", *rig.facts[name])


def figures_of(rigs):
    for rig in rigs:
        yield from figures_of_rig(rig)
    yield figure("silent_failures", sum(rig.silent_failures() for rig in rigs))


def targets_of(rigs):
    targets = {
        "silent_failures": ("<=", 0),
        "vlp16_halves_deg": ("<=", 0.12),
        "vlp16_halves_mm": ("<=", 5),
        "vlp16_range_sd_ratio": ("<=", 0.7),
        "os64_used": (">=", 11),
        "os64_sigma_deg": ("<=", 0.08),
        "os64_sigma_mm": ("<=", 5),
        "plain_used": (">=", 14),
        "plain_halves_deg": ("<=", 0.15),
        "plain_halves_mm": ("<=", 10),
    }
    for rig in rigs:
        targets[f"{rig.name}_halves_coverage95"] = ("in", 0.88, 0.99)
        targets[f"{rig.name}_edge_plane_chi2"] = ("<=", 16)
        targets[f"{rig.name}_lens_chi2"] = ("<=", 16)
    return targets


def line_of(rig, case):
    own = rig.solved(case)
    line = [rig.name, CASES[case].replace("_", " "), f"{len(own)}"]
    for key in COLUMNS:
        line += [median(column(own, key)), median(column(own, f"sigma_{key}"))] if own else ["-", "-"]
    return line + ([median(column(own, "chi2")), mean(column(own, "inside95"))] if own else ["-", "-"])


def table(rigs):
    text = "Medians of differences, each beside the sigma stated of it\n"
    head = ("rig", "what", "pairs", "deg", "sigma", "mm", "sigma", "px at 5 m", "sigma",
            "chi2 of 6", "inside 95%")
    lines = [line_of(rig, case) for rig in rigs for case in CASES]
    for rig in rigs:
        for what, label in (("edge_plane", "edges, planes"), ("lens", "given, own lens")):
            values = [rig.fact(f"{what}_{key}") for key in ("deg", "mm", "chi2")]
            if None not in values:
                lines.append([rig.name, label, "1", values[0], "-", values[1], "-", "-", "-", values[2],
                              "-"])
    text += trials.grid(head, lines)
    for rig in rigs:
        text += (f"\n{rig.name}: {rig.fact('found'):.0f} of {rig.fact('recorded'):.0f} views found, "
                 f"{rig.fact('used'):.0f} used; estimated along:\n")
        for name, (value, unit) in rig.facts.items():
            if f"{name}, sigma" in rig.facts:
                text += f"  {name:<45}{value:>9.3g} +- {rig.fact(f'{name}, sigma'):<8.3g} {unit}\n"
    return text + "\n"


def draw_differences(axes, rig, key, unit):
    for case, colour in (("random", "tab:green"), ("random_exact_lens", "tab:gray")):
        own = rig.solved(case)
        axes.scatter(column(own, f"sigma_{key}"), column(own, key), s=10, c=colour, alpha=0.6,
                     label=CASES[case].replace("_", " "))
    most = max(axes.get_xlim()[1], axes.get_ylim()[1])
    axes.plot([0, most], [0, most], c="k", lw=0.8, label="one sigma")
    axes.set(xlim=(0, most), ylim=(0, most), xlabel=f"stated sigma [{unit}]",
             ylabel=f"difference [{unit}]", title=f"{rig.name}: {key.split('_')[0]}")
    axes.legend(fontsize=8)


def draw_rings(axes, rig):
    for corrected, colour, label in ((0, "tab:red", "as measured"), (1, "tab:blue", "corrected")):
        enough = [r for r in rig.rings if r["points"] >= 5 and r["corrected"] == corrected]
        axes.scatter(column(enough, "ring"), column(enough, "mean_mm"), s=10, c=colour, alpha=0.6,
                     label=label)
    axes.axhline(0, c="k", lw=0.8)
    axes.legend(fontsize=8)
    axes.set(xlabel="ring", ylabel="behind the plane, along the beam [mm]",
             title=f"{rig.name}: mean of a ring's points in a view")


def draw_lens(axes, rig):
    """How far halves are turned apart, against how far their lenses' centres are."""
    own = rig.solved("random")
    for axis, colour in (("pitch", "tab:blue"), ("yaw", "tab:orange")):
        axes.scatter(column(own, f"lens_{axis}_deg"), column(own, f"{axis}_deg"), s=10, c=colour,
                     alpha=0.6, label=axis)
    most = max(map(abs, (*axes.get_xlim(), *axes.get_ylim())))
    axes.plot([-most, most], [-most, most], c="k", lw=0.8, label="the lens alone")
    axes.set(xlabel="lenses' centres apart, as an angle [deg]", ylabel="poses apart [deg]",
             title=f"{rig.name}: halves, pose against lens")
    axes.legend(fontsize=8)


def draw_views(axes, rig):
    """The board in each cloud against where its image has it."""
    for axis, colour in (("about x", "tab:blue"), ("about y", "tab:orange"), ("about z", "tab:green")):
        own = pick(rig.views, axis=axis)
        axes.errorbar(range(len(own)), column(own, "value"), column(own, "sigma"), fmt="o", ms=3,
                      lw=0.8, c=colour, label=axis)
    axes.axhline(0, c="k", lw=0.8)
    axes.legend(fontsize=8)
    axes.set(xlabel="view", ylabel="cloud against image [mrad], 1 sigma",
             title=f"{rig.name}: the board turned about its axes")


def draw_sides(axes, rig):
    """What no unknown of the solve explains: each side's place in the cloud, view by view."""
    for side, (name, colour) in enumerate(SIDES):
        own = pick(rig.sides, side=side)
        axes.errorbar(column(own, "range_m"), column(own, "shift_mrad"), column(own, "sigma_mrad"),
                      fmt="o", ms=3, lw=0.8, c=colour, label=name)
    axes.axhline(0, c="k", lw=0.8)
    axes.legend(fontsize=8)
    axes.set(xlabel="range [m]", ylabel="outwards of where the solve has it [mrad], 1 sigma",
             title=f"{rig.name}: sides of the board in the cloud")


def draw(rigs, path):
    plot, axes = plt.subplots(len(rigs), 6, figsize=(30, 4.5 * len(rigs)), squeeze=False)
    for row, rig in zip(axes, rigs):
        for axis, (key, unit) in zip(row, DIFFERENCES):
            draw_differences(axis, rig, key, unit)
        draw_rings(row[2], rig)
        draw_lens(row[3], rig)
        draw_views(row[4], rig)
        draw_sides(row[5], rig)
    plot.tight_layout()
    plot.savefig(path, dpi=120)


def main():
    out = pathlib.Path(sys.argv[1])
    parts = out / "parts"
    rigs = [Rig(parts, path.stem[len("facts-"):]) for path in sorted(parts.glob("facts-*.csv"))]
    if not rigs:
        sys.exit(f"study: no session in {parts}")
    draw(rigs, out / "real.png")
    figures = list(figures_of(rigs))
    rows = [row for rig in rigs for row in rig.splits]
    trials.write(out, "real", rows, figures, table(rigs) + trials.table(figures, targets_of(rigs)))


main()
