"""Table, CSV, picture and summary.json of `scripts/study detection` from its parts."""

import csv
import json
import math
import pathlib
import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# What is to be reached: at least or at most.
TARGETS = {
    "board_found_color": (">=", 0.99),
    "board_found_thermal": (">=", 0.95),
    "board_found_dense": (">=", 0.98),
    "board_found_32": (">=", 0.90),
    "board_found_16_4m": (">=", 0.75),
    "wrong_accepted": ("<=", 0),
    "first_guess_success": (">=", 1.0),
    "detect_cloud_ms_720k": ("<=", 80),
    "detect_cloud_unorganised_ms_720k": ("<=", 400),
}
GUESS_DEG, GUESS_MM = 2.0, 60.0  # what counts as a good first guess
KINDS = ("color", "thermal")
# Columns; all others are numbers.
TEXT = {"class", "scenery", "form", "holder", "kind", "why", "status"}


def read(parts, prefix):
    rows = []
    for path in sorted(parts.glob(f"{prefix}*.csv")):
        with open(path, newline="") as file:
            rows += list(csv.DictReader(file))
    for row in rows:
        for key in row.keys() - TEXT:
            row[key] = float(row[key])
    return rows


def groups(rows, key="class"):
    """Rows by a column, in order of appearance."""
    out = {}
    for row in rows:
        out.setdefault(row[key], []).append(row)
    return out


def share(rows, test):
    return sum(1 for r in rows if test(r)) / len(rows)


def median(rows, key):
    return statistics.median(r[key] for r in rows)


def mean(rows, key):
    return statistics.mean(r[key] for r in rows)


def rms(rows, key):
    return math.sqrt(statistics.mean(r[key] ** 2 for r in rows))


def image_found(row):
    return row["found"] == 1 and row["wrong"] == 0


def image_figures(rows):
    for kind in KINDS:
        mine = [r for r in rows if r["class"].startswith(kind)]
        right = [r for r in mine if image_found(r)]
        yield f"board_found_{kind}", share(mine, image_found), "1"
        yield f"board_scenes_{kind}", len(mine), "1"
        yield f"board_wrong_{kind}", sum(r["wrong"] == 1 for r in mine), "1"
        yield f"corner_rms_px_{kind}", rms(right, "rms_px"), "px"
        yield f"detect_image_ms_{kind}", median(mine, "ms"), "ms"
    for name, mine in groups(rows).items():
        yield f"board_found_{name}", share(mine, image_found), "1"


def cloud_figures(rows):
    for name, mine in groups(rows).items():
        found = [r for r in mine if r["found"] == 1]
        yield f"board_found_{name}", share(mine, lambda r: r["found"] == 1), "1"
        yield f"board_scenes_{name}", len(mine), "1"
        yield f"board_first_{name}", share(mine, lambda r: r["first"] == 1), "1"
        if not found:
            continue
        yield f"rotation_deg_median_{name}", median(found, "rotation_deg"), "deg"
        yield f"centre_mm_median_{name}", median(found, "centre_mm"), "mm"
        yield f"centre_mm_worst_{name}", max(r["centre_mm"] for r in found), "mm"
        yield f"chi2_per_6_{name}", mean(found, "chi2") / 6, "1"
    dense = [r for r in rows if r["class"] == "dense"]
    for form, mine in groups(dense, "form").items():
        yield f"board_found_dense_{form}", share(mine, lambda r: r["found"] == 1), "1"


def good_guess(row):
    return row["rotation_deg"] <= GUESS_DEG and row["centre_mm"] <= GUESS_MM


