#!/usr/bin/env bash
# rgbdt scanner on a rendered room whose rig file is wrong about the scanner by 5 mm and 0.5 degrees:
# it is found, from clouds alone, and what a sweep does not tell is said. Usage: scanner_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

room=$scratch/room
mkdir "$scratch/kept"
accepts "a wrong rig" "$bin/rgbdt" simulate "$room" --views 1 --scene indoor --seed 3 --full-turn \
  --scanner-error
accepts "a right rig" "$bin/rgbdt" simulate "$scratch/right" --views 1 --scene indoor --seed 3 \
  --full-turn
cp "$room/rig.textproto" "$scratch/kept"

# mount RIG: motor_from_scanner as quaternion and metres, in one line.
mount() {
  sed -n '/motor_from_scanner/,/}/p' "$1" | tr -d '\n' | sed 's/[^-0-9.e]\+/ /g; s/^[ e]*//'
}
# near RIG MM DEG: what a sweep can tell lies within so much of the truth. The turn about z and the
# height are as they were guessed; the turn is taken out of lever arm and tilt first.
near() {
  /usr/bin/python3 - "$(mount "$scratch/right/rig.textproto")" "$(mount "$1")" "$2" "$3" <<'END'
import math, sys

def split(text):
    numbers = [float(word) for word in text.split()]
    assert len(numbers) == 7, text
    return numbers[:4], numbers[4:]

def times(a, b):
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw)

(q, t), (found_q, found_t) = split(sys.argv[1]), split(sys.argv[2])
w, _, _, z = times(found_q, (q[0], -q[1], -q[2], -q[3]))
turn = 2 * math.atan2(z, w)
turned = times((math.cos(turn / 2), 0, 0, math.sin(turn / 2)), q)
_, x, y, _ = times(found_q, (turned[0], -turned[1], -turned[2], -turned[3]))
lever = (math.cos(turn) * t[0] - math.sin(turn) * t[1], math.sin(turn) * t[0] + math.cos(turn) * t[1])
mm = 1000 * math.hypot(found_t[0] - lever[0], found_t[1] - lever[1])
deg = math.degrees(2 * math.hypot(x, y))
print(f"off by {mm:.3f} mm and {deg:.4f} degrees")
sys.exit(mm > float(sys.argv[3]) or deg > float(sys.argv[4]))
END
}

! near "$room/rig.textproto" 4 0.4 || complain "the wrong rig is not wrong: nothing is tested"

# Images are not needed.
rm "$room"/views/0001/*.png
sed -i '/^image {/,/^}/d' "$room/views/0001/view.textproto"
out=$scratch/out
accepts "a room" "$bin/rgbdt" scanner "$room" --out "$out/rig.textproto"
for word in "converged" "both halves" "before" "after" "+-" "tilt about x" "lever arm y" \
  "point_in_motor = R * point_in_scanner" "encoder's zero  not observed" "next: use that rig file"; do
  grep -qF -- "$word" "$scratch/output" || complain "no word of '$word'"
done
near "$out/rig.textproto" 0.5 0.02 || complain "the rig found is not as true as asked for"
[ -s "$out/scanner.png" ] || complain "no picture was drawn"
cmp -s "$room/rig.textproto" "$scratch/kept/rig.textproto" || complain "the rig file was replaced"
# All else is as it was.
sed '/motor_from_scanner/,/}/d' "$room/rig.textproto" >"$scratch/before"
sed '/motor_from_scanner/,/}/d' "$out/rig.textproto" >"$scratch/after"
cmp -s "$scratch/before" "$scratch/after" || complain "more than motor_from_scanner changed"

# From a log: lines and readings as they were, none of it through a cloud.
"$bin/scanner_test_log" "$scratch/room.lcmlog" "$room/rig.textproto"
accepts "a log" "$bin/rgbdt" scanner "$scratch/room.lcmlog" --out "$scratch/log/rig.textproto"
near "$scratch/log/rig.textproto" 0.5 0.02 || complain "the rig found from a log is not as true"
head -c -100 "$scratch/room.lcmlog" >"$scratch/cut.lcmlog"
accepts "a log that was cut" "$bin/rgbdt" scanner "$scratch/cut.lcmlog" --out "$scratch/cut/rig.textproto"
grep -q 'bytes belong to no whole message' "$scratch/output" || complain "a log that was cut: it is not said"

# What cannot be done is said, and writes nothing.
accepts "a short sweep" "$bin/rgbdt" simulate "$scratch/short" --views 1 --scene indoor --seed 3
says=("NOT CONVERGED" "both halves" "over the vertical" "no rig file was written")
refuses "a sweep that sees nothing twice" "$bin/rgbdt" scanner "$scratch/short" \
  --out "$scratch/kept/none.textproto"
accepts "a spinning LIDAR" "$bin/rgbdt" simulate "$scratch/rings" --views 1 --lidar vlp16
says=("turned_scanner")
refuses "a rig without a motor" "$bin/rgbdt" scanner "$scratch/rings"
says=("not assembled with this rig")
cp "$scratch/right/views/0001/cloud.pcd" "$scratch/other.pcd"
cp -r "$room" "$scratch/mixed"
cp "$scratch/other.pcd" "$scratch/mixed/views/0001/cloud.pcd"
sed -i 's/translation_m: \[0.025, -0.005/translation_m: [0.425, -0.405/' \
  "$scratch/mixed/rig.textproto"
refuses "a cloud of another rig" "$bin/rgbdt" scanner "$scratch/mixed"
says=("nowhere")
refuses "a session that is none" "$bin/rgbdt" scanner "$scratch/nowhere"
says=("--full-turn")
refuses "a full turn of a spinning LIDAR" "$bin/rgbdt" simulate "$scratch/kept/x" --lidar 32 \
  --full-turn

verdict
