#!/usr/bin/env bash
# A disk that takes nothing, as it is full or read-only, when a session begins or a view is to be
# taken (which is refused), while one is taken (it stays in memory until the disk takes it), and when
# the session is to be saved: the page, or the terminal, hears of it, the views stay, and once the
# disk takes something the session goes on. One that a person leads and one by a script. Run by
# scripts/in-namespace. Usage: full_disk_test.sh BIN_DIR full|read_only
set -euo pipefail
if [ -z "${RGBDT_IN_MOUNTS-}" ]; then
  export RGBDT_IN_MOUNTS=1
  if unshare --mount true 2>/dev/null; then exec unshare --mount "$0" "$@"; fi
  echo "skipped: no mount namespace may be made here"
  exit 77
fi
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

fault=$2
disk=$scratch/disk
session=$disk/session

remount() { mount -o "remount,$1" "$disk" || fail "no tmpfs that is $1"; }
case $fault in
  full)
    reason='No space left on device'
    spoil() { remount "size=$(df --output=used -k "$disk" | tail -n 1 | tr -d ' ')k"; }
    mend() { remount size=512m; }
    ;;
  read_only)
    reason='Read-only file system'
    spoil() { remount ro; }
    mend() { remount rw; }
    ;;
esac

says() {  # SESSION TEXT: waits until its output has it
  until grep -qs -- "$2" "$scratch/$1.log"; do
    kill -0 "${pids[$1]}" || fail "the session ended before it said: $2"
    sleep 0.02
  done
}

checksums() { find "$disk" -type f ! -name asked.lcm -exec cksum {} + | sort; }  # which is no view

is_as_it_was() { checksums | cmp - "$scratch/checksums" || fail "what is there is not what it was"; }

refused() {  # WORDS: a session on the disk, before it is on the bus
  local code=0
  "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session" >"$scratch/refused.log" 2>&1 ||
    code=$?
  cat "$scratch/refused.log"
  [ "$code" = 1 ] || fail "the session ended with exit code $code"
  grep -q "cannot write $session/rig.textproto: $reason" "$scratch/refused.log" ||
    fail "the reason is missing"
}

mkdir "$disk"
mount -t tmpfs -o size=512m tmpfs "$disk" || fail "no tmpfs"
echo "another's" >"$disk/file"  # or it could not be full: of size 0 it has no limit
trap 'umount --lazy "$disk"; clean_up' EXIT
for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
start simulator "$bin/rgbdt-simulator" --speed 6 --rig "$scratch/rig.textproto"
helper ready "${services[@]}" simulator || fail "not every process came up"

echo "== a session begins, on a disk that is ${fault/_/-}"
spoil
refused
[ ! -e "$session" ] || fail "a folder was made"
mend

start session "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
for _ in 1 2 3; do
  helper ask next_pose || fail "no pose"
  helper ask capture || fail "no view"
done

echo "== a capture"
spoil
checksums >"$scratch/checksums"
helper ask next_pose || fail "no pose"
code=0
helper ask capture >"$scratch/answer" || code=$?
cat "$scratch/answer"
[ "$code" = 3 ] || fail "the capture was not refused"
grep -q "no view is taken: .*$reason.*make room" "$scratch/answer" || fail "the reason is missing"
is_as_it_was

echo "== while a view is taken"
mend
helper ask capture >"$scratch/answer" &
asked=$!
says session "view 0004: asked for a sweep"
spoil
says session "view 0004 is kept in memory: .*$reason"
is_as_it_was
mend
wait "$asked" || fail "the view was lost: $(cat "$scratch/answer")"
[ -s "$session/views/0004/view.textproto" ] || fail "the view is not on disk"
[ -s "$session/views/0004/detection.lcm" ] || fail "its detection is not on disk"

echo "== finish"
spoil
checksums >"$scratch/checksums"
code=0
helper ask finish >"$scratch/answer" || code=$?
cat "$scratch/answer"
[ "$code" = 3 ] || fail "the session did not say that it failed"
grep -q "save.*$reason.*rgbdt calibrate $session" "$scratch/answer" || fail "the reason is missing"
kill -0 "${pids[session]}" || fail "the session ended"
is_as_it_was

echo "== and once the disk takes it"
mend
helper ask finish || fail "finish could not be repeated"
wait_for session || fail "the session ended with exit code $?"
for file in calibration.textproto report.json; do
  [ -s "$session/$file" ] || fail "$file was not saved"
done

echo "== by a script"
session_script 4 >"$scratch/session.textproto"
session=$disk/scripted
start scripted "$bin/rgbdt-session" "$scratch/session.textproto" --rig "$scratch/rig.textproto" \
  --out "$session"
says scripted "view 0002: asked for a sweep"
spoil
says scripted "view 0002 is kept in memory: .*$reason"
mend
says scripted "what was kept in memory is on disk"
wait_for scripted || fail "the session ended with exit code $?"
[ "$(find "$session/views" -name view.textproto | wc -l)" = 4 ] || fail "not every view is there"
[ -s "$session/calibration.textproto" ] || fail "nothing was saved"

echo "== told to end while a view is kept in memory"
session=$disk/ended
start ended "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
helper ask next_pose || fail "no pose"
start asked "$bin/live_helper" ask capture
says ended "view 0001: asked for a sweep"
spoil
says ended "view 0001 is kept in memory: .*$reason"
mend
kill -TERM "${pids[ended]}"
wait_for ended || true
[ -s "$session/views/0001/view.textproto" ] || fail "the view is lost, though there was room"
kill_process asked

start lost "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
helper ask next_pose || fail "no pose"
start asked "$bin/live_helper" ask capture
says lost "view 0002: asked for a sweep"
spoil
says lost "view 0002 is kept in memory: .*$reason"
kill -TERM "${pids[lost]}"
wait_for lost || true
grep -q "view 0002 is lost, as it could not be written: .*$reason" "$scratch/lost.log" ||
  fail "it did not say that the view is lost"
kill_process asked
mend
stop TERM "${services[@]}" simulator
echo "passed"
