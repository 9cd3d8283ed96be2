# shellcheck shell=bash
# Sourced by the hardware tests' scripts: cameras in network namespaces of their own, rig files.
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"

helper() { "$bin/hardware_helper" "$@"; }

namespaces=()

clean_up_hardware() {
  clean_up
  local name
  for name in "${namespaces[@]}"; do ip netns delete "$name" 2>/dev/null || true; done
}
trap clean_up_hardware EXIT

# A namespace behind a cable: 10.77.NUMBER.1 here, on cable-NAME; 10.77.NUMBER.2 there.
plug_in() {  # NAME NUMBER MTU
  local name=$1 number=$2 mtu=$3
  local there=rgbdt-$$-$name
  ip netns add "$there" || fail "no network namespace may be made here"
  namespaces+=("$there")
  ip link add "cable-$name" mtu "$mtu" type veth peer name eth0 mtu "$mtu" netns "$there"
  ip address add "10.77.$number.1/24" dev "cable-$name"
  ip link set "cable-$name" up
  ip -n "$there" address add "10.77.$number.2/24" dev eth0
  ip -n "$there" link set lo up
  ip -n "$there" link set eth0 up
}

at() {  # NAME COMMAND...: in that namespace
  local there=rgbdt-$$-$1
  shift
  ip netns exec "$there" "$@"
}

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
