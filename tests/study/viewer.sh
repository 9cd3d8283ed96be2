#!/usr/bin/env bash
# How soon the bus is on the screen, how fast the cloud is drawn, and what browsers cost the bus and
# the machine. Leaves screen.csv, orbit.csv, idle.csv and the latencies in OUT. Run by
# scripts/in-namespace, called by scripts/study. Usage: viewer.sh BIN_DIR BUILD_DIR OUT SECONDS
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../browser/common.sh"

out=$3
seconds=$4
study=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export RGBDT_TEST=viewer RGBDT_SCREENSHOTS=$out
# sweeps a second, points, messages a sweep, images a second: the simulated scanner, a line of 400
# beams 25 times a second; the same four times as fast, as scripts/demo has it; a spinning LIDAR
declare -A rates=([scanner]="0.083333 120000 300 1" [demo]="0.333333 120000 300 4" [sweeps]="5 100000 10 5")

page() { node "$study/viewer.mjs" "$@" >"$scratch/page.log" 2>&1 || fail "viewer.mjs $1"; }

start_stream() {  # WHICH
  start fuser "$bin/rgbdt-fuser"
 # shellcheck disable=SC2086 # four words
  start stream "$bin/browser_helper" stream ${rates[$1]}
  helper ready fuser || fail "rgbdt-fuser did not come up"
}

stop_stream() {
  kill "${pids[stream]}"
  wait_for stream || true
  stop TERM fuser
}

cpu_seconds() {  # PID: user and system time so far
  awk -v hz="$(getconf CLK_TCK)" '{ print ($14 + $15) / hz }' "/proc/$1/stat"
}

for which in scanner sweeps; do
  start_stream "$which"
  start_viewer
  page screen "$which" "$seconds" "$out/screen-$which.csv"
  stop_stream
  stop TERM viewer
done

start_stream sweeps
start_viewer
page orbit "${pids[stream]}" "$seconds" "$out/orbit.csv"
kill -CONT "${pids[stream]}"
stop_stream
stop TERM viewer

start_stream demo
start_viewer
helper hears RGBDT_SWEEP 1 >/dev/null || fail "no sweep came"
before=$(cpu_seconds "${pids[viewer]}")
sleep "$seconds"  # the time that is measured
after=$(cpu_seconds "${pids[viewer]}")
awk -v a="$before" -v b="$after" -v s="$seconds" 'BEGIN { print "cpu_percent"; print 100 * (b - a) / s }' >"$out/idle.csv"
stop_stream
stop TERM viewer

# Both ways in turn, so that a busy moment of the machine does not tell one from the other.
start_viewer
for round in 1 2; do
  bash "$study/../bench/latency.sh" "$bin" "$seconds" "$out/latency-none-$round.csv" \
    "$scratch/memory.csv" >"$scratch/latency.log" 2>&1 || fail "bench_latency without a browser"
  start stalled node "$study/viewer.mjs" stall
  wait_for_line stalled '^stalled' >/dev/null
  bash "$study/../bench/latency.sh" "$bin" "$seconds" "$out/latency-stalled-$round.csv" \
    "$scratch/memory.csv" >"$scratch/latency.log" 2>&1 || fail "bench_latency with a stalled browser"
  kill -TERM "${pids[stalled]}"
  wait_for stalled || true
done
stop TERM viewer
