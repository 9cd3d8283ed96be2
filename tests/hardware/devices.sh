# shellcheck shell=bash
# Sourced: devices that speak the real protocols, cameras in network namespaces of their own, behind
# cables. The caller brings `fail`, `start NAME COMMAND...` and $bin.
: "${bin:?the folder of the programs}"

namespaces=()
driver_environment=()  # NAME=VALUE, of the drivers' processes alone

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

# The rig of rig_world: its motor and scanner, two cameras behind cables, and the drivers that serve
# them. Waits for the rig file, which rig_world writes once its devices answer.
start_hardware() {  # FOLDER RIG TRUTH [OPTION OF rig_world...]
  local folder=$1 rig=$2 truth=$3
  shift 3
  start world "$bin/rig_world" --folder "$folder" --rig "$rig" --truth "$truth" "$@"
  local _
  for _ in $(seq 300); do
    [ -s "$rig" ] && break
    sleep 0.1
  done
  [ -s "$rig" ] || fail "rig_world wrote no rig in 30 s"
  local number=0 camera
  for camera in rgb thermal; do
    number=$((number + 1))
    plug_in "$camera" "$number" 9000
    start "device_$camera" ip netns exec "rgbdt-$$-$camera" "$bin/fake_camera" \
      "10.77.$number.2" "$camera-1" "$folder/$camera.raw"
    start "camera_$camera" "${driver_environment[@]}" "$bin/rgbdt-camera" --rig "$rig" --camera "$camera"
  done
  start lidar "${driver_environment[@]}" "$bin/rgbdt-lidar" --rig "$rig"
  start motor "${driver_environment[@]}" "$bin/rgbdt-motor" --rig "$rig"
}
