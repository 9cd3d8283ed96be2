"""Table, CSV, picture and summary.json of `scripts/study import`: a session as a bag of each kind
against itself as folders, and what reading bags takes."""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trials  # noqa: E402
from trials import figure, mean  # noqa: E402

TARGETS = {"import_identical": (">=", 1), "import_over_copy": ("<=", 3), "import_rss_mb": ("<=", 500)}


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [{key: value if key == "kind" else float(value) if value else None
             for key, value in row.items()} for row in rows]


def rate(row):
    return row["megabytes"] / row["list_s"]


def over_copy(row):
    """Packed bags are not copied: most of their time is the packing's."""
    return row["import_s"] / row["copy_s"] if row["copy_s"] else None


def figures_of(rows):
    yield figure("import_identical", mean([row["identical"] for row in rows]))
    yield figure("import_over_copy", max(over_copy(row) for row in rows if row["copy_s"]))
    yield figure("import_rss_mb", max(row["rss_mb"] for row in rows), "MB")
    yield figure("import_largest_mb", max(row["megabytes"] for row in rows), "MB")
    yield figure("import_kinds", len(rows))
    for row in rows:
        name = row["kind"].replace(".", "_").replace(":", "_")
        yield figure(f"import_{name}_mb_per_s", rate(row), "MB/s")
        if row["copy_s"]:
            yield figure(f"import_{name}_over_copy", over_copy(row))


def draw(rows, path):
    plot, axes = plt.subplots(1, 2, figsize=(11, 4))
    kinds = [row["kind"] for row in rows]
    axes[0].barh(kinds, [rate(row) for row in rows])
    axes[0].set_xlabel("listed, of the file's size [MB/s]")
    axes[1].barh(kinds, [row["rss_mb"] for row in rows])
    axes[1].axvline(TARGETS["import_rss_mb"][1], color="k", ls="--", lw=1)
    axes[1].set_xlabel("most memory of an import [MB]")
    for axis in axes:
        axis.invert_yaxis()
        axis.grid(alpha=0.3)
    plot.tight_layout()
    plot.savefig(path, dpi=130)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = read(out / "parts/import.csv")
    figures = list(figures_of(rows))
    lines = [[row["kind"], row["identical"], row["megabytes"], row["list_s"], row["import_s"],
              row["copy_s"] or "", row["rss_mb"]] for row in rows]
    text = trials.table(figures, TARGETS) + "\n" + trials.grid(
        ("bag", "identical", "MB", "list s", "import s", "copy s", "memory MB"), lines)
    draw(rows, out / "import.png")
    with open(out / "import.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0])
        writer.writeheader()
        writer.writerows(rows)
    trials.write_summary(out, "import", figures, text)


main()
