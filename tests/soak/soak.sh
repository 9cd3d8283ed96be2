#!/usr/bin/env bash
# What scripts/soak runs once all is built, and, short, the test soak_load.
# Usage: soak.sh BIN_DIR DIR SECONDS LOAD
#   LOAD  share of a large rig's load (scripts/soak --help), or `auto`: what the machine holds
# RGBDT_FIGURES=FILE: figures as lines "NAME VALUE UNIT".
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
in_namespace=$here/../../scripts/in-namespace
bin=$1
mkdir -p "$2"
out=$(cd "$2" && pwd)
seconds=$3
load=$4
held_extra=2 settle=6 stopped=3 default_seconds=10 rung_seconds=8

judge() { /usr/bin/python3 -B "$here/soak.py" "$@"; }  # Debian's own has matplotlib

rm -rf "$out/run" "$out/default" "$out/rung"
if [ "$load" = auto ]; then
  load=
  for rung in 1 0.7 0.5 0.35 0.25 0.15 0.1; do
    "$in_namespace" "$here/load.sh" "$bin" "$out/rung" "$rung" "$rung_seconds"
    if judge --holds "$out/rung"; then
      load=$rung
      echo "the machine holds $load of the load"
      break
    fi
  done
  if [ -z "$load" ]; then
    echo "FAILED: the machine does not hold a tenth of the load" >&2
    exit 1
  fi
fi
echo "$load" >"$out/load.txt"
# Until the queue of 64 images is full (services/bus/lcm_bus.cc), at 70 of them a second, and longer.
held=$(awk -v load="$load" -v extra="$held_extra" 'BEGIN { printf "%d", 64 / (70 * load) + extra + 1 }')
steady=$((seconds - held - stopped - 2 * settle))
"$in_namespace" "$here/load.sh" "$bin" "$out/run" "$load" "$steady" "$held" "$stopped" "$settle"
echo "the kernel's default receive buffers"
default=$(cat /proc/sys/net/core/rmem_default 2>/dev/null || echo 212992)
RGBDT_RECEIVE_BUFFER=$default "$in_namespace" "$here/load.sh" "$bin" "$out/default" "$load" \
  "$default_seconds"
code=0
judge "$out" >"$out/figures.txt" || code=$?
cat "$out/figures.txt" >>"${RGBDT_FIGURES:-/dev/null}"
cat "$out/table.txt"
[ "$code" = 0 ] || echo "FAILED: figures are out of their bounds" >&2
exit "$code"
