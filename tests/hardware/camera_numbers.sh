#!/usr/bin/env bash
# What rgbdt-camera costs and how soon it is back: both cameras at full size and rate through cables
# of MTU 9000. Prints "name value" lines. Run by scripts/in-namespace.
# Usage: camera_numbers.sh BIN_DIR [SECONDS]
set -euo pipefail
# shellcheck source=tests/hardware/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seconds=${2-60}
rig=$scratch/rig.textproto
cat >"$rig" <<'END_OF_RIG'
name: "two cameras"
lidar { name: "lidar" }
camera {
  name: "rgb" kind: COLOR width: 1936 height: 1456 pixel_format: BAYER_RG8
  device { address: "10.77.1.2" feature { name: "AcquisitionFrameRate" value: "20" } }
}
camera {
  name: "thermal" kind: THERMAL width: 640 height: 480 pixel_format: MONO16
  linear { gain_k_per_count: 0.01 offset_k: 233.15 }
  device { address: "10.77.2.2" feature { name: "AcquisitionFrameRate" value: "30" } }
}
target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }
END_OF_RIG

cpu_seconds() {  # PID: user and system time so far
  awk -v hz="$(getconf CLK_TCK)" '{ print ($14 + $15) / hz }' "/proc/$1/stat"
}

plug_in rgb 1 9000
plug_in thermal 2 9000
helper frames "$scratch/color.raw" 2 1936 1456 1
helper frames "$scratch/thermal.raw" 2 640 480 2
start_camera rgb 1 "$scratch/color.raw"
start_camera thermal 2 "$scratch/thermal.raw"
for name in rgb thermal; do
  start "$name" "$bin/rgbdt-camera" --rig "$rig" --camera "$name"
done
for name in rgb thermal; do helper counter "camera-$name" frames 20 >/dev/null; done

rgb=$(cpu_seconds "${pids[rgb]}")
thermal=$(cpu_seconds "${pids[thermal]}")
start heard_rgb "$bin/hardware_helper" images RGB_IMAGE "$scratch/color.raw" $((20 * seconds)) $((seconds + 40))
helper images THERMAL_IMAGE "$scratch/thermal.raw" $((30 * seconds)) $((seconds + 40)) \
  >"$scratch/heard_thermal.log" || fail "thermal images are missing"
wait_for heard_rgb || fail "colour images are missing"
for name in rgb thermal; do
  echo "camera_cpu_percent_$name $(awk -v a="${!name}" -v b="$(cpu_seconds "${pids[$name]}")" \
    -v s="$seconds" 'BEGIN { print 100 * (b - a) / s }')"
  helper counter "camera-$name" frames 1 >"$scratch/counters"
  echo "camera_frames_incomplete_$name $(sed -n 's/^incomplete frames: //p' "$scratch/counters")"
  echo "camera_messages_missing_$name $(sed -n 's/^missing \([0-9]*\),.*/\1/p' "$scratch/heard_$name.log")"
done

# From the cable's return to the first frame on the bus.
for away in 0.5 2 2.9 3.1 3.5 4 4.3 6; do
  ip link set cable-rgb down
  sleep "$away"  # how long somebody holds the plug: not a wait for anything
  ip link set cable-rgb up
  back=$(date +%s%N)
  helper images RGB_IMAGE "$scratch/color.raw" 1 >/dev/null || fail "it did not come back"
  echo "camera_reconnect_s_after_$away $(awk -v a="$back" -v b="$(date +%s%N)" 'BEGIN { print (b - a) / 1e9 }')"
done
