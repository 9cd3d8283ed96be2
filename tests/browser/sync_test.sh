#!/usr/bin/env bash
# rgbdt sync live and its page: what a log says of a waved board they say as it is played, too, and
# how well the offset is known so far. Run by scripts/in-namespace.
# Usage: sync_test.sh BIN_DIR BUILD_DIR; exit code 77: skipped
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$bin/sync_test_log" "$scratch/wave.lcmlog" "$scratch/other.lcmlog" "$scratch/calibration.textproto"
"$bin/rgbdt" sync "$scratch/wave.lcmlog" --calibration "$scratch/calibration.textproto" \
  --out "$scratch/file" >"$scratch/file.log" 2>&1 || fail "the log tells no offset"

start_viewer
# Once the page is there, and the log so slowly that there is time to say what it knows so far, on a
# busy machine, too.
# shellcheck disable=SC2016 # $1 and $@ are the inner shell's
once='while [ ! -e "$1" ]; do sleep 0.1; done; shift; exec "$@"'
start live sh -c "$once" sh "$scratch/page_open" "$bin/rgbdt" sync live --seconds 22 \
  --calibration "$scratch/calibration.textproto" --out "$scratch/live"
start player sh -c "$once" sh "$scratch/page_waits" lcm-logplayer --speed=0.22 "$scratch/wave.lcmlog"
drive "$scratch/live"
wait_for live || fail "rgbdt sync live ended with exit code $?"
grep -Eq 'wave the board: [1-9][0-9]* s left; [0-9]+ CLOUD, .*[0-9]+ RGB_IMAGE' "$scratch/live.log" ||
  fail "it does not say how far it is"
grep -Eq '[1-9][0-9]* s left; time offsets to \(1 sigma\) rgb [0-9.]+ ms; [0-9]+ CLOUD' "$scratch/live.log" ||
  fail "it does not say how well it knows the offset so far"
offset() {  # FOLDER: of the camera [s], and its sigma
  tr -d '\n' <"$scratch/$1/calibration.textproto" |
    sed -E 's/.*time_offset_s *\{ *value: *([^ ]+) *sigma: *([^ }]+).*/\1 \2/'
}
echo "of the log: $(offset file); live: $(offset live)"
read -r of_file _ <<<"$(offset file)"
read -r of_live sigma <<<"$(offset live)"
awk -v a="$of_file" -v b="$of_live" -v s="$sigma" \
  'BEGIN { d = a > b ? a - b : b - a; exit !(s > 0 && d < 4 * s && d < 0.002) }' ||
  fail "the offsets differ: $of_file, $of_live +- $sigma"
[ -s "$scratch/live/wave.lcmlog" ] || fail "what it heard was not kept"
stop TERM viewer
echo "passed"
