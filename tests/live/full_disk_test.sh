#!/usr/bin/env bash
# A disk that is full when a view is to be taken (which is refused), while it is taken (it stays in
# memory until there is room), and when the session is to be saved: the page, or the terminal, hears
# of it, the views stay, and once there is room the session goes on. One that a person leads and one
# by a script. Run by scripts/in-namespace. Usage: full_disk_test.sh BIN_DIR
set -euo pipefail
if [ -z "${RGBDT_IN_MOUNTS-}" ]; then
  export RGBDT_IN_MOUNTS=1
  if unshare --mount true 2>/dev/null; then exec unshare --mount "$0" "$@"; fi
  echo "skipped: no mount namespace may be made here"
  exit 77
fi
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

disk=$scratch/disk
session=$disk/session

size() { mount -o "remount,size=$1" "$disk" || fail "no tmpfs of $1"; }
fill() { size "$(df --output=used -k "$disk" | tail -n 1 | tr -d ' ')k"; }
make_room() { size 512m; }

says() {  # SESSION TEXT: waits until its output has it
  until grep -q -- "$2" "$scratch/$1.log"; do
    kill -0 "${pids[$1]}" || fail "the session ended before it said: $2"
    sleep 0.02
  done
}

mkdir "$disk"
mount -t tmpfs -o size=512m tmpfs "$disk" || fail "no tmpfs"
trap 'umount --lazy "$disk"; clean_up' EXIT
for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
start simulator "$bin/rgbdt-simulator" --speed 6 --rig "$scratch/rig.textproto"
helper ready "${services[@]}" simulator || fail "not every process came up"
start session "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
for _ in 1 2 3; do
  helper ask next_pose || fail "no pose"
  helper ask capture || fail "no view"
done

echo "== a capture on a full disk"
fill
helper ask next_pose || fail "no pose"
code=0
helper ask capture >"$scratch/answer" || code=$?
cat "$scratch/answer"
[ "$code" = 3 ] || fail "the capture was not refused"
grep -q "no view is taken: .*make room" "$scratch/answer" || fail "the reason is missing"
[ ! -e "$session/views/0004" ] || fail "the view was taken"

echo "== a disk that fills up while a view is taken"
make_room
helper ask capture >"$scratch/answer" &
asked=$!
says session "view 0004: asked for a sweep"
fill
says session "view 0004 is kept in memory: .*No space left on device"
[ ! -e "$session/views/0004" ] || fail "half of the view was written"
make_room
wait "$asked" || fail "the view was lost: $(cat "$scratch/answer")"
[ -s "$session/views/0004/view.textproto" ] || fail "the view is not on disk"
[ -s "$session/views/0004/detection.lcm" ] || fail "its detection is not on disk"
find "$session/views" -type f -exec cksum {} + | sort >"$scratch/views"

echo "== finish, on a full disk"
fill
code=0
helper ask finish >"$scratch/answer" || code=$?
cat "$scratch/answer"
[ "$code" = 3 ] || fail "the session did not say that it failed"
grep -q "save.*No space left on device.*rgbdt calibrate $session" "$scratch/answer" ||
  fail "the reason is missing"
kill -0 "${pids[session]}" || fail "the session ended"
find "$session/views" -type f -exec cksum {} + | sort | cmp - "$scratch/views" ||
  fail "the views are not what they were"
[ ! -e "$session/calibration.textproto" ] || fail "half of the results were written"

echo "== and once there is room"
make_room
helper ask finish || fail "finish could not be repeated"
wait_for session || fail "the session ended with exit code $?"
for file in calibration.textproto report.json; do
  [ -s "$session/$file" ] || fail "$file was not saved"
done

echo "== by a script"
{
  for _ in 1 2 3 4; do
    echo 'step { next_pose {} }' 'step { sweep {} }' 'step { capture {} }'
  done
  echo 'step { solve {} }' 'step { evaluate {} }' 'step { save {} }'
} >"$scratch/session.textproto"
session=$disk/scripted
start scripted "$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto" \
  --out "$session"
says scripted "view 0002: asked for a sweep"
fill
says scripted "view 0002 is kept in memory: .*No space left on device"
make_room
says scripted "what was kept in memory is on disk"
wait_for scripted || fail "the session ended with exit code $?"
[ "$(find "$session/views" -name view.textproto | wc -l)" = 4 ] || fail "not every view is there"
[ -s "$session/calibration.textproto" ] || fail "nothing was saved"
stop TERM "${services[@]}" simulator
echo "passed"
