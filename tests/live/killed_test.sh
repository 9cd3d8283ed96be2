#!/usr/bin/env bash
# A session that is killed and started again on its own folder: its views stay as they are, and its
# calibration is that of an undisturbed session, to the bit. Then sessions in which each process in
# turn is killed at a random moment and started anew: they end by themselves, each view is there,
# and the calibration agrees with the undisturbed one. Run by scripts/in-namespace.
# Usage: killed_test.sh BIN_DIR; RGBDT_KILLS: how many (5); RGBDT_SEED: of the moments (1)
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

kills=${RGBDT_KILLS:-5}
seed=${RGBDT_SEED:-1}
views=8
speed=4

write_script() {
  local view
  for view in $(seq "$views"); do
    echo 'step { next_pose {} }' 'step { sweep {} }' 'step { capture {} }'
    if [ "$view" = 2 ]; then echo 'step { wait { seconds: 3 } }'; fi
  done
  echo 'step { solve {} }' 'step { evaluate {} }' 'step { save {} }'
}

start_process() {  # NAME: one of a session's, in the folder $folder
  case $1 in
    session)
      start session "$bin/rgbdt-session" "$scratch/session.textproto" \
        --rig "$scratch/rig.textproto" --out "$folder"
      ;;
    simulator) start simulator "$bin/rgbdt-simulator" --speed "$speed" --rig "$scratch/rig.textproto" ;;
    *) start "$1" "$bin/rgbdt-$1" ;;
  esac
}

begin() {  # NAME: a session, with processes of its own
  local process
  folder=$scratch/$1
  for process in "${services[@]}" simulator; do start_process "$process"; done
  helper ready "${services[@]}" simulator || fail "not every process came up"
  start_process session
}

end() {
  wait_for session || fail "the session ended with exit code $?"
  stop TERM "${services[@]}" simulator
}

has_all_views() {
  local view lost=()
  for view in $(seq -f %04.0f "$views"); do
    [ -s "$folder/views/$view/view.textproto" ] || lost+=("$view")
  done
  figure views_lost "${#lost[@]}" 1
  [ "${#lost[@]}" = 0 ] || fail "views are missing: ${lost[*]}"
}

checksums() { find "$folder/views" -type f -exec cksum {} + | sort; }

restart() {  # PROCESS: what it had said is kept
  kill_process "$1"
  cat "$scratch/$1.log" >>"$scratch/killed-$1.log"
  start_process "$1"
}


taken() { find "$folder/views" -name detection.lcm 2>/dev/null | wc -l || true; }

another_view_is_taken() {  # since there were $1; false: the session has ended
  until [ "$(taken)" -gt "$1" ]; do
    kill -0 "${pids[session]}" 2>/dev/null || return 1
    sleep 0.05
  done
}

write_script >"$scratch/session.textproto"
echo "== undisturbed"
began=$(now_ms)
begin undisturbed
end
a_view_ms=$((($(now_ms) - began) / views))
if grep 'started anew' "$scratch/session.log"; then fail "nothing was"; fi

echo "== a session that is killed goes on"
begin resumed
until grep -qs 'waiting 3' "$scratch/session.log"; do
  kill -0 "${pids[session]}" || fail "the session ended before it waited"
  sleep 0.05
done
checksums >"$scratch/views"
restart session
end
grep 'goes on with the 2 views' "$scratch/session.log" || fail "it did not say that it goes on"
checksums | grep -F -x -f "$scratch/views" | cmp - "$scratch/views" ||
  fail "the views that there were are not what they were"
has_all_views
cmp "$scratch/undisturbed/calibration.textproto" "$folder/calibration.textproto" ||
  fail "the calibration is not what it is undisturbed"
figure calibration_identical 1 1

shuffle_turn() {  # all, in an order by RANDOM, which a subshell would draw anew
  local i j other
  turn=("${services[@]}" simulator session)
  for ((i = ${#turn[@]} - 1; i > 0; i--)); do
    j=$((RANDOM % (i + 1)))
    other=${turn[i]}
    turn[i]=${turn[j]}
    turn[j]=$other
  done
}

figure kills_planned "$kills" 1
RANDOM=$seed
number=0
turn=()
while [ "$kills" -gt 0 ]; do
  number=$((number + 1))
  echo "== each process in turn is killed at a random moment, session $number"
  begin "killed-$number"
  there=-1
  before=$kills
  # One a view, at any moment of it; more, and none would ever be whole.
  while [ "$kills" -gt 0 ] && another_view_is_taken "$there"; do
    moment=$((RANDOM * a_view_ms / 32768))
    sleep "$((moment / 1000)).$(printf %03d $((moment % 1000)))"
    kill -0 "${pids[session]}" 2>/dev/null || break  # the others die in the next session
    there=$(taken)
    if [ "${#turn[@]}" = 0 ]; then shuffle_turn; fi
    process=${turn[0]}
    turn=("${turn[@]:1}")
    echo "$process is killed after $moment ms, in: $(grep -E '^\[[0-9]+/' "$scratch/session.log" | tail -n 1)"
    restart "$process"
    kills=$((kills - 1))
  done
  end
  has_all_views
  cat "$scratch"/killed-session.log "$scratch/session.log" 2>/dev/null | grep 'started anew' || true
  "$bin/rgbdt" compare "$scratch/undisturbed" "$folder" ||
    fail "the calibrations contradict each other"
  figure kills_survived $((before - kills)) 1
  rm -rf "$folder" "$scratch"/killed-*.log
done
echo "passed"
