#!/usr/bin/env bash
# Two LIDARs in one rig: as folders and as a bag they are calibrated alike, to the bit, and the second
# one lands where it is. Usage: import_lidars_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
make_bag=$(dirname "${BASH_SOURCE[0]}")/make_bag.py

good=$scratch/good
accepts "a session" "$bin/rgbdt" simulate "$good" --views 8 --seed 3 --lidar 32 --further-lidar vlp16
mkdir -p "$scratch/kept" "$scratch/folders"/{rgb,thermal,front,rear}
board=11x8@0.1,1.2192x0.9144
# As a person has it, called by the times that the bag's headers have.
for i in 1 2 3 4 5 6 7 8; do
  view=$good/views/000$i time=170000000$((i - 1))
  ln -s "$view/rgb.png" "$scratch/folders/rgb/$time.020000.png"
  ln -s "$view/thermal.png" "$scratch/folders/thermal/$time.020000.png"
  ln -s "$view/cloud.pcd" "$scratch/folders/front/$time.000000.pcd"
  ln -s "$view/cloud_lidar2.pcd" "$scratch/folders/rear/$time.000000.pcd"
done
lenses=()
for camera in rgb thermal; do
  lens_of "$good/rig.textproto" "$camera" >"$scratch/$camera.yaml"
  lenses+=(--lens "$scratch/$camera.yaml")
done
session=("$bin/rgbdt" session --images "$scratch/folders/rgb" --images "$scratch/folders/thermal"
  "${lenses[@]}" --board "$board")
accepts "folders" "${session[@]}" --clouds "$scratch/folders/front" \
  --clouds lidar2="$scratch/folders/rear" --out "$scratch/session"
says_all "folders" "lidar lidar: the reference" "lidar2: 1700000003.000000.pcd" "8 views"
accepts "folders: calibrating" "$bin/rgbdt" calibrate "$scratch/session" --truth "$good/truth.textproto"
says_all "folders: calibrating" "LIDAR lidar2: converged"
python3 - "$scratch/session/report.json" <<'END' || complain "the second LIDAR is not where it is"
import json, sys
(lidar,) = json.load(open(sys.argv[1]))["lidars"]
error = lidar["truth_error"]
assert error["rotation_deg"] < 0.5 and error["translation_mm"] < 30, error
END

accepts "making bags" python3 "$make_bag" "$good" "$scratch/b.mcap" "$scratch/b.bag:lz4"
for kind in mcap bag; do
  accepts "$kind" "$bin/rgbdt" import "$scratch/b.$kind" --board "$board" --every 1 --out "$scratch/$kind"
  says_all "$kind" "lidar lidar (the reference): /lidar/points" "lidar lidar2: /lidar2/points, " \
    "0008: cloud at 7.00 s  rgb: +20 ms  thermal: +20 ms  lidar2: +0 ms"
  cmp "$scratch/session/rig.textproto" "$scratch/$kind/rig.textproto" || complain "$kind: another rig"
  cmp "$good/views/0005/cloud_lidar2.pcd" "$scratch/$kind/views/0005/cloud_lidar2.pcd" ||
    complain "$kind: another cloud"
  accepts "$kind: calibrating" "$bin/rgbdt" calibrate "$scratch/$kind"
  cmp "$scratch/session/calibration.textproto" "$scratch/$kind/calibration.textproto" ||
    complain "$kind: another calibration than of the folders"
done
grep -q reference_from_lidar "$scratch/mcap/calibration.textproto" || complain "the second LIDAR has no pose"

# The other one as the reference; one alone; what is listed; a log carries one.
bag=("$bin/rgbdt" import "$scratch/b.mcap")
accepts "the other way round" "${bag[@]}" --board "$board" --every 1 --out "$scratch/turned" \
  --cloud rear=/lidar2/points --cloud front=/lidar/points
says_all "the other way round" "lidar rear (the reference): /lidar2/points"
[ -s "$scratch/turned/views/0001/cloud_front.pcd" ] || complain "the other way round: no cloud of the other"
accepts "one alone" "${bag[@]}" --board "$board" --at 0 --cloud /lidar/points --out "$scratch/one"
[ "$(grep -c '^lidar {' "$scratch/one/rig.textproto")" = 1 ] || complain "one alone: others are there, too"
accepts "a list" "${bag[@]}"
says_all "a list" "would take: lidar lidar (the reference; another by --cloud): /lidar/points" \
  "would take: lidar lidar2: /lidar2/points"
says=("a log carries the clouds of one" "--cloud" "/lidar2/points")
refuses "a log of two LIDARs" "${bag[@]}" --log "$scratch/kept/log"
says=("--log" "one --cloud")
misuses "a log of two LIDARs, asked for" "${bag[@]}" --log "$scratch/kept/log" --cloud /lidar/points \
  --cloud /lidar2/points
accepts "a log of one of them" "${bag[@]}" --log "$scratch/one.lcmlog" --cloud /lidar2/points
says_all "a log of one of them" "8 clouds"
says=("--metadata is of packets")
refuses "metadata of clouds" "${bag[@]}" --board "$board" --out "$scratch/kept/new" --metadata rear=x.json
says=("two LIDARs")
refuses "one folder twice" "${session[@]}" --clouds "$scratch/folders/front" \
  --clouds "$scratch/folders/front" --out "$scratch/kept/new"
verdict
