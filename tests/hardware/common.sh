# shellcheck shell=bash
# Sourced by the hardware tests' scripts: live processes, and devices behind cables.
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
# shellcheck source=tests/hardware/devices.sh
source "$(dirname "${BASH_SOURCE[0]}")/devices.sh"

if ! ip netns add "rgbdt-$$-probe" 2>/dev/null; then
  echo "skipped: no network namespace may be made here; needs root"
  exit 77
fi
ip netns delete "rgbdt-$$-probe"

helper() { "$bin/hardware_helper" "$@"; }

clean_up_hardware() {
  clean_up
  unplug_all
}
trap clean_up_hardware EXIT

start_camera() {  # NAME NUMBER FRAMES: a fake camera at the cable's other end
  local name=$1
  start "device_$name" ip netns exec "rgbdt-$$-$name" "$bin/fake_camera" "10.77.$2.2" "$name-1" "$3"
  local _
  for _ in $(seq 200); do
    grep -q ready "$scratch/device_$name.log" && return
    sleep 0.05
  done
  fail "the fake camera $name does not come up"
}

# How many of the packets that NAME's camera streams are lost on the way; 0: none.
lose() {  # NAME SHARE_OF_10000
  at "$1" nft flush ruleset
  [ "$2" -eq 0 ] && return
  # Port 3956 is where it is controlled: only the stream suffers.
  at "$1" nft -f - <<END_OF_RULES
table inet loss {
  chain out {
    type filter hook output priority 0;
    udp sport 3956 accept
    meta l4proto udp numgen random mod 10000 < $2 drop
  }
}
END_OF_RULES
}
