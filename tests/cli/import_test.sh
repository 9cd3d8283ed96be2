#!/usr/bin/env bash
# rgbdt import: a session as a bag of any kind gives the calibration that it gives as folders, bit for
# bit; bags that are cut off, odd or hostile. Usage: import_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
make_bag=$(dirname "${BASH_SOURCE[0]}")/make_bag.py

good=$scratch/good
accepts "a session" "$bin/rgbdt" simulate "$good" --views 8 --picked rgb
mkdir -p "$scratch/kept"
board=11x8@0.1,1.2192x0.9144
imports() {  # WHAT BAG ARGUMENTS...: into $scratch/import
  rm -rf "$scratch/import"
  accepts "$1" "$bin/rgbdt" import "$2" --board "$board" --out "$scratch/import" "${@:3}"
}
# As folders, named by the times that the bags' headers have.
mkdir -p "$scratch/folders"/{rgb,thermal,pcd}
for i in 1 2 3 4 5 6 7 8; do
  view=$good/views/000$i time=170000000$((i - 1))
  ln -s "$view/rgb.png" "$scratch/folders/rgb/$time.020000.png"
  ln -s "$view/thermal.png" "$scratch/folders/thermal/$time.020000.png"
  ln -s "$view/cloud.pcd" "$scratch/folders/pcd/$time.000000.pcd"
done
for camera in rgb thermal; do lens_of "$good/rig.textproto" "$camera" >"$scratch/$camera.yaml"; done
accepts "folders" "$bin/rgbdt" session --images "$scratch/folders/rgb" \
  --images "$scratch/folders/thermal" --clouds "$scratch/folders/pcd" --lens "$scratch/rgb.yaml" \
  --lens "$scratch/thermal.yaml" --board "$board" --out "$scratch/session"
accepts "folders: calibrating" "$bin/rgbdt" calibrate "$scratch/session" --truth "$good/truth.textproto"
grep 'result against truth' "$scratch/output" | awk '{ if ($4 > 0.1 || $6 > 5) exit 1 }' ||
  complain "folders: not the right poses"

accepts "making bags" python3 "$make_bag" "$good" "$scratch/b.mcap:zstd" "$scratch/b.db3" "$scratch/b.bag:lz4"
for kind in mcap db3 bag; do
  imports "$kind" "$scratch/b.$kind" --every 1
  says_all "$kind" "/rgb/image_raw  sensor_msgs/Image  8 messages, 1 Hz" "1936x1456 mono8" \
    "400x300 x y z intensity ring" "lens of /thermal/camera_info" "0008: cloud at 7.00 s  rgb: +20 ms" \
    "8 views" "next: rgbdt calibrate"
  cmp "$scratch/session/rig.textproto" "$scratch/import/rig.textproto" || complain "$kind: another rig"
  cmp "$good/views/0005/cloud.pcd" "$scratch/import/views/0005/cloud.pcd" || complain "$kind: another cloud"
  accepts "$kind: calibrating" "$bin/rgbdt" calibrate "$scratch/import"
  cmp "$scratch/session/calibration.textproto" "$scratch/import/calibration.textproto" ||
    complain "$kind: another calibration than of the folders"
done

# Listed, and nothing else.
accepts "a list" "$bin/rgbdt" import "$scratch/b.db3"
says_all "a list" "ROS 2 bag (sqlite)" "/chatter  std_msgs/String  1 messages" "would take: camera thermal" \
  "would take: lidar: /lidar/points" "next: add --board and --out"

# The other ways to write the same: one view, the same files.
cp -r "$scratch/import/views/0001" "$scratch/view"
same() {  # WHAT BAG[:COMPRESSION] OPTIONS...
  accepts "$1: making it" python3 "$make_bag" "$good" --views 1 "${@:2}"
  imports "$1" "${2%:*}" --at 0
  diff -r "$scratch/view" "$scratch/import/views/0001" >>"$scratch/output" || complain "$1: another view"
}
same "MCAP, never closed" "$scratch/o.mcap:zstd" --no-summary
same "MCAP by lz4" "$scratch/o.mcap:lz4"
same "MCAP without chunks, big-endian" "$scratch/o.mcap" --no-chunks --big-endian
same "MCAP of ROS 1's messages" "$scratch/o.ros1:zstd"
same "PNG in the messages" "$scratch/o.mcap" --png
same "sqlite, messages packed" "$scratch/o.db3:zstd"
same "ROS 1, not packed" "$scratch/o.bag"
same "ROS 1 by bz2" "$scratch/o.bag:bz2"

