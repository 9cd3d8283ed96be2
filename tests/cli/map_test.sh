#!/usr/bin/env bash
# rgbdt map and rgbdt terrain: good runs, help, and files that are none. Usage: map_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
mkdir "$scratch/kept"
log=$scratch/fused.lcmlog

# An LCM log of fused clouds (lcmtypes/rgbdt_cloud_t.lcm) over level ground with a crate on it, and
# ones of sweeps (lcmtypes/cloud_t.lcm) of drives.
drive=$scratch/drive.lcmlog
"$bin/map_test_log" "$log" "$scratch/other.lcmlog" "$drive" "$scratch/rigged.lcmlog" \
  "$scratch/truth" "$scratch/loop.lcmlog" "$scratch/turned.lcmlog"

accepts "map" "$bin/rgbdt" map "$log" --voxel 0.1 --out "$scratch/kept/map.ply"
grep -q 'rgbdt terrain' "$scratch/output" || complain "map names no next step"
head -c 500 "$scratch/kept/map.ply" | grep -qa '^comment voxel_m: 0.1$' || complain "no voxel_m"
head -c 500 "$scratch/kept/map.ply" | grep -qa '^comment frame: lidar$' || complain "no frame"
accepts "the map again" "$bin/rgbdt" map "$log" --voxel 0.1 --out "$scratch/again.ply"
head -c 8 "$scratch/again.png" | grep -qa PNG || complain "no picture from above of fused clouds"
[ ! -e "$scratch/again.tum" ] || complain "a way of clouds that have no poses"
python3 - "$scratch/again_terrain.json" <<'END' || complain "the map's terrain"
import json, sys
grid = json.load(open(sys.argv[1]))["grid"]
traversable = grid["states"].index("traversable")
assert grid["state"].count(traversable) > 100, grid["state"].count(traversable)
END
cmp "$scratch/kept/map.ply" "$scratch/again.ply" || complain "the same log, another map"

# A drive with nothing but sweeps: the way is found from them.
accepts "map of a drive" "$bin/rgbdt" map "$drive" --out "$scratch/drive/map.ply"
grep '^18 clouds' "$scratch/output" | cut -d ';' -f 1 >"$scratch/unrigged" || complain "clouds of the drive"
grep -q 'poses by odometry' "$scratch/output" || complain "where does the way come from?"
grep -q '^20 sweeps, 1 without a place, 0 that' "$scratch/output" || complain "sweeps of the drive"
head -c 500 "$scratch/drive/map.ply" | grep -qa '^comment frame: map$' || complain "the drive's frame"
head -c 8 "$scratch/drive/map.png" | grep -qa PNG || complain "no picture from above"
python3 - "$scratch/drive/map.tum" "$scratch/truth" <<'END' >"$scratch/output" 2>&1 || complain "map.tum"
import math, sys
lines = [l.split() for l in open(sys.argv[1]) if not l.startswith("#")]
truth = {int(l.split()[0]): [float(v) for v in l.split()[1:]] for l in open(sys.argv[2])}
assert len(lines) == 20 and all(len(l) == 8 for l in lines), lines
first, last = lines[1], lines[-1]  # the very first is of a sweep's middle
found = math.dist([float(v) for v in first[1:4]], [float(v) for v in last[1:4]])
times = [int(l[0].replace(".", "")) for l in (first, last)]
true = math.dist(truth[times[0]], truth[times[1]])
assert true > 4 and abs(found - true) < 0.05, (found, true)
END
accepts "a drive with a rig" "$bin/rgbdt" map "$scratch/rigged.lcmlog" --out "$scratch/drive/rigged.ply"
grep '^18 clouds' "$scratch/output" | cut -d ';' -f 1 | cmp - "$scratch/unrigged" ||
  complain "fused by a rig whose cameras saw nothing, another map"
accepts "the drive again" "$bin/rgbdt" map "$drive" --out "$scratch/drive/again.ply"
cmp "$scratch/drive/map_terrain.png" "$scratch/drive/again_terrain.png" ||
  complain "the same drive, another terrain"
