#!/usr/bin/env bash
# report.html by itself, offline, and the same session in rgbdt-viewer --session. Run by
# scripts/in-namespace. Usage: report_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

session=$scratch/session
"$bin/rgbdt" simulate "$session" --views 6 --seed 5 >"$scratch/simulate.log" 2>&1 ||
  fail "nothing was simulated"
"$bin/rgbdt" calibrate "$session" >"$scratch/calibrate.log" 2>&1 || fail "nothing was calibrated"
start_viewer --session "$session"

drive "$session/report.html" "$RGBDT_URL"

stop TERM viewer
echo "passed"
