#!/usr/bin/env bash
# What people give wrong beside a session is named, first on the terminal, and ends as it should.
# Usage: mistakes_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$(dirname "${BASH_SOURCE[0]}")

accepts "a session" "$bin/rgbdt" simulate "$scratch/right" --views 8 --lidar 32

# names MISTAKE EXIT_CODE WORDS...: all in the lines that `rgbdt calibrate` prints of this mistake.
names() {
  local what=$1 expected=$2
  shift 2
  /usr/bin/python3 -B "$here/spoil.py" "$scratch/right" "$scratch/$what" "$what"
  says_of "$what" "$expected" "$@"
}

# says_of SESSION EXIT_CODE WORDS...
says_of() {
  local what=$1 expected=$2 word
  shift 2
  ends_with "$expected" "$what" "$bin/rgbdt" calibrate "$scratch/$what"
  for word in "$@"; do
    grep -qF -- "$word" "$scratch/output" || complain "$what: no word of '$word'"
  done
}

names none 0 "rgb: Usable"
names "cloud in millimetres" 1 "rgb: Do not use it" "its unit seems to be the millimetre"
names "cloud in camera axes" 1 "rgb: Do not use it" "its axes seem to be a camera's"
names "cloud mirrored" 1 "rgb: Do not use it" "images or clouds are mirrored"
names "images mirrored" 1 "rgb: Do not use it" "images or clouds are mirrored"
names "clouds of the next view" 1 "rgb: Do not use it. Images and clouds are 1 apart"
names "guess inverted" 0 "it seems to be lidar_from_camera. Write its inverse"
names "board in millimetres" 1 "target.width_m is 1219.2; expected metres"
names "board's sides exchanged" 1 "expected at least the pattern's width"
names "inner corners" 1 "rgb: Do not use it" "count squares, not inner corners"
names "fx and cx exchanged" 0 "rgb: Usable. Likeliest cause: fx and cx of rgb are exchanged"
names "focal length 10% too long" 0 \
  "rgb: Usable. Likeliest cause: the focal length of rgb in the rig file is" "% too long"
names "squares 5% too large" 1 "rgb: Do not use it" "square_m, width_m and height_m" \
  "thermal: Do not use it. Likeliest cause: the squares are" "smaller than given"

# Its sweeps turn one way and the other in turn.
accepts "a late encoder" "$bin/rgbdt" simulate "$scratch/late" --views 8 --encoder-delay 0.2
mkdir -p "$scratch/one way/views"
cp "$scratch/late/rig.textproto" "$scratch/one way"
cp -r "$scratch"/late/views/000[1357] "$scratch/one way/views"
says_of late 4 "rgb: Do not use it. Likeliest cause: the motor's encoder is stamped " " ms late" \
  "Add 0.2" " to encoder_delay_s of the rig file" "thermal: Do not use it. Likeliest cause: the motor's"
says_of "one way" 0 "rgb: Usable" "All sweeps turned the same way"

verdict