# A folder of split files is one bag.
mkdir "$scratch/split"
accepts "making split bags" python3 "$make_bag" "$good" --views 1 "$scratch/split/b_0.mcap"
cp "$scratch/split/b_0.mcap" "$scratch/split/b_10.mcap"
cp "$scratch/split/b_0.mcap" "$scratch/split/b_9.mcap"
imports "split" "$scratch/split" --at 0
says_all "split" "/lidar/points  sensor_msgs/PointCloud2  3 messages" "1 view"
accepts "making another kind" python3 "$make_bag" "$good" --views 1 "$scratch/split/b.db3"
says=("several kinds (1 .db3, 3 .mcap)" "name one of the files")
refuses "a folder of two kinds" "$bin/rgbdt" import "$scratch/split"
printf 'relative_file_paths:\n  - b.db3\n' >"$scratch/split/metadata.yaml"
imports "the kind that metadata.yaml lists" "$scratch/split" --at 0
says_all "the kind that metadata.yaml lists" "ROS 2 bag (sqlite)" "/lidar/points  sensor_msgs/PointCloud2  1 messages"

# Where the board stands still, and only there; and what tf_static says.
accepts "making a slow bag" python3 "$make_bag" "$good" --views 3 --seconds 3 --rate 2 --mosaic --tf \
  "$scratch/still.mcap"
imports "standing still" "$scratch/still.mcap"
says_all "standing still" "it stood still 3 times, 3 are taken" "0001: cloud at 1.00 s" \
  "0003: cloud at 7.00 s" "guess rgb_from_lidar of tf_static" "the camera at 0.000 0.000 0.100 m" "3 views"
grep -q 'pixel_format: BAYER_RG8' "$scratch/import/rig.textproto" || complain "standing still: no mosaic"
grep -A2 camera_from_lidar_guess "$scratch/import/rig.textproto" | grep -qF '[0.5, 0.5, -0.5, 0.5]' ||
  complain "standing still: not the guess"
imports "two views of three" "$scratch/still.mcap" --views 2
says_all "two views of three" "3 times, 2 are taken"
accepts "making a moving bag" python3 "$make_bag" "$good" --views 3 --no-info "$scratch/moving.bag"
lenses=(--lens "$scratch/rgb.yaml" --lens "thermal=$scratch/thermal.yaml")
says=("never stood still" "--every")
refuses "never still" "$bin/rgbdt" import "$scratch/moving.bag" --board "$board" "${lenses[@]}" --out "$scratch/kept/new"
imports "without CameraInfo" "$scratch/moving.bag" --lens "$scratch/rgb.yaml" --every 2 --image front=/rgb/image_raw
says_all "without CameraInfo" "camera front: colour" "2 views"

# Cut off: what lies before is taken.
accepts "making a cut bag" python3 "$make_bag" "$good" --views 2 --cut 300000 --no-summary \
  "$scratch/cut.mcap:zstd" "$scratch/cut.bag:lz4"
for kind in mcap bag; do
  imports "cut off ($kind)" "$scratch/cut.$kind" --every 1
  says_all "cut off ($kind)" "problem: $scratch/cut.$kind, byte " "cut off" "1 view"
done

# What makes no sense is one line on stderr, and leaves nothing.
refuses_bag() {  # WHAT BAG ARGUMENTS...
  refuses "$1" "$bin/rgbdt" import "$2" --board "$board" --out "$scratch/kept/new" "${@:3}"
  [ "$(grep -c '^rgbdt' "$scratch/output")" = 1 ] || complain "$1: not one line of error"
}
says=("nowhere.bag")
refuses_bag "no file" "$scratch/nowhere.bag"
mkfifo "$scratch/pipe"
says=("pipe" "regular file")
refuses_bag "a pipe" "$scratch/pipe"
says=("rgb.yaml" "MCAP" ".db3")
refuses_bag "no bag" "$scratch/rgb.yaml"
printf '\x28\xb5\x2f\xfd' >"$scratch/whole.db3"
says=("whole.db3" "unzstd")
refuses_bag "a bag packed as a whole" "$scratch/whole.db3"
python3 -c 'import sqlite3, sys; sqlite3.connect(sys.argv[1]).execute("CREATE TABLE t(i)")' "$scratch/other.db3"
says=("other.db3" "no ROS 2 bag")
refuses_bag "another database" "$scratch/other.db3"
says=("--lens" "--pinhole")
refuses_bag "no lens" "$scratch/moving.bag" --every 1
says=("--cloud" "/nothing" "/lidar/points")
refuses_bag "no such topic" "$scratch/b.mcap" --cloud /nothing
says=("11 x 8" "inner corners" "count squares")
refuses "inner corners" "$bin/rgbdt" import "$scratch/o.bag" --board 10x7@0.1,1.2192x0.9144 --every 1 --out "$scratch/kept/new"
says=("--board" "--out")
misuses "no directory" "$bin/rgbdt" import "$scratch/b.mcap" --board "$board"
says=("--at" "noon")
refuses_bag "no time" "$scratch/o.bag" --at noon
says=("rgb.yaml/new")
refuses "a folder that cannot be made" "$bin/rgbdt" import "$scratch/b.mcap" --board "$board" \
  --out "$scratch/rgb.yaml/new"
! grep -q '/lidar/points' "$scratch/output" || complain "a folder that cannot be made: after the bag was read"
cp -r "$scratch/import" "$scratch/kept/import"
says=("earlier session")
refuses "a session that is there" "$bin/rgbdt" import "$scratch/b.mcap" --board "$board" --out "$scratch/kept/import"

verdict