def guess_figures(good, wrong):
    yield "first_guess_success", share(good, good_guess), "1"
    yield "first_guess_sessions", len(good), "1"
    for key, unit in (("rotation_deg", "deg"), ("centre_mm", "mm")):
        yield f"first_guess_{key}_median", median(good, key), unit
        yield f"first_guess_{key}_worst", max(r[key] for r in good), unit
    yield "first_guess_chi2_per_6", mean(good, "chi2") / 6, "1"
    yield "wrong_accepted", sum(r["wrong_accepted"] for r in wrong), "1"
    for holder, mine in groups(wrong, "holder").items():
        yield f"wrong_accepted_{holder}", sum(r["wrong_accepted"] for r in mine), "1"
        yield f"wrong_sessions_{holder}", len(mine), "1"
        yield f"wrong_sessions_guess_mm_worst_{holder}", max(r["centre_mm"] for r in mine), "mm"
    yield "wrong_sessions", len(wrong), "1"
    yield "wrong_clouds", sum(r["wrong_clouds"] for r in wrong), "1"
    yield "wrong_clouds_accepted", sum(r["from_wrong_clouds"] for r in wrong), "1"
    boards = sum(r["views_with_board"] for r in wrong)
    right = sum(r["accepted"] - r["wrong_accepted"] for r in wrong)
    yield "right_accepted", right / boards, "1"
    yield "wrong_sessions_good_guess", share(wrong, good_guess), "1"


def corner_figures(rows):
    for kind, mine in groups(rows, "kind").items():
        yield f"corner_scenes_{kind}", len(mine), "1"
        for how in ("rendered", "sampled"):
            yield f"corner_sigma_{how}_px_{kind}", rms(mine, f"{how}_px"), "px"
            yield f"image_pose_deg_median_{how}_{kind}", median(mine, f"{how}_deg"), "deg"
            yield f"image_pose_mm_median_{how}_{kind}", median(mine, f"{how}_mm"), "mm"
            yield f"image_pose_chi2_per_6_{how}_{kind}", mean(mine, f"{how}_chi2") / 6, "1"


def time_figures(rows):
    yield "detect_cloud_ms_720k", median(rows, "organised_ms"), "ms"
    yield "detect_cloud_worst_ms_720k", max(r["organised_ms"] for r in rows), "ms"
    yield "detect_cloud_unorganised_ms_720k", median(rows, "unorganised_ms"), "ms"
    yield "detect_cloud_unorganised_worst_ms_720k", max(r["unorganised_ms"] for r in rows), "ms"
    paper = [r for r in rows if r["paper_ms"] > 0]  # the board lies in the image
    if paper:
        yield "detect_cloud_pcl_ms_720k", median(paper, "paper_ms"), "ms"
        yield "detect_cloud_pcl_found_720k", share(paper, lambda r: r["paper_found"] == 1), "1"
    yield "detect_cloud_found_720k", share(rows, lambda r: r["organised_found"] == 1), "1"
    yield "detect_cloud_hits_720k", median(rows, "hits"), "1"


def reached(name, value):
    how, target = TARGETS[name]
    return value >= target if how == ">=" else value <= target


def table(figures):
    lines = []
    for f in sorted(figures, key=lambda f: f["name"] not in TARGETS):
        line = f"{f['name']:<44}{f['value']:>12.5g} {f['unit']:<4}"
        if f["name"] in TARGETS:
            how, target = TARGETS[f["name"]]
            line += f"{how} {target:<6g}{'' if reached(f['name'], f['value']) else 'MISSED'}"
        lines.append(line.rstrip())
    return "\n".join(lines) + "\n"


def misses(images, clouds, good, wrong):
    """What was not found, so that it can be rendered again: class and scene, or seed."""
    lines = []
    for r in images:
        if not image_found(r):
            lines.append(f"not found: image {r['class']} scene {r['scene']:.0f}: {r['why']}")
    for r in clouds:
        if r["found"] == 0:
            why = r["why"] or f"{r['candidates']:.0f} candidates, none of them the board"
            lines.append(
                f"not found: cloud {r['class']} scene {r['scene']:.0f} ({r['scenery']},"
                f" {r['form']}, {r['range_m']:.1f} m): {why}"
            )
    for r in good:
        if not good_guess(r):
            lines.append(f"no good first guess: seed {r['seed']:.0f}: {r['status']}")
    for r in wrong:
        if r["wrong_accepted"] > 0:
            lines.append(
                f"wrong accepted: seed {r['seed']:.0f} ({r['rings']:.0f} rings, {r['holder']}):"
                f" {r['wrong_accepted']:.0f} of {r['accepted']:.0f},"
                f" up to {r['worst_deg']:.1f} deg and {r['worst_mm']:.0f} mm off; {r['status']}"
            )
    return "".join(line + "\n" for line in lines)


