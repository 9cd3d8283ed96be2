#!/usr/bin/env bash
# rgbdt export --las: fused clouds and maps, read by a reader of its own; LAZ and COPC, decoded by
# laz-perf and copc and held against the LAS. Usage: export_las_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$(dirname "${BASH_SOURCE[0]}")
modules=$(cd "$2" && pwd)/viewer/page/node_modules
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

# The same cloud as LAS, LAZ and COPC, decoded by others.
decoder=
if command -v node >/dev/null && [ -d "$modules/laz-perf" ] && [ -d "$modules/copc" ]; then decoder=1; fi
compresses() {  # CLOUD WHAT...
  local cloud=$1 to=$scratch/packed ending
  for ending in las laz copc.laz; do
    accepts "$cloud as $ending" "$bin/rgbdt" export --las "$cloud" --out "$to.$ending"
    grep -q "; wrote $to.$ending\$" "$scratch/output" || complain "$cloud as $ending: not said"
  done
  [ -n "$decoder" ] || return 0
  accepts "$cloud decoded" node "$here/read_laz.mjs" "$to".{las,laz,copc.laz} "$modules"
  says_all "$cloud decoded" "${@:2}"
}
for kind in wild same; do
  for count in 1 2 50000 50001 120000; do
    python3 "$here/make_cloud.py" "$scratch/$kind.ply" "$count" "$kind"
    compresses "$scratch/$kind.ply" "$count points"
  done
done
compresses "$scratch/map.ply" "points"
compresses "$scratch/session/fused.ply" "points" " levels"
[ "$(stat -c %s "$scratch/packed.laz")" -lt "$(($(stat -c %s "$scratch/packed.las") / 2))" ] ||
  complain "LAZ: not half of the LAS"
cmp "$scratch/packed.las" "$scratch/session/fused.las" || complain "another LAS"
for ending in las laz copc.laz; do
  capital=$scratch/packed.${ending^^}
  accepts "$ending in capitals" "$bin/rgbdt" export --las "$scratch/session/fused.ply" --out "$capital"
  cmp "$capital" "$scratch/packed.$ending" || complain "$ending in capitals: other bytes"
done
if [ -n "$decoder" ]; then
  # One bit of a point, and of the table behind them: a decoder that saw nothing would prove nothing.
  for file in laz copc.laz; do
    size=$(stat -c %s "$scratch/packed.$file")
    for at in $((size / 2)) $((size / 3)); do
      cp "$scratch/packed.laz" "$scratch/bad.laz"
      cp "$scratch/packed.copc.laz" "$scratch/bad.copc.laz"
      python3 - "$scratch/bad.$file" "$at" <<'END'
import sys
with open(sys.argv[1], "r+b") as f:
    f.seek(int(sys.argv[2]))
    byte = f.read(1)[0] ^ 1
    f.seek(int(sys.argv[2]))
    f.write(bytes([byte]))
END
      ends_with 3 "a wrong bit in $file" node "$here/read_laz.mjs" "$scratch"/{packed.las,bad.laz,bad.copc.laz} "$modules"
    done
  done
else
  echo "without laz-perf and copc: LAZ and COPC are not decoded"
fi

says=("FILE.laz" "FILE.copc.laz" "map.txt")
misuses "another ending" "$bin/rgbdt" export --las "$scratch/map.ply" --out "$scratch/kept/map.txt"
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
says=("300000" "214748")
refuses "a point too far, as LAZ" "$bin/rgbdt" export --las "$scratch/far.ply" --out "$scratch/kept/map.laz"
mkdir "$scratch/kept/full"
refuses "a full disk" bash -c "ulimit -f 100 && trap '' XFSZ && '$bin/rgbdt' export --las '$scratch/same.ply' --out '$scratch/kept/full/x.las'"
for ending in laz copc.laz; do
  refuses "a full disk, $ending" bash -c "ulimit -f 100 && trap '' XFSZ && '$bin/rgbdt' export --las '$scratch/wild.ply' --out '$scratch/kept/full/x.$ending'"
done

verdict
