#!/usr/bin/env bash
# What goes wrong between machines is told: a clock that is off, with its host and by how much; two
# programs on one channel; a bus that does not leave its machine. Run by scripts/in-namespace.
# Usage: told_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
# shellcheck source=tests/hosts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

can_have_hosts || {
  echo "SKIPPED: no bridges or no nftables in a namespace here"
  exit 77
}

told() {  # PROCESS EXPRESSION: within a minute
  local _
  for _ in $(seq 600); do
    if grep -Em 1 "$2" "$scratch/$1.log"; then return; fi
    sleep 0.1
  done
  fail "$1 does not say: $2"
}

make_hosts 1500 compute sensor viewer

echo "== a clock that is off"
faked=$(find /usr/lib -name libfaketime.so.1 -print -quit)
if [ -n "$faked" ]; then
  start_at compute solver "$bin/rgbdt-solver"
  start_at viewer fuser "$bin/rgbdt-fuser"
  start_at sensor detector env "LD_PRELOAD=$faked" FAKETIME=-0.2s DONT_FAKE_MONOTONIC=1 \
    "$bin/rgbdt-detector"
  told solver "the clock of host sensor \(10\.78\.0\.2\) is 0\.(19|2[0-4]) s behind the others'"
  kill_process detector
  start_at sensor assembler env "LD_PRELOAD=$faked" FAKETIME=+10s DONT_FAKE_MONOTONIC=1 \
    "$bin/rgbdt-assembler"
  told fuser "the clock of host sensor \(10\.78\.0\.2\) is (9\.9[5-9]|10\.0[0-2]) s ahead of the others'"
  if grep -E 'clock of host (compute|viewer)' "$scratch"/{solver,fuser,detector,assembler}.log; then
    fail "a clock that is right was taken for one that is off"
  fi
  for process in assembler solver fuser; do kill_process "$process"; done
else
  echo "libfaketime is not installed: passed over"
fi

echo "== two programs on one channel, of two machines"
start_at compute detector "$bin/rgbdt-detector"
start_at sensor simulator "$bin/rgbdt-simulator" --rig "$scratch/rig.textproto"
at compute "$bin/live_helper" ready detector simulator || fail "not every process came up"
start_at sensor first "$bin/live_helper" speaks 0
start_at viewer second "$bin/live_helper" speaks 100000
told detector 'RIG: its numbers fell back [0-9]+ times in 10 s: two programs send on this channel'
for process in first second; do kill_process "$process"; done

echo "== a bus that does not leave its machine"
echo 'step { sweep {} } step { capture {} }' >"$scratch/session.textproto"
start_at compute session env "LCM_DEFAULT_URL=${LCM_DEFAULT_URL/ttl=1/ttl=0}" "$bin/rgbdt-session" \
  "$scratch/session.textproto" --rig "$scratch/rig.textproto" --out "$scratch/session"
code=0
wait_for session || code=$?
[ "$code" = 1 ] || fail "the session ended with exit code $code"
told session 'rgbdt-fuser \(not heard\)'
told session 'stays on this machine .*ttl=0.*are heard with ttl=1'
echo "passed"
