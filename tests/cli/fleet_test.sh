#!/usr/bin/env bash
# Many sessions as jobs: killed in the middle they go on, and end with the same bytes as in one go.
# Usage: fleet_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
fleet=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../scripts/examples/fleet" && pwd)
export RGBDT=$bin/rgbdt

accepts "a session" "$bin/rgbdt" simulate "$scratch/all/a" --views 5 --picked rgb
for name in b c d e; do
  mkdir -p "$scratch/all/$name"
  cp -r "$scratch/all/a/." "$scratch/all/$name"
done
rm -r "$scratch/all/b/views/0002"  # another result
rm "$scratch/all/c/views"/*/*.pcd  # no result
jobs=$scratch/jobs # WORKERS OUT
cat >"$jobs" <<END
ls -d "$scratch/all"/*/ | xargs -P "\$1" -I SESSION "$fleet/calibrate_one" SESSION "\$2"
END
done_in() { find "$1" -mindepth 1 -maxdepth 1 -type d -not -name '.*' | wc -l; }

accepts "all in one go" bash "$jobs" 1 "$scratch/whole"
[ "$(cat "$scratch/whole/a/exit_code")" = 0 ] || complain "a good session: no exit code 0"
[ "$(cat "$scratch/whole/c/exit_code")" = 1 ] || complain "a session without clouds: no exit code 1"
grep -q 'could be read' "$scratch/whole/c/messages.txt" || complain "without clouds: no reason"

# Killed when the first result is there.
set -m
bash "$jobs" 2 "$scratch/cut" >"$scratch/output" 2>&1 &
all=$!
for _ in $(seq 1200); do
  ls "$scratch/cut"/*/exit_code >"$scratch/done" 2>"$scratch/output" && break
  sleep 0.05
done
kill -KILL -- -$all
wait "$all" 2>"$scratch/output" || true
set +m
[ "$(done_in "$scratch/cut")" -lt 5 ] || complain "killed: all were done before"
accepts "gone on with" bash "$jobs" 2 "$scratch/cut"
[ "$(done_in "$scratch/cut")" = 5 ] || complain "gone on with: not all of them"

for run in whole cut; do
  accepts "summary" python3 "$fleet/summary.py" "$scratch/$run"
  cp "$scratch/output" "$scratch/$run.tsv"
done
cmp -s "$scratch/whole.tsv" "$scratch/cut.tsv" || complain "the summaries differ"
[ "$(grep -c CONVERGED "$scratch/cut.tsv")" -ge 4 ] || complain "the summary: too few results"
for name in a b d e; do
  cmp "$scratch/whole/$name/calibration.textproto" "$scratch/cut/$name/calibration.textproto" ||
    complain "$name: another calibration"
done

"$bin/rgbdt" calibrate "$scratch/all/a" --out "$scratch/json" --json >"$scratch/said.json" \
  2>"$scratch/output" || complain "as JSON: exit code $?"
cmp "$scratch/said.json" "$scratch/json/report.json" || complain "--json: not report.json"
verdict
