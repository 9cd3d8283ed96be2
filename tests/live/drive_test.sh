#!/usr/bin/env bash
# rgbdt up --drive: sweeps alone come, and a map of the drive is made of them by odometry, fuser and
# mapper; the monitor sends rig and calibration. Run by scripts/in-namespace.
# Usage: drive_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

session=$scratch/session
{ "$bin/rgbdt" simulate "$session" --views 5 --lidar 32 && "$bin/rgbdt" calibrate "$session"; } \
  >"$scratch/calibrate.log" 2>&1 || fail "no calibrated session"
"$bin/map_test_log" "$scratch/fused.lcmlog" "$scratch/other.lcmlog" "$scratch/drive.lcmlog" \
  "$scratch/rigged.lcmlog" "$scratch/truth"

start up "$bin/rgbdt" up "$session/rig.textproto" --drive "$session" --out "$scratch/drive" \
  --listen 127.0.0.1:0
helper ready monitor fuser=fusing odometry mapper viewer up || fail "not every process came up"
lcm-logplayer "$scratch/drive.lcmlog" >"$scratch/player.log" 2>&1
# Of 20 sweeps all but the first ones, which come before there are poses.
voxels() {
  [ ! -e "$scratch/drive/map.ply" ] || sed -n '/^element vertex/{s/.* //p;q}' "$scratch/drive/map.ply"
}
for _ in $(seq 150); do
  count=$(voxels)
  [ "${count:-0}" -lt 40000 ] || break
  sleep 0.1
done
stop INT up
[ "${count:-0}" -ge 40000 ] || fail "the map has ${count:-no} voxels"
head -c 500 "$scratch/drive/map.ply" | grep -qa '^comment frame: map$' || fail "the map has no poses"

code=0
"$bin/rgbdt" up "$session/rig.textproto" --drive "$scratch" >"$scratch/refused.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a drive by no calibration: exit code $code"
grep -q 'calibration.textproto' "$scratch/refused.log" || fail "it did not say what is missing"
echo "passed"
