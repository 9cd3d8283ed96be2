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

said() { strings "$scratch/$1.lcmlog" 2>/dev/null | grep -c "$2" || true; }

wait_for_log() {  # NAME COUNT WORDS: until NAME's log has so many lines with them
  local _
  for _ in $(seq 600); do
    [ "$(said "$1" "$3")" -lt "$2" ] || return 0
    sleep 0.1
  done
  fail "in $1.lcmlog $3 stands $(said "$1" "$3") times, not $2"
}

watch() {  # NAME WORDS: monitor and fuser with NAME's calibration, until each camera was told four
           # times and a status has the words
  start logger lcm-logger "$scratch/$1.lcmlog"
  start monitor "$bin/rgbdt-monitor" "$scratch/$1"
  start fuser "$bin/rgbdt-fuser" --follow-monitor
  helper ready monitor fuser || fail "not every process came up"
  wait_for_log "$1" 1 'fusing'  # the logger hears, and the fuser has the calibration
  lcm-logplayer "$scratch/drive.lcmlog" >"$scratch/player.log" 2>&1
  wait_for_log "$1" 8 MOUNT_CHECK
  wait_for_log "$1" 1 "$2"
  stop TERM monitor fuser
  stop INT logger
}

watch room 'rgb holds'
[ "$(said room 'holds, as far as')" -gt 1 ] || fail "it does not say that the cameras hold"
[ "$(said room 'moved by')" = 0 ] || fail "it says that a camera moved"

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
watch knocked 'rgb moved by'
[ "$(said knocked 'thermal moved')" = 0 ] || fail "it says that thermal moved"

code=0
"$bin/rgbdt-monitor" "$scratch/none" >"$scratch/monitor.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a session that is not there: exit code $code"
grep -q 'rgbdt-monitor: .*none' "$scratch/monitor.log" || fail "it did not say what is missing"
echo "passed"
