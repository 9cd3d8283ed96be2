#!/usr/bin/env bash
# A session whose assembler, and later its detector, is killed in the midst of a sweep: without the
# assembler's lines it is taken again, a detector is told the view. The calibration agrees with that
# of an undisturbed session. Run by scripts/in-namespace. Usage: torn_sweep_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

views=4

until_told() {  # NAME WORDS: as the session's progress has it
  until grep -qs "$2" "$scratch/$1.log"; do
    kill -0 "${pids[$1]}" || fail "the session ended before it said: $2"
    sleep 0.05
  done
}

kill_in_sweep_of() {  # VIEW PROCESS WORDS: and starts it anew, before the sweep has ended
  until_told disturbed "view $1: sweeping, 25%"
  kill_process "$2"
  start "$2" "$bin/rgbdt-$2"
  until_told disturbed "view $1: .*$3"
}

session_script "$views" >"$scratch/session.textproto"
echo "== undisturbed"
begin_session undisturbed 6
end_session undisturbed
if grep 'the sweep is taken again' "$scratch/undisturbed.log"; then fail "for no reason"; fi

# Slow enough that a process that is started anew has the rig long before the sweep ends.
echo "== disturbed"
begin_session disturbed 2
kill_in_sweep_of 0002 assembler "rgbdt-assembler was started anew; the sweep is taken again"
kill_in_sweep_of 0003 detector "is not whole: .*; it is told the view again"
end_session disturbed
[ "$(grep -c 'the sweep is taken again' "$scratch/disturbed.log")" = 1 ] ||
  fail "other sweeps were taken again, too"
for view in 0001 0002 0003 0004; do
  [ -s "$scratch/disturbed/views/$view/view.textproto" ] || fail "view $view is missing"
done
"$bin/rgbdt" compare "$scratch/undisturbed" "$scratch/disturbed" ||
  fail "the calibrations contradict each other"
echo "passed"
