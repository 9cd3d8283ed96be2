#!/usr/bin/env bash
# Sessions of spinning LIDARs hold what such a LIDAR gives. Usage: simulate_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

holds() {  # WHAT FILE PATTERN: the text file, or a binary one's header, has such a line
  head -c 2000 "$2" | grep -qaE -- "$3" || complain "$1: no '$3' in $2"
}

for kind in "vlp16 16 1800" "64 64 2118"; do
  read -r lidar rings azimuths <<<"$kind"
  session=$scratch/$lidar
  accepts "a session of $lidar" "$bin/rgbdt" simulate "$session" --views 1 --lidar "$lidar"
  cloud=$session/views/0001/cloud.pcd
  holds "$lidar" "$cloud" "^FIELDS x y z intensity ring utime line beam dir_x dir_y dir_z$"
  holds "$lidar" "$cloud" "^WIDTH $azimuths$"
  holds "$lidar" "$cloud" "^HEIGHT $rings$"
  ! grep -q turned_scanner "$session/rig.textproto" || complain "$lidar: its rig has a motor"
  [ -s "$session/views/0001/thermal.png" ] || complain "$lidar: no thermal image"
done

accepts "the turned scanner by name" "$bin/rgbdt" simulate "$scratch/by name" --views 1 --lidar turned
grep -qF "next: rgbdt calibrate '$scratch/by name'" "$scratch/output" ||
  complain "what is next is no command: $(tail -1 "$scratch/output")"
accepts "the turned scanner by default" "$bin/rgbdt" simulate "$scratch/default" --views 1
diff -r "$scratch/by name" "$scratch/default" >"$scratch/output" 2>&1 ||
  complain "the turned scanner is not the default"
grep -q turned_scanner "$scratch/by name/rig.textproto" || complain "the turned scanner has no motor"

session=$scratch/imperfect
accepts "an imperfect rig" "$bin/rgbdt" simulate "$session" --views 1 --lidar vlp16 --imperfect
grep -q "print_sigma: 0.003" "$session/rig.textproto" || complain "imperfect: its print is exact"
! grep -q "exact: true" "$session/rig.textproto" || complain "imperfect: its lenses are exact"
holds "imperfect" "$session/truth.textproto" "^# rings' ranges \[mm\], the lowest first:( [+-][0-9.]+){16}$"
holds "imperfect" "$session/truth.textproto" "^# beams meet at a radius of [0-9.]+ mm$"
! cmp -s "$session/views/0001/cloud.pcd" "$scratch/vlp16/views/0001/cloud.pcd" ||
  complain "the imperfect rig's cloud is that of the exact one"

for kind in "turned outdoor" "32 indoor"; do
  read -r lidar scene <<<"$kind"
  session=$scratch/natural_$scene
  accepts "a natural session $scene" "$bin/rgbdt" simulate "$session" --views 2 --natural \
    --scene "$scene" --lidar "$lidar"
  for file in cloud.pcd rgb.png thermal.png view.textproto; do
    [ -s "$session/views/0002/$file" ] || complain "natural $scene: no $file"
    ! cmp -s "$session/views/0001/$file" "$session/views/0002/$file" ||
      complain "natural $scene: both views have the same $file"
  done
  grep -q camera_from_lidar "$session/truth.textproto" || complain "natural $scene: no truth"
  ! grep -rqE "^ *(lidar_from_target|picked) *\{" "$session" --include=*.textproto --exclude=rig.textproto ||
    complain "natural $scene: it has a board"
done
drive=$scratch/drive
accepts "a drive" "$bin/rgbdt" simulate "$drive" --drive 1 --scene indoor --lidar vlp16
grep -qF "next: rgbdt map $drive/drive.lcmlog" "$scratch/output" || complain "a drive names no next step"
[ "$(grep -cv '^#' "$drive/truth.tum")" = 10 ] || complain "a drive's way has not a pose a sweep"
accepts "a drive's map" "$bin/rgbdt" map "$drive/drive.lcmlog" --out "$scratch/map.ply"
grep -qE '(^| )9 poses|10 sweeps' "$scratch/output" || complain "the map is not of ten sweeps"
drive=$scratch/imperfect_drive
accepts "an imperfect drive" "$bin/rgbdt" simulate "$drive" --drive 0.2 --scene indoor --lidar vlp16 --imperfect
holds "imperfect drive" "$drive/truth.textproto" "^# rings' ranges \[mm\], the lowest first:( [+-][0-9.]+){16}$"
holds "imperfect drive" "$drive/truth.textproto" "^# rgb: time_offset_s -?[0-9.]+, drifts by .*, rolling_s 0.0[12]"
holds "imperfect drive" "$drive/calibration.textproto" "timing {"
! grep -q "^# pattern" "$drive/truth.textproto" || complain "imperfect drive: a print, without a board"
! grep -q "exact: true" "$drive/rig.textproto" || complain "imperfect drive: its lenses are exact"
grep -q "lens {" "$drive/calibration.textproto" || complain "imperfect drive: the true lenses are not there"
misuses "a drive and a wave" "$bin/rgbdt" simulate "$scratch/refused" --drive 1 --wave 1
misuses "a natural drive" "$bin/rgbdt" simulate "$scratch/refused" --drive 1 --natural
for lidar in avia turned; do
  misuses "a board that is waved before $lidar" "$bin/rgbdt" simulate "$scratch/refused" --wave 1 --lidar "$lidar"
  grep -q "a spinning LIDAR: --lidar vlp16" "$scratch/output" || complain "who drives with $lidar is told nothing"
done
misuses "a drive in views" "$bin/rgbdt" simulate "$scratch/refused" --drive 1 --views 12
grep -q -e "--views goes with views" "$scratch/output" || complain "a drive in views is told nothing"
misuses "a wave with picked corners" "$bin/rgbdt" simulate "$scratch/refused" --wave 1 --picked rgb
misuses "a drive with a board" "$bin/rgbdt" simulate "$scratch/refused" --drive 1 --target 8x6@0.095,0.85x0.61
refuses "a drive at night" "$bin/rgbdt" simulate "$scratch/refused" --drive 1 --scene night
misuses "a natural night" "$bin/rgbdt" simulate "$scratch/refused" --natural --scene night
misuses "--board alone" "$bin/rgbdt" simulate "$scratch/refused" --board

verdict