for kind in ply tum png; do
  cmp "$scratch/drive/map.$kind" "$scratch/drive/again.$kind" || complain "the same drive, another $kind"
done
# Loops are closed where that is asked; this street is driven once.
accepts "a drive without a loop" "$bin/rgbdt" map "$drive" --close-loops --out "$scratch/drive/open.ply"
grep -q '^no loop found: way and map are as without' "$scratch/output" || complain "no loop, and not said"
for kind in ply tum png; do
  cmp "$scratch/drive/map.$kind" "$scratch/drive/open.$kind" || complain "no loop, another $kind"
done
# For programs.
"$bin/rgbdt" map "$drive" --json --out "$scratch/json/map.ply" >"$scratch/said.json" \
  2>"$scratch/output" || complain "map as JSON: exit code $?"
cmp "$scratch/json/map.ply" "$scratch/drive/map.ply" || complain "map as JSON: another map"
python3 - "$scratch/said.json" <<'END' >"$scratch/output" 2>&1 || complain "map as JSON"
import json, sys
said = json.load(open(sys.argv[1]))
assert said["clouds"] == 18 and said["frame"] == "map" and said["unreadable_bytes"] == 0, said
assert said["points"] > said["voxels"] > 1000 and said["voxels_gone"] == 0, said
drive = said["drive"]
assert drive["by_odometry"] and drive["poses"] == 20 and drive["length_m"] > 4, drive
assert (drive["sweeps"], drive["without_place"], drive["degenerate"]) == (20, 1, 0), drive
assert drive["begun_anew"] == 0 and drive["loops"] is None, drive
END
"$bin/rgbdt" terrain "$scratch/json/map.ply" --json --out "$scratch/json" >"$scratch/said.json" \
  2>"$scratch/output" || complain "terrain as JSON: exit code $?"
cmp "$scratch/said.json" "$scratch/json/terrain.json" || complain "--json: not terrain.json"
# A log that was cut in the midst of a message, as a disk was full.
for options in "" --drive --close-loops; do
  head -c -1000 "$drive" >"$scratch/cut.lcmlog"
  # shellcheck disable=SC2086 # none or one
  accepts "a log that was cut $options" "$bin/rgbdt" map "$scratch/cut.lcmlog" $options \
    --out "$scratch/cut/map.ply"
  [ "$(grep -c 'bytes belong to no whole message' "$scratch/output")" = 1 ] ||
    complain "a log that was cut $options: it is not said, or twice"
done
# There and back: the way ends 1 m beside where it began, looking back.
accepts "a loop, not closed" "$bin/rgbdt" map "$scratch/loop.lcmlog" --out "$scratch/drive/loop.ply"
grep -q -- '--close-loops' "$scratch/output" || complain "the way comes back, and nothing is said"
accepts "a loop" "$bin/rgbdt" map "$scratch/loop.lcmlog" --close-loops --out "$scratch/drive/closed.ply"
grep -qE '^[1-9][0-9]* loops closed: the end of the way moved by 0\.[0-9]+ m' "$scratch/output" ||
  complain "loops are not told"
for kind in ply tum png; do
  cmp -s "$scratch/drive/loop.$kind" "$scratch/drive/closed.$kind" && complain "closed, the same $kind"
done
python3 - "$scratch/drive/closed.tum" <<'END' >"$scratch/output" 2>&1 || complain "closed.tum"
import math, sys
lines = [l.split() for l in open(sys.argv[1]) if not l.startswith("#")]
first, last = ([float(v) for v in l[1:4]] for l in (lines[0], lines[-1]))
assert abs(math.dist(first, last) - 1) < 0.05, (first, last)
END
accepts "a loop again" "$bin/rgbdt" map "$scratch/loop.lcmlog" --close-loops --out "$scratch/drive/again.ply"
for kind in ply tum png; do
  cmp "$scratch/drive/closed.$kind" "$scratch/drive/again.$kind" || complain "the same loop, another $kind"
