#!/usr/bin/env bash
# A session over several machines whose links lose datagrams: it ends well, its calibration is that
# of a session without loss, to the bit, and every datagram that was lost is in the STATUS counters.
# Run by scripts/in-namespace.
# Usage: hosts_test.sh BIN_DIR [PERMILLE [MTU [VIEWS [CUT_SECONDS]]]]
#   PERMILLE     of the datagrams on the way to each host are lost (10)
#   MTU          of the network (1500)
#   VIEWS        of the session (4)
#   CUT_SECONDS  the sensors' host is cut off for so long in the second view's sweep (0: it is not)
# RGBDT_HOSTS=4: sensor, compute, log and viewer; else sensor and compute.
# RGBDT_FIGURES=FILE: figures as lines "NAME VALUE UNIT".
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
# shellcheck source=tests/hosts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

permille=${2:-10}
mtu=${3:-1500}
views=${4:-4}
cut_seconds=${5:-0}
speed=4
hosts=(sensor compute)
log_host=compute
[ "${RGBDT_HOSTS-2}" = 4 ] && hosts+=(log viewer) log_host=log

can_have_hosts || {
  echo "SKIPPED: no bridges or no nftables in a namespace here"
  exit 77
}

begin() {  # NAME
  local process
  folder=$scratch/$1
  start_at sensor simulator "$bin/rgbdt-simulator" \
    --speed "$speed" --rig "$scratch/rig.textproto"
  for process in "${services[@]}"; do
    start_at compute "$process" "$bin/rgbdt-$process"
  done
  if [ "$log_host" = log ]; then
    start_at viewer viewer "$bin/rgbdt-viewer" \
      --listen 127.0.0.1:0
  fi
  at compute "$bin/live_helper" ready "${services[@]}" simulator || fail "not every process came up"
}

lead_session() {
  began=$(now_ms)
  bytes_before=$(all_bytes)
  start_at "$log_host" session "$bin/rgbdt-session" \
    "$scratch/session.textproto" --rig "$scratch/rig.textproto" --out "$folder"
}

await_session() {
  wait_for session || fail "the session ended with exit code $?: $(tail -n 1 "$scratch/session.log")"
  took_ms=$(($(now_ms) - began))
  bytes=$(($(all_bytes) - bytes_before))
}

all_bytes() {
  local name sum=0
  for name in "${hosts[@]}"; do sum=$((sum + $(sent_bytes "$name"))); done
  echo "$sum"
}

end() {
  sleep 2.5  # a Beat of each sender, and a STATUS
  stop TERM "${services[@]}" simulator
  if [ "$log_host" = log ]; then stop TERM viewer; fi
}

make_hosts "$mtu" "${hosts[@]}"
session_script "$views" 3 >"$scratch/session.textproto"

echo "== ${#hosts[@]} hosts, MTU $mtu, nothing lost"
begin undisturbed
lead_session
await_session
end
lost=$(last_count assembler 'datagrams lost')
[ "${lost:-0}" = 0 ] || echo "note: $lost datagrams were lost by a busy machine"
echo "the session took $took_ms ms"
figure hosts_mbit_s "$((bytes * 8 / took_ms / 1000))" Mbit/s

echo "== $permille in 1000 datagrams are lost on the way to each host"
begin lossy
[ "$permille" = 0 ] || lose "$permille" "${hosts[@]}"
lead_session
if [ "$cut_seconds" != 0 ]; then
  until grep -qs 'view 0002: asked for a sweep' "$scratch/session.log"; do
    kill -0 "${pids[session]}" || fail "the session ended before its second view"
    sleep 0.05
  done
  cut_off sensor
  sleep "$cut_seconds"
  plug_in sensor
fi
await_session
true_loss=$(dropped compute)
lose_nothing_more
end
grep -h 'datagrams lost' "$scratch"/{assembler,detector,simulator}.log | tail -n 3 || true
figure session_s "$((took_ms / 1000))" s
grep -hE 'cut off|again|loses|clock' "$scratch"/{session,detector,assembler}.log || true
for view in $(seq -f %04.0f "$views"); do
  [ -s "$folder/views/$view/view.textproto" ] || fail "view $view is missing"
done
if [ "$cut_seconds" = 0 ]; then
  cmp "$scratch/undisturbed/calibration.textproto" "$folder/calibration.textproto" ||
    fail "the calibration is not what it is without loss"
  if [ "$permille" != 0 ]; then
    counted=$(last_count assembler 'datagrams lost')
    echo "lost on the way to compute: $true_loss; its assembler counts ${counted:-0}"
    figure losses_counted_share "$(awk -v t="$true_loss" -v c="${counted:-0}" \
      'BEGIN { d = t > c ? t - c : c - t; printf "%.5f", (t > 0 ? 1 - d / t : 0) }')" 1
    awk -v t="$true_loss" -v c="${counted:-0}" \
      'BEGIN { d = t > c ? t - c : c - t; exit !(t > 0 && d <= 0.001 * t) }' ||
      fail "losses are not counted: $true_loss, ${counted:-0}"
    [ "$(last_count assembler 'messages given up')" = '' ] || fail "messages were given up"
  fi
else
  grep 'was cut off for' "$scratch/session.log" || fail "that a host was cut off was not told"
  "$bin/rgbdt" compare "$scratch/undisturbed" "$folder" || fail "the calibrations contradict each other"
fi
echo "passed"
