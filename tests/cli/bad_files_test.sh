#!/usr/bin/env bash
# Every file that a person may get wrong: rgbdt says what, where and what to do, and leaves alone
# what an earlier run left. Usage: bad_files_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

good=$scratch/good
accepts "a good session" "$bin/rgbdt" simulate "$good" --views 4 --seed 3
mkdir "$scratch/kept"
accepts "calibrating it" "$bin/rgbdt" calibrate "$good" --out "$scratch/kept"
[ -s "$scratch/kept/calibration.textproto" ] || complain "no calibration was written"

session() {  # a fresh copy of the good session's first two views, at $scratch/bad
  chmod -R u+w "$scratch/bad" 2>/dev/null || true
  rm -rf "$scratch/bad"
  cp -r "$good" "$scratch/bad"
  rm -r "$scratch"/bad/views/000[34]
}
bad=$scratch/bad
view=$bad/views/0002

# The other view can still be used, so the run ends with what it can, into a folder of its own; a
# run that must not write at all gets the folder `kept`.
refuses_view() {  # WHAT: a view that cannot be read is named, and the exit code is not 0
  refuses "$1" "$bin/rgbdt" calibrate "$bad" --out "$scratch/out"
}
refuses_all() { refuses "$1" "$bin/rgbdt" calibrate "$bad" --out "$scratch/kept"; }

says=("$scratch/nowhere")
refuses "a missing directory" "$bin/rgbdt" calibrate "$scratch/nowhere" --out "$scratch/kept"
for verb in evaluate fuse export; do
  says=("$scratch/nowhere")
  refuses "a missing directory ($verb)" "$bin/rgbdt" "$verb" "$scratch/nowhere" --out "$scratch/kept"
done
says=("calibration.textproto")
refuses "evaluate before calibrate" "$bin/rgbdt" evaluate "$good" --out "$scratch/kept"
says=("no view" "0099")
refuses "fuse a view that is not there" "$bin/rgbdt" fuse "$good" --view 0099 \
  --calibration "$scratch/kept/calibration.textproto" --out "$scratch/kept"

session
rm -r "$bad/views"
says=("views")
refuses_all "no views"

session
rm "$bad/rig.textproto"
says=("rig.textproto")
refuses_all "no rig"

session
sed -i '1i colour_of_the_car: "red"' "$bad/rig.textproto"
says=("rig.textproto" "colour_of_the_car" "1")
refuses_all "an unknown key in the rig"

session
sed -i '0,/fx: [0-9.]*/s//fx: -5/' "$bad/rig.textproto"
says=("rig.textproto" "fx" "-5")
refuses_all "a negative focal length"

session
rm "$view/cloud.pcd"
says=("0002" "cloud.pcd")
refuses_view "a missing cloud"

session
rm "$view/thermal.png"
says=("0002" "thermal.png")
refuses_view "a missing image"

session
sed -i '1i exposure: 5' "$view/view.textproto"
says=("0002" "view.textproto" "exposure")
refuses_view "an unknown key in a view"

session
sed -i 's/utime: [0-9]*/utime: 1433167200000000/' "$view/view.textproto"
sed -i '0,/sweep_utime: [0-9]*/s//sweep_utime: 1433160000000000/' "$view/view.textproto"
says=("0002" "view.textproto:8" "different times")
refuses_view "a cloud and an image of different times"

session
head -c 2000 "$good/views/0001/cloud.pcd" >"$view/cloud.pcd"
says=("0002" "cloud.pcd")
refuses_view "a truncated cloud"

session
head -c 2000 "$good/views/0001/rgb.png" >"$view/rgb.png"
says=("0002" "rgb.png")
refuses_view "a truncated image"

session
cp "$bin/rgbdt" "$view/rgb.png"
says=("0002" "rgb.png")
refuses_view "a program as an image"

session
cp "$good/views/0001/rgb.png" "$view/thermal.png"
says=("0002" "thermal")
refuses_view "a colour camera's image as thermal"

