#!/usr/bin/env bash
# Foxglove's own client before rgbdt-viewer: what it gets of a live rig, decoded by the schemas that
# are advertised, is what rgbdt export --mcap makes of the same bus' log. Transforms and lenses come
# at once, also to who connects when the bus is quiet. Run by scripts/in-namespace.
# Usage: foxglove_test.sh BIN_DIR BUILD_DIR; exit code 77: skipped
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$(dirname "${BASH_SOURCE[0]}")
modules=$2/viewer/page/node_modules

if ! command -v node >/dev/null || [ ! -d "$modules/@foxglove/ws-protocol" ]; then
  echo "skipped: no node, or no @foxglove/ws-protocol"
  exit 77
fi

collect() {  # NAME SECONDS: into NAME.json
  { sleep "$2"; } | timeout 120 node "$here/foxglove.mjs" collect "$url" "$modules" "$scratch/$1.json" \
    >"$scratch/$1.log" 2>&1 || fail "$1: $(cat "$scratch/$1.log")"
}
compare() {  # NAME: what came, with how many messages, a line a topic
  node "$here/foxglove.mjs" compare "$scratch/$1.json" "$scratch/bus.mcap" "$modules" \
    >"$scratch/$1.txt" 2>&1 || fail "$1: $(cat "$scratch/$1.txt")"
}
came() {  # NAME LEAST TOPIC...
  local name=$1 least=$2 topic count
  shift 2
  for topic in "$@"; do
    count=$(sed -n "s|^$topic  ||p" "$scratch/$name.txt")
    [ "${count:-0}" -ge "$least" ] || fail "$name: ${count:-0} of $topic, expected $least: $(cat "$scratch/$name.txt")"
  done
}

start logger lcm-logger --lcm-url="$LCM_DEFAULT_URL" --quiet "$scratch/bus.lcmlog"
start fuser "$bin/rgbdt-fuser"
start viewer "$bin/rgbdt-viewer" --listen 127.0.0.1:0
helper ready viewer || fail "rgbdt-viewer did not come up"
helper ready fuser || fail "rgbdt-fuser did not come up"
url=$(sed -n 's/^for Foxglove: //p' "$scratch/viewer.log")
[[ $url == ws://127.0.0.1:* ]] || fail "the viewer did not say where Foxglove connects: $url"

start stream "$bin/browser_helper" stream 2 20000 5 2 12
collect live 10
wait_for stream || fail "the stream failed"
collect quiet 2
stop TERM fuser viewer
stop INT logger

"$bin/rgbdt" export --mcap "$scratch/bus.lcmlog" --out "$scratch/bus.mcap" >"$scratch/export.log" 2>&1 ||
  fail "the log is not exported"
for name in live quiet; do compare "$name"; done
came live 5 /lidar/points /fused/points /rgb/image_raw /thermal/image_raw
came live 2 /rgb/camera_info /thermal/camera_info /tf_static /status
came quiet 1 /rgb/camera_info /thermal/camera_info
came quiet 2 /tf_static
full=$(sed -n 's/^points with .*: //p' "$scratch/live.txt")
[ "$full" -ge 1000 ] || fail "only $full points have colour, temperature and sigma"
cat "$scratch/live.txt"
echo "passed"
