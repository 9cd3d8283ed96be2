#!/usr/bin/env bash
# rgbdt-camera against GigE Vision cameras behind cables of their own, over the real protocol: what
# it publishes, lost packets, an unplugged cable, a wrong size, triggers, packed images. Run by
# scripts/in-namespace. Usage: camera_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/hardware/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

rig=$scratch/rig.textproto
color_frames=$scratch/color.raw
thermal_frames=$scratch/thermal.raw

# What each test changes: features of the two cameras.
write_rig() {  # COLOR_DEVICE THERMAL_DEVICE
  cat >"$rig" <<END_OF_RIG
name: "two cameras"
lidar { name: "lidar" }
camera {
  name: "rgb" kind: COLOR width: 1936 height: 1456 pixel_format: BAYER_RG8
  device { address: "10.77.1.2" $1 }
}
camera {
  name: "thermal" kind: THERMAL width: 640 height: 480 pixel_format: MONO16
  linear { gain_k_per_count: 0.01 offset_k: 233.15 }
  device { serial: "thermal-1" $2 }
}
target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }
END_OF_RIG
}

rate() { echo "feature { name: \"AcquisitionFrameRate\" value: \"$1\" }"; }

start_driver() {  # NAME [OPTION...]
  local name=$1
  shift
  start "$name" "$bin/rgbdt-camera" --rig "$rig" --camera "$name" "$@"
}

plug_in rgb 1 1500
plug_in thermal 2 1500
helper frames "$color_frames" 3 1936 1456 1
helper frames "$thermal_frames" 3 640 480 2
start_camera rgb 1 "$color_frames"
start_camera thermal 2 "$thermal_frames"

echo "== both stream, found by address and by serial; each image is a frame that was served"
write_rig "$(rate 10)" "$(rate 15)"
start_driver rgb
start_driver thermal
helper images RGB_IMAGE "$color_frames" 20 || fail "no colour images"
helper images THERMAL_IMAGE "$thermal_frames" 30 || fail "no thermal images"
helper ready camera-rgb
helper counter camera-rgb frames 25 | tee "$scratch/counters"
grep -qx 'incomplete frames: 0' "$scratch/counters" || fail "frames were incomplete without loss"
stop TERM rgb thermal

echo "== one packet in 10,000 is lost: about one frame in six is not whole"
write_rig "$(rate 15) packet_bytes: 1500" "$(rate 5)"
lose rgb 1
start_driver rgb
helper images RGB_IMAGE "$color_frames" 60 || fail "a broken frame came through"
helper counter camera-rgb 'incomplete frames' 3 | tee "$scratch/counters"
incomplete=$(sed -n 's/^incomplete frames: //p' "$scratch/counters")
frames=$(sed -n 's/^frames: //p' "$scratch/counters")
[ "$incomplete" -lt "$frames" ] || fail "$incomplete of $((incomplete + frames)) frames were incomplete"
helper problem camera-rgb "not whole and was dropped"

echo "== one in 20: none is whole, none comes through"
lose rgb 500
helper counter camera-rgb 'incomplete frames' $((incomplete + 2)) >/dev/null  # some were on the way
before=$(helper counter camera-rgb 'incomplete frames' 0 | sed -n 's/^frames: //p')
helper counter camera-rgb 'incomplete frames' $((incomplete + 20)) | tee "$scratch/counters"
after=$(sed -n 's/^frames: //p' "$scratch/counters")
[ "$after" -eq "$before" ] || fail "$((after - before)) frames came through"
lose rgb 0
helper counter camera-rgb frames $((after + 5)) >/dev/null || fail "it did not recover"
grep -q "times lost: 0" "$scratch/counters" || fail "the camera was taken for lost"

echo "== the cable is pulled and put back"
ip link set cable-rgb down
helper counter camera-rgb 'times lost' 1 >/dev/null || fail "nobody noticed"
frames=$(helper counter camera-rgb 'times lost' 1 | sed -n 's/^frames: //p')
ip link set cable-rgb up
helper counter camera-rgb frames $((frames + 5)) || fail "it did not come back"
grep -q "back after .* s without a frame" "$scratch/rgb.log" || fail "the gap was not told"
stop TERM rgb

echo "== a camera that sends another size than the rig file says"
write_rig "feature { name: \"Width\" value: \"1024\" }" ""
start_driver rgb
helper problem camera-rgb "its frames are 1024 x 1456 px, the rig file says 1936 x 1456"
helper counter camera-rgb 'unfit frames' 5 | grep -qx 'frames: 0' || fail "it was published"
stop TERM rgb

echo "== features that it has not, refuses, or takes otherwise are named"
write_rig "feature { name: \"NoSuchFeature\" value: \"1\" }
           feature { name: \"PixelFormat\" value: \"Mono99\" }
           feature { name: \"AcquisitionFrameRate\" value: \"730000\" }" ""
start_driver rgb
helper ready camera-rgb >/dev/null || true
grep -q "has no feature NoSuchFeature" "$scratch/rgb.log" || fail "an unknown feature was not named"
grep -q "PixelFormat = Mono99 was refused" "$scratch/rgb.log" || fail "a value that is none was not named"
grep -q "AcquisitionFrameRate is 1e+06 after it was set to 730000" \
  "$scratch/rgb.log" || fail "a value taken otherwise was not named"
stop TERM rgb

echo "== software trigger: one image a capture; JPEG on the bus, raw on this host"
write_rig "trigger: SOFTWARE wire: JPEG" "wire: PNG"
start_driver rgb --captures "$scratch/captures"
for view in 0001 0002; do
  until grep -q . "$scratch/captures/$view/rgb.png" 2>/dev/null; do
    helper capture "$view"
    sleep 0.2
    [ $((waited = ${waited-0} + 1)) -lt 100 ] || fail "no raw image of the capture"
  done
  helper raw "$scratch/captures/$view/rgb.png" "$color_frames" || fail "the capture is not raw"
done
helper capture 0001  # as the next session calls its first view
until [ -s "$scratch/captures/0001/rgb.1.png" ] && [ -s "$scratch/captures/0001/rgb.png" ]; do
  sleep 0.2
  [ $((waited = waited + 1)) -lt 200 ] || fail "the earlier session's raw image was not kept"
done
stop TERM rgb
start_driver thermal
helper images THERMAL_IMAGE "$thermal_frames" 10 || fail "PNG changed the counts"
stop TERM thermal

echo "== controlled by another program"
write_rig "" ""
start_driver rgb
helper counter camera-rgb frames 2 >/dev/null
start second "$bin/rgbdt-camera" --rig "$rig" --camera rgb
for _ in $(seq 100); do
  grep -q "controlled by another program" "$scratch/second.log" && break
  sleep 0.1
done
grep -q "controlled by another program" "$scratch/second.log" || fail "that was not told"
stop TERM rgb second
echo "passed"
