#!/usr/bin/env bash
# rgbdt doctor against faults that are truly made: each is named with a command, the command is run
# as it stands where a test may, and then doctor is content. Run by scripts/in-namespace: nothing
# leaves this network namespace, and mounts stay in one of the test's own.
# Usage: doctor_test.sh BIN_DIR
set -euo pipefail
if [ "${RGBDT_IN_NAMESPACE-}" != namespace ]; then
  echo "skipped: needs a network namespace"
  exit 77
fi
if [ -z "${DOCTOR_TEST_MOUNTS-}" ]; then
  DOCTOR_TEST_MOUNTS=1 exec unshare --mount "$0" "$@"
fi
PATH=$PATH:/usr/sbin:/sbin
mount -t sysfs sysfs /sys  # the one from before is another network namespace's
peers=$(dirname "${BASH_SOURCE[0]}")
# shellcheck source=tests/hardware/doctor_common.sh
source "$peers/doctor_common.sh"
unset LCM_DEFAULT_URL

# -- the machine

doctor
silent "receive buffer"
silent "LCM URL"
silent "multicast"
silent "LCM port"
[ "$code" = 0 ] || fail "exit code $code where nothing is wrong"

# The true limit is the whole machine's; this is this mount namespace's idea of it.
echo 212992 >"$scratch/rmem_max"
mount --bind "$scratch/rmem_max" /proc/sys/net/core/rmem_max
doctor
finds PROBLEM "receive buffer" "212992 bytes" "get lost"
[ "$code" = 1 ] || fail "exit code $code with a problem"
mend "receive buffer"
doctor
silent "receive buffer"
umount /proc/sys/net/core/rmem_max

ip route del 239.0.0.0/8
doctor
finds PROBLEM multicast "no route" "239.255.76.67"
mend multicast
doctor
silent multicast
ip link set lo down
ip link set lo multicast off
doctor
finds PROBLEM multicast "no route"
mend multicast
doctor
silent multicast
ip link set lo multicast off
doctor
finds WARNING multicast "lo, which has no multicast"
mend multicast
doctor
silent multicast

