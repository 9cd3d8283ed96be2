#!/usr/bin/env bash
# rgbdt fuse --correct-ranges puts points where the calibration says they truly are.
# Usage: fuse_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
mkdir -p "$scratch"/{kept,plain,unused,corrected,differ}

accepts "a session of one view" "$bin/rgbdt" simulate "$scratch/s" --views 1 --lidar vlp16
calibration() {  # NAME RGB THERMAL: what stands in the two cameras' parts
  for part in "camera: \"rgb\" $2" "camera: \"thermal\" $3"; do
    echo "camera { $part status: CONVERGED camera_from_lidar {
      quaternion_wxyz: [0.5, 0.5, -0.5, 0.5] translation_m: [0, 0.1, 0] } }"
  done >"$scratch/$1.textproto"
}
errors() {  # OFFSET: range errors of it, and beams that meet at 50 mm
  echo "range_errors {
    offset_m { value: $1 sigma: 0.001 }
    beams_meet_m { value: 0.05 sigma: 0.001 }
  }"
}
fuses() {  # WHAT NAME FLAG...: by the calibration of that name, into a folder of that name
  accepts "$1" "$bin/rgbdt" fuse "$scratch/s" --calibration "$scratch/$2.textproto" \
    --out "$scratch/$2" "${@:3}"
}

calibration plain "" ""
fuses "fusing" plain
calibration unused "$(errors 0.1)" "$(errors 0.1)"
fuses "fusing as measured" unused
cmp "$scratch"/{plain,unused}/fused.ply || complain "ranges were corrected unasked"
calibration corrected "$(errors 0.1)" "$(errors 0.1)"
fuses "correcting ranges" corrected --correct-ranges
grep -q ", ranges corrected," "$scratch/output" || complain "it does not say so"
! grep -q "differ" "$scratch/output" || complain "it warns of cameras that agree"
calibration differ "$(errors 0.1)" "$(errors 0.2)"
fuses "cameras that differ" differ --correct-ranges
grep -q "differ.textproto: cameras differ in their range_errors" "$scratch/output" ||
  complain "cameras differ, and nothing is said"
cmp "$scratch"/{corrected,differ}/fused.ply || complain "not by the first camera's range errors"

python3 - "$scratch"/{plain,corrected}/fused.ply <<'END' >"$scratch/output" 2>&1 || complain "points"
import math, struct, sys

def points(path):
    header, data = open(path, "rb").read().split(b"end_header\n", 1)
    formats = {"float": "f", "double": "d", "uchar": "B", "uint": "I", "int": "i"}
    words = [line.split() for line in header.decode().splitlines()]
    fields = [word for word in words if word[0] == "property"]
    assert [field[2] for field in fields[:3]] == ["x", "y", "z"], fields
    record = struct.Struct("<" + "".join(formats[field[1]] for field in fields))
    return [row[:3] for row in record.iter_unpack(data)]

before, after = points(sys.argv[1]), points(sys.argv[2])
assert len(before) == len(after) > 1000, (len(before), len(after))
for (x, y, z), point in zip(before, after):
    longer = 1 + 0.1 / math.sqrt(x * x + y * y + z * z)
    expected = (x * longer, y * longer, z * longer - 0.05 * z / math.hypot(x, y))
    assert math.dist(expected, point) < 1e-4, (x, y, z, point)
END

cp "$scratch/plain/fused.ply" "$scratch/kept"
says=("plain.textproto has no range_errors" "calibrate with this version")
refuses "a calibration without range errors" "$bin/rgbdt" fuse "$scratch/s" --correct-ranges \
  --calibration "$scratch/plain.textproto" --out "$scratch/kept"

for program in "rgbdt fuse" rgbdt-fuser; do
  read -ra words <<<"$program"
  accepts "help of $program" "$bin/${words[0]}" "${words[@]:1}" --help
  grep -q -- '--correct-ranges' "$scratch/output" || complain "$program --help lacks the flag"
done
says=("nonsense://")
refuses "a bus that is none" "$bin/rgbdt-fuser" --correct-ranges --lcm-url nonsense://

verdict
