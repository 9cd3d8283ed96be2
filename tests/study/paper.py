"""Table, CSV, picture and summary.json of `scripts/study paper` from its reports."""

import csv
import json
import pathlib
import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

CAMERAS = ("rgb", "thermal")
REACHED_DEG, REACHED_MM = 1.0, 100.0  # what counts as success from the wide start


def read(folder):
    rows = []
    for path in sorted(folder.glob("*.json"), key=lambda p: int(p.stem)):
        report = json.loads(path.read_text())
        for camera in CAMERAS:
            c = report["cameras"][camera]
            wide = c["other_starts"][0] if c.get("other_starts") else None
            rows.append(
                {
                    "seed": int(path.stem),
                    "camera": camera,
                    "views_used": len(c["views"]["used"]),
                    "converged": c["status"] in ("CONVERGED", "FIRST_GUESS_KEPT"),
                    "rotation_deg": c["truth_error"]["rotation_deg"],
                    "translation_mm": c["truth_error"]["translation_mm"],
                    "guess_rotation_deg": c["first_guess_error"]["rotation_deg"],
                    "guess_translation_mm": c["first_guess_error"]["translation_mm"],
                    "wide_rotation_deg": wide["truth_error"]["rotation_deg"] if wide else None,
                    "wide_translation_mm": wide["truth_error"]["translation_mm"] if wide else None,
                    "heldout_dt_px": c["distance_transform_px"].get("heldout"),
                    "heldout_edge_rms_px": c["edge_rms_px"].get("heldout"),
                    "solve_s": c["seconds"]["solve"],
                }
            )
    return rows


def reached(row):
    return (
        row["wide_rotation_deg"] is not None
        and row["wide_rotation_deg"] <= REACHED_DEG
        and row["wide_translation_mm"] <= REACHED_MM
    )


def figures(rows):
    out = []
    for camera in CAMERAS:
        mine = [r for r in rows if r["camera"] == camera]

        def add(name, value, unit):
            out.append({"name": f"{camera}_{name}", "value": value, "unit": unit})

        for key, unit in (("rotation_deg", "deg"), ("translation_mm", "mm")):
            values = [r[key] for r in mine]
            add(f"{key}_median", statistics.median(values), unit)
            add(f"{key}_worst", max(values), unit)
        for key in ("heldout_dt_px", "heldout_edge_rms_px"):
            values = [r[key] for r in mine if r[key] is not None]
            if values:
                add(f"{key}_median", statistics.median(values), "px")
        add("wide_start_success", sum(map(reached, mine)) / len(mine), "1")
        add("converged", sum(r["converged"] for r in mine) / len(mine), "1")
        add("solve_s_median", statistics.median(r["solve_s"] for r in mine), "s")
    out.append({"name": "seeds", "value": len(rows) // len(CAMERAS), "unit": "1"})
    return out


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(11, 4.5))
    colours = {"rgb": "tab:blue", "thermal": "tab:red"}
    for camera in CAMERAS:
        mine = [r for r in rows if r["camera"] == camera]
        axes[0].scatter(
            [r["guess_rotation_deg"] for r in mine],
            [r["rotation_deg"] for r in mine],
            c=colours[camera],
            label=camera,
        )
        axes[1].scatter(
            [r["wide_rotation_deg"] for r in mine],
            [r["wide_translation_mm"] for r in mine],
            c=colours[camera],
            label=camera,
        )
    axes[0].set_xlabel("hand-measured guess: rotation error [deg]")
    axes[0].set_ylabel("result: rotation error [deg]")
    axes[0].set_title("From the hand-measured guess")
    axes[1].axvline(REACHED_DEG, color="grey", lw=1)
    axes[1].axhline(REACHED_MM, color="grey", lw=1)
    axes[1].set(xscale="log", yscale="log")
    axes[1].set_xlabel("rotation error [deg]")
    axes[1].set_ylabel("translation error [mm]")
    axes[1].set_title("From 30 deg roll and 40 deg yaw off it")
    for a in axes:
        a.grid(alpha=0.3)
        a.legend()
    plot.suptitle(f"The paper's method, {len(rows) // len(CAMERAS)} synthetic sessions of 8 + 4 views")
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = read(out / "reports")
    if not rows:
        sys.exit(f"study: no report in {out / 'reports'}")
    with open(out / "paper.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, out / "paper.png")
    summary = figures(rows)
    (out / "summary.json").write_text(json.dumps({"figures": summary}, indent=2) + "\n")
    table = "".join(f"{f['name']:<36}{f['value']:>12.4g} {f['unit']}\n" for f in summary)
    (out / "table.txt").write_text(table)
    print(table, end="")
    print(f"wrote {out}: table.txt, paper.csv, paper.png, summary.json")


main()
