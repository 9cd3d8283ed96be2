#!/usr/bin/env bash
# One rig file that names hosts, one command on each of them: rgbdt up runs there what is that
# machine's, and a session that the page leads goes over all of them; one keeps a log of it (of which a
# busy network may lose some: lcm-logger asks for nothing again). Run by scripts/in-namespace. Usage: up_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
# shellcheck source=tests/hosts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

can_have_hosts || {
  echo "SKIPPED: no bridges or no nftables in a namespace here"
  exit 77
}

up_at() { start_at "$1" "up-$1" "$bin/rgbdt" up "$scratch/hosts.textproto" --out "$scratch/$1"; }  # HOST

ask() { at desk "$bin/live_helper" ask "$1" || fail "$2"; }

make_hosts 1500 sensor compute desk

echo "== a machine that the rig does not name, and a process that is nobody's"
start_at sensor simulator "$bin/rgbdt-simulator" --speed 4 --rig "$scratch/rig.textproto"
at sensor "$bin/live_helper" ready simulator || fail "no simulator"
{
  cat "$scratch/rig.textproto"
  echo 'host { name: "compute" runs: ["assembler", "detector", "solver", "fuser", "session"] }'
  echo 'host { name: "desk" runs: ["logger", "viewer"] }'
} >"$scratch/hosts.textproto"
refused() {  # FILE WORDS: what the sensors' host is told
  at sensor timeout 60 "$bin/rgbdt" up "$1" --out "$scratch/refused" >"$scratch/refused.log" 2>&1 &&
    fail "it was not refused"
  grep -q "$2" "$scratch/refused.log" || fail "it does not say: $2: $(cat "$scratch/refused.log")"
}
refused "$scratch/hosts.textproto" 'this machine is "sensor", and the rig'"'"'s hosts are compute, desk'
sed 's/, "session"//' "$scratch/hosts.textproto" >"$scratch/nobodys.textproto"
refused "$scratch/nobodys.textproto" 'no host runs session'

echo "== a session over three machines"
up_at compute
up_at desk
at desk "$bin/live_helper" ready assembler detector solver fuser session viewer up-compute up-desk ||
  fail "not every process came up"
for process in assembler detector solver fuser session; do
  grep -q "^$process: started" "$scratch/up-compute.log" || fail "$process is not compute's"
  ! grep -q "^$process: started" "$scratch/up-desk.log" || fail "$process is desk's, too"
done
ask next_pose "no pose"
for _ in 1 2 3; do
  ask capture "no view"
  ask next_pose "no pose"
done
ask capture "no view"
ask finish "it was not saved"
[ -s "$scratch/compute/calibration.textproto" ] || fail "no calibration"
stop INT up-desk
stop INT up-compute
stop TERM simulator
[ -s "$scratch/desk.lcmlog.00" ] || fail "desk kept no log"
for channel in RIG CLOUD SESSION_EVENT STATUS; do
  grep -aq "$channel" "$scratch/desk.lcmlog.00" || fail "the log has no $channel"
done
echo "passed"