# What the kernel says, by way of another language.
synchronised=$(python3 -c 'import ctypes
clock = ctypes.create_string_buffer(512)
ctypes.CDLL(None).adjtimex(clock)
status = int.from_bytes(clock.raw[40:44], "little")  # behind modes and four longs
print("no" if status & 0x40 else "yes")')
doctor
if [ "$synchronised" = yes ]; then
  silent clock
else
  finds WARNING clock "not synchronised" "sudo timedatectl set-ntp true"
fi

mkdir "$scratch/small"
mount -t tmpfs -o size=1G small "$scratch/small"
doctor_in "$scratch/small"
finds WARNING disk "1.1 GB free in $scratch/small"
mend disk
fallocate -l 1000M "$scratch/small/log"
doctor_in "$scratch/small"
finds PROBLEM disk "too little"
rm "$scratch/small/log"
mount -o remount,size=3G "$scratch/small"
doctor_in "$scratch/small"
silent disk
umount "$scratch/small"

# -- the bus's URL and port

for bad in 'udpm//239.255.76.67:7667' 'udpm://10.1.2.3:7667' 'udpm://:99999' 'udpm://?ttl=often' \
  'udpm://?tll=1' 'file://log'; do
  doctor --lcm-url "$bad"
  finds PROBLEM "LCM URL" "\"$bad"
done
doctor --lcm-url 'udpm://?recv_buf_size=100000'
finds WARNING "LCM URL" "recv_buf_size=100000 is small"
doctor --lcm-url 'udpm://239.255.76.67:7667?ttl=1'
finds WARNING "LCM URL" "ttl=1" "leads to lo: other machines hear nothing"

start logger lcm-logger --lcm-url='udpm://239.255.76.67:7667?ttl=0' "$scratch/bus.lcmlog"
until_udp 7667
doctor
silent "LCM port"
stop_peer logger
peer holder python3 "$peers/holder.py" udp 7667
doctor
finds PROBLEM "LCM port" "UDP port 7667 is in use by python3 (pid ${pids[holder]})"
stop_peer holder
doctor
silent "LCM port"

# -- the processes on the bus

LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'
export LCM_DEFAULT_URL
for process in fuser solver; do start "$process" "$bin/rgbdt-$process"; done
helper ready fuser solver || fail "fuser and solver did not come up"
rig
listen=3
doctor
grep -q '^WARNING  process fuser: waits for the rig (RIG)' "$scratch/output" ||
  fail_with_output "it does not say what the fuser waits for"
doctor --rig "$scratch/rig.textproto"
finds WARNING "silent processes" "detector" "viewer" "pgrep"
lidar='velodyne { model: VLP16 }' rig
doctor --rig "$scratch/rig.textproto"
finds WARNING "silent processes" "lidar"
rig
start second "$bin/rgbdt-fuser"
listen=6
doctor
finds PROBLEM "process fuser" "two programs of this name"
[ "$code" = 1 ] || fail "exit code $code with two fusers"
stop TERM second
stop TERM fuser solver
doctor
silent processes
listen=0
unset LCM_DEFAULT_URL

# -- other machines and lcm-logger

silent "LCM firewall"
ip link add other type veth peer name end
ip link set other up
doctor
finds WARNING "LCM firewall" "UDP port 7667" "lcm-logger"
doctor --lcm-url 'udpm://239.255.76.67:7667?ttl=1'
! grep -q "LCM firewall" "$scratch/output" || fail "a bus of ttl=1 wants to be heard"
doctor
mend "LCM firewall"
doctor
silent "LCM firewall"
doctor --lcm-url 'udpm://239.255.76.67:7668?ttl=0'
finds WARNING "LCM firewall" "UDP port 7668"
nft delete table ip lcm
ip link del other

# -- a camera at the other end of a cable

camera_network
rig A1
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "nobody answers who has serial number A1" "no GigE Vision camera answers"

camera 0 192.168.7.20/24=A1
rig B2
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "serial number B2" "there is Acme Fieldcam 3, serial number A1" \
  "192.168.7.20 on cable"

# Heard, though out of reach: unless the kernel drops what comes from another subnet.
rig A1
echo 1 >/proc/sys/net/ipv4/conf/cable/rp_filter
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "no GigE Vision camera answers at all"
finds WARNING "camera search" "filter of cable"
mend "camera search"
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "cannot be reached: it has 192.168.7.20/24" "has 10.9.0.1/24" \
  "00:11:1c:00:12:34"
mend "camera rgb"
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"
ip addr flush dev cable
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "cannot be reached" "cable where it answers has no address"
mend "camera rgb"
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"

# Another interface in the same subnet, which the kernel prefers.
ip link add other type veth peer name other-end
ip addr add 192.168.7.200/25 dev other
ip addr add 192.168.7.1/25 dev other
ip link set other-end up
ip link set other up
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "leads to other"
mend "camera rgb"
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"
ip link del other

for control in 1 2 denied; do
  stop_peer camera
  camera "$control" 192.168.7.20/24=A1
  doctor --rig "$scratch/rig.textproto"
  finds PROBLEM "camera rgb" "another program holds its control channel"
done
stop_peer camera
camera 0 192.168.7.20/24=A1 192.168.7.21/24=A2
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"
if can_be_nobody; then
  as=("${unprivileged[@]}" --clear-groups)
  doctor --rig "$scratch/rig.textproto"
  silent "camera rgb"
fi

# -- packets and links

rig A1 'packet_bytes: 8000'
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "packets of rgb" "packets of 8000 bytes" "cable takes 1500"
mend "packets of rgb"
doctor --rig "$scratch/rig.textproto"
silent "packets of rgb"
ip link set dev cable mtu 1500
size='1936 1456' rig A1  # 677 Mbit/s at 30 Hz
doctor --rig "$scratch/rig.textproto"
finds WARNING "packets of rgb" "677 Mbit/s at 30 Hz (assumed)"
mend "packets of rgb"
doctor --rig "$scratch/rig.textproto"
silent "packets of rgb"

size='8000 3000' rig A1 '' A2 'feature { name: "AcquisitionFrameRate" value: "25" }'
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "link cable" "rgb 5760 Mbit/s at 30 Hz (assumed), second 4800 Mbit/s at 25 Hz" \
  "together 10560 Mbit/s" "link's 10000 Mbit/s"
mapfile -t features < <(mend_of "link cable" | grep -o 'feature {[^}]*}')
[ "${#features[@]}" = 2 ] || fail "it names ${#features[@]} frame rates"
size='8000 3000' rig A1 "${features[0]}" A2 "${features[1]}"
doctor --rig "$scratch/rig.textproto"
silent "link cable"

# -- Aravis as camera and as who controls it

stop_peer camera
peer camera in_camera "$bin/aravis_camera" serve plug GV42
rig GV42
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"
which='id: "Aravis-GV42"' rig GV42
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"
peer controller "$bin/aravis_camera" hold
doctor --rig "$scratch/rig.textproto"
finds PROBLEM "camera rgb" "another program holds its control channel"
stop_peer controller
doctor --rig "$scratch/rig.textproto"
silent "camera rgb"
stop_peer camera

# -- LIDARs

lidar='hokuyo { address: "192.168.7.20" }' rig
doctor --rig "$scratch/rig.textproto"
finds PROBLEM Hokuyo "something is at 192.168.7.20 but refuses port 10940"
peer holder in_camera python3 "$peers/holder.py" listen 192.168.7.20 10940
doctor --rig "$scratch/rig.textproto"
silent Hokuyo
stop_peer holder
lidar='hokuyo { address: "192.168.7.99" }' rig
doctor --rig "$scratch/rig.textproto"
finds PROBLEM Hokuyo "nobody answers at 192.168.7.99 port 10940"
lidar='hokuyo { address: "the scanner" }' rig
doctor --rig "$scratch/rig.textproto"
finds PROBLEM Hokuyo '"the scanner" is no address'
lidar='hokuyo { address: "172.31.0.10" }' rig
ip route add default via 192.168.7.20  # it drops what is not for itself
doctor --rig "$scratch/rig.textproto"
finds PROBLEM Hokuyo "172.31.0.10 is out of reach"
ip route del default
lidar='hokuyo { address: "172.30.5.10" }' rig
in_camera ip addr add 172.30.5.10/24 dev plug
peer holder in_camera python3 "$peers/holder.py" listen 172.30.5.10 10940
doctor --rig "$scratch/rig.textproto"
finds PROBLEM Hokuyo "172.30.5.10 is out of reach"
mend Hokuyo
doctor --rig "$scratch/rig.textproto"
silent Hokuyo
stop_peer holder

lidar='velodyne { model: VLP16 }' rig
for reuse in '' reuse; do
  peer holder python3 "$peers/holder.py" udp 2368 $reuse
  doctor --rig "$scratch/rig.textproto"
  finds PROBLEM "Velodyne port" "UDP port 2368 is in use by python3 (pid ${pids[holder]})"
  mend "Velodyne port"
  grep -q ":2368 .*pid=${pids[holder]}," "$scratch/mended" || fail "ss does not name the holder"
  stop_peer holder
done
doctor --rig "$scratch/rig.textproto"
silent "Velodyne port"

# -- the motor's serial port

motor=/dev/ttyUSB-none rig
doctor --rig "$scratch/rig.textproto"
finds PROBLEM motor "/dev/ttyUSB-none does not exist"
motor=$scratch/rig.textproto rig
doctor --rig "$scratch/rig.textproto"
finds PROBLEM motor "is no serial port"
peer terminal python3 "$peers/holder.py" pty
tty=$said
ln -s "$tty" "$scratch/by-id"
motor=$scratch/by-id rig
doctor --rig "$scratch/rig.textproto"
silent motor
peer holder python3 "$peers/holder.py" tty "$tty"
doctor --rig "$scratch/rig.textproto"
finds PROBLEM motor "is open in python3 (pid ${pids[holder]})"
mend motor
wait_for holder || true
doctor --rig "$scratch/rig.textproto"
silent motor

if can_be_nobody; then
  # shellcheck disable=SC2016 # it is what doctor prints
  join='sudo usermod -aG dialout $USER'
  chgrp 0 "$tty"
  chmod 600 "$tty"
  as=("${unprivileged[@]}" --clear-groups)
  doctor --rig "$scratch/rig.textproto"
  finds PROBLEM motor "no permission for" "$join"
  # All that it says but the last: that is what the second run's group is.
  sed -i '/fix:.*usermod/s/; sudo usermod.*//' "$scratch/output"
  mend motor
  as=("${unprivileged[@]}" --clear-groups)
  doctor --rig "$scratch/rig.textproto"
  finds PROBLEM motor "members of dialout have it" "fix: $join"
  group=$(getent group dialout | cut -d: -f3)
  as=("${unprivileged[@]}" --groups "$group")
  doctor --rig "$scratch/rig.textproto"
  silent motor
  peer holder python3 "$peers/holder.py" tty "$tty" exclusive
  as=("${unprivileged[@]}" --groups "$group")
  doctor --rig "$scratch/rig.textproto"
  finds PROBLEM motor "held by a program of another user"
  stop_peer holder
else
  echo "not tried: another user's permissions"
fi

# -- a rig that is none

echo 'cameras {}' >"$scratch/rig.textproto"
doctor --rig "$scratch/rig.textproto"
finds PROBLEM rig "rig.textproto" "cameras"
silent multicast
doctor --help
grep -q 'Example: rgbdt doctor' "$scratch/output" || fail "--help has no example"
stop_peer terminal
stop_peer namespace
echo "passed"
