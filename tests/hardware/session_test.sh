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
"$bin/rgbdt" evaluate "$session" --out "$scratch/evaluated" >"$scratch/evaluate.log" 2>&1 ||
  fail "it cannot be judged"
grep -E '^(result against truth|1 sigma, worst axis)' "$scratch/evaluate.log"

# "result against truth  0.014 deg 0.6 mm  0.014 deg 0.6 mm": both cameras, within four times what
# they say of themselves, which for five views is less than half of this.
awk '
  /^result against truth/ { for (i = 4; i <= NF; i += 2) error[++n] = $i }
  /^1 sigma, worst axis/ { for (i = 5; i <= NF; i += 2) sigma[++m] = $i }
  END {
    if (n != 4 || m != 4) exit 1
    for (i = 1; i <= 4; ++i) {
      if (error[i] > 4 * sigma[i] || error[i] > (i % 2 ? 0.1 : 5)) exit 1
    }
  }' "$scratch/evaluate.log" || fail "the result is not what it says it is"
grep -q "lost 0" "$scratch/camera_rgb.log" || fail "a camera was lost"
echo "passed"
