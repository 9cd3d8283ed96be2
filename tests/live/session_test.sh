#!/usr/bin/env bash
# A session of the real processes on LCM with garbage on the bus and a solver that is killed; then
# its log's inputs again into fresh services: the same calibration. Run by scripts/in-namespace.
# Usage: session_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

views=5
speed=6
session=$scratch/session
log=$scratch/session.lcmlog

write_script() {
  local view
  for view in $(seq "$views"); do
    echo 'step { next_pose {} }' 'step { sweep {} }'
    echo "step { capture { picked_camera: \"thermal\" heldout: $([ "$view" = 3 ] && echo true || echo false) } }"
  done
  echo 'step { solve {} }' 'step { evaluate {} }' 'step { save {} }'
}

start_services() {
  local process
  for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
}

no_gaps_in() {  # the processes' last words
  local process
  for process in "$@"; do
    grep -q "$process: stopped" "$scratch/$process.log" || fail "$process said no goodbye"
    if grep "$process: stopped" "$scratch/$process.log" | grep -Eq ', gaps [1-9]'; then
      fail "$process missed messages; speed $speed is chosen so that none does"
    fi
  done
}

echo "== a session, live, with garbage on every channel"
# lcm-logger's queue holds 30 messages, so it goes first where that is allowed (as in scripts/demo).
start logger nice -n -10 lcm-logger --quiet --force "--lcm-url=$LCM_DEFAULT_URL" "$log"
start_services
start simulator "$bin/rgbdt-simulator" --speed "$speed" --rig "$scratch/rig.textproto"
helper ready "${services[@]}" simulator || fail "not every process came up"
write_script >"$scratch/session.textproto"
start session "$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto" \
  --out "$session"
helper ready session || fail "rgbdt-session did not come up"
helper garbage "${services[@]}" simulator session || fail "garbage was not named"
# Below the log's inputs go to a solver that is not killed: the calibration has to be the same.
until [ -s "$session/views/0002/view.textproto" ]; do
  kill -0 "${pids[session]}" || fail "the session ended before its second view"
  sleep 0.05
done
kill_process solver
start solver "$bin/rgbdt-solver"
wait_for session || fail "the session ended with exit code $?"
grep -q 'rgbdt-solver .*; all views are sent to it again' "$scratch/session.log" ||
  fail "the session did not notice that its solver was killed"
for file in rig.textproto calibration.textproto report.json views/0005/view.textproto \
  views/0005/cloud.pcd views/0005/rgb.png views/0005/thermal.png; do
  [ -s "$session/$file" ] || fail "the session left no $file"
done
stop TERM "${services[@]}" simulator
stop INT logger
no_gaps_in "${services[@]}"
helper gaps "$log" >"$scratch/gaps.log" ||
  fail "lcm-logger missed messages; speed $speed is chosen so that it does not"

echo "== the log's inputs into fresh services"
start_services
helper ready "${services[@]}" || fail "not every service came up again"
"$bin/live_helper" calibration "$views" >"$scratch/replayed" 2>"$scratch/gaps.log" &
pids[listener]=$!
play_inputs "$log"
wait_for listener || fail "no calibration from the log, or with gaps: $(cat "$scratch/gaps.log")"
stop TERM "${services[@]}"
no_gaps_in "${services[@]}"
helper print "$session/calibration.textproto" >"$scratch/live"
diff "$scratch/live" "$scratch/replayed" || fail "the log gives another calibration than the live run"
cat "$scratch/live"

echo "== the log through rgbdt replay"
"$bin/rgbdt" replay "$log" --out "$scratch/replay" >"$scratch/replay.log" 2>&1 ||
  fail "rgbdt replay ended with exit code $?"
cmp "$session/calibration.textproto" "$scratch/replay/calibration.textproto" ||
  fail "rgbdt replay gives another calibration"
echo "passed"
