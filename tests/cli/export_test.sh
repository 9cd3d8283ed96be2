#!/usr/bin/env bash
# What rgbdt export writes, read by Python's own XML and YAML and turned back into the calibration.
# Usage: export_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

here=$(dirname "${BASH_SOURCE[0]}")
session=$scratch/session
mkdir "$session" "$scratch/kept"
cat >"$session/rig.textproto" <<'DONE'
name: "cart"
lidar { name: "vlp16" }
camera {
  name: "rgb" kind: COLOR width: 1920 height: 1208 pixel_format: BGR8
  pinhole { fx: 1100 fy: 1100 cx: 959.5 cy: 603.5 distortion: [-0.1, 0.02, 0, 0, 0] }
}
camera {
  name: "thermal" kind: THERMAL width: 320 height: 256 pixel_format: MONO16
  fisheye { fx: 350 fy: 350 cx: 159.5 cy: 127.5 distortion: [0.01, 0, 0, 0] }
}
target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }
DONE
# The second camera lies on its side, where roll and yaw turn about one axis.
cat >"$session/calibration.textproto" <<'DONE'
method: "auto"
camera {
  camera: "rgb"
  camera_from_lidar { quaternion_wxyz: [0.51, 0.49, -0.5, 0.5] translation_m: [1e-07, 0.1, -0.2] }
  status: CONVERGED
}
camera {
  camera: "thermal"
  camera_from_lidar { quaternion_wxyz: [0, 0.70710678118654752, 0, 0.70710678118654752] translation_m: [0.1, -0.3, 0.05] }
  status: NOT_CONVERGED
  detail: "stopped -- at 50 steps"
}
DONE

says=("thermal" "not converged: stopped -- at 50 steps" "--anyway")
refuses "a camera that did not converge" "$bin/rgbdt" export "$session" --out "$scratch/kept"
accepts "exporting" "$bin/rgbdt" export "$session" --lidar-frame velodyne --anyway \
  --camera-frame rgb=camera_optical_frame --camera-frame thermal=flir/optical
[ "$(grep -c '^wrote .*: ' "$scratch/output")" = 7 ] || complain "exporting: not a line a file"
[ "$(grep -c '^rgbdt: used anyway: ' "$scratch/output")" = 1 ] || complain "exporting: no warning"
[ "$(wc -l <"$scratch/output")" = 8 ] || complain "exporting: more than a line a file"
sed -i '/^wrote/!d' "$scratch/output"
while read -r _ file _; do
  [ -s "${file%:}" ] || complain "exporting: ${file%:} is not there"
done <"$scratch/output"
python3 "$here/check_exports.py" "$session" >"$scratch/output" 2>&1 || complain "what was exported"

sed -i 's/NOT_CONVERGED/CONVERGED/' "$session/calibration.textproto"
accepts "exporting with its own names" "$bin/rgbdt" export "$session" --out "$scratch/plain"
grep -qx '  thermal/camera_link:' "$scratch/plain/sensor_kit_calibration.yaml" ||
  complain "a camera_link of no given name"
grep -q -- '--frame-id vlp16 --child-frame-id rgb_optical_frame' "$scratch"/plain/*.launch.yaml ||
  complain "names that were not given"

cp "$session/calibration.textproto" "$scratch/kept"
says=("no rig.textproto" "session directory" "--calibration")
refuses "a calibration without its rig" "$bin/rgbdt" export "$scratch/kept"

says=("--camera-frame" "CAMERA=FRAME")
misuses "a frame of no camera" "$bin/rgbdt" export "$session" --camera-frame front --out "$scratch/kept"
says=("front" "rgb" "thermal")
refuses "a camera that is not there" "$bin/rgbdt" export "$session" --camera-frame front=x --out "$scratch/kept"
says=("a b" "name of a frame")
refuses "no name of a frame" "$bin/rgbdt" export "$session" --lidar-frame "a b" --out "$scratch/kept"
says=("cam" "twice")
refuses "one name for two" "$bin/rgbdt" export "$session" --lidar-frame cam --camera-frame rgb=cam \
  --out "$scratch/kept"

verdict
