#!/usr/bin/env bash
# rgbdt sync: a waved board, by a calibration and without; and logs that tell nothing.
# Usage: sync_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
mkdir "$scratch/kept"
log=$scratch/wave.lcmlog
"$bin/sync_test_log" "$log" "$scratch/other.lcmlog" "$scratch/calibration.textproto"

# FILE: its time offset is 250 ms and its read-out 15 ms, both within what is stated.
holds() {
  python3 - "$1" <<'END' >"$scratch/output" 2>&1 || complain "$1"
import re, sys
text = open(sys.argv[1]).read()
def estimate(name):
    found = re.search(name + r"\s*\{\s*value:\s*(\S+)\s*sigma:\s*(\S+)\s*\}", text)
    return float(found.group(1)), float(found.group(2))
for name, truth, most in (("time_offset_s", 0.25, 1e-3), ("rolling_s", 0.015, 5e-4)):
    value, sigma = estimate(name)
    assert 0 < sigma < most and abs(value - truth) < min(most, 5 * sigma), (name, value, sigma)
END
}

accepts "sync" "$bin/rgbdt" sync "$log" --calibration "$scratch/calibration.textproto" --out "$scratch/synced"
grep -q 'px at 1 m/s' "$scratch/output" || complain "what does the offset do?"
grep -q 'rgbdt-monitor' "$scratch/output" || complain "no next step"
holds "$scratch/synced/calibration.textproto"
[ -s "$scratch/synced/rig.textproto" ] || complain "no rig"
python3 - "$scratch/synced/sync.csv" <<'END' >"$scratch/output" 2>&1 || complain "sync.csv"
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert len(rows) >= 3, rows
for row in rows:
    offset, sigma = float(row["time_offset_s"]), float(row["sigma_s"])
    assert row["camera"] == "rgb" and 0 < sigma < 0.01 and abs(offset - 0.25) < 6 * sigma, row
END
pose_of() { sed -n '/^  camera_from_lidar {/,/^  }/p' "$1"; }
[ -n "$(pose_of "$scratch/calibration.textproto")" ] || complain "no pose to compare with"
[ "$(pose_of "$scratch/synced/calibration.textproto")" = "$(pose_of "$scratch/calibration.textproto")" ] ||
  complain "the pose was to stay"
accepts "sync again" "$bin/rgbdt" sync "$log" --calibration "$scratch/calibration.textproto" --out "$scratch/again"
cmp "$scratch/synced/calibration.textproto" "$scratch/again/calibration.textproto" ||
  complain "the same log, another offset"

accepts "sync without a calibration" "$bin/rgbdt" sync "$log" --out "$scratch/found"
holds "$scratch/found/calibration.textproto"

accepts "help of sync" "$bin/rgbdt" sync --help
grep -q 'Example: rgbdt' "$scratch/output" || complain "sync --help has no example"
says=("nowhere")
refuses "a missing file" "$bin/rgbdt" sync "$scratch/nowhere" --out "$scratch/kept"
says=("no RIG")
refuses "a log without a rig" "$bin/rgbdt" sync "$scratch/other.lcmlog" --out "$scratch/kept"
head -c 100000 /dev/urandom >"$scratch/noise"
says=("noise")
refuses "noise" "$bin/rgbdt" sync "$scratch/noise" --out "$scratch/kept"

verdict
