#!/usr/bin/env bash
# rgbdt sync live without a sweep: it gives up, and leaves nothing behind; browser/sync_test.sh has a
# whole wave. Run by scripts/in-namespace. Usage: sync_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

code=0
"$bin/rgbdt" sync live --out "$scratch/silent" >"$scratch/silent.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "without a sweep: exit code $code"
grep -q 'no sweep on the bus in 10 s' "$scratch/silent.log" || fail "it does not say what is missing"
[ -z "$(ls "$scratch/silent")" ] || fail "it left something behind"
echo "passed"
