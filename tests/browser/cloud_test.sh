#!/usr/bin/env bash
# The cloud of a report: fitted, measured, cropped, cut, blended, on a desk and on a phone. Run by
# scripts/in-namespace. Usage: cloud_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

session=$scratch/session
"$bin/rgbdt" simulate "$session" --views 6 --seed 5 >"$scratch/simulate.log" 2>&1 ||
  fail "nothing was simulated"
"$bin/rgbdt" calibrate "$session" >"$scratch/calibrate.log" 2>&1 || fail "nothing was calibrated"

drive "$session/report.html"

echo "passed"