def write_rows(path, parts):
    """All scenes and sessions in one file: what is looked at, and each its own columns."""
    columns = ["part"]
    for rows in parts.values():
        columns += [key for key in rows[0] if key not in columns]
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=columns)
        writer.writeheader()
        for part, rows in parts.items():
            writer.writerows({"part": part, **row} for row in rows)


def draw_shares(axes, title, names, shares):
    axes.barh(names, shares, color="tab:blue")
    axes.invert_yaxis()
    axes.set_xlim(min(0.5, min(shares)), 1.0)
    axes.set_title(title)
    axes.tick_params(axis="y", labelsize=7)
    axes.grid(axis="x", alpha=0.3)


def draw(images, clouds, good, times, path):
    plot, axes = plt.subplots(2, 2, figsize=(13, 9))
    by_class = groups(images)
    draw_shares(
        axes[0, 0],
        "Found in images",
        list(by_class),
        [share(v, image_found) for v in by_class.values()],
    )
    by_class = groups(clouds)
    draw_shares(
        axes[0, 1],
        "Found in clouds",
        list(by_class),
        [share(v, lambda r: r["found"] == 1) for v in by_class.values()],
    )
    for name in ("dense", "128", "64", "32", "16_4m"):
        found = [r for r in by_class[name] if r["found"] == 1]
        axes[1, 0].scatter(
            [r["range_m"] for r in found], [r["centre_mm"] for r in found], s=6, label=name
        )
    axes[1, 0].set(xlabel="range [m]", ylabel="error of the board's centre [mm]", yscale="log")
    axes[1, 0].set_title("Board in the cloud")
    for kind in KINDS:
        mine = [r for r in good if r["kind"] == kind]
        axes[1, 1].scatter(
            [r["rotation_deg"] for r in mine], [r["centre_mm"] for r in mine], s=8, label=kind
        )
    axes[1, 1].axvline(GUESS_DEG, color="grey", lw=1)
    axes[1, 1].axhline(GUESS_MM, color="grey", lw=1)
    axes[1, 1].set(xlabel="rotation error [deg]", ylabel="camera centre's error [mm]")
    axes[1, 1].set(xscale="log", yscale="log")
    axes[1, 1].set_title("First guess from 5 views")
    for a in axes[1]:
        a.grid(alpha=0.3)
        a.legend()
    plot.suptitle(
        f"{len(images)} images, {len(clouds)} clouds; 720,000 points searched in "
        f"{median(times, 'organised_ms'):.0f} ms"
    )
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    names = {"image": "image-", "cloud": "cloud-", "good": "good-", "wrong": "wrong-"}
    names.update({"corners": "corners", "times": "times"})
    parts = {name: read(out / "parts", prefix) for name, prefix in names.items()}
    for name, rows in parts.items():
        if not rows:
            sys.exit(f"study: no {name} in {out / 'parts'}")
    found = [
        *image_figures(parts["image"]),
        *cloud_figures(parts["cloud"]),
        *guess_figures(parts["good"], parts["wrong"]),
        *corner_figures(parts["corners"]),
        *time_figures(parts["times"]),
    ]
    figures = [{"name": n, "value": v, "unit": u} for n, v, u in found]
    write_rows(out / "detection.csv", parts)
    draw(parts["image"], parts["cloud"], parts["good"], parts["times"], out / "detection.png")
    (out / "summary.json").write_text(json.dumps({"figures": figures}, indent=2) + "\n")
    text = table(figures)
    missed = misses(parts["image"], parts["cloud"], parts["good"], parts["wrong"])
    (out / "table.txt").write_text(text + "\n" + missed)
    print(text + "\n" + missed, end="")
    print(f"wrote {out}: table.txt, detection.csv, detection.png, summary.json")


main()
