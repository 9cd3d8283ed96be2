#!/usr/bin/env bash
# What is wrong alike in every view is said once, not for every view, camera and stage.
# Usage: one_line_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

good=$scratch/good
bad=$scratch/bad
accepts "a session" "$bin/rgbdt" simulate "$good" --views 3 --seed 3
cat >"$good/calibration.textproto" <<'DONE'
method: "auto"
camera { camera: "rgb" status: CONVERGED camera_from_lidar { quaternion_wxyz: [0.5, 0.5, -0.5, 0.5] translation_m: [0, 0, 0] } }
DONE
mkdir "$scratch/kept"

session() {  # a fresh copy of the good one, at $bad
  rm -rf "$bad"
  cp -r "$good" "$bad"
}

# "what" WORD VERB...: each verb fails, and WORD, which names what is wrong, is said in one line.
tells_once() {
  local what=$1 word=$2 verb
  shift 2
  for verb in "$@"; do
    says=("$word")
    refuses "$what ($verb)" "$bin/rgbdt" "$verb" "$bad" --out "$scratch/kept/$verb"
    [ "$(grep -cF -- "$word" "$scratch/output")" = 1 ] || complain "$what ($verb): not in one line"
  done
}
all=(calibrate evaluate fuse intrinsics)

rm -rf "$bad"
tells_once "no directory" "$bad" "${all[@]}" export
session
sed -i '1i colour_of_the_car: "red"' "$bad/rig.textproto"
tells_once "a broken rig" colour_of_the_car "${all[@]}" export
session
rm "$bad"/views/*/thermal.png
tells_once "no thermal image in any view" thermal.png "${all[@]}"
session
for view in "$bad"/views/*; do head -c 2000 "$good/views/0001/rgb.png" >"$view/rgb.png"; done
tells_once "no whole image in any view" rgb.png "${all[@]}"
session
for view in "$bad"/views/*; do head -c 2000 "$good/views/0001/cloud.pcd" >"$view/cloud.pcd"; done
tells_once "no whole cloud in any view" cloud.pcd calibrate evaluate fuse scanner
session
rm "$bad"/views/*/cloud.pcd
tells_once "no cloud in any view" cloud.pcd calibrate evaluate fuse scanner
session
sed -i '1i exposure: 5' "$bad"/views/*/view.textproto
tells_once "an unknown key in every view" '"exposure"' "${all[@]}" scanner

# In some views only, the others are used; which ones is said in that line.
session
rm "$bad"/views/000[12]/thermal.png
for verb in calibrate evaluate intrinsics; do
  says=("2 views not read (0001, 0002)")
  refuses "no thermal image in two views ($verb)" "$bin/rgbdt" "$verb" "$bad" --out "$scratch/out/$verb"
  [ "$(grep -c 'thermal\.png' "$scratch/output")" = 1 ] ||
    complain "no thermal image in two views ($verb): not in one line"
done

verdict
