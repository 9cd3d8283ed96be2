#!/usr/bin/env bash
# Two halves of a session are the same; a camera that was moved in between is not.
# Usage: compare_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

accepts "a session" "$bin/rgbdt" simulate "$scratch/s1" --views 12
mkdir -p "$scratch/s2/views"
cp "$scratch/s1/rig.textproto" "$scratch/s2"
mv "$scratch"/s1/views/00{07,08,09,10,11,12} "$scratch/s2/views"
for session in s1 s2; do
  accepts "calibrating half of it" "$bin/rgbdt" calibrate "$scratch/$session"
done
accepts "two sessions" "$bin/rgbdt" compare "$scratch/s1" "$scratch/s2"
[ "$(grep -c 'the same within what both can tell' "$scratch/output")" = 2 ] ||
  complain "two sessions: not the same"
grep -q 'colours at 2, 5, 10 m' "$scratch/output" || complain "two sessions: no pixels"

# The colour camera 20 mm aside.
awk '/translation_m:/ && !moved { split($0, n, /[\[,\]]/)
       printf "%s[%.17g,%s,%s]\n", n[1], n[2] + 0.02, n[3], n[4]; moved = 1; next } { print }' \
  "$scratch/s2/calibration.textproto" >"$scratch/moved.textproto"
code=0
"$bin/rgbdt" compare "$scratch/s1" "$scratch/s2" "$scratch/moved.textproto" \
  >"$scratch/output" 2>&1 || code=$?
[ "$code" = 1 ] || complain "a camera moved: exit code $code"
[ "$(grep -c 'the same within' "$scratch/output")" = 3 ] || complain "a camera moved: which did not?"
grep -q 'rgb: the mount moved by .* mm along the LIDAR' "$scratch/output" ||
  complain "a camera moved: nothing said"

mkdir "$scratch/kept"
says=("two")
refuses "one calibration" "$bin/rgbdt" compare "$scratch/s1"
says=("calibration.textproto is missing" "rgbdt calibrate")
mkdir "$scratch/empty"
refuses "a folder without one" "$bin/rgbdt" compare "$scratch/s1" "$scratch/empty"
sed 's/camera: "\([a-z]*\)"/camera: "other_\1"/' "$scratch/s2/calibration.textproto" >"$scratch/other.textproto"
says=("no camera in common")
refuses "another rig's" "$bin/rgbdt" compare "$scratch/s1" "$scratch/other.textproto"
# Other sensors: nothing moved.
sed '/^sensors {/,/^}/ s/width: [0-9]*/width: 320/' "$scratch/s2/calibration.textproto" >"$scratch/smaller.textproto"
sed -i 's/^rig_hash: .*/rig_hash: "0123456789abcdef"/' "$scratch/smaller.textproto"
says=("different rigs" "another camera \"rgb\"" "320x")
refuses "another camera of the same name" "$bin/rgbdt" compare "$scratch/s1" "$scratch/smaller.textproto"
sed '/^sensors {/,/^}/ s/fx: 1100/fx: 1111/' "$scratch/s2/calibration.textproto" >"$scratch/lens.textproto"
sed -i 's/^rig_hash: .*/rig_hash: "0123456789abcdef"/' "$scratch/lens.textproto"
"$bin/rgbdt" compare "$scratch/s1" "$scratch/lens.textproto" >"$scratch/output" 2>&1 || true
grep -q 'the rig files differ (camera rgb: pinhole.fx: 1100 -> 1111)' "$scratch/output" ||
  complain "another lens: it is not said which"
sed 's/camera: "thermal"/camera: "second"/' "$scratch/s2/calibration.textproto" >"$scratch/second.textproto"
"$bin/rgbdt" compare "$scratch/s1" "$scratch/second.textproto" >"$scratch/output" 2>&1 || true
grep -q 'not compared: thermal (only in ' "$scratch/output" || complain "a camera of one alone: not said"

verdict
