#!/usr/bin/env bash
# rgbdt sync live: what a log says of a waved board it says as it is played, too; without a sweep it
# gives up, and keeps what it had. Run by scripts/in-namespace. Usage: sync_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$bin/sync_test_log" "$scratch/wave.lcmlog" "$scratch/other.lcmlog" "$scratch/calibration.textproto"
"$bin/rgbdt" sync "$scratch/wave.lcmlog" --calibration "$scratch/calibration.textproto" \
  --out "$scratch/file" >"$scratch/file.log" 2>&1 || fail "the log tells no offset"

echo "== as it is played"
start live "$bin/rgbdt" sync live --seconds 14 --calibration "$scratch/calibration.textproto" \
  --out "$scratch/live"
for _ in $(seq 100); do
  ! grep -q 'waiting for a sweep' "$scratch/live.log" || break
  sleep 0.1
done
# So slowly that there is time to say what it knows so far, on a busy machine, too.
lcm-logplayer --speed=0.35 "$scratch/wave.lcmlog" >"$scratch/player.log" 2>&1
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

echo "== nobody speaks"
code=0
"$bin/rgbdt" sync live --out "$scratch/silent" >"$scratch/silent.log" 2>&1 || code=$?
[ "$code" = 1 ] || fail "without a sweep: exit code $code"
grep -q 'no sweep on the bus in 10 s' "$scratch/silent.log" || fail "it does not say what is missing"
[ -z "$(ls "$scratch/silent")" ] || fail "it left something behind"
echo "passed"
