#!/usr/bin/env bash
# A session that a person leads in the page, by clicks alone, from the first view to the saved
# calibration; points of the cloud against the simulator's truth. Run by scripts/in-namespace.
# Usage: session_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seed=5
session=$scratch/session
truth=$scratch/truth.textproto
log=$scratch/session.lcmlog

start logger lcm-logger --quiet --force "--lcm-url=$LCM_DEFAULT_URL" "$log"
for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
start simulator "$bin/rgbdt-simulator" --seed "$seed" --speed 20 --rig "$scratch/rig.textproto" \
  --truth "$truth"
helper ready "${services[@]}" simulator || fail "not every process came up"
start session "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
start_viewer

drive "$seed" "$truth"

wait_for session || fail "rgbdt-session ended with exit code $?"
[ -s "$session/calibration.textproto" ] || fail "no calibration was saved"
stop TERM "${services[@]}" simulator viewer
stop INT logger
"$bin/rgbdt" evaluate "$session" --truth "$truth" --out "$scratch/evaluated" \
  >"$scratch/evaluate.log" 2>&1 || fail "it cannot be judged"
grep -E '^(result against truth|1 sigma, worst axis)' "$scratch/evaluate.log"
# "result against truth  0.014 deg 0.6 mm  0.014 deg 0.6 mm"
awk '
  /^result against truth/ { for (i = 4; i <= NF; i += 2) error[++n] = $i }
  END {
    if (n != 4) exit 1
    for (i = 1; i <= 4; ++i) if (error[i] > (i % 2 ? 0.1 : 5)) exit 1
  }' "$scratch/evaluate.log" || fail "the calibration is wrong"
# Six times next place and capture, and the finish.
[ "$("$bin/browser_helper" count "$log" SESSION_REQUEST)" = 13 ] || fail "the log lacks requests"
echo "passed"
