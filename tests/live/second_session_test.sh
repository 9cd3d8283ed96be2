#!/usr/bin/env bash
# A second session on a bus is refused and says which one is there; the first says so, too, and ends
# as if undisturbed: its calibration is the same to the bit. Run by scripts/in-namespace.
# Usage: second_session_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

views=4
speed=6

refused() {  # NAME ARGUMENT...: a session that is refused while the one called disturbed goes on
  local name=$1 code=0
  shift
  "$bin/rgbdt-session" "$@" --rig "$scratch/rig.textproto" --out "$scratch/$name" \
    >"$scratch/$name.log" 2>&1 || code=$?
  [ "$code" = 1 ] || fail "$name ended with exit code $code"
  grep "rgbdt-session: .*another rgbdt-session is on this bus .*:$scratch/disturbed" \
    "$scratch/$name.log" || fail "$name did not name the session that is there"
  [ ! -e "$scratch/$name" ] || fail "$name was refused and left a directory"
  kill -0 "${pids[disturbed]}" || fail "the first session had ended: $name came too late"
}

session_script "$views" >"$scratch/session.textproto"
echo "== undisturbed"
begin_session undisturbed "$speed"
end_session undisturbed
if grep 'another rgbdt-session' "$scratch/undisturbed.log"; then fail "there was no other"; fi

echo "== a second and a third session come"
begin_session disturbed "$speed"
until [ -s "$scratch/disturbed/views/0002/view.textproto" ]; do
  kill -0 "${pids[disturbed]}" || fail "the session ended before its second view"
  sleep 0.05
done
refused second "$scratch/session.textproto"
refused third

echo "== one on another bus, in the first one's folder"
code=0
"$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$scratch/disturbed" \
  --lcm-url 'udpm://239.255.76.67:7668?ttl=0' >"$scratch/same_folder.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a session in another one's folder ended with exit code $code"
grep "rgbdt-session: $scratch/disturbed: another rgbdt-session writes to it" \
  "$scratch/same_folder.log" || fail "it did not name the folder"
end_session disturbed
[ "$(grep -c 'another rgbdt-session is on this bus' "$scratch/disturbed.log")" = 2 ] ||
  fail "the first session did not warn of each of the others, once"
cmp "$scratch/undisturbed/calibration.textproto" "$scratch/disturbed/calibration.textproto" ||
  fail "the first session's calibration is not what it is undisturbed"
echo "passed"
