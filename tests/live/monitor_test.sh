#!/usr/bin/env bash
# rgbdt-monitor on a bus: what it is given it sends, and while a drive is played it says that the
# cameras hold, and of a camera that does not sit where its calibration says, that it moved. Run by
# scripts/in-namespace. Usage: monitor_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$bin/rgbdt" simulate "$scratch/room" --natural --scene indoor --lidar 32 --views 4 --seed 12 \
  >"$scratch/simulate.log" 2>&1
"$bin/drive_test_log" "$scratch/room" 1 "$scratch/drive.lcmlog" \
  "$scratch/room/calibration.textproto"

watch() {  # NAME: monitor and fuser with NAME's calibration, until each camera was told four times
  start monitor "$bin/rgbdt-monitor" "$scratch/$1"
  start fuser "$bin/rgbdt-fuser" --follow-monitor
  start logger lcm-logger "$scratch/$1.lcmlog"
  helper ready monitor fuser || fail "not every process came up"
  "$bin/live_helper" hears MOUNT_CHECK 8 >"$scratch/hears.log" 2>&1 &
  local hears=$!
  lcm-logplayer "$scratch/drive.lcmlog" >"$scratch/player.log" 2>&1
  wait "$hears" || fail "no MOUNT_CHECK of each camera and sweep"
  # The fuser's newest status, a second later at most.
  helper ready fuser >/dev/null
  stop TERM monitor fuser
  stop INT logger
}
said() { strings "$scratch/$1.lcmlog" | grep -c "$2" || true; }

watch room
[ "$(said room 'holds, as far as')" -gt 1 ] || fail "it does not say that the cameras hold"
[ "$(said room 'moved by')" = 0 ] || fail "it says that a camera moved"
[ "$(said room 'fusing')" -gt 0 ] || fail "the fuser did not get the calibration that was given"

# The colour camera's calibration is that of another mount: its x is a degree off.
cp -r "$scratch/room" "$scratch/knocked"
python3 - "$scratch/knocked/calibration.textproto" <<'END'
import math, re, sys
text = open(sys.argv[1]).read()
found = re.search(r'quaternion_wxyz: \[([^\]]*)\]', text)
w, x, y, z = (float(n) for n in found[1].split(','))
s, c = math.sin(math.radians(0.5)), math.cos(math.radians(0.5))  # about the camera's y
turned = (c * w - s * y, c * x + s * z, c * y + s * w, c * z - s * x)
open(sys.argv[1], 'w').write(text[:found.start(1)] + ', '.join(repr(n) for n in turned) + text[found.end(1):])
END
watch knocked
[ "$(said knocked 'rgb moved by 1.0')" -gt 0 ] || fail "it does not say that rgb moved"
[ "$(said knocked 'thermal moved')" = 0 ] || fail "it says that thermal moved"

code=0
"$bin/rgbdt-monitor" "$scratch/none" >"$scratch/monitor.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a session that is not there: exit code $code"
grep -q 'rgbdt-monitor: .*none' "$scratch/monitor.log" || fail "it did not say what is missing"
echo "passed"
