#!/usr/bin/env bash
# A session whose processes share a key ends with the same calibration, to the bit, as one without,
# while unsigned commands are on its bus, which every process ignores, counts and names. Its log,
# played again, commands nobody who has the key, and is read by all who have none. Run by
# scripts/in-namespace. Usage: key_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

views=4
speed=6
log=$scratch/keyed.lcmlog

start_services() {
  local process
  for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
}

session_script "$views" >"$scratch/session.textproto"
"$bin/rgbdt" key "$scratch/rig.key" >"$scratch/key.log" || fail "no key was made"
[ "$(stat -c %a "$scratch/rig.key")" = 600 ] || fail "others may read the key"

echo "== without a key"
begin_session plain "$speed"
end_session plain

echo "== with a key, and unsigned commands"
start logger nice -n -10 lcm-logger --quiet --force "--lcm-url=$LCM_DEFAULT_URL" "$log"
begin_session keyed "$speed" --key "$scratch/rig.key"
until [ -s "$scratch/keyed/views/0001/view.textproto" ]; do
  kill -0 "${pids[keyed]}" || fail "the session ended before its first view"
  sleep 0.05
done
helper forge "${services[@]}" simulator session || fail "not every process named what is unsigned"
end_session keyed
stop INT logger
helper keep_signed "$log" "$scratch/signed.lcmlog" >"$scratch/dropped"
[ "$(cat "$scratch/dropped")" -gt 10 ] || fail "the forged messages are not in the log"
log=$scratch/signed.lcmlog
cmp "$scratch/plain/calibration.textproto" "$scratch/keyed/calibration.textproto" ||
  fail "with a key and forged commands it is another calibration"

echo "== its log commands nobody who has the key"
RGBDT_KEY=$scratch/rig.key start_services
helper ready "${services[@]}" || fail "not every service came up again"
play_inputs "$log"
sleep 2  # the next STATUS
stop TERM "${services[@]}"
grep -q 'detector: ignored: SESSION_COMMAND was signed .* a recording' "$scratch/detector.log" ||
  fail "the detector did not say that it is a recording"
grep -q 'solver: stopped; .*unsigned [1-9]' "$scratch/solver.log" || fail "the solver counted none"
if grep 'solver: stopped' "$scratch/solver.log" | grep -Eq 'views [1-9]'; then
  fail "the log's commands made views"
fi

echo "== and is as any other to who has none"
start_services
helper ready "${services[@]}" || fail "not every service came up again"
"$bin/live_helper" calibration "$views" >"$scratch/replayed" 2>"$scratch/gaps.log" &
pids[listener]=$!
play_inputs "$log"
wait_for listener || fail "no calibration from the log, or with gaps: $(cat "$scratch/gaps.log")"
stop TERM "${services[@]}"
helper print "$scratch/keyed/calibration.textproto" >"$scratch/live"
diff "$scratch/live" "$scratch/replayed" || fail "the log gives another calibration than the session"
"$bin/rgbdt" replay "$log" --out "$scratch/replay" >"$scratch/replay.log" 2>&1 ||
  fail "rgbdt replay ended with exit code $?"
cmp "$scratch/keyed/calibration.textproto" "$scratch/replay/calibration.textproto" ||
  fail "rgbdt replay gives another calibration"
cat "$scratch/live"
echo "passed"
