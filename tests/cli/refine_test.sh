#!/usr/bin/env bash
# `rgbdt refine`: a room without a board, from the rig file's guess.
# Usage: refine_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

accepts "a room" "$bin/rgbdt" simulate "$scratch/room" --natural --scene indoor --views 3 --seed 12

accepts "refining the guess" "$bin/rgbdt" refine "$scratch/room"
for file in calibration.textproto report.json report.html; do
  [ -s "$scratch/room/refined/$file" ] || complain "refine wrote no $file"
done
[ ! -e "$scratch/room/calibration.textproto" ] || complain "refine wrote into the session itself"
# Nearer to the truth than the guess by far, and judged on the sweep that was left out.
python3 - "$scratch/room/refined/report.json" <<'END' || complain "the refined calibration is not near the truth"
import json, sys
report = json.load(open(sys.argv[1]))
assert report["method"] == "natural", report["method"]
for name, camera in report["cameras"].items():
    before, after = (camera[key]["rotation_deg"] for key in ("first_guess_error", "truth_error"))
    assert camera["status"] == "CONVERGED", (name, camera["status"])
    assert after < 0.1 and after < 0.2 * before, (name, before, after)
    assert camera["scene"]["heldout_result"] > camera["scene"]["heldout_start"], (name, camera["scene"])
END

# From a guess that is off by some 20 degrees: not without --search, and it says so.
cp -r "$scratch/room" "$scratch/lost"
rm -r "$scratch/lost/refined"
python3 - "$scratch/lost/rig.textproto" <<'END'
import math, re, sys
half = math.radians(19) / 2
def turned(match):  # about an axis of the LIDAR's
    w, x, y, z = (float(number) for number in match[1].split(","))
    c, s = math.cos(half), math.sin(half)
    return f"quaternion_wxyz: [{w*c - x*s}, {x*c + w*s}, {y*c + z*s}, {z*c - y*s}]"
text = open(sys.argv[1]).read()
open(sys.argv[1], "w").write(re.sub(r"quaternion_wxyz: \[(.*?)\]", turned, text))
END
"$bin/rgbdt" refine "$scratch/lost" --out "$scratch/lost/near" >"$scratch/output" 2>&1 &&
  complain "a guess that is off by 20 degrees is refined without --search"
grep -q -- '--search looks farther' "$scratch/output" || complain "nothing says that --search may help"
accepts "a search" "$bin/rgbdt" refine "$scratch/lost" --search --out "$scratch/lost/far"
python3 - "$scratch/lost/far/report.json" <<'END' || complain "--search ends elsewhere"
import json, sys
for name, camera in json.load(open(sys.argv[1]))["cameras"].items():
    assert camera["first_guess_error"]["rotation_deg"] > 15, (name, camera["first_guess_error"])
    assert camera["status"] == "CONVERGED", (name, camera["status"])
    assert camera["truth_error"]["rotation_deg"] < 0.1, (name, camera["truth_error"])
END

# From the first result, in turn; what it knew of itself is joined.
accepts "a prior" "$bin/rgbdt" refine "$scratch/room" \
  --prior "$scratch/room/refined/calibration.textproto" --out "$scratch/joined"
[ -s "$scratch/joined/calibration.textproto" ] || complain "no calibration with --prior"

# Images that show other places than the clouds: no calibration that calls itself converged.
cp -r "$scratch/room" "$scratch/mixed"
rm -r "$scratch/mixed/refined"
mv "$scratch/mixed/views/0001/cloud.pcd" "$scratch/other.pcd"
mv "$scratch/mixed/views/0002/cloud.pcd" "$scratch/mixed/views/0001/cloud.pcd"
mv "$scratch/other.pcd" "$scratch/mixed/views/0002/cloud.pcd"
"$bin/rgbdt" refine "$scratch/mixed" >"$scratch/output" 2>&1 || true
python3 - "$scratch/mixed/refined/report.json" <<'END' || complain "clouds of other places give a calibration"
import json, sys
for name, camera in json.load(open(sys.argv[1]))["cameras"].items():
    # The two views stand close together: what comes out is right, or is called what it is.
    wrong = camera["truth_error"]["rotation_deg"] > 0.5
    assert camera["status"] != "CONVERGED" or not wrong, (name, camera["truth_error"])
END

# Out of a log of a drive, from the true calibration turned by what the guess is off.
"$bin/drive_test_log" "$scratch/room" 1 "$scratch/drive.lcmlog" "$scratch/true.textproto"
accepts "a log" "$bin/rgbdt" refine "$scratch/drive.lcmlog" --out "$scratch/from_log" \
  --truth "$scratch/room/truth.textproto"
for file in calibration.textproto report.json drive/rig.textproto drive/views/0003-thermal/cloud.pcd; do
  [ -s "$scratch/from_log/$file" ] || complain "refine of a log wrote no $file"
done
python3 - "$scratch/from_log/report.json" <<'END' || complain "the log's calibration is not near the truth"
import json, sys
for name, camera in json.load(open(sys.argv[1]))["cameras"].items():
    assert camera["status"] == "CONVERGED", (name, camera["status"])
    assert camera["truth_error"]["rotation_deg"] < 0.1, (name, camera["truth_error"])
    assert camera["views"]["heldout"] == ["0003-" + name], (name, camera["views"])
END
# Killed while the log is cut, and again once it is: run again it gives the same.
is_cut() { grep -q solving "$scratch/output"; }
is_being_cut() { compgen -G "$scratch/killed/drive*/views/*/view.textproto" >"$scratch/found"; }
for stage in is_being_cut is_cut; do
  "$bin/rgbdt" refine "$scratch/drive.lcmlog" --out "$scratch/killed" \
    --truth "$scratch/room/truth.textproto" >"$scratch/output" 2>&1 &
  refining=$!
  until "$stage"; do
    kill -0 "$refining" 2>/dev/null || break
    sleep 0.02
  done
  kill -KILL "$refining" || complain "$stage: it ended before it could be killed"
  wait "$refining" 2>/dev/null || true
done
accepts "a log once more" "$bin/rgbdt" refine "$scratch/drive.lcmlog" --out "$scratch/killed" \
  --truth "$scratch/room/truth.textproto"
cmp "$scratch/from_log/calibration.textproto" "$scratch/killed/calibration.textproto" ||
  complain "killed and run again: another calibration"
[ "$(ls "$scratch/killed")" = "$(ls "$scratch/from_log")" ] ||
  complain "killed and run again: other files: $(ls "$scratch/killed")"
says=("is there already")
refuses "a drive that was cut before" "$bin/rgbdt" refine "$scratch/drive.lcmlog" --out "$scratch/from_log"

misuses "a method that is not there" "$bin/rgbdt" refine "$scratch/room" --method magic
says=("there is no session directory")
refuses "a session that is not there" "$bin/rgbdt" refine "$scratch/none"

verdict
