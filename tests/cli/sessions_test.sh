#!/usr/bin/env bash
# Several sessions of a rig are solved together, with one pose of each camera or one in each session.
# Usage: sessions_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# Another seed is another place of the cameras, on the same rig.
accepts "a session" "$bin/rgbdt" simulate "$scratch/monday" --views 12
accepts "another" "$bin/rgbdt" simulate "$scratch/friday" --views 6 --seed 5
mkdir -p "$scratch/tuesday/views"
cp "$scratch"/monday/{rig,truth}.textproto "$scratch/tuesday"
mv "$scratch"/monday/views/00{07,08,09,10,11,12} "$scratch/tuesday/views"

accepts "one mount" "$bin/rgbdt" calibrate "$scratch/monday" "$scratch/tuesday" --out "$scratch/one"
[ "$(grep -c 'the same within what both can tell' "$scratch/output")" = 2 ] ||
  complain "one mount: not the same"
grep -q 'tuesday/0012' "$scratch/one/report.json" || complain "one mount: no view of the second"
grep -q 'tuesday against monday' "$scratch/output" || complain "one mount: no comparison"

code=0
"$bin/rgbdt" calibrate "$scratch/monday" "$scratch/friday" --out "$scratch/both" \
  >"$scratch/output" 2>&1 || code=$?
[ "$code" = 4 ] || complain "a mount moved: exit code $code"
grep -q 'Do not use it. The sessions contradict each other: friday' "$scratch/output" ||
  complain "a mount moved: nothing said"

accepts "poses of each session" "$bin/rgbdt" calibrate "$scratch/monday" "$scratch/friday" \
  --mounts-moved --out "$scratch/each"
for session in monday friday; do
  for file in calibration.textproto report.json report.html; do
    [ -s "$scratch/each/$session/$file" ] || complain "poses of each session: no $session/$file"
  done
done
[ "$(grep -c 'the mount moved by' "$scratch/output")" = 2 ] ||
  complain "poses of each session: not how far they moved"
grep 'result against truth' "$scratch/output" | awk '{ if ($4 > 0.1 || $6 > 5 || $8 > 0.1 || $10 > 5) exit 1 }' ||
  complain "poses of each session: not the right ones"

mkdir "$scratch/kept"
says=("--out")
refuses "no place for the result" "$bin/rgbdt" calibrate "$scratch/monday" "$scratch/friday"
says=("--mounts-moved" "two")
refuses "a single session's mounts" "$bin/rgbdt" calibrate "$scratch/monday" --mounts-moved
says=("twice")
refuses "one session twice" "$bin/rgbdt" calibrate "$scratch/monday" "$scratch/friday/../monday" \
  --out "$scratch/kept/out"
says=("auto")
refuses "another method" "$bin/rgbdt" calibrate "$scratch/monday" "$scratch/friday" --mounts-moved \
  --method plane --out "$scratch/kept/out"
sed -i 's/square_m: .*/square_m: 0.11/' "$scratch/friday/rig.textproto"
says=("target.square_m" "rgbdt compare")
refuses "another board" "$bin/rgbdt" calibrate "$scratch/monday" "$scratch/friday" \
  --out "$scratch/kept/out"
verdict
