#!/usr/bin/env bash
# A session that is killed and started again on its own folder, and whose detector is killed between
# two views: its views stay as they are, and its calibration is that of an undisturbed session, to
# the bit. So it is where solver, fuser, viewer, detector, session and logger are killed, each at a
# random moment, and started anew. Where simulator or assembler are, a capture is taken again: the
# session ends by itself, each view is there, and the calibration agrees with the undisturbed one.
# Run by scripts/in-namespace.
# Usage: killed_test.sh BIN_DIR; RGBDT_KILLS: how many at random moments (8), half of them of each
# kind; RGBDT_SEED: of the moments (1)
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

kills=${RGBDT_KILLS:-8}
seed=${RGBDT_SEED:-1}
views=8
speed=4
harmless=(solver fuser viewer detector session logger)
spoiling=(simulator assembler)

write_script() {
  local view
  for view in $(seq "$views"); do
    echo 'step { next_pose {} }' 'step { sweep {} }' 'step { capture {} }'
    case $view in 2 | 4) echo 'step { wait { seconds: 3 } }' ;; esac
  done
  echo 'step { solve {} }' 'step { evaluate {} }' 'step { save {} }'
}

start_process() {  # NAME: one of a session's, in the folder $folder
  case $1 in
    session)
      start session "$bin/rgbdt-session" "$scratch/session.textproto" \
        --rig "$scratch/rig.textproto" --out "$folder"
      ;;
    viewer) start viewer "$bin/rgbdt-viewer" --listen 127.0.0.1:0 ;;
    logger)
      start logger lcm-logger --quiet -i "--lcm-url=$LCM_DEFAULT_URL" "$scratch/session.lcmlog"
      ;;
    simulator) start simulator "$bin/rgbdt-simulator" --speed "$speed" --rig "$scratch/rig.textproto" ;;
    *) start "$1" "$bin/rgbdt-$1" ;;
  esac
}

begin() {  # NAME [PROCESS...]: a session, with processes of its own, and some more
  local process
  folder=$scratch/$1
  shift
  others=("$@")
  for process in "${services[@]}" simulator "${others[@]}"; do start_process "$process"; done
  helper ready "${services[@]}" simulator || fail "not every process came up"
  start_process session
}

end() {
  wait_for session || fail "the session ended with exit code $?"
  stop INT "${services[@]}" simulator "${others[@]}"
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

is_identical() {  # to the undisturbed session's calibration
  local same=1
  cmp "$scratch/undisturbed/calibration.textproto" "$folder/calibration.textproto" || same=0
  figure calibration_identical "$same" 1
  [ "$same" = 1 ] || fail "the calibration is not what it is undisturbed"
}

restart() {  # PROCESS: what it had said is kept
  kill_process "$1"
  cat "$scratch/$1.log" >>"$scratch/killed-$1.log"
  start_process "$1"
}

until_it_waits() {  # AFTER_VIEW
  until [ -s "$folder/views/000$1/detection.lcm" ] && grep -qs 'waiting 3' "$scratch/session.log"; do
    kill -0 "${pids[session]}" || fail "the session ended before it waited"
    sleep 0.05
  done
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

echo "== a session that is killed goes on, and one whose detector is killed between two views"
begin resumed
until_it_waits 2
checksums >"$scratch/views"
restart session
until_it_waits 4
restart detector
end
grep 'goes on with the 2 views' "$scratch/session.log" || fail "it did not say that it goes on"
checksums | grep -F -x -f "$scratch/views" | cmp - "$scratch/views" ||
  fail "the views that there were are not what they were"
has_all_views
is_identical

shuffle() {  # PROCESS...: into turn, in an order by RANDOM, which a subshell would draw anew
  local i j other
  turn=("$@")
  for ((i = ${#turn[@]} - 1; i > 0; i--)); do
    j=$((RANDOM % (i + 1)))
    other=${turn[i]}
    turn[i]=${turn[j]}
    turn[j]=$other
  done
}

# In a session, one a view, at any moment of it; more, and none would ever be whole. Sets `killed`:
# how many were.
kill_in_turn() {  # MOST PROCESS...
  local most=$1 there=-1 moment process
  shift
  killed=0
  turn=()
  while [ "$killed" -lt "$most" ] && another_view_is_taken "$there"; do
    moment=$((RANDOM * a_view_ms / 32768))
    sleep "$((moment / 1000)).$(printf %03d $((moment % 1000)))"
    kill -0 "${pids[session]}" 2>/dev/null || break  # the others die in the next session
    there=$(taken)
    if [ "${#turn[@]}" = 0 ]; then shuffle "$@"; fi
    process=${turn[0]}
    turn=("${turn[@]:1}")
    echo "$process is killed after $moment ms, in: $(grep -E '^\[[0-9]+/' "$scratch/session.log" | tail -n 1)"
    restart "$process"
    killed=$((killed + 1))
  done
}

figure kills_planned "$kills" 1
RANDOM=$seed
number=0

sessions_with_kills() {  # COUNT CHECK PROCESS...: until so many were killed
  local count=$1 check=$2
  shift 2
  while [ "$count" -gt 0 ]; do
    number=$((number + 1))
    echo "== killed at a random moment, each in turn: $*; session $number"
    begin "killed-$number" viewer logger
    kill_in_turn "$count" "$@"
    end
    has_all_views
    cat "$scratch"/killed-session.log "$scratch/session.log" 2>/dev/null | grep 'started anew' || true
    "$check"
    figure kills_survived "$killed" 1
    count=$((count - killed))
    rm -rf "$folder" "$scratch"/killed-*.log "$scratch"/session.lcmlog.*
  done
}

agrees() {
  "$bin/rgbdt" compare "$scratch/undisturbed" "$folder" || fail "the calibrations contradict each other"
}

sessions_with_kills $(((kills + 1) / 2)) is_identical "${harmless[@]}"
sessions_with_kills $((kills / 2)) agrees "${spoiling[@]}"
echo "passed"
