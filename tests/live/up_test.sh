#!/usr/bin/env bash
# rgbdt up: all processes of a rig run; one that is killed comes back, and the session goes on; what
# it is told by Ctrl-C ends all, and where it is killed itself none stays. Run by
# scripts/in-namespace. Usage: up_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

processes=(assembler detector solver fuser session viewer)

up() {  # NAME
  start "$1" "$bin/rgbdt" up "$scratch/rig.textproto" --out "$scratch/$1" --listen 127.0.0.1:0 \
    --log "$scratch/$1.lcmlog"
  helper ready "${processes[@]}" up || fail "not every process came up"
}

pid_of() {  # NAME PROCESS: the newest
  sed -n "s/^$2: started, pid //p" "$scratch/$1.log" | tail -n 1
}

until_it_says() {  # NAME PATTERN COUNT
  local waited=0
  until [ "$(grep -c "$2" "$scratch/$1.log")" -ge "$3" ]; do
    kill -0 "${pids[$1]}" 2>/dev/null || fail "rgbdt up ended before it said: $2"
    waited=$((waited + 1))
    [ "$waited" -lt 1200 ] || fail "rgbdt up did not say in a minute: $2"
    sleep 0.05
  done
}

none_is_left() {  # PID...
  local pid waited=0
  for pid in "$@"; do
    while [ -d "/proc/$pid" ]; do
      waited=$((waited + 1))
      [ "$waited" -lt 400 ] || fail "process $pid still runs"
      sleep 0.05
    done
  done
}

start simulator "$bin/rgbdt-simulator" --speed 6 --rig "$scratch/rig.textproto"
helper ready simulator || fail "no simulator"
echo "== one after the other is killed"
up first
until_it_says first '^page: http://127.0.0.1:' 1
helper ask next_pose || fail "no pose"
helper ask capture || fail "no view"
for process in "${processes[@]}" logger; do
  kill -KILL "$(pid_of first "$process")"
  until_it_says first "^$process: was killed by SIGKILL" 1
  until_it_says first "^$process: started, pid" 2
done
for _ in 1 2 3; do
  helper ask next_pose || fail "no pose"
  helper ask capture || fail "no view"
done
helper ask finish || fail "it was not saved"
until_it_says first '^session: ended with exit code 0$' 1
for view in 0001 0002 0003 0004; do
  [ -s "$scratch/first/views/$view/detection.lcm" ] || fail "view $view is missing"
done
[ -s "$scratch/first/calibration.textproto" ] || fail "no calibration"

echo "== Ctrl-C ends all"
mapfile -t all < <(for process in "${processes[@]}" logger; do pid_of first "$process"; done)
stop INT first
for log in 00 01; do
  [ -s "$scratch/first.lcmlog.$log" ] || fail "what the logger wrote before it was killed, or after, is missing"
done
none_is_left "${all[@]}"

echo "== a session that has ended is refused before anything is started"
code=0
timeout 60 "$bin/rgbdt" up "$scratch/rig.textproto" --out "$scratch/first" --listen 127.0.0.1:0 \
  >"$scratch/refused.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a session that has ended: exit code $code"
grep -q 'has ended' "$scratch/refused.log" || fail "it does not say that the session has ended"
! grep -q started "$scratch/refused.log" || fail "something was started"

echo "== so is what cannot be written"
echo "a file" >"$scratch/file"
for options in "--out $scratch/file/session --logs $scratch/logs" \
  "--out $scratch/third --log $scratch/file/bus.lcmlog"; do
  code=0
  # shellcheck disable=SC2086 # an option and its value
  timeout 60 "$bin/rgbdt" up "$scratch/rig.textproto" $options --listen 127.0.0.1:0 \
    >"$scratch/refused.log" 2>&1 || code=$?
  [ "$code" = 1 ] || fail "$options: exit code $code"
  grep -q "cannot write $scratch/file/.*Not a directory" "$scratch/refused.log" ||
    fail "$options: it does not say what cannot be written"
  if grep started "$scratch/refused.log"; then fail "$options: something was started"; fi
done

echo "== so is a session that another process writes, on whichever bus"
mkdir "$scratch/taken"
code=0
flock "$scratch/taken" timeout 60 "$bin/rgbdt" up "$scratch/rig.textproto" --out "$scratch/taken" \
  --listen 127.0.0.1:0 >"$scratch/refused.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a session that is taken: exit code $code"
grep -q "$scratch/taken: another rgbdt-session writes to it" "$scratch/refused.log" ||
  fail "it does not say that the session is taken"
if grep started "$scratch/refused.log"; then fail "something was started"; fi

echo "== killed itself, it takes all along; what was printed in the run before is kept"
mkdir "$scratch/second.logs"
echo "why it ended" >"$scratch/second.logs/fuser.log"
up second
grep -q "why it ended" "$scratch/second.logs/fuser.log.earlier" || fail "its last run's log is lost"
mapfile -t all < <(for process in "${processes[@]}"; do pid_of second "$process"; done)
kill_process second
none_is_left "${all[@]}"
stop TERM simulator
echo "passed"
