#!/usr/bin/env bash
# A session without a detector says so and fails; stopped half way it says where. Run by
# scripts/in-namespace. Usage: missing_process_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

for process in assembler solver fuser; do start "$process" "$bin/rgbdt-$process"; done
start simulator "$bin/rgbdt-simulator" --rig "$scratch/rig.textproto"
helper ready assembler solver fuser simulator || fail "not every process came up"
echo 'step { next_pose {} }' >"$scratch/session.textproto"
run_session=("$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto")

code=0
"${run_session[@]}" --out "$scratch/session" >"$scratch/session.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a session without a detector ended with exit code $code"
grep -q 'rgbdt-session: .*rgbdt-detector (not heard)' "$scratch/session.log" ||
  fail "the session did not name the detector"
[ ! -e "$scratch/session" ] || fail "a session that never began left a directory"

start session "${run_session[@]}" --out "$scratch/stopped"
helper ready session || fail "rgbdt-session did not come up"
kill -TERM "${pids[session]}"
code=0
wait_for session || code=$?
[ "$code" = 1 ] || fail "a session stopped by SIGTERM ended with exit code $code"
grep -q 'rgbdt-session: stopped before its end' "$scratch/session.log" ||
  fail "a stopped session did not say so"

stop INT assembler solver
stop TERM fuser simulator
echo "passed"
