"""Table, CSV, picture and summary.json of `scripts/bench build` from what build.sh left in DIR:
cpu.csv and deps-now.txt."""

import csv
import json
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "study"))
from trials import figure  # noqa: E402

TARGETS = {"build_programs_ratio": 0.5, "build_all_ratio": 0.6, "build_demo_ratio": 0.3}
MEANINGS = {
    "build_programs_ratio": "to compile the demo's programs, over the same before",
    "build_all_ratio": "to compile everything, tests included, over the same before",
    "build_demo_ratio": "what scripts/demo compiles now, over what it compiled before (everything)",
    "build_worst_header_share": "sources touched when one public header of calib/model changes",
}


def header_shares(path):
    """Of each public header of calib/model, the share of all objects that include it."""
    objects, users = set(), {}
    current = None
    for line in path.read_text().splitlines():
        if line and not line.startswith(" "):
            current = line.split(":")[0]
            if current.endswith(".o"):
                objects.add(current)
            continue
        found = re.search(r"calib/model/(\w+\.h)$", line.strip())
        if found and current in objects:
            users.setdefault(found[1], set()).add(current)
    return {header: len(used) / len(objects) for header, used in users.items()}


def figures_of(seconds, shares):
    now, before = seconds["now"], seconds["before"]
    everything = sum(before.values())
    return [
        figure("build_programs_ratio", now["programs"] / before["programs"]),
        figure("build_all_ratio", sum(now.values()) / everything),
        figure("build_demo_ratio", now["programs"] / everything),
        figure("build_worst_header_share", max(shares.values())),
    ]


def table(seconds, figures, shares):
    lines = [f"{'processor seconds':<24}{'programs':>10}{'the rest':>10}{'all':>10}"]
    for tree, parts in seconds.items():
        lines.append(
            f"{tree:<24}{parts['programs']:>10.0f}{parts['rest']:>10.0f}{sum(parts.values()):>10.0f}"
        )
    lines.append("")
    for entry in figures:
        name, value = entry["name"], entry["value"]
        target = TARGETS.get(name)
        verdict = "" if target is None else f"<= {target}: {'ok' if value <= target else 'MISSED'}"
        lines.append(f"{name:<26}{value:>7.3f}  {verdict:<14} {MEANINGS[name]}")
    worst = sorted(shares.items(), key=lambda item: -item[1])[:5]
    lines.append("most included: " + ", ".join(f"{name} {share:.0%}" for name, share in worst))
    return "\n".join(lines) + "\n"


def draw(seconds, path):
    plot, axes = plt.subplots(figsize=(7, 3), layout="constrained")
    names = list(seconds)
    bottom = [0] * len(names)
    for part, colour in (("programs", "tab:blue"), ("rest", "tab:grey")):
        values = [seconds[name][part] / 60 for name in names]
        label = "the demo's programs" if part == "programs" else "all the rest, tests included"
        axes.barh(names, values, left=bottom, color=colour, label=label)
        bottom = [a + b for a, b in zip(bottom, values)]
    axes.set_xlabel("processor time to compile [min]")
    axes.invert_yaxis()
    axes.legend()
    plot.savefig(path, dpi=90)


def main():
    out = pathlib.Path(sys.argv[1])
    seconds = {}
    with open(out / "cpu.csv", newline="") as file:
        for row in csv.DictReader(file):
            seconds.setdefault(row["tree"], {})[row["what"]] = float(row["seconds"])
    shares = header_shares(out / "deps-now.txt")
    figures = figures_of(seconds, shares)
    with open(out / "build.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("tree", "what", "seconds"))
        for tree, parts in seconds.items():
            writer.writerows((tree, what, value) for what, value in parts.items())
        writer.writerows(("now", f"share of sources: {name}", share) for name, share in shares.items())
    (out / "summary.json").write_text(json.dumps({"figures": figures}, indent=2) + "\n")
    draw(seconds, out / "build.png")
    text = table(seconds, figures, shares)
    (out / "table.txt").write_text(text)
    print(text, end="")
    print(f"wrote {out}: table.txt, build.csv, build.png, summary.json")


main()
