#!/usr/bin/env bash
# However a calibration ends, no older result stands in its folder as if it were its own: it is kept
# beside, under a name that says so. Usage: set_aside_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

s=$scratch/s
out=$scratch/out
mkdir "$scratch/kept"
accepts "a session" "$bin/rgbdt" simulate "$s" --views 5
accepts "calibrating it" "$bin/rgbdt" calibrate "$s" --out "$scratch/first"
! grep -q previous "$scratch/output" || complain "something was set aside where nothing was"

again() {  # results of an earlier run, in $out
  rm -rf "$out"
  cp -r "$scratch/first" "$out"
}
set_aside() {  # WHAT: the first run's results are kept, and named
  for name in calibration.textproto report.json report.html; do
    cmp -s "$scratch/first/$name" "$out/${name%.*}.previous.${name##*.}" ||
      complain "$1: $name was not kept"
  done
}
said() {  # WHAT: in one line
  [ "$(grep -c 'calibration.previous.textproto, report.previous.json, report.previous.html' \
    "$scratch/output")" -eq 1 ] || complain "$1: nothing said of the earlier results"
}
is_gone() {  # WHAT NAME...
  local name
  for name in "${@:2}"; do [ ! -e "$out/$name" ] || complain "$1: an older $name is there"; done
}

again
accepts "a second run" "$bin/rgbdt" calibrate "$s" --out "$out"
set_aside "a second run"
said "a second run"
cmp -s "$scratch/first/calibration.textproto" "$out/calibration.textproto" ||
  complain "a second run: not its own calibration"

# Nothing of it can be read.
cp -r "$s" "$scratch/bad"
rm "$scratch"/bad/views/*/thermal.png
again
says=("could be read")
refuses "no images" "$bin/rgbdt" calibrate "$scratch/bad" --out "$out"
set_aside "no images"
said "no images"
is_gone "no images" calibration.textproto report.json report.html
# A failed run after it takes nothing away.
refuses "no images, again" "$bin/rgbdt" calibrate "$scratch/bad" --out "$out"
set_aside "no images, again"

# It runs to its end, without a camera solved.
cp -r "$s" "$scratch/few"
rm -r "$scratch"/few/views/000[2-5]
again
says=("no camera was solved")
refuses "one view" "$bin/rgbdt" calibrate "$scratch/few" --out "$out"
set_aside "one view"
is_gone "one view" calibration.textproto
[ -s "$out/report.json" ] || complain "one view: no report of its own"
cmp -s "$scratch/first/report.json" "$out/report.json" && complain "one view: the older report"

# Killed half way: as soon as it has begun.
again
"$bin/rgbdt" calibrate "$s" --out "$out" >"$scratch/output" 2>&1 &
run=$!
tail -F --pid=$run "$scratch/output" 2>/dev/null | grep -q -m 1 previous || true
kill -KILL $run 2>/dev/null || complain "killed: it was over before"
wait $run 2>/dev/null || true
set_aside "killed"
is_gone "killed" calibration.textproto report.json report.html

# What is refused before anything is done leaves all as it was.
again
sed -i '1i colour_of_the_car: "red"' "$scratch/bad/rig.textproto"
says=("colour_of_the_car")
refuses "a broken rig file" "$bin/rgbdt" calibrate "$scratch/bad" --out "$out"
diff -r "$scratch/first" "$out" >"$scratch/output" || complain "a broken rig file: results moved"

verdict
