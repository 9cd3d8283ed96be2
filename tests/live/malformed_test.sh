#!/usr/bin/env bash
# Malformed datagrams to the processes on a bus of ttl=0: from this machine, to its addresses and to
# the group, and from another machine. Each process goes on and tells what reached it. Run by
# scripts/in-namespace. Usage: malformed_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

PATH=$PATH:/usr/sbin:/sbin
group=${LCM_DEFAULT_URL#udpm://}
port=${group#*:}
port=${port%%\?*}
group=${group%%:*}
processes=(assembler detector solver fuser monitor odometry mapper session viewer simulator)
channels=(CLOUD LINE_SCAN DETECTION CALIBRATION RGBDT_CLOUD STATUS SESSION_COMMAND rgb_IMAGE)
addresses=(127.0.0.1)

all_go_on() {  # AFTER WHAT
  local process code
  for process in "${processes[@]}"; do
    kill -0 "${pids[$process]}" 2>/dev/null && continue
    code=0
    wait_for "$process" || code=$?
    fail "after $1 rgbdt-$process ended with exit code $code"
  done
}

# LEAST AFTER WHAT: what each of them tells, once that is so many.
told() {
  helper malformed "$1" "${processes[@]}" >"$scratch/told" && return
  all_go_on "$2"
  fail "$2: not every process tells of them"
}

none_told() {  # WHAT: nothing of it reached any of them
  told 0 "$1"
  ! grep -v ' 0$' "$scratch/told" || fail "$1 reached these"
  all_go_on "$1"
}

# Another machine, whose cable the bus's group leads to, and a process of ttl=1, which hears it.
other_machine=
if [ "${RGBDT_IN_NAMESPACE-}" = namespace ]; then
  start_other_machine
  addresses+=(10.79.0.1)
  start listener env "LCM_DEFAULT_URL=${LCM_DEFAULT_URL/ttl=0/ttl=1}" \
    "$bin/live_helper" hears_malformed CLOUD
fi

start simulator "$bin/rgbdt-simulator" --rig "$scratch/rig.textproto"
helper ready simulator || fail "rgbdt-simulator did not come up"
start session "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$scratch/session"
start viewer "$bin/rgbdt-viewer" --listen 127.0.0.1:0
start mapper "$bin/rgbdt-mapper" --out "$scratch/map.ply"
for process in assembler detector solver fuser monitor odometry; do
  start "$process" "$bin/rgbdt-$process"
done
helper ready "${processes[@]}" || fail "not every process came up"

for address in "${addresses[@]}"; do
  helper attack "$address" "$port" "${channels[@]}" >/dev/null
  none_told "datagrams to $address"
done

if [ -n "$other_machine" ]; then
  for address in 10.79.0.1 "$group"; do
    at_other "$bin/live_helper" attack "$address" "$port" "${channels[@]}" >/dev/null
    none_told "datagrams from another machine to $address"
  done
  wait_for listener || fail "not even a bus of ttl=1 heard the other machine"
fi

sent=$(helper attack "$group" "$port" "${channels[@]}")
told 128 "datagrams to the group"  # 16 kinds by 8 channels, and more on channels that it hears
all_go_on "datagrams to the group"
echo "malformed datagrams told, of $sent:"
cat "$scratch/told"
grep -q 'viewer: a malformed datagram from ' "$scratch/viewer.log" ||
  fail "the viewer's log does not name them"
stop TERM assembler detector solver fuser monitor odometry mapper viewer simulator
kill -TERM "${pids[session]}"
wait_for session || [ $? = 1 ] || fail "rgbdt-session did not end as it does when stopped"
echo "passed"
