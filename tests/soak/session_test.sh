#!/usr/bin/env bash
# A scripted session in company: it ends as it does alone, and no view is lost. Run by
# scripts/in-namespace.
# Usage: session_test.sh BIN_DIR garbage|busy
#   garbage  another program publishes garbage on all our channels, a thousand messages a second
#   busy     two programs a processor that only compute share the machine
# RGBDT_FIGURES=FILE: figures as lines "NAME VALUE UNIT".
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"

company=$2
views=4
speed=4
garbage_hz=1000
case $company in
  garbage | busy) ;;
  *) fail "which company? garbage or busy" ;;
esac

begin_company() {
  local i
  if [ "$company" = garbage ]; then
    start flood "$bin/live_helper" flood "$garbage_hz"
  else
    for i in $(seq $((2 * $(nproc)))); do start "busy-$i" sh -c 'while :; do :; done'; done
  fi
}

end_company() {
  local i hz
  if [ "$company" = garbage ]; then
    stop TERM flood
    hz=$(cat "$scratch/flood.log")
    figure garbage_hz "$hz" 1/s
    [ "$hz" -ge $((garbage_hz * 9 / 10)) ] || fail "only $hz messages a second were made"
  else
    for i in $(seq $((2 * $(nproc)))); do kill_process "busy-$i"; done
  fi
}

last_count() {  # PROCESS COUNTER: in its last words
  sed -n "s/.*: stopped;.*, $2 \([0-9][0-9]*\).*/\1/p" "$scratch/$1.log" | tail -n 1
}


run_session() {  # NAME
  local name began view lost=0
  folder=$scratch/$1
  for name in "${services[@]}"; do start "$name" "$bin/rgbdt-$name"; done
  start simulator "$bin/rgbdt-simulator" --speed "$speed" --rig "$scratch/rig.textproto"
  helper ready "${services[@]}" simulator || fail "not every process came up"
  began=$(now_ms)
  start session "$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto" \
    --out "$folder"
  wait_for session || fail "the session ended with exit code $?: $(tail -n 1 "$scratch/session.log")"
  took_ms=$(($(now_ms) - began))
  for view in $(seq -f %04.0f "$views"); do
    [ -s "$folder/views/$view/view.textproto" ] || lost=$((lost + 1))
  done
  stop TERM "${services[@]}" simulator
  figure "$([ "$1" = alone ] && echo alone_session_s || echo session_s)" "$((took_ms / 1000)).$(printf %03d $((took_ms % 1000)))" s
  figure views_lost "$lost" 1
  [ "$lost" = 0 ] || fail "$lost views are missing"
}

session_script "$views" >"$scratch/session.textproto"
echo "== alone"
run_session alone
echo "== $company"
begin_company
run_session "$company"
end_company
if [ "$company" = garbage ]; then
  for name in "${services[@]}" simulator; do
    count=$(last_count "$name" dropped)
    echo "$name: dropped ${count:-0}"
    [ "${count:-0}" -gt 0 ] || fail "$name counted no garbage"
  done
fi
grep -hE 'again|started anew|cut off' "$scratch/session.log" || true
if cmp -s "$scratch/alone/calibration.textproto" "$folder/calibration.textproto"; then
  echo "the calibration is the same, bit for bit"
else
  "$bin/rgbdt" compare "$scratch/alone" "$folder" || fail "the calibrations contradict each other"
fi
echo "passed"
