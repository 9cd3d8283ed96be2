#!/usr/bin/env bash
# rgbdt-assembler and rgbdt-fuser on a bus of their own, and bench_latency beside them. Called by
# scripts/bench through scripts/in-namespace.
#   latency.sh BIN SECONDS LATENCY_CSV MEMORY_CSV
set -euo pipefail

bin=$1
pids=()
stop() {
  kill "${pids[@]}" 2>/dev/null || true
  wait "${pids[@]}" 2>/dev/null || true
}
trap stop EXIT

"$bin/rgbdt-assembler" &
pids+=($!)
"$bin/rgbdt-fuser" &
pids+=($!)
"$bin/bench_latency" "$2" "${pids[1]}" "$3" "$4"
