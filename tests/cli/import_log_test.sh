#!/usr/bin/env bash
# `rgbdt import --log`: a bag as a log of lcm-logger. Usage: import_log_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
make_bag=$(dirname "${BASH_SOURCE[0]}")/make_bag.py
mkdir "$scratch/kept"

# All of its clouds and images, by a calibrated session's rig.
accepts "a room" "$bin/rgbdt" simulate "$scratch/room" --natural --scene indoor --views 5 --seed 12 --lidar 32
"$bin/drive_test_log" "$scratch/room" 1 "$scratch/ignored.lcmlog" "$scratch/room/calibration.textproto"
accepts "making a bag of it" python3 "$make_bag" "$scratch/room" --mosaic --seconds 3 --rate 2 "$scratch/room.mcap"
accepts "a log" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/logs/room.lcmlog" --session "$scratch/room"
says_all "a log" "camera thermal: /thermal/image_raw" "15 clouds: their points' times are of another clock" \
  "15 clouds, 60 images" "rgbdt refine $scratch/logs/room.lcmlog"
[ "$(ls "$scratch/logs")" = room.lcmlog ] || complain "a log: left beside it: $(ls "$scratch/logs")"
python3 - "$scratch/logs/room.lcmlog" <<'END' || complain "what is in the log"
import collections, struct, sys
data, at, events = open(sys.argv[1], "rb").read(), 0, []
while at < len(data):
    sync, number, utime, name, size = struct.unpack_from(">IQQII", data, at)
    assert sync == 0xEDA1DA01 and number == len(events)
    events.append((utime, data[at + 28:at + 28 + name].decode()))
    at += 28 + name + size
count = collections.Counter(channel for _, channel in events)
assert count["RGB_IMAGE"] == count["THERMAL_IMAGE"] == 30 and count["CLOUD"] >= 15, count
assert count["RIG"] == 15 and count["CALIBRATION"] == 30, count
times = [utime for utime, _ in events]
assert times == sorted(times), "not in the order of time"
assert [channel for _, channel in events[:3]] == ["RIG", "CALIBRATION", "CALIBRATION"], events[:3]
END
# By the rig's guess, which is off; nothing but the log's images and clouds can put that right.
rm "$scratch/room/calibration.textproto"
accepts "a log without a calibration" "$bin/rgbdt" import "$scratch/room.mcap" \
  --log "$scratch/logs/guess.lcmlog" --session "$scratch/room"
says_all "a log without a calibration" "is not calibrated: the log has no calibration"
accepts "refining by the log" "$bin/rgbdt" refine "$scratch/logs/guess.lcmlog" --every 1 \
  --out "$scratch/refined" --truth "$scratch/room/truth.textproto"
python3 - "$scratch/refined/report.json" <<'END' || complain "the log's calibration is not near the truth"
import json, sys
for name, camera in json.load(open(sys.argv[1]))["cameras"].items():
    before, after = (camera[key]["rotation_deg"] for key in ("first_guess_error", "truth_error"))
    assert camera["status"] == "CONVERGED", (name, camera["status"])
    assert before > 0.5 and after < 0.1, (name, before, after)
END
accepts "a log of clouds alone" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/logs/clouds.lcmlog"
says_all "a log of clouds alone" "15 clouds, 0 images" "rgbdt map"
# What lies under the name that it is written as, as a stranger's folder may have it, is not written through.
echo precious >"$scratch/kept/precious"
ln -s "$scratch/kept/precious" "$scratch/logs/linked.lcmlog.part"
accepts "a link in the log's place" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/logs/linked.lcmlog"
[ "$(cat "$scratch/kept/precious")" = precious ] || complain "a log was written through a link"
cmp "$scratch/logs/linked.lcmlog" "$scratch/logs/clouds.lcmlog" || complain "another log"
says=("is there already")
refuses "a log that is there" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/logs/clouds.lcmlog"
says=("is it another camera's" "1936x1456")
sed '0,/width: [0-9]*/s//width: 640/' "$scratch/room/rig.textproto" >"$scratch/small.textproto"
mkdir "$scratch/small" && mv "$scratch/small.textproto" "$scratch/small/rig.textproto"
refuses "a rig of smaller images" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/kept/log" \
  --session "$scratch/small"
says=("none of the rig's cameras" "--image")
refuses "another rig's cameras" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/kept/log" \
  --session "$scratch/room" --image left=/rgb/image_raw --image right=/thermal/image_raw
says=("--log and --out")
misuses "a log and a session" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/kept/log" \
  --board 8x6@0.095,0.85x0.61 --out "$scratch/kept/new"
says=("--log takes all clouds")
misuses "moments of a log" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/kept/log" --every 1
says=("needs --session")
misuses "images without a rig" "$bin/rgbdt" import "$scratch/room.mcap" --log "$scratch/kept/log" \
  --image rgb=/rgb/image_raw
says=("--session goes with --log")
misuses "a session without a log" "$bin/rgbdt" import "$scratch/room.mcap" --session "$scratch/room"

verdict
