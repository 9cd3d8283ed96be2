#!/usr/bin/env bash
# A session over two machines, each on a network of its own, with a relay between them that hands
# datagrams over late, so out of order, and some of them twice: it ends well, no message is missing,
# come twice or out of order, none is taken for lost, and the calibration is that of one network, to
# the bit. Run by scripts/in-namespace.
# Usage: relay_test.sh BIN_DIR [PERMILLE_TWICE [MOST_LATE_MS [VIEWS]]]; RGBDT_SEED: of the relay (1)
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
# shellcheck source=tests/hosts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

permille=${2:-50}
late_ms=${3:-40}
views=${4:-4}

can_have_hosts || {
  echo "SKIPPED: no bridges or no nftables in a namespace here"
  exit 77
}

begin() {  # NAME
  local process
  start_at sensor simulator "$bin/rgbdt-simulator" --speed 4 --rig "$scratch/rig.textproto"
  for process in "${services[@]}"; do start_at compute "$process" "$bin/rgbdt-$process"; done
  at compute "$bin/live_helper" ready "${services[@]}" simulator || fail "not every process came up"
  start_at compute session "$bin/rgbdt-session" "$scratch/session.textproto" \
    --rig "$scratch/rig.textproto" --out "$scratch/$1"
}

end() {
  wait_for session || fail "the session ended with exit code $?: $(tail -n 1 "$scratch/session.log")"
  sleep 2.5  # a Beat of each sender, and a STATUS
  stop TERM "${services[@]}" simulator
}

relayed() { sed -n "s/^$1 //p" "$scratch/relay.log"; }

make_hosts 1500 sensor compute
session_script "$views" 3 >"$scratch/session.textproto"

echo "== one network"
begin undisturbed
end

echo "== two networks, and a relay: up to $late_ms ms late, $permille in 1000 twice"
for host in sensor compute; do
  cut_off "$host"
  # Beside the host's own address, to which this is the way.
  address=$(at "$host" ip -4 -o address show eth0 | sed 's|.* inet \([0-9.]*\)/.*|\1|')
  ip address add "${address%.*}.10${address##*.}" peer "$address/32" dev "$host"
done
start relay python3 "$(dirname "${BASH_SOURCE[0]}")/relay.py" sensor compute "${RGBDT_SEED:-1}" \
  "$permille" "$late_ms"
until grep -qs ready "$scratch/relay.log"; do
  kill -0 "${pids[relay]}" || fail "the relay ended"
  sleep 0.05
done
begin relayed
end
stop TERM relay

came=$(relayed came) twice=$(relayed twice) overtaken=$(relayed overtaken)
echo "the relay handed over $came datagrams, $twice of them twice, $overtaken after later ones"
if [ $((2000 * twice)) -lt $((came * permille)) ] || [ $((2 * overtaken)) -lt "$came" ]; then
  fail "the relay disturbed less than it was to"
fi
grep -h ': stopped;' "$scratch"/{assembler,detector,solver,fuser,simulator}.log
if [ "$(relayed behind)" -gt 1000 ]; then  # after 2.4 s what is missing is given up
  echo "note: a busy machine, the relay was $(relayed behind) ms late itself: counters are not looked at"
else
  for process in "${services[@]}" simulator; do
    [ "$(last_count "$process" gaps)" = 0 ] || fail "$process misses messages"
    for counter in late duplicates restarts 'datagrams lost' 'messages given up' malformed; do
      [ "$(last_count "$process" "$counter")" = '' ] || fail "$process counts: $counter"
    done
  done
fi
for view in $(seq -f %04.0f "$views"); do
  [ -s "$scratch/relayed/views/$view/view.textproto" ] || fail "view $view is missing"
done
if grep 'taken again' "$scratch/session.log"; then
  "$bin/rgbdt" compare "$scratch/undisturbed" "$scratch/relayed" ||
    fail "the calibrations contradict each other"
else
  cmp "$scratch/undisturbed/calibration.textproto" "$scratch/relayed/calibration.textproto" ||
    fail "the calibration is not what it is on one network"
fi
echo "passed"
