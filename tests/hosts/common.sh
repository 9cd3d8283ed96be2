# shellcheck shell=bash
# Sourced by the tests of several machines, after tests/live/common.sh: hosts, each a network
# namespace with a name of its own, on a bridge within the namespace that scripts/in-namespace made.
# Links that lose datagrams, or are cut. LCM goes by ttl=1.

PATH=$PATH:/usr/sbin:/sbin
group=239.255.76.67
export LCM_DEFAULT_URL="udpm://$group:7667?ttl=1&recv_buf_size=33554432"
declare -A host_pids=()

can_have_hosts() {
  [ "${RGBDT_IN_NAMESPACE-}" = namespace ] && command -v nft >/dev/null &&
    nft add table bridge links 2>/dev/null && ip link add probe type bridge 2>/dev/null &&
    ip link delete probe
}

make_hosts() {  # MTU NAME...: 10.78.0.1, 10.78.0.2, ...
  local mtu=$1 name number=0 namespace
  shift
  ip link add switch mtu "$mtu" type bridge mcast_snooping 0
  ip link set switch up
  nft add chain bridge links forward '{ type filter hook forward priority 0; }'
  for name in "$@"; do
    number=$((number + 1))
    # shellcheck disable=SC2016 # "$1" is the inner shell's
    start "host-$name" unshare --net --uts sh -c 'hostname "$1" && exec sleep 3600' sh "$name"
    # shellcheck disable=SC2154 # of tests/live/common.sh
    host_pids[$name]=${pids[host-$name]}
    namespace=/proc/${host_pids[$name]}/ns/net
    for _ in $(seq 100); do
      [ "$(readlink "$namespace")" = "$(readlink /proc/self/ns/net)" ] || break
      sleep 0.05
    done
    ip link add "$name" mtu "$mtu" type veth peer name eth0 mtu "$mtu" netns "${host_pids[$name]}"
    ip link set "$name" master switch up
    at "$name" ip link set lo up
    at "$name" ip address add "10.78.0.$number/24" dev eth0
    at "$name" ip link set eth0 up
    at "$name" ip route add 239.0.0.0/8 dev eth0
  done
}

at() {  # HOST COMMAND...
  local target=${host_pids[$1]}
  shift
  nsenter --target "$target" --net --uts "$@"
}

start_at() {  # HOST NAME COMMAND...: as `start`
  local target=${host_pids[$1]} name=$2
  shift 2
  start "$name" nsenter --target "$target" --net --uts "$@"
}

# What goes over RGBDT_REPAIR is counted apart: a receiver counts what was sent and did not come,
# and what is sent about that is none of it. (The channel's name stands 8 bytes into LCM's header.)
lose() {  # PERMILLE HOST...: of the datagrams, and pieces of datagrams, on the way to each
  local permille=$1 name repair=0x52474244545f524550414952
  shift
  for name in "$@"; do
    nft add rule bridge links forward oifname "\"$name\"" @th,128,96 "$repair" numgen random mod 1000 \
      "<" "$permille" counter drop comment "\"repair $name\""
    nft add rule bridge links forward oifname "\"$name\"" @th,128,96 != "$repair" ip protocol udp \
      numgen random mod 1000 "<" "$permille" counter drop comment "\"data $name\""
  done
}

dropped() {  # HOST: datagrams, of those that receivers are to count
  nft list chain bridge links forward |
    sed -n "s/.*counter packets \([0-9]*\) .*comment \"data $1\".*/\1/p"
}

lose_nothing_more() { nft flush chain bridge links forward; }

cut_off() { ip link set "$1" nomaster; }  # HOST
plug_in() { ip link set "$1" master switch; }

sent_bytes() {  # HOST: what it put on the network
  awk -v name="$1:" '$1 == name { print $2 }' /proc/net/dev
}

# A counter in the last words of a process.
last_count() {  # PROCESS COUNTER
  # shellcheck disable=SC2154 # of tests/live/common.sh
  sed -n "s/.*: stopped;.*, $2 \([0-9]*\).*/\1/p" "$scratch/$1.log" | tail -n 1
}
