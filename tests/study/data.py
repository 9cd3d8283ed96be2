"""Table, CSV, picture and summary.json of `scripts/study data`: what other people's sensors and files
give. One module a subject, data_SUBJECT.py: figures(parts), draw(parts, axis), TARGETS."""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import data_decoders  # noqa: E402
import data_holes  # noqa: E402
import data_lidars  # noqa: E402
import data_livox  # noqa: E402
import data_markers  # noqa: E402
import data_mcap  # noqa: E402
import trials  # noqa: E402

SUBJECTS = (data_livox, data_markers, data_holes, data_lidars, data_decoders, data_mcap)


def left_out(subject, figures):
    """A line where figures of the subject were not measured."""
    measured = {f["name"] for f in figures}
    names = [name for name in subject.TARGETS if name not in measured]
    needs = getattr(subject, "NEEDS", "no scenes")
    return f"left out: {', '.join(names)}: {needs}\n" if names else ""


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
    text = trials.table(figures, targets) + "".join(left_out(s, figures) for s in SUBJECTS)
    trials.write_summary(out, "data", figures, text)


main()
