#!/usr/bin/env bash
# Flags, scripts and folders that make no sense. Usage: bad_flags_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

mkdir "$scratch/kept"
accepts "a session of one view" "$bin/rgbdt" simulate "$scratch/good" --views 1
good=$scratch/good

misuses "no verb" "$bin/rgbdt"
says=("frobnicate")
misuses "an unknown verb" "$bin/rgbdt" frobnicate
says=("--colour")
misuses "an unknown flag" "$bin/rgbdt" calibrate "$good" --colour
says=("verb" "--help")
misuses "flags only" "$bin/rgbdt" --frob
says=("--seed" "-1" "less than 0")
misuses "a seed below zero" "$bin/rgbdt" simulate "$scratch/new" --seed -1
says=("--out")
misuses "two sessions and no folder" "$bin/rgbdt" calibrate "$good" "$good"
says=("two")
misuses "one calibration" "$bin/rgbdt" compare "$good"
says=("DIR")
misuses "no directory" "$bin/rgbdt" calibrate
says=("magic" "paper")
misuses "an unknown method" "$bin/rgbdt" calibrate "$good" --method magic --out "$scratch/kept"
says=("--views" "0")
misuses "no views at all" "$bin/rgbdt" simulate "$scratch/new" --views 0
says=("--seconds" "live")
misuses "a log that is read for some seconds" "$bin/rgbdt" sync "$scratch/log" --seconds 5
says=("--scene" "moon")
misuses "an unknown scene" "$bin/rgbdt" simulate "$scratch/new" --scene moon
says=("--lidar" "moon")
misuses "an unknown LIDAR" "$bin/rgbdt" simulate "$scratch/new" --lidar moon
says=("front" "rgb" "thermal")
refuses "picks for a camera that is not there" "$bin/rgbdt" simulate "$scratch/new" --picked front
mkdir "$scratch/out"
echo "what an earlier run found" >"$scratch/out/calibration.textproto"
says=("degenerate: only one view" "calibration.textproto was not written")
refuses "too few views" "$bin/rgbdt" calibrate "$good" --out "$scratch/out"
grep -q "an earlier run" "$scratch/out/calibration.previous.textproto" ||
  complain "what an earlier run found was not kept"
[ ! -e "$scratch/out/calibration.textproto" ] || complain "a guess took the place of a calibration"

: >"$scratch/file"
says=("$scratch/file")
refuses "a file in place of a folder" "$bin/rgbdt" calibrate "$good" --out "$scratch/file/out"
if [ "$(id -u)" -ne 0 ]; then
  mkdir "$scratch/locked"
  chmod a-w "$scratch/locked"
  says=("$scratch/locked")
  refuses "a folder that nobody may write" "$bin/rgbdt" calibrate "$good" --out "$scratch/locked"
fi
says=("/proc/rgbdt")
refuses "a file system that takes no files" "$bin/rgbdt" simulate /proc/rgbdt --views 1

for process in assembler detector solver fuser simulator viewer; do
  says=("--colour")
  misuses "an unknown flag of rgbdt-$process" "$bin/rgbdt-$process" --colour
  says=("nonsense://")
  refuses "a bus that is none (rgbdt-$process)" "$bin/rgbdt-$process" --lcm-url nonsense://
done
says=("--speed")
misuses "standing still" "$bin/rgbdt-simulator" --speed 0

says=("--listen" "nonsense" "0.0.0.0:8080")
misuses "no address" "$bin/rgbdt-viewer" --listen nonsense
says=("1.2.3.4.5")
refuses "another that is none" "$bin/rgbdt-viewer" --listen 1.2.3.4.5:0
says=("--run" "which command")
misuses "nothing to run" "$bin/rgbdt-viewer" --run
says=("unexpected" "out/session" "--help")
misuses "a session without --session" "$bin/rgbdt-viewer" out/session
says=("$scratch/nowhere" "rig.textproto")
refuses "a session that is not there" "$bin/rgbdt-viewer" --listen 127.0.0.1:0 --session "$scratch/nowhere"
says=("--session" "--lcm-url")
misuses "files and a bus" "$bin/rgbdt-viewer" --session "$good" --lcm-url udpm://

script=$scratch/session.textproto
run=("$bin/rgbdt-session" "$script" --rig "$good/rig.textproto" --out "$scratch/kept/session")
says=("--rig")
misuses "neither script nor rig" "$bin/rgbdt-session"
says=("--by-hand" "script")
misuses "carried by hand without a script" "$bin/rgbdt-session" --by-hand --rig "$good/rig.textproto"
says=("session.textproto")
refuses "a missing script" "${run[@]}"
printf 'step { next_pose {} }\nstep { frobnicate {} }\n' >"$script"
says=("session.textproto:2" "frobnicate")
refuses "an unknown key in the script" "${run[@]}"
echo 'step { capture {} }' >"$script"
says=("session.textproto" "sweep")
refuses "a capture without a sweep" "${run[@]}"
: >"$script"
says=("session.textproto" "step")
refuses "a script without steps" "${run[@]}"
echo 'step { next_pose {} }' >"$script"
says=("nowhere.textproto")
refuses "a missing rig" "$bin/rgbdt-session" "$script" --rig "$scratch/nowhere.textproto"
mkdir -p "$scratch/kept/session/views/0001"
: >"$scratch/kept/session/views/0001/view.textproto"
says=("kept/session/views" "earlier session")
refuses "another session's views" "${run[@]}"

verdict
