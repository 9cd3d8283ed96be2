# shellcheck shell=bash
# Sourced by doctor_test.sh: running doctor, reading it, doing what it says; peers; a rig.

# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"
bin=$(realpath "$bin")
chmod 755 "$scratch"
trap 'umount "$scratch/small" 2>/dev/null || true; clean_up' EXIT

# The commands that doctor names begin with it.
sudo() { "$@"; }

# A user without rights; a namespace that root did not make knows none.
unprivileged=(setpriv --reuid 65534 --regid 65534)
can_be_nobody() { "${unprivileged[@]}" --clear-groups test -x "$bin/rgbdt" 2>/dev/null; }

as=()
listen=0  # seconds, to the processes on the bus
doctor() { doctor_in / "$@"; }
doctor_in() {  # FOLDER OPTION...: output in $scratch/output, exit code in $code
  local folder=$1
  shift
  code=0
  (cd "$folder" && timeout 20 "${as[@]}" "$bin/rgbdt" doctor --listen "$listen" "$@") >"$scratch/output" 2>&1 || code=$?
  as=()
  [ "$code" -le 1 ] || fail_with_output "exit code $code"
}

fail_with_output() {
  cat "$scratch/output" >&2
  fail "line ${BASH_LINENO[1]}: $*"
}

mend_of() { grep -F -A1 "  $1: " "$scratch/output" | sed -n 's/^  fix: //p'; }  # CHECK

finds() {  # LEVEL CHECK WORD...: in its line or its mend's; a mend is there
  local said word
  said=$(grep -A1 "^$1  $2: " "$scratch/output") || fail_with_output "no $1 of $2"
  for word in "${@:3}"; do
    grep -qF -- "$word" <<<"$said" || fail_with_output "$2: not a word of '$word'"
  done
  [ "$2" = rig ] || [ -n "$(mend_of "$2")" ] || fail_with_output "$2: no mend"
}

silent() {  # CHECK: looked at and well
  grep -q "^ok       $1: " "$scratch/output" || fail_with_output "$1 is not ok"
  ! grep -qE "^(WARNING|PROBLEM)  $1: " "$scratch/output" || fail_with_output "$1 is not silent"
}

mend() {  # CHECK: runs the command as it stands
  local command
  command=$(mend_of "$1")
  eval "$command" >"$scratch/mended" 2>&1 || fail "'$command' failed: $(cat "$scratch/mended")"
}

declare -A leashes=()
peer() {  # NAME COMMAND...: in the background until stop_peer; its first line in $said
  local name=$1 leash
  shift
  rm -f "$scratch/$name.in" "$scratch/$name.out"
  mkfifo "$scratch/$name.in" "$scratch/$name.out"
  "$@" <"$scratch/$name.in" >"$scratch/$name.out" 2>"$scratch/$name.log" &
  pids[$name]=$!
  exec {leash}>"$scratch/$name.in"
  leashes[$name]=$leash
  read -r -t 20 said <"$scratch/$name.out" || fail "$name did not come up"
}

stop_peer() {  # NAME: and waits until it is gone
  local leash=${leashes[$1]-}
  if [ -n "$leash" ]; then
    exec {leash}>&-
    unset "leashes[$1]"
    wait_for "$1" || fail "$1 ended with exit code $?"
  else
    stop INT "$1"
  fi
}

until_udp() {  # PORT: until somebody has it open
  for _ in $(seq 100); do
    ! ss -uln "sport = :$1" | grep -q ":$1" || return 0
    sleep 0.1
  done
  fail "nobody opened UDP port $1"
}

camera_network() {  # interface "cable" here, 10.9.0.1/24; its end "plug" where the cameras are
  peer namespace unshare --net sh -c 'echo ready; exec cat'
  ip link add cable type veth peer name plug
  ip link set plug netns "${pids[namespace]}"
  echo 0 >/proc/sys/net/ipv4/conf/all/rp_filter
  echo 0 >/proc/sys/net/ipv4/conf/cable/rp_filter
  ip addr add 10.9.0.1/24 dev cable
  ip link set cable up
  in_camera sysctl -q net.ipv4.conf.all.rp_filter=0 net.ipv4.conf.plug.rp_filter=0
  in_camera ip addr add 192.168.7.20/24 dev plug
  in_camera ip addr add 192.168.7.21/24 dev plug
  in_camera ip link set plug up
}

in_camera() { nsenter --net="/proc/${pids[namespace]}/ns/net" "$@"; }

# shellcheck disable=SC2154 # peers: the sourcing test's
camera() {  # CONTROL ADDRESS/PREFIX=SERIAL...
  peer camera in_camera python3 "$peers/gvcp_camera.py" plug "$@"
}

camera_text() {  # NAME SERIAL MORE
  local width height
  read -r width height <<<"${size:-640 480}"
  printf 'camera { name: "%s" kind: COLOR width: %s height: %s pixel_format: MONO8\n' \
    "$1" "$width" "$height"
  printf '  device { %s %s } }\n' "${which:-serial: \"$2\"}" "$3"
}

rig() {  # [SERIAL [MORE [SERIAL_2 [MORE_2]]]]: rig.textproto; $lidar and $motor are its devices
  {
    printf 'name: "faulty"\nlidar { name: "lidar" %s\n' "${lidar-}"
    if [ -n "${motor-}" ]; then
      printf 'turned_scanner { motor_from_scanner { quaternion_wxyz: [1, 0, 0, 0] '
      printf 'translation_m: [0, 0, 0] } ticks_per_degree: 11 dynamixel { port: "%s" ' "$motor"
      printf 'from_deg: -90 to_deg: 90 speed_deg_s: 10 } }\n'
    fi
    printf '}\n'
    camera_text rgb "${1:-A1}" "${2-}"
    [ -z "${3-}" ] || camera_text second "$3" "${4-}"
    printf 'target { squares_x: 8 squares_y: 6 square_m: 0.1 width_m: 1 height_m: 0.8 }\n'
  } >"$scratch/rig.textproto"
}
