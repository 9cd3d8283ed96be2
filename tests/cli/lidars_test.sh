#!/usr/bin/env bash
# Two LIDARs in one rig: the second one's pose, from a simulated session to ROS. Usage: lidars_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

session=$scratch/session
accepts "a session of two LIDARs" "$bin/rgbdt" simulate "$session" --views 8 --seed 3 --lidar 32 \
  --further-lidar vlp16
[ "$(grep -c '^lidar {' "$session/rig.textproto")" -eq 2 ] || complain "the rig has not two LIDARs"
[ -s "$session/views/0001/cloud_lidar2.pcd" ] || complain "no cloud of the second LIDAR"
grep -q reference_from_lidar "$session/truth.textproto" || complain "no truth of the second LIDAR"

accepts "its calibration" "$bin/rgbdt" calibrate "$session"
grep -q "LIDAR lidar2: converged" "$scratch/output" || complain "no word of the second LIDAR"
grep -q reference_from_lidar "$session/calibration.textproto" || complain "it is not written"
python3 - "$session/report.json" >"$scratch/output" 2>&1 <<'PYTHON' || complain "it is off"
import json
import sys

(lidar,) = json.load(open(sys.argv[1]))["lidars"]
sigma = lidar["sigma"]
error = lidar["truth_error"]
print(error, sigma)
assert lidar["calibration"]["lidar"] == "lidar2"
assert error["rotation_deg"] < 4 * sum(s * s for s in sigma["rotation_deg"]) ** 0.5
assert error["translation_mm"] < 4 * sum(s * s for s in sigma["translation_mm"]) ** 0.5
assert error["rotation_deg"] < 0.5 and error["translation_mm"] < 30
PYTHON

accepts "its export" "$bin/rgbdt" export "$session" --out "$scratch/export"
grep -q 'link name="lidar2"' "$scratch/export/cameras.urdf" || complain "it is not in the URDF"

# A rig that has a second LIDAR, of which no view has a cloud: said, and the cameras are calibrated.
sed -i '/^further_cloud {/,/^}/d' "$session"/views/*/view.textproto
accepts "views without its clouds" "$bin/rgbdt" calibrate "$session" --out "$scratch/without"
grep -q "LIDAR lidar2 is not calibrated: no view has a cloud of it" "$scratch/output" ||
  complain "it is not said that there is no cloud of the second LIDAR"

misuses "a second LIDAR that turns" "$bin/rgbdt" simulate "$scratch/refused" --further-lidar turned

verdict
