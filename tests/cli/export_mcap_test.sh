#!/usr/bin/env bash
# rgbdt export --mcap: what it makes of a log, decoded by @mcap/core, which shares no code with ours,
# and read back by rgbdt import. Usage: export_mcap_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$(dirname "${BASH_SOURCE[0]}")
modules=$2/viewer/page/node_modules
has() {  # WHAT PATTERN...
  local pattern
  for pattern in "${@:2}"; do
    grep -qE -- "$pattern" "$scratch/output" || complain "$1: no line of '$pattern'"
  done
}

accepts "a session" "$bin/rgbdt" simulate "$scratch/room" --views 6
accepts "a log" "$bin/drive_test_log" "$scratch/room" 1 "$scratch/drive.lcmlog" "$scratch/true.textproto" 60
accepts "exporting" "$bin/rgbdt" export --mcap "$scratch/drive.lcmlog" --camera-frame rgb=front
has "exporting" '^/lidar/points  foxglove.PointCloud  6 messages$' '^/thermal/image_raw  foxglove.RawImage  ' \
  '^/rgb/camera_info  foxglove.CameraCalibration  6 messages$' "^wrote $scratch/drive.mcap$"
mcap=$scratch/drive.mcap
cp "$mcap" "$scratch/first.mcap"
accepts "once more" "$bin/rgbdt" export --mcap "$scratch/drive.lcmlog" --camera-frame rgb=front
cmp "$mcap" "$scratch/first.mcap" || complain "once more: another file"
# As lcm-logger names the logs of one day.
for log in lcmlog-2025-11-25.00 lcmlog-2025-11-25.01; do
  ln "$scratch/drive.lcmlog" "$scratch/$log"
  accepts "$log" "$bin/rgbdt" export --mcap "$scratch/$log"
  has "$log" "^wrote $scratch/$log.mcap$"
done

if command -v node >/dev/null && [ -d "$modules/@mcap/core" ]; then
  accepts "by @mcap/core" node "$here/read_mcap.mjs" "$mcap" "$modules"
  has "by @mcap/core" '^/lidar/points  foxglove.PointCloud  6 6  lidar 120000 points; ' \
    '^/rgb/camera_info  foxglove.CameraCalibration  6 6  front plumb_bob fx 1100.00 D 5$' \
    '^/thermal/image_raw  foxglove.RawImage  6 6  thermal_optical_frame 640x480 mono16 614400 bytes$'
  all=$(sed -n 's/^decoded \([0-9]*\) of \1$/\1/p' "$scratch/output")
  echo "mcap_decoded $all of $all"
  # Fused clouds and poses; a street of sweeps.
  accepts "other logs" "$bin/map_test_log" "$scratch/fused.lcmlog" "$scratch/pose.lcmlog" \
    "$scratch/street.lcmlog" "$scratch/rigged.lcmlog" "$scratch/way.txt"
  for log in fused pose rigged; do
    accepts "$log" "$bin/rgbdt" export --mcap "$scratch/$log.lcmlog"
    accepts "$log by @mcap/core" node "$here/read_mcap.mjs" "$scratch/$log.mcap" "$modules"
    case $log in
      fused) has "$log" '^/fused/points .* red=100.000 green=120.000 blue=90.0000 alpha=255.000 intensity=0.500000 temperature=300.000 temperature_sigma=NaN ' ;;
      pose) has "$log" '^/pose  foxglove.PoseInFrame  1 1  map: ' '^/tf  .* map > lidar: ' ;;
      *) has "$log" '^/lidar/points  foxglove.PointCloud  20 20 ' ;;
    esac
  done
else
  echo "without @mcap/core: read by rgbdt import alone"
fi

# Back again: the same sweeps, and a calibration as good as of the session itself.
accepts "importing" "$bin/rgbdt" import "$mcap" --board 11x8@0.1,1.2192x0.9144 --every 60 --max-apart 15 \
  --out "$scratch/back"
has "importing" '^camera rgb: colour, 1936x1456, pinhole lens of /rgb/camera_info' \
  '^camera thermal: thermal, 640x480' '6 views$'
accepts "calibrating" "$bin/rgbdt" calibrate "$scratch/back" --truth "$scratch/room/truth.textproto"
grep 'result against truth' "$scratch/output" | awk '{ if ($4 > 0.1 || $6 > 5) exit 1 }' ||
  complain "calibrating: not the right poses"

# What makes no sense is one line, and what was there stays.
mkdir "$scratch/kept"
echo old >"$scratch/kept/out.mcap"
says=("nowhere.lcmlog")
refuses "no log" "$bin/rgbdt" export --mcap "$scratch/nowhere.lcmlog" --out "$scratch/kept/out.mcap"
says=("rig.textproto" "log")
refuses "no log but a text" "$bin/rgbdt" export --mcap "$scratch/room/rig.textproto" --out "$scratch/kept/out.mcap"
says=("the log itself")
refuses "onto itself" "$bin/rgbdt" export --mcap "$scratch/drive.lcmlog" --out "$scratch/drive.lcmlog"
says=("--calibration")
misuses "of a session" "$bin/rgbdt" export --mcap "$scratch/drive.lcmlog" --calibration x
says=("a b" "name of a frame")
refuses "no name of a frame" "$bin/rgbdt" export --mcap "$scratch/drive.lcmlog" --lidar-frame "a b" \
  --out "$scratch/kept/out.mcap"
says=("front" "twice")
refuses "one name for two" "$bin/rgbdt" export --mcap "$scratch/drive.lcmlog" --lidar-frame front \
  --camera-frame rgb=front --out "$scratch/kept/out.mcap"
says=("full" "cannot write")
refuses "a full disk" bash -c "ulimit -f 2000 && trap '' XFSZ && '$bin/rgbdt' export --mcap '$scratch/drive.lcmlog' --out '$scratch/kept/full/x.mcap'"
[ -z "$(find "$scratch/kept" -name '.tmp*')" ] || complain "a temporary file was left"

verdict