python3 - "$scratch/three.png" 640 480 <<'END'
import struct, sys, zlib
path, width, height = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
def chunk(kind, data):
    return (struct.pack(">I", len(data)) + kind + data +
            struct.pack(">I", zlib.crc32(kind + data)))
rows = (b"\0" + bytes([200, 90, 20]) * width) * height  # coloured
with open(path, "wb") as f:
    f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
END
session
cp "$scratch/three.png" "$view/thermal.png"
sed -i 's/pixel_format: MONO16//' "$view/view.textproto"
says=("0002" "thermal" "channel")
refuses_view "a coloured thermal image"

session
for name in 0001 0002; do
  cat >"$bad/views/$name/cloud.pcd" <<'END'
VERSION .7
FIELDS x y z
SIZE 4 4 4
TYPE F F F
COUNT 1 1 1
WIDTH 3
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS 3
DATA ascii
nan nan nan
nan nan nan
nan nan nan
END
done
says=("0002")
refuses_view "clouds of nothing but NaN"

session
for name in 0001 0002; do
  python3 - "$bad/views/$name/rgb.png" 1936 1456 <<'END'
import random, struct, sys, zlib
path, width, height = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
random.seed(1)
def chunk(kind, data):
    return (struct.pack(">I", len(data)) + kind + data +
            struct.pack(">I", zlib.crc32(kind + data)))
rows = b"".join(b"\0" + random.randbytes(width) for _ in range(height))
with open(path, "wb") as f:
    f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))
END
done
says=("board")
refuses_view "noise in place of the board"

head -c 100000 /dev/urandom >"$scratch/noise.lcmlog"
says=("noise.lcmlog")
refuses "noise as a log" "$bin/rgbdt" replay "$scratch/noise.lcmlog" --out "$scratch/kept"
says=("nowhere.lcmlog")
refuses "a missing log" "$bin/rgbdt" replay "$scratch/nowhere.lcmlog" --out "$scratch/kept"
: >"$scratch/empty.lcmlog"
says=("empty.lcmlog")
refuses "an empty log" "$bin/rgbdt" replay "$scratch/empty.lcmlog" --out "$scratch/kept"

session
sed 's/quaternion_wxyz/quaternion/' "$scratch/kept/calibration.textproto" >"$scratch/broken.textproto"
says=("broken.textproto")
refuses "a calibration that is none" "$bin/rgbdt" evaluate "$good" \
  --calibration "$scratch/broken.textproto" --out "$scratch/kept"

# Before any work: of these inputs none would get through it.
session
rm "$bad"/views/*/*.png
: >"$scratch/file"
below=$scratch/file/below
head -c 100000 /dev/urandom >"$scratch/noise.ply"
cannot() {  # WHAT COMMAND...: where --out leads below a file
  says=("cannot write $below" "Not a directory")
  refuses "--out that cannot be written ($1)" "${@:2}"
  [ "$(wc -l <"$scratch/output")" -eq 1 ] || complain "$1: not one line"
}
for verb in calibrate intrinsics; do cannot "$verb" "$bin/rgbdt" "$verb" "$bad" --out "$below"; done
for verb in fuse export refine evaluate; do
  cannot "$verb" "$bin/rgbdt" "$verb" "$bad" --out "$below" \
    --calibration "$scratch/kept/calibration.textproto"
done
for verb in map "export --mcap" scanner sync; do
  # shellcheck disable=SC2086 # a verb and its flag
  cannot "$verb" "$bin/rgbdt" $verb "$scratch/noise.lcmlog" --out "$below"
done
cannot terrain "$bin/rgbdt" terrain "$scratch/noise.ply" --out "$below"
cannot "export --las" "$bin/rgbdt" export --las "$scratch/noise.ply" --out "$below.las"
says=("cannot write $scratch/kept" "Is a directory")
refuses "--out that is a folder" "$bin/rgbdt" map "$scratch/noise.lcmlog" --out "$scratch/kept"

verdict
