#!/usr/bin/env bash
# The drawing of the board: black where it is to be black, closed lines, as many corners as rgbdt
# will look for. Usage: target_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
draw=$(dirname "${BASH_SOURCE[0]}")/../../scripts/target
check=$(dirname "${BASH_SOURCE[0]}")/check_drawing.py
mkdir "$scratch/kept"

# The paper's board: 4 x 3 feet, of which 44 of 88 squares of 100 mm are white.
accepts "the default board" "$draw" --out "$scratch/paper"
accepts "its drawing" python3 "$check" "$scratch/paper" --board 1219.2 914.4 --squares 11 8 \
  --corners 70 --black-mm2 674836.48 --first-corner 159.6 157.2
cmp -s "$scratch/paper/target.svg" "$(dirname "$draw")/../calib/detect/target.svg" ||
  complain "calib/detect/target.svg is not what scripts/target draws"
grep -q 'width_m: 1.2192 height_m: 0.9144' "$scratch/paper/target.textproto" ||
  complain "the board's size is not in the rig's words"
grep -q 'pattern_offset_m' "$scratch/paper/target.textproto" && complain "an offset of nothing"

# 8 x 6 on white, 5 mm to the right and 2 mm up.
accepts "another board" "$draw" --squares 8x6 --square-mm 95 --board-mm 850x610 --offset-mm 5,-2 \
  --border white --out "$scratch/other"
accepts "its drawing" python3 "$check" "$scratch/other" --board 850 610 --squares 8 6 --corners 35 \
  --black-mm2 216600 --first-corner 145 113
grep -q 'pattern_offset_m: \[0.005, -0.002\]' "$scratch/other/target.textproto" ||
  complain "the offset is not in the rig's words"

# rgbdt takes the block as it is.
{
  printf 'lidar { name: "lidar" }\ncamera { name: "rgb" kind: COLOR width: 640 height: 480\n'
  printf '  pixel_format: MONO8 }\n'
  cat "$scratch/other/target.textproto"
} >"$scratch/rig.textproto"
mkdir -p "$scratch/session/views/0001"
mv "$scratch/rig.textproto" "$scratch/session"
says=("view.textproto is missing") # so the rig was taken
refuses "a session without images" "$bin/rgbdt" intrinsics "$scratch/session"

says=("1000" "1100")
refuses "a board too small for its pattern" "$draw" --board-mm 1000x914.4 --out "$scratch/kept"
says=("--squares" "11by8" "11x8")
refuses "squares that are none" "$draw" --squares 11by8 --out "$scratch/kept"
says=("--squares" "3 to 100")
refuses "too few squares" "$draw" --squares 2x8 --out "$scratch/kept"
says=("--border" "grey")
refuses "a grey border" "$draw" --border grey --out "$scratch/kept"
says=("--colour")
refuses "an unknown option" "$draw" --colour
says=("--out")
refuses "an option without its value" "$draw" --out

verdict
