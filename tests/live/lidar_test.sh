#!/usr/bin/env bash
# rgbdt-lidar on the bus: a folder of PCD files to its end, and what it says to a rig that it cannot
# serve. Run by scripts/in-namespace. Usage: lidar_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

rig() {  # DEVICE: a rig file with it
  cat >"$scratch/rig.textproto" <<END
name: "test"
lidar { name: "lidar" $1 }
camera {
  name: "rgb" kind: COLOR width: 640 height: 480 pixel_format: BGR8
  pinhole { fx: 500 fy: 500 cx: 320 cy: 240 }
}
target { squares_x: 8 squares_y: 6 square_m: 0.1 width_m: 0.9 height_m: 0.7 }
END
}

refused() {  # PATTERN: it ends at once with exit code 1 and says this
  local code=0
  "$bin/rgbdt-lidar" --rig "$scratch/rig.textproto" >"$scratch/refused.log" 2>&1 || code=$?
  [ "$code" = 1 ] || fail "rgbdt-lidar ended with exit code $code instead of 1"
  grep -q "$1" "$scratch/refused.log" || fail "rgbdt-lidar did not say: $1"
}

rig ''
refused 'add one of these to its lidar'
rig "pcd_folder { folder: \"$scratch/missing\" }"
refused 'expected a folder of PCD files'
rig 'velodyne { model: VLP16 pcap: "/dev/null" }'
refused '/dev/null'

mkdir "$scratch/clouds"
for i in $(seq 8); do
  printf 'FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 3\nHEIGHT 2\nPOINTS 6\nDATA ascii\n' \
    >"$scratch/clouds/$i.pcd"
  for y in 1 2 3 4 5 6; do echo "3 $y $i"; done >>"$scratch/clouds/$i.pcd"
done
echo "no cloud" >"$scratch/clouds/3.pcd"
rig "pcd_folder { folder: \"$scratch/clouds\" period_s: 0.5 }"
start hears "$bin/live_helper" hears CLOUD 3
start lidar "$bin/rgbdt-lidar" --rig "$scratch/rig.textproto"
wait_for hears || fail "no clouds came"
wait_for lidar || fail "rgbdt-lidar ended with exit code $?"
grep -q 'clouds/3.pcd' "$scratch/lidar.log" || fail "rgbdt-lidar did not name the bad file"
echo "passed"
