#!/usr/bin/env bash
# rgbdt session: folders of images and clouds become a session directory, which rgbdt calibrate takes
# as it is; what cannot become one is refused. Usage: folders_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# A simulated session, taken apart as a person has it: 8 views, called otherwise in each folder.
good=$scratch/good
accepts "a session" "$bin/rgbdt" simulate "$good" --views 8 --picked rgb
mkdir -p "$scratch/kept" "$scratch"/{left,flir_thermal,pcd}
for i in 1 2 3 4 5 6 7 8; do
  view=$good/views/000$i
  mv "$view/rgb.png" "$scratch/left/img_00$i.png"
  mv "$view/thermal.png" "$scratch/flir_thermal/$i.png"
  mv "$view/cloud.pcd" "$scratch/pcd/scan-$i.pcd"
done
# As a person writes the lens down, from the rig file of the simulator.
numbers() { sed -n "/name: \"$1\"/,/^}/s/^ *\(fx\|fy\|cx\|cy\|width\|height\|distortion\): //p" "$good/rig.textproto" | tr '\n' ' '; }
ros() {  # CAMERA: as camera_calibration writes it
  local width height fx fy cx cy distortion
  read -r width height fx fy cx cy distortion <<<"$(numbers "$1")"
  cat <<TEXT
image_width: $width
image_height: $height
camera_matrix: {rows: 3, cols: 3, data: [$fx, 0, $cx, 0, $fy, $cy, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients:
  data: $distortion
TEXT
}
kalibr() {  # CAMERA PART
  local width height fx fy cx cy distortion
  read -r width height fx fy cx cy distortion <<<"$(numbers "$1")"
  cat <<TEXT
$2:
  camera_model: pinhole
  intrinsics: [$fx, $fy, $cx, $cy]
  distortion_model: radtan
  distortion_coeffs: $distortion
  resolution: [$width, $height]
  rostopic: /$1/image_raw
TEXT
}
ros rgb >"$scratch/rgb.yaml"
ros thermal >"$scratch/thermal.yaml"
{ kalibr thermal cam0; kalibr rgb cam1; } >"$scratch/camchain.yaml"

board=11x8@0.1,1.2192x0.9144
session=("$bin/rgbdt" session --clouds "$scratch/pcd" --board "$board")
both=(--images "$scratch/left" --images "$scratch/flir_thermal")
lenses=(--lens "$scratch/rgb.yaml" --lens "$scratch/thermal.yaml")
calibrates() {  # WHAT DIR: and lands where the truth is
  accepts "$1: calibrating" "$bin/rgbdt" calibrate "$2" --truth "$good/truth.textproto"
  grep 'result against truth' "$scratch/output" | awk '{ if ($4 > 0.1 || $6 > 5) exit 1 }' ||
    complain "$1: not the right poses"
}

accepts "two cameras" "${session[@]}" "${both[@]}" "${lenses[@]}" --out "$scratch/two"
for word in "camera rgb: colour" "camera thermal: thermal" "paired by number" \
  "scan-7.pcd  rgb: img_007.png  thermal: 7.png" "next: rgbdt calibrate $scratch/two"; do
  grep -qF -- "$word" "$scratch/output" || complain "two cameras: no word of '$word'"
done
[ -z "$(find "$scratch/two" -name '*.p[nc][gd]')" ] || complain "two cameras: files were copied"
calibrates "two cameras" "$scratch/two"
cp -r "$scratch/two" "$scratch/kept"
says=("earlier session")
refuses "a session that is there" "${session[@]}" "${both[@]}" "${lenses[@]}" --out "$scratch/kept/two"

# Without a view: said in the report, and the page in it says that it is so.
accepts "without a view" "$bin/rgbdt" calibrate "$scratch/two" --without scan-4 --without scan-5 --out "$scratch/without"
grep -qF "Left out by hand: scan-4, scan-5" "$scratch/without/report.json" || complain "without a view: not in the report"
! grep -q '"scan-4"' "$scratch/without/report.json" || complain "without a view: it still has a part in it"
misuses "a view that is not there" "$bin/rgbdt" calibrate "$scratch/two" --without scan-44

# Inner corners given for squares in a rig file, once the session is there.
cp -r "$scratch/two" "$scratch/corners"
sed -i 's/squares_x: 11/squares_x: 10/; s/squares_y: 8/squares_y: 7/' "$scratch/corners/rig.textproto"
code=0
"$bin/rgbdt" calibrate "$scratch/corners" >"$scratch/output" 2>&1 || code=$?
[ "$code" -eq 1 ] || complain "inner corners for squares: exit code $code"
for word in "11 x 8 squares" "count squares, not inner corners"; do
  grep '^rgb: Do not use it' "$scratch/output" | grep -qF -- "$word" || complain "inner corners for squares: no word of '$word'"
done

# A camchain whose cameras stand in another order: their topics tell.
accepts "a camchain" "${session[@]}" "${both[@]}" --lens "$scratch/camchain.yaml" --out "$scratch/chain"
cmp -s "$scratch/two/rig.textproto" "$scratch/chain/rig.textproto" || complain "a camchain: another rig"

# Without a lens, and with a file that belongs to nothing.
cp "$scratch/left/img_001.png" "$scratch/left/img_040.png"
accepts "no lens" "${session[@]}" --images front="$scratch/left" --pinhole --out "$scratch/bare"
for word in "1 image of front" "img_040.png" "converged" "next: rgbdt calibrate"; do
  grep -qF -- "$word" "$scratch/output" || complain "no lens: no word of '$word'"
done
accepts "no lens: calibrating" "$bin/rgbdt" calibrate "$scratch/bare"

# Times: the cameras' own clouds are the nearest.
mkdir "$scratch/stamped" "$scratch/stamped_pcd"
for i in 1 2 3 4 5 6 7 8; do
  ln -s "$scratch/left/img_00$i.png" "$scratch/stamped/170000000$i.250000.png"
  ln -s "$scratch/pcd/scan-$i.pcd" "$scratch/stamped_pcd/170000000${i}_230000000.pcd"
done
stamped=("$bin/rgbdt" session --images "$scratch/stamped" --clouds "$scratch/stamped_pcd"
  --board "$board" --lens "$scratch/rgb.yaml")
accepts "times" "${stamped[@]}" --out "$scratch/times"
grep -qF "1700000003.250000.png (+20 ms)" "$scratch/output" || complain "times: not how far apart"
says=("0.02 s apart" "--max-apart")
refuses "times too far apart" "${stamped[@]}" --max-apart 0.01 --out "$scratch/kept/new"

# What makes no sense is one line, and leaves nothing.
refuses_all() {  # WHAT ARGUMENTS...: of rgbdt session, with a good folder of clouds
  local what=$1
  shift
  refuses "$what" "$bin/rgbdt" session --clouds "$scratch/pcd" --out "$scratch/kept/new" "$@"
  [ "$(grep -c . "$scratch/output")" = 1 ] || complain "$what: more than one line"
}
one=(--images "$scratch/left" --lens "$scratch/rgb.yaml")
says=("11 x 8" "inner corners" "count squares")
refuses_all "inner corners" "${one[@]}" --board 10x7@0.1,1.2192x0.9144
says=("millimetres" "0.1")
refuses_all "millimetres" "${one[@]}" --board 11x8@100,1219.2x914.4
says=("--pinhole" "--fisheye" "--lens")
refuses_all "neither lens nor model" --images "$scratch/left" --board "$board"
says=("--pinhole" "--fisheye")
refuses_all "both models" "${one[@]}" --board "$board" --pinhole --fisheye
says=("3 lens files" "1 camera")
refuses_all "too many lenses" "${one[@]}" --lens a --lens b --board "$board"
says=("thermal.yaml" "px" "rgb")
sed 's/^image_width: .*/image_width: 99/' "$scratch/rgb.yaml" >"$scratch/small.yaml"
says=("small.yaml" "99x" "rgb")
refuses_all "another camera's lens" --images "$scratch/left" --lens "$scratch/small.yaml" --board "$board"
sed 's/plumb_bob/fov/' "$scratch/rgb.yaml" >"$scratch/fov.yaml"
says=("fov.yaml:4: distortion_model" "fov" "equidistant")
refuses_all "a lens that no model is" --images "$scratch/left" --lens "$scratch/fov.yaml" --board "$board"
says=("nowhere.yaml")
refuses_all "a lens that is not there" --images "$scratch/left" --lens "$scratch/nowhere.yaml" --board "$board"
mkdir "$scratch/empty"
says=("empty" "no image")
refuses_all "no images" --images "$scratch/empty" --lens "$scratch/rgb.yaml" --board "$board"
says=("9 images" "8 clouds" "--in-order")
refuses_all "counts that differ" "${one[@]}" --board "$board" --in-order
mkdir "$scratch/words"
ln -s "$scratch/left/img_001.png" "$scratch/words/first.png"
says=("1 images" "8 clouds" "same name")
refuses_all "nothing to pair" --images "$scratch/words" --lens "$scratch/rgb.yaml" --board "$board"

verdict
