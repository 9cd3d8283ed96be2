#!/usr/bin/env bash
# rgbdt intrinsics on rendered views whose lens is known: it is found, also from images alone and
# without any lens in the rig file, and nothing is replaced unasked. Usage: intrinsics_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

good=$scratch/good
mkdir "$scratch/kept"
accepts "a session" "$bin/rgbdt" simulate "$good" --views 8 --seed 3
cp "$good/rig.textproto" "$scratch/kept"

# focal RIG: fx of the first camera, the colour one.
focal() { sed -n 's/^ *fx: //p' "$1" | head -n 1; }
# as_true WHAT RIG: within half a percent of the lens that the views were rendered with.
as_true() {
  awk -v truth="$(focal "$good/rig.textproto")" -v found="$(focal "$2")" \
    'BEGIN { ratio = found / truth - 1; exit !(ratio * ratio < 0.005 * 0.005) }' ||
    complain "$1: fx is $(focal "$2"), the truth is $(focal "$good/rig.textproto")"
}

accepts "finding the colour camera's lens" "$bin/rgbdt" intrinsics "$good" --camera rgb
for word in "converged" "fx " "+-" "RMS" "covered" "next: mv"; do
  grep -qF -- "$word" "$scratch/output" || complain "no word of '$word'"
done
as_true "with a lens before" "$good/rig.intrinsics.textproto"
grep -q '^  no other lens model fits these images better: ' "$scratch/output" ||
  complain "the right lens model is not left alone"
[ -s "$good/intrinsics.html" ] || complain "no page was written"
cmp -s "$good/rig.textproto" "$scratch/kept/rig.textproto" || complain "the rig file was replaced"
sed -n '/name: "thermal"/,/^}/p' "$good/rig.textproto" >"$scratch/before"
sed -n '/name: "thermal"/,/^}/p' "$good/rig.intrinsics.textproto" >"$scratch/after"
cmp -s "$scratch/before" "$scratch/after" || complain "the other camera is not as it was"

# A copy tells nothing new.
cp -r "$good/views/0001" "$good/views/0009"
accepts "a copied view" "$bin/rgbdt" intrinsics "$good" --camera rgb --out "$scratch/copied.textproto"
grep -q '^  0009 .*a copy of another image: it counts once' "$scratch/output" || complain "a copy is not told"
grep -q 'board found in 8 of 9 images' "$scratch/output" || complain "a copy counts"
rm -r "$good/views/0009"

# More numbers than the images tell, which may not converge.
"$bin/rgbdt" intrinsics "$good" --camera rgb --model pinhole8 --out "$scratch/eight/rig.textproto" \
  >"$scratch/output" 2>&1 || true
grep -qE '^  pinhole5 fits these images as well, with fewer numbers: .*; give --model pinhole5$' \
  "$scratch/output" || complain "more numbers than the images tell: nothing said"

# Images alone, a rig without lenses.
bare=$scratch/bare
cp -r "$good" "$bare"
rm "$bare"/views/*/cloud.pcd
sed -i '/^cloud:/d' "$bare"/views/*/view.textproto
sed -i '/^  pinhole {/,/^  }/d' "$bare/rig.textproto"
says=("rig.textproto" "no lens" "rgbdt intrinsics")
refuses "calibrating without a lens" "$bin/rgbdt" calibrate "$bare" --out "$scratch/kept"
accepts "images alone" "$bin/rgbdt" intrinsics "$bare" --camera rgb --model pinhole5 \
  --out "$scratch/found.textproto"
as_true "without a lens before" "$scratch/found.textproto"

# What cannot be done is said.
rm -r "$bare"/views/000[3-8]
says=("NOT CONVERGED" "2 usable views" "no rig file was written")
refuses "two views" "$bin/rgbdt" intrinsics "$bare" --camera rgb --out "$scratch/two/rig.textproto"
[ ! -e "$scratch/two/rig.textproto" ] || complain "two views made a rig file"
says=("front" "rgb" "thermal")
refuses "a camera that is not there" "$bin/rgbdt" intrinsics "$good" --camera front
says=("--model" "pinhole9")
refuses "a model that is none" "$bin/rgbdt" intrinsics "$good" --model pinhole9
says=("nowhere")
refuses "a session that is none" "$bin/rgbdt" intrinsics "$scratch/nowhere"
head -c 1000 "$good/views/0001/rgb.png" >"$bare/views/0002/rgb.png"
says=("view 0002 not read" "rgb.png")
refuses "a truncated image" "$bin/rgbdt" intrinsics "$bare" --out "$scratch/two/rig.textproto"

verdict
