#!/usr/bin/env bash
# A calibration that is not to be used, or that was made with another rig, is refused with the reason
# and what to do; with --anyway it is used, and the reason is said. Usage: refused_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

s=$scratch/s
mkdir "$scratch/kept"
accepts "a session" "$bin/rgbdt" simulate "$s" --views 5
accepts "calibrating it" "$bin/rgbdt" calibrate "$s"
cp "$s/rig.textproto" "$scratch/rig.textproto"
cp "$s/calibration.textproto" "$scratch/good.textproto"
grep -q '^sensors {' "$scratch/good.textproto" || complain "the calibration does not say what it holds for"

uses() {  # WHAT VERB FLAG...: the verb takes the session's calibration, and warns of nothing
  accepts "$1" "$bin/rgbdt" "$2" "$s" --out "$scratch/out" "${@:3}"
  ! grep -q 'used anyway' "$scratch/output" || complain "$1: it warns"
}
# refuses_it WHAT VERB WORD...: exit code 1, nothing written, one line with the words and --anyway.
refuses_it() {
  local what=$1 verb=$2
  shift 2
  says=("$@" "or give --anyway")
  refuses "$what ($verb)" "$bin/rgbdt" "$verb" "$s" --out "$scratch/kept/$verb"
  [ "$refused_with" -eq 1 ] || complain "$what ($verb): exit code $refused_with"
  [ "$(wc -l <"$scratch/output")" -eq 1 ] || complain "$what ($verb): not one line"
}
# Then with --anyway it is done, and the line is said all the same.
yields() {
  local what=$1 verb=$2
  refuses_it "$@"
  shift 2
  accepts "$what ($verb --anyway)" "$bin/rgbdt" "$verb" "$s" --out "$scratch/out" --anyway
  for word in "$@"; do
    grep -F -- "$word" "$scratch/output" | grep -q '^rgbdt: used anyway: ' ||
      complain "$what ($verb --anyway): no word of '$word'"
  done
}

# Another file, the same sensors.
{
  echo "# Looked through on Monday."
  sed 's/square_m: .*/square_m: 0.1001/; s/^name: .*/name: "renamed"/' "$scratch/rig.textproto"
} >"$s/rig.textproto"
for verb in fuse export; do uses "comment, name and board ($verb)" "$verb"; done

fx=$(sed -n 's/^ *fx: //p' "$scratch/rig.textproto" | head -n 1)
sed "0,/fx: [0-9.]*/s//fx: 1300/" "$scratch/rig.textproto" >"$s/rig.textproto"
another=("$s/calibration.textproto was made with another rig than $s/rig.textproto"
  "camera rgb: pinhole.fx: $fx -> 1300")
refuses_it "another lens" evaluate "${another[@]}"
refuses_it "another lens" fuse "${another[@]}"
yields "another lens" export "${another[@]}"
sed 's/zero_ticks: .*/zero_ticks: 12345/' "$scratch/rig.textproto" >"$s/rig.textproto"
refuses_it "another scanner" export "lidar.turned_scanner.zero_ticks: " " -> 12345"

# Of a calibration of an earlier version only the rig's hash is known.
awk '/^sensors \{/ { skip = 1 } !skip { print } /^\}/ { skip = 0 }' "$scratch/good.textproto" \
  >"$s/calibration.textproto"
! grep -q sensors "$s/calibration.textproto" || complain "sensors were not taken out"
refuses_it "an earlier version's" fuse "what differs is not known"
cp "$scratch/rig.textproto" "$s/rig.textproto"
uses "an earlier version's, of this rig" fuse

sed '0,/status: CONVERGED/s//status: CONTRADICTED detail: "Likeliest cause: the focal length is 3% too long."/' \
  "$scratch/good.textproto" >"$s/calibration.textproto"
refuses_it "do not use" export "camera rgb is not to be used" "the focal length is 3% too long. Fix"
yields "do not use" fuse "camera rgb is not to be used" "the focal length is 3% too long. Fix"
ends_with 4 "judging what is not to be used" "$bin/rgbdt" evaluate "$s" --out "$scratch/out"
sed '0,/status: CONVERGED/s//status: DEGENERATE/' "$scratch/good.textproto" >"$s/calibration.textproto"
refuses_it "degenerate" fuse "camera rgb is not to be used: degenerate"

sed '0,/status: CONVERGED/s//status: CONVERGED detail: "doubtful: a mount moved."/' \
  "$scratch/good.textproto" >"$s/calibration.textproto"
for verb in fuse export; do
  uses "doubtful ($verb)" "$verb"
  grep -q "^rgbdt: $s/calibration.textproto: camera rgb: doubtful: a mount moved." "$scratch/output" ||
    complain "doubtful ($verb): nothing said"
done

for program in "rgbdt fuse" "rgbdt export" "rgbdt evaluate" "rgbdt replay" rgbdt-fuser rgbdt-viewer; do
  read -ra words <<<"$program"
  accepts "help of $program" "$bin/${words[0]}" "${words[@]:1}" --help
  grep -q -- '--anyway' "$scratch/output" || complain "$program --help lacks --anyway"
done

verdict
