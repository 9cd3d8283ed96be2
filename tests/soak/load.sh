#!/usr/bin/env bash
# The processes of a rig under soak_rig's load, steady and then overloaded: what they take, what they
# lose, how soon they are back. Leaves CSV files in DIR, which soak.py reads. Run by
# scripts/in-namespace.
# Usage: load.sh BIN_DIR DIR LOAD STEADY_SECONDS [HELD_SECONDS STOPPED_SECONDS SETTLE_SECONDS]
#   LOAD     of what a large rig publishes (soak_rig.cc)
#   HELD     for so long the handlers of fuser and detector then do nothing; 0: no overload
#   STOPPED  and for so long the kernel runs neither, afterwards
#   SETTLE   time after each, to see them recover
# RGBDT_RECEIVE_BUFFER: bytes of the sockets' receive buffers, in place of the bus' own
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

out=$2
load=$3
steady=$4
held=${5:-0}
stopped=${6:-0}
settle=${7:-0}
processes=(detector solver fuser viewer)
[ -z "${RGBDT_RECEIVE_BUFFER-}" ] ||
  export LCM_DEFAULT_URL="${LCM_DEFAULT_URL%recv_buf_size=*}recv_buf_size=$RGBDT_RECEIVE_BUFFER"

page_kb=$(($(getconf PAGESIZE) / 1024))

# Into memory.csv once a second, for so many seconds; by the shell alone, as others want the machine.
watch() {  # SECONDS
  local name end now pages descriptors
  end=$((SECONDS + $1))
  while [ "$SECONDS" -lt "$end" ]; do
    for name in "${processes[@]}"; do
      read -r now _ </proc/uptime
      read -r _ pages _ <"/proc/${pids[$name]}/statm" || fail "$name is gone"
      [ "$pages" -gt 0 ] || fail "$name has ended"
      descriptors=("/proc/${pids[$name]}/fd/"*)
      echo "$now,$name,$((pages * page_kb)),${#descriptors[@]}" >>"$out/memory.csv"
    done
    kill -0 "${pids[rig]}" 2>/dev/null || fail "soak_rig is gone"
    [ ! -t 1 ] || printf '\r%4d s to go ' $((end - SECONDS))
    sleep 1
  done
  [ ! -t 1 ] || printf '\r\033[K'
}

overload() {  # handler|process SECONDS
  echo "overload: $1 of fuser and detector, for $2 s"
  local span
  span=$(python3 "$here/pause.py" "$1" "$2" "${pids[fuser]}" "${pids[detector]}") ||
    fail "the overload could not be made"
  echo "$1,$span" >>"$out/overloads.csv"
  watch "$settle"
}

mkdir -p "$out"
rm -f "$out"/*.csv
echo "second,process,rss_kb,descriptors" >"$out/memory.csv"
echo "what,begin,end" >"$out/overloads.csv"
for name in detector solver fuser; do start "$name" "$bin/rgbdt-$name"; done
start viewer "$bin/rgbdt-viewer" --listen 127.0.0.1:0
# Longer than needed: it is told when to end. It gives the processes a minute to come up.
start rig "$bin/soak_rig" $((steady + held + stopped + 2 * settle + 600)) "$load" "$out" "${processes[@]}"
waited=0
until grep -qsx begun "$scratch/rig.log"; do
  kill -0 "${pids[rig]}" 2>/dev/null || fail "no load: $(tail -n 1 "$scratch/rig.log")"
  waited=$((waited + 1))
  [ "$waited" -lt 1800 ] || fail "no load within 90 s"
  sleep 0.05
done
echo "$load of the load, for $steady s"
watch "$steady"
if [ "$held" != 0 ]; then
  overload handler "$held"
  overload process "$stopped"
fi
stop TERM rig  # it listens to the others' last words
stop TERM "${processes[@]}"
