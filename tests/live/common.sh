# shellcheck shell=bash
# Sourced by the live tests: processes in the background, a folder that goes away.

bin=$1
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rgbdt-live-XXXXXX")
declare -A pids=()
services=(assembler detector solver fuser)  # of a session

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  local log
  for log in "$scratch"/*.log; do
    [ -s "$log" ] && printf -- '-- %s\n%s\n' "${log##*/}" "$(tail -n 8 "$log")" >&2
  done
  exit 1
}

figure() {  # NAME VALUE UNIT: for scripts/study faults
  printf '%s %s %s\n' "$@" | tee -a "${RGBDT_FIGURES:-/dev/null}"
}

clean_up() {
  local pid
  for pid in "${pids[@]}"; do kill -KILL "$pid" 2>/dev/null || true; done
  rm -rf "$scratch"
}
trap clean_up EXIT

start() {  # NAME COMMAND...: in the background, its output in NAME.log
  local name=$1
  shift
  # A background job of a script ignores SIGINT unless told otherwise, and lcm-logger stops by it.
  env --default-signal=INT "$@" >"$scratch/$name.log" 2>&1 &
  pids[$name]=$!
}

wait_for() {  # NAME: its exit code
  local code=0
  wait "${pids[$1]}" || code=$?
  unset "pids[$1]"
  return "$code"
}

stop() {  # SIGNAL NAME...: each must end with exit code 0
  local signal=$1 name
  shift
  for name in "$@"; do kill "-$signal" "${pids[$name]}" || fail "$name was gone"; done
  for name in "$@"; do wait_for "$name" || fail "$name ended with exit code $? by SIG$signal"; done
}

kill_process() {  # NAME
  kill -KILL "${pids[$1]}"
  wait_for "$1" || true
}

now_ms() { date +%s%3N; }

helper() { "$bin/live_helper" "$@"; }

session_script() {  # VIEWS [HELD_OUT]: of so many views, one of which is kept from the solver
  local view
  for view in $(seq "$1"); do
    echo 'step { next_pose {} }' 'step { sweep {} }' \
      "step { capture { heldout: $([ "$view" = "${2-}" ] && echo true || echo false) } }"
  done
  echo 'step { solve {} }' 'step { evaluate {} }' 'step { save {} }'
}

# NAME SPEED [OPTION...]: the session of $scratch/session.textproto into $scratch/NAME, with $services
# and a simulator of its own.
begin_session() {
  local name=$1 speed=$2 process
  shift 2
  for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process" "$@"; done
  start simulator "$bin/rgbdt-simulator" --speed "$speed" --rig "$scratch/rig.textproto" "$@"
  helper ready "${services[@]}" simulator || fail "not every process came up"
  start "$name" "$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto" \
    --out "$scratch/$name" "$@"
}

end_session() {  # NAME
  wait_for "$1" || fail "the session ended with exit code $?"
  stop TERM "${services[@]}" simulator
}

at_other() { nsenter "--net=$other_machine" "$@"; }

# Another machine, 10.79.0.2, by a cable that the bus's group leads to; this one is 10.79.0.1.
start_other_machine() {
  start machine unshare --net sleep 300
  other_machine=/proc/${pids[machine]}/ns/net
  for _ in $(seq 100); do
    [ "$(readlink "$other_machine")" = "$(readlink /proc/self/ns/net)" ] || break
    sleep 0.05
  done
  ip link add cable type veth peer name cable netns "${pids[machine]}"
  ip address add 10.79.0.1/24 dev cable
  ip link set cable up
  at_other ip address add 10.79.0.2/24 dev cable
  at_other ip link set cable up
  at_other ip route add 239.0.0.0/8 dev cable
  ip route replace 239.0.0.0/8 dev cable
}

# LOG: what goes into the services, by lcm-logplayer.
play_inputs() {
  lcm-logplayer "--lcm-url=$LCM_DEFAULT_URL" \
    --regexp='^(RIG|LINE_SCAN|ENCODER|.*_IMAGE|CORNER_SELECTION|SESSION_COMMAND)$' "$1" \
    >"$scratch/logplayer.log" 2>&1 || fail "lcm-logplayer failed"
}