done
# A turned scanner, whose rig stands for a sweep of 3.75 s and drives through two: all of that but the
# last second is in the map.
accepts "a turned scanner" "$bin/rgbdt" map "$scratch/turned.lcmlog" --out "$scratch/turned/map.ply"
grep -q '^3 sweeps, 0 without a place, 0 that' "$scratch/output" || complain "a turned scanner's sweeps"
points=$(sed -nE 's/^[0-9]+ clouds, ([0-9]+) points.*/\1/p' "$scratch/output")
{ [ "$points" -gt 95000 ] && [ "$points" -lt 108000 ]; } || complain "$points points of a turned scanner"
says=("no POSE" "0 sweeps")
refuses "a drive without sweeps" "$bin/rgbdt" map "$log" --drive --out "$scratch/kept/map.ply"

accepts "terrain" "$bin/rgbdt" terrain "$scratch/kept/map.ply" --out "$scratch/kept/terrain"
grep -qE '^ +1 ' "$scratch/output" || complain "no site in the table"
[ -s "$scratch/kept/terrain/terrain.png" ] || complain "no picture"
python3 - "$scratch/kept/terrain/terrain.json" <<'END' >"$scratch/output" 2>&1 || complain "terrain.json"
import json, math, sys
terrain = json.load(open(sys.argv[1]))
grid, sites = terrain["grid"], terrain["sites"]
cells = grid["columns"] * grid["rows"]
for name in ("state", "height_m", "slope_deg", "roughness_m", "step_m", "temperature_k", "points"):
    assert len(grid[name]) == cells, name
def state(x, y):
    column = int((x - grid["origin_x_m"]) / grid["cell_m"])
    row = int((y - grid["origin_y_m"]) / grid["cell_m"])
    return grid["states"][grid["state"][row * grid["columns"] + column]]
assert state(3.05, 0.05) == "obstacle", state(3.05, 0.05)
assert state(6.05, 2.05) == "traversable", state(6.05, 2.05)
assert sites and sites[0]["rank"] == 1 and sites[0]["radius_m"] >= 1
assert all(math.hypot(s["x_m"] - 3, s["y_m"]) > s["radius_m"] + 0.3 for s in sites)
assert abs(sites[0]["temperature_c"] - 26.85) < 0.1, sites[0]
END

for verb in map terrain; do
  accepts "help of $verb" "$bin/rgbdt" "$verb" --help
  grep -q 'Example: rgbdt' "$scratch/output" || complain "$verb --help has no example"
  says=("nowhere")
  refuses "a missing file ($verb)" "$bin/rgbdt" "$verb" "$scratch/nowhere" --out "$scratch/kept/x"
  head -c 100000 /dev/urandom >"$scratch/noise"
  says=("noise")
  refuses "noise ($verb)" "$bin/rgbdt" "$verb" "$scratch/noise" --out "$scratch/kept/x"
done
says=("RGBDT_CLOUD" "record")
refuses "a log without fused clouds" "$bin/rgbdt" map "$scratch/other.lcmlog" --out "$scratch/kept/map.ply"
for end in png tum; do
  says=("written beside it" ".ply")
  refuses "a map called .$end" "$bin/rgbdt" map "$log" --out "$scratch/kept/map.$end"
done
says=("voxel_m" "-1")
refuses "a negative voxel" "$bin/rgbdt" map "$log" --voxel -1 --out "$scratch/kept/map.ply"
says=("cell_m")
refuses "a cell of nothing" "$bin/rgbdt" terrain "$scratch/kept/map.ply" --cell 0 --out "$scratch/kept"
head -c 1000 "$scratch/kept/map.ply" >"$scratch/short.ply"
says=("short.ply" "cut short")
refuses "a truncated map" "$bin/rgbdt" terrain "$scratch/short.ply" --out "$scratch/kept"

verdict
