#!/usr/bin/env bash
# rgbdt export --las: fused clouds and maps, read by a reader of its own. Usage: export_las_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$(dirname "${BASH_SOURCE[0]}")
mkdir "$scratch/kept"

accepts "a session" "$bin/rgbdt" simulate "$scratch/session" --views 6
accepts "its calibration" "$bin/rgbdt" calibrate "$scratch/session"
accepts "its fused cloud" "$bin/rgbdt" fuse "$scratch/session"
accepts "a fused cloud" "$bin/rgbdt" export --las "$scratch/session/fused.ply"
grep -q 'in metres, no coordinate system; wrote .*fused.las$' "$scratch/output" || complain "not said"
reads() {
  local code=0
  python3 "$here/read_las.py" "$@" >"$scratch/output" 2>&1 || code=$?
  [ "$code" -eq 0 ] || complain "$1 is not what $2 holds"
}
reads "$scratch/session/fused.las" "$scratch/session/fused.ply"
accepts "the PCD" "$bin/rgbdt" export --las "$scratch/session/fused.pcd" --out "$scratch/pcd.las"
cmp "$scratch/pcd.las" "$scratch/session/fused.las" || complain "PLY and PCD: other bytes"

"$bin/map_test_log" "$scratch/"{fused,other,drive,rigged}.lcmlog "$scratch/truth"
accepts "a map" "$bin/rgbdt" map "$scratch/fused.lcmlog" --voxel 0.1 --out "$scratch/map.ply"
accepts "a map as LAS" "$bin/rgbdt" export --las "$scratch/map.ply" --out "$scratch/kept/map.las"
reads "$scratch/kept/map.las" "$scratch/map.ply"
grep -q 'temperature, count$' "$scratch/output" || complain "a map's dimensions"

says=("FILE.laz" "pdal")
misuses "LAZ" "$bin/rgbdt" export --las "$scratch/map.ply" --out "$scratch/kept/map.copc.laz"
says=("--mcap" "--las")
misuses "both" "$bin/rgbdt" export --las --mcap "$scratch/map.ply"
says=("map.las")
refuses "a LAS file" "$bin/rgbdt" export --las "$scratch/kept/map.las" --out "$scratch/again.las"
head -c 4000 "$scratch/map.ply" >"$scratch/cut.ply"
says=("cut.ply")
refuses "a cloud cut short" "$bin/rgbdt" export --las "$scratch/cut.ply" --out "$scratch/kept/map.las"
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n300000 0 1\n' \
  >"$scratch/far.ply"
says=("300000" "214748")
refuses "a point too far" "$bin/rgbdt" export --las "$scratch/far.ply" --out "$scratch/kept/map.las"

verdict
