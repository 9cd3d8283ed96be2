"""Table, CSV, picture and summary.json of `scripts/study data`: what other people's sensors and files
give. One module a subject, data_SUBJECT.py: figures(parts), draw(parts, axis), TARGETS."""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import data_lidars  # noqa: E402
import data_livox  # noqa: E402
import data_markers  # noqa: E402
import trials  # noqa: E402

SUBJECTS = (data_livox, data_markers, data_lidars)


def main():
    out = pathlib.Path(sys.argv[1])
    parts = out / "parts"
    figures, targets = [], {}
    plot, axes = plt.subplots(1, len(SUBJECTS), figsize=(6 * len(SUBJECTS), 4), squeeze=False)
    for subject, axis in zip(SUBJECTS, axes[0]):
        figures += list(subject.figures(parts))
        targets.update(subject.TARGETS)
        subject.draw(parts, axis)
    plot.tight_layout()
    plot.savefig(out / "data.png", dpi=130)
    with open(out / "data.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=("name", "value", "unit"))
        writer.writeheader()
        writer.writerows(figures)
    trials.write_summary(out, "data", figures, trials.table(figures, targets))


main()
