"""What the studies of accuracy share: their rows (a session, method and camera each), figures,
tables and pictures."""

import csv
import json
import math
import statistics

from matplotlib import ticker

CAMERAS = ("rgb", "thermal")
COLOURS = {"rgb": "tab:blue", "thermal": "tab:red"}
METHOD_COLOURS = {
    "auto": "tab:green",
    "separate": "tab:olive",
    "plane": "tab:orange",
    "first_guess": "tab:purple",
}
# Chi-square of six degrees of freedom that is as unlikely as 4 sigma of one.
FOUR_SIGMA = 28.9
# Columns; all others are numbers, and what is not to be had is empty.
TEXT = {"axis", "camera", "case", "first", "grade", "how", "judged", "method", "mistake", "mode",
        "place", "reason", "scene", "second", "sensor", "session", "start", "status", "view",
        "why_not"}


def read(parts, *prefixes):
    rows = []
    for prefix in prefixes:
        for path in sorted(parts.glob(f"{prefix}*.csv")):
            with open(path, newline="") as file:
                rows += [{**row, "part": path.stem} for row in csv.DictReader(file)]
    for row in rows:
        for key in row.keys() - TEXT - {"part"}:
            row[key] = float(row[key]) if row[key] else None
    return rows


def pick(rows, **wanted):
    return [r for r in rows if all(r[key] == value for key, value in wanted.items())]


def column(rows, key):
    return [r[key] for r in rows if r[key] is not None]


def median(values):
    return statistics.median(values)


def mean(values):
    return statistics.mean(values)


def rms(values):
    return math.sqrt(statistics.mean(v * v for v in values))


def figure(name, value, unit="1"):
    return {"name": name, "value": value, "unit": unit}


def over_bound(rows, bounds):
    """RMS error over RMS bound: the largest of both cameras, rotation and centre."""
    most = 0
    for camera in CAMERAS:
        for key in ("rotation_deg", "centre_mm"):
            errors = column(pick(rows, method="auto", camera=camera), key)
            bound = column(pick(bounds, method="auto", camera=camera), f"bound_{key}")
            most = max(most, rms(errors) / rms(bound))
    return most


def honesty_figures(rows, prefix, method="auto"):
    chi2 = column(pick(rows, method=method), "chi2")
    if not chi2:
        return
    yield figure(f"{prefix}nees_mean", mean(chi2))
    yield figure(f"{prefix}coverage95", mean(column(pick(rows, method=method), "inside95")))
    yield figure(f"{prefix}nees_count", len(chi2))


def silent_failures(rows):
    """Results of `auto` that are wrong by more than 4 stated sigma, all six axes together or the
    length of rotation or translation, and are called good or usable."""
    return [
        r
        for r in pick(rows, method="auto", doubtful=0)
        if r["chi2"] is not None
        and (
            r["chi2"] > FOUR_SIGMA
            or r["rotation_deg"] > 4 * r["sigma_rotation_deg"]
            or r["centre_mm"] > 4 * r["sigma_centre_mm"]
        )
    ]


def bounds_of(how, target):
    """Least and most of a target such as ("<=", 1) or ("in", 5, 8)."""
    if how == "in":
        return target
    return (target[0], math.inf) if how == ">=" else (-math.inf, target[0])


class Target:
    """What a figure is to reach. Where the bound itself lies too high, 1.5 times the bound is the
    figure to reach; another factor stands behind the target, as in ("<=", 1, 1.3)."""

    def __init__(self, target, bound=None):
        self.least, self.most = bounds_of(target[0], target[1:])
        self.factor = target[2] if target[0] == "<=" and len(target) > 2 else 1.5
        self.raised = bound is not None and self.factor * bound > self.most
        self.bound = bound
        self.asked = self.most
        if self.raised:
            self.most = self.factor * bound

    def reached(self, value):
        return self.least <= value <= self.most

    def text(self, value):
        if self.least == -math.inf:
            out = f"<= {self.most:.4g}"
        elif self.most == math.inf:
            out = f">= {self.least:.4g}"
        else:
            out = f"{self.least:.4g} to {self.most:.4g}"
        out = f"{out:<14}{'' if self.reached(value) else 'MISSED'}"
        if self.bound is not None:
            out = f"{out:<22}bound {self.bound:.3g}"
        if self.raised:
            out += f": {self.asked:.3g} was asked for, {self.factor:.3g} times the bound counts"
        return out.rstrip()


def table(figures, targets):
    """`targets`: by name. Figures with a target come first; a bound stands beside its figure."""
    by_name = {f["name"]: f["value"] for f in figures}
    lines = []
    for f in sorted(figures, key=lambda f: f["name"] not in targets):
        line = f"{f['name']:<44}{f['value']:>11.4g} {f['unit']:<5}"
        if f["name"] in targets:
            line += Target(targets[f["name"]], by_name.get(f["name"] + "_bound")).text(f["value"])
        lines.append(line.rstrip())
    return "\n".join(lines) + "\n"


def missed(figures, targets):
    by_name = {f["name"]: f["value"] for f in figures}
    return [
        f["name"]
        for f in figures
        if f["name"] in targets
        and not Target(targets[f["name"]], by_name.get(f["name"] + "_bound")).reached(f["value"])
    ]


def grid(head, lines):
    """Columns under each other."""
    cells = [list(head), *[[c if isinstance(c, str) else f"{c:.3g}" for c in line] for line in lines]]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    return "".join("  ".join(c.rjust(w) for c, w in zip(row, widths)) + "\n" for row in cells)


def plain_log(axis):
    """Ticks of a logarithmic axis as a person writes them: 0.01, 0.02, 0.05."""
    axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(ticker.NullLocator())


def write_rows(path, rows):
    keys = ["part"] + [key for key in rows[0] if key != "part"]
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=keys, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


def write(out, name, rows, figures, text):
    write_rows(out / f"{name}.csv", rows)
    write_summary(out, name, figures, text)


def write_summary(out, name, figures, text):
    (out / "summary.json").write_text(json.dumps({"figures": figures}, indent=2) + "\n")
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, {name}.csv, {name}.png, summary.json")
