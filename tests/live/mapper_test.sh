#!/usr/bin/env bash
# rgbdt-mapper saves while it runs and at its end, by SIGTERM and by SIGINT. Run by
# scripts/in-namespace. Usage: mapper_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$bin/map_test_log" "$scratch/fused.lcmlog" "$scratch/other.lcmlog"
voxels() { sed -n '/^element vertex/{s/.* //p;q}' "$scratch/$1.ply"; }

for signal in TERM INT; do
  start mapper "$bin/rgbdt-mapper" --voxel 0.1 --every 0.2 --out "$scratch/$signal.ply"
  helper ready mapper || fail "rgbdt-mapper did not come up"
  [ ! -e "$scratch/$signal.ply" ] || fail "a map without points was written"
  lcm-logplayer --speed=0 "$scratch/fused.lcmlog" >"$scratch/player.log" 2>&1
  for _ in $(seq 50); do
    [ ! -s "$scratch/$signal.ply" ] || break
    sleep 0.1
  done
  [ -s "$scratch/$signal.ply" ] || fail "the map was not saved while running"
  stop "$signal" mapper
  [ "$(voxels "$signal")" -gt 1000 ] || fail "the map has $(voxels "$signal") voxels"
done

code=0
timeout 20 "$bin/rgbdt-mapper" --out "$scratch/mapper.log/map.ply" >"$scratch/refused.log" 2>&1 &&
  fail "it maps to nowhere"
grep -q "cannot write $scratch/mapper.log/map.ply: Not a directory" "$scratch/refused.log" ||
  fail "it did not say what cannot be written"
"$bin/rgbdt-mapper" --voxel 0 >"$scratch/mapper.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "a voxel of nothing: exit code $code"
grep -q 'voxel_m is 0' "$scratch/mapper.log" || fail "it did not say what is wrong"
echo "passed"
