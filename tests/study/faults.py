"""Table, CSV, picture and summary.json of `scripts/study faults`: sessions over several machines whose
links lose datagrams, or that are cut off, sessions whose processes are killed, or that have a busy
machine or garbage beside them, and a soak."""

import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from trials import figure  # noqa: E402

TARGETS = {
    "kills_survived_share": (">=", 1),
    "calibration_identical_share": (">=", 1),
    "views_lost": ("<=", 0),
    "loss_1pct_sessions_ok_share": (">=", 1),
    "losses_counted_share": (">=", 0.999),
    "hosts_mbit_s": ("<=", 300),
    "garbage_session_ok": (">=", 1),
    "busy_session_ok": (">=", 1),
    "soak_rss_growth_mb": ("<=", 5),
    "recovery_s": ("<=", 1),
    "commands_lost": ("<=", 0),
}
SOAK = ("soak_load", "soak_s", "soak_rss_growth_mb", "soak_descriptor_growth", "soak_p99_first_ms",
        "soak_p99_last_ms", "recovery_s", "commands_lost", "dropped_counted_share")


def read(parts):
    rows = []
    for path in sorted(parts.glob("*.csv")):
        with open(path, newline="") as file:
            rows += [{**row, "value": float(row["value"])} for row in csv.DictReader(file)]
    return rows


def figures_of(rows):
    of = lambda name, start="": [  # noqa: E731
        r["value"] for r in rows if r["name"] == name and r["fault"].startswith(start)]
    for name, start in (("loss_01pct", "loss-1-"), ("loss_1pct", "loss-10-"),
                        ("loss_5pct", "loss-50-"), ("cut_off_10s", "cut-off")):
        ended = of("ended_well", start)
        if ended:
            yield figure(f"{name}_sessions_ok_share", sum(ended) / len(ended))
    # The worst of the runs; one that ended before its losses were compared has none.
    if of("losses_counted_share"):
        yield figure("losses_counted_share", min(of("losses_counted_share")))
    if of("hosts_mbit_s"):
        yield figure("hosts_mbit_s", max(of("hosts_mbit_s")), "Mbit/s")
    if of("ended_well", "garbage"):
        yield figure("garbage_session_ok", min(of("ended_well", "garbage")))
    if of("ended_well", "busy"):
        yield figure("busy_session_ok", min(of("ended_well", "busy")))
    for r in rows:
        if r["fault"] == "soak" and r["name"] in SOAK:
            yield figure(r["name"], r["value"], r["unit"])
    # A run that a kill ended told neither of that kill's survival nor of its views.
    if of("ended_well", "kills"):
        planned = sum(of("kills_planned"))
        yield figure("kills_survived_share", sum(of("kills_survived")) / planned if planned else 0)
        identical = of("calibration_identical") or [0]
        yield figure("calibration_identical_share", sum(identical) / len(identical))
        if of("views_lost"):
            yield figure("views_lost", sum(of("views_lost")))


def table(figures):
    lines = []
    for f in figures:
        sign, target = TARGETS.get(f["name"], ("", ""))
        lines.append(f"{f['name']:32} {f['value']:10.4f} {f['unit']:8} {sign} {target}".rstrip())
    return "\n".join(lines) + "\n"


def draw(rows, path):
    faults = sorted({r["fault"] for r in rows})
    value = {(r["fault"], r["name"]): r["value"] for r in rows}
    plot, axes = plt.subplots(figsize=(9, 4))
    axes.barh(faults, [value.get((f, "session_s"), 0) for f in faults],
              color=["tab:green" if value[f, "ended_well"] else "tab:red" for f in faults])
    axes.set_xlabel("session [s]; green: ended well")
    plot.tight_layout()
    plot.savefig(path)


def main():
    out = pathlib.Path(sys.argv[1])
    rows = read(out / "parts")
    if not rows:
        sys.exit("study: no run left figures")
    figures = list(figures_of(rows))
    with open(out / "faults.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["fault", "name", "value", "unit"])
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, out / "faults.png")
    (out / "summary.json").write_text(json.dumps({"figures": figures}, indent=2) + "\n")
    (out / "table.txt").write_text(table(figures))
    print(table(figures), end="")


main()
