#!/usr/bin/env bash
# How many messages of what `rgbdt export --mcap` writes @mcap/core decodes, which shares no code with
# it: a log of sweeps and images, and those that map_test_log makes (fused cloud, poses, sweeps with a
# rig). Usage: mcap.sh BIN_DIR BUILD_DIR OUT.csv VIEWS
# Without node or @mcap/core there is no OUT.csv, and a line that says so.
set -euo pipefail
bin=$1
modules=$2/viewer/page/node_modules
out=$3
views=$4
here=$(dirname "${BASH_SOURCE[0]}")
if ! command -v node >/dev/null || [ ! -d "$modules/@mcap/core" ]; then
  echo "no node or no @mcap/core: the MCAP is not read"
  exit 0
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$bin/rgbdt" simulate "$scratch/room" --views "$views" >&2
"$bin/drive_test_log" "$scratch/room" 1 "$scratch/drive.lcmlog" "$scratch/true.textproto" >&2
"$bin/map_test_log" "$scratch/fused.lcmlog" "$scratch/pose.lcmlog" "$scratch/street.lcmlog" \
  "$scratch/rigged.lcmlog" "$scratch/way.txt" >&2
{
  echo log,messages,decoded
  for log in drive fused pose rigged; do
    "$bin/rgbdt" export --mcap "$scratch/$log.lcmlog" >&2
    # It ends by 1 where a message is not decoded, which is a result.
    node "$here/../cli/read_mcap.mjs" "$scratch/$log.mcap" "$modules" >"$scratch/read" ||
      grep -q '^decoded ' "$scratch/read"
    sed -n "s/^decoded \([0-9]*\) of \([0-9]*\)$/$log,\2,\1/p" "$scratch/read"
  done
} >"$scratch/rows"
mv "$scratch/rows" "$out"
