#!/usr/bin/env bash
# A session that a person leads, on a disk that is full when it is to be saved: the page hears of it,
# the views stay, and once there is room finish may be asked for again. Run by scripts/in-namespace.
# Usage: full_disk_test.sh BIN_DIR
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

mkdir "$disk"
mount -t tmpfs -o size=256m tmpfs "$disk" || fail "no tmpfs"
trap 'umount --lazy "$disk"; clean_up' EXIT
for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
start simulator "$bin/rgbdt-simulator" --speed 6 --rig "$scratch/rig.textproto"
helper ready "${services[@]}" simulator || fail "not every process came up"
start session "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
for _ in 1 2 3 4; do
  helper ask next_pose || fail "no pose"
  helper ask capture || fail "no view"
done
find "$session/views" -type f -exec cksum {} + | sort >"$scratch/views"

echo "== finish, on a full disk"
dd if=/dev/zero of="$disk/filler" bs=4k 2>/dev/null || true
code=0
helper ask finish >"$scratch/answer" || code=$?
cat "$scratch/answer"
[ "$code" = 3 ] || fail "the session did not say that it failed"
grep -q "save.*No space left on device" "$scratch/answer" || fail "the reason is missing"
kill -0 "${pids[session]}" || fail "the session ended"
find "$session/views" -type f -exec cksum {} + | sort | cmp - "$scratch/views" ||
  fail "the views are not what they were"
[ ! -e "$session/calibration.textproto" ] || fail "half of the results were written"

echo "== and once there is room"
rm "$disk/filler"
helper ask finish || fail "finish could not be repeated"
wait_for session || fail "the session ended with exit code $?"
for file in calibration.textproto report.json; do
  [ -s "$session/$file" ] || fail "$file was not saved"
done
stop TERM "${services[@]}" simulator
echo "passed"
