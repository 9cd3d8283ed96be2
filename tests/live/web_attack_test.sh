#!/usr/bin/env bash
# Hostile browsers (web_attack.py) before the viewer of a live rig: each gets what it deserves, the
# page is there for others, the viewer loses no message and does not grow. What the bus feels is
# printed, and judged with RGBDT_TURNS=10: speed is not for every run (scripts/check-all web).
# Run by scripts/in-namespace. Usage: web_attack_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

turns=${RGBDT_TURNS:-3}
most_growth_kb=70000  # of it 23 MB are images on their way to eight who do not read
ulimit -n "$(ulimit -H -n)"
[ "$(ulimit -n)" -ge 2000 ] || fail "1,000 connections need more open files than $(ulimit -n)"

# Who attacks is another machine, which has processors of its own: here the last one, and the rig the
# others. By priority they cannot be kept apart: the scheduler gives even idle tasks a tick (4 ms)
# now and then while the bus' wait. What they cost where they take the rig's own processors shows
# RGBDT_ATTACK_AS=env.
read -ra processors <<<"$(python3 -c 'import os; print(*sorted(os.sched_getaffinity(0)))')"
rig=() attackers=()
if [ "${#processors[@]}" -ge 2 ]; then
  attackers=(taskset -c "${processors[-1]}")
  unset 'processors[-1]'
  rig=(taskset -c "$(IFS=,; echo "${processors[*]}")")
else
  [ "$turns" -le 3 ] || fail "the attackers need a processor of their own; there is only one"
fi
[ -z "${RGBDT_ATTACK_AS-}" ] || read -ra attackers <<<"$RGBDT_ATTACK_AS"

resident_kb() { awk '/^VmRSS:/ { print $2 }' "/proc/${pids[viewer]}/status"; }

start viewer "${rig[@]}" "$bin/rgbdt-viewer" --listen 127.0.0.1:0
helper ready viewer || fail "rgbdt-viewer did not come up"
port=$(sed -n 's/^http:.*:\([0-9]*\).*/\1/p' "$scratch/viewer.log")
[ -n "$port" ] || fail "the viewer did not say where its page is"
start stream "${rig[@]}" "$bin/browser_helper" stream 2 2000 10 2
start pulse "${rig[@]}" "$bin/bus_pulse" "$scratch/pulse.csv"
sleep 3
before=$(resident_kb)
"${attackers[@]}" python3 "$(dirname "$0")/web_attack.py" "$port" "${pids[pulse]}" "$scratch/pulse.csv" \
  "$turns" >"$scratch/figures" || fail "under attack: $(cat "$scratch/figures")"
cat "$scratch/figures"
growth=$(($(resident_kb) - before))
echo "the viewer grew by $growth kB"
[ "$growth" -lt "$most_growth_kb" ] || fail "the viewer grew by $growth kB"
kill -0 "${pids[stream]}" || fail "the stream ended"
stop TERM viewer
grep -q 'viewer: stopped' "$scratch/viewer.log" || fail "the viewer said no goodbye"
! grep 'viewer: stopped' "$scratch/viewer.log" | grep -Eq ', gaps [1-9]' ||
  fail "the viewer missed messages"
echo "passed"
