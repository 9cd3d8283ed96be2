#!/usr/bin/env bash
# A session by real drivers (devices on ports and behind cables, as in tests/hardware) over two
# machines, one of whose clocks is set while a view is swept: the session says whose clock is off and
# by how much, and sweeps no view until it is right again; then it ends well, and its result against
# the truth is what it says of itself. Where the clock stays off, the session ends with that reason.
# Run by scripts/in-namespace.
# Usage: clocks_test.sh BIN_DIR [HOST:SECONDS...]: sensor:+0.2 sensor:-1 compute:+10, where none is
# named; one a view
set -euo pipefail
tests=$(dirname "${BASH_SOURCE[0]}")/..
# shellcheck source=tests/hardware/common.sh
source "$tests/hardware/common.sh"
# shellcheck source=tests/hosts/common.sh
source "$tests/hosts/common.sh"

jumps=("${@:2}")
[ "${#jumps[@]}" -gt 0 ] || jumps=(sensor:+0.2 sensor:-1 compute:+10)
views=$((${#jumps[@]} + 2))
declare -A address=([compute]=10.78.0.1 [sensor]=10.78.0.100)
session=$scratch/session

faked=$(find /usr/lib -name libfaketime.so.1 -print -quit)
if ! can_have_hosts || [ -z "$faked" ]; then
  echo "SKIPPED: no bridges or no nftables in a namespace here, or no libfaketime"
  exit 77
fi

set_clock() {  # HOST SECONDS: so far off, from now on
  echo "$2s" >"$scratch/$1.new"
  mv "$scratch/$1.new" "$scratch/$1.clock"
}

clock_of() {  # HOST: the environment by which a process has its clock
  printf '%s\n' "LD_PRELOAD=$faked" "FAKETIME_TIMESTAMP_FILE=$scratch/$1.clock" FAKETIME_NO_CACHE=1 \
    DONT_FAKE_MONOTONIC=1
}

until_told() {  # WORDS
  until grep -Eqs "$1" "$scratch/session.log"; do
    kill -0 "${pids[session]}" || fail "the session ended before it said: $1"
    sleep 0.05
  done
}

start_session() {
  start session "${driver_environment[@]}" "$bin/rgbdt-session" "$scratch/session.textproto" \
    --rig "$scratch/rig.textproto" --out "$1"
}

# "clocks disagree: that of host sensor (10.78.0.100) is 200 ms ahead of that of ...": to 30 ms.
tells_of() {  # HOST SECONDS FROM_LINE
  tail -n "+$3" "$scratch/session.log" |
    grep -Eo 'that of host [^ ]+ \([0-9.]+\) is [0-9]+ ms (ahead of|behind)' |
    awk -v address="(${address[$1]})" -v seconds="$2" '
      $5 == address {
        off = ($9 == "ahead" ? 1 : -1) * $7 - 1000 * seconds
        if (off > -30 && off < 30) found = 1
      }
      END { exit !found }'
}

# This one is the sensors', whose devices keep their own time, as does who carries the board: it
# speaks within this machine alone, without telling others of its clock.
make_hosts 1500 compute
ip address add "${address[sensor]}/24" dev switch
ip route replace 239.0.0.0/8 dev switch
for host in compute sensor; do set_clock "$host" +0; done
mapfile -t compute_environment < <(clock_of compute)
# shellcheck source=tests/hardware/devices.sh
source "$tests/hardware/devices.sh"  # again: what plugs in here are cameras
mapfile -t driver_environment < <(clock_of sensor)
for process in assembler detector solver fuser; do
  start_at compute "$process" env "${compute_environment[@]}" "$bin/rgbdt-$process"
done
mkdir "$scratch/world" "$session"
start_hardware "$scratch/world" "$scratch/rig.textproto" "$session/truth.textproto" --seed 2 \
  --lcm-url "udpm://$group:7667?ttl=0"

echo "== a clock that stays off"
set_clock sensor +0.2
echo 'step { sweep {} timeout_s: 8 } step { capture {} }' >"$scratch/session.textproto"
start_session "$scratch/refused"
code=0
wait_for session || code=$?
tail -n 1 "$scratch/session.log"
[ "$code" = 1 ] || fail "the session ended with exit code $code"
tells_of sensor +0.2 "$(wc -l <"$scratch/session.log")" || fail "it does not say whose clock is off"
[ ! -e "$scratch/refused/views" ] || fail "a view was taken"
set_clock sensor +0

echo "== clocks that are set while a view is swept: ${jumps[*]}"
session_script "$views" "$views" >"$scratch/session.textproto"
start_session "$session"
number=0
for jump in "${jumps[@]}"; do
  host=${jump%:*} seconds=${jump#*:}
  number=$((number + 1))
  until_told "view 000$number: sweeping to .*, [2-4][0-9]%"
  line=$(($(wc -l <"$scratch/session.log") + 1))
  set_clock "$host" "$seconds"
  began=$(now_ms)
  until tells_of "$host" "$seconds" "$line"; do
    kill -0 "${pids[session]}" || fail "the session ended before it told of $jump"
    sleep 0.05
  done
  echo "$jump: told after $(($(now_ms) - began)) ms"
  set_clock "$host" +0
done
wait_for session || fail "the session ended with exit code $?"
grep -E 'again|waits for' "$scratch/session.log" || true
number=0
for jump in "${jumps[@]}"; do
  number=$((number + 1))
  # Lines and encoder readings of before and after do not fit each other.
  grep -q "view 000$number: .*; the sweep is taken again" "$scratch/session.log" ||
    fail "the sweep in which $jump was set was used"
done
stop TERM lidar motor camera_rgb camera_thermal assembler detector solver fuser
for view in $(seq -f %04.0f "$views"); do
  [ -s "$session/views/$view/view.textproto" ] || fail "view $view is missing"
done
is_what_it_says "$session"
echo "passed"
