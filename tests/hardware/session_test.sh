#!/usr/bin/env bash
# A calibration session through the drivers: cameras behind cables, a scanner that speaks SCIP, a
# motor that speaks Dynamixel; then its result against the truth. scripts/demo --hardware is the same
# with more views. Run by scripts/in-namespace. Usage: session_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/hardware/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

views=5
session=$scratch/session
mkdir "$scratch/world" "$session"

session_script "$views" 3 >"$scratch/session.textproto"

for process in assembler detector solver fuser; do start "$process" "$bin/rgbdt-$process"; done
start_hardware "$scratch/world" "$scratch/rig.textproto" "$session/truth.textproto" --seed 2
"$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto" \
  --out "$session" >"$scratch/session.log" 2>&1 || fail "the session failed"
stop TERM lidar motor camera_rgb camera_thermal
is_what_it_says "$session"
grep -q "lost 0" "$scratch/camera_rgb.log" || fail "a camera was lost"
echo "passed"
