# shellcheck shell=bash
# Sourced: devices in network namespaces of their own, behind cables. `fail` comes from the caller.

namespaces=()

unplug_all() {
  local name
  for name in "${namespaces[@]}"; do ip netns delete "$name" 2>/dev/null || true; done
}

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
