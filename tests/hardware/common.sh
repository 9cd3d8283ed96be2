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

# A session's result against the truth beside it.
is_what_it_says() {  # SESSION
  "$bin/rgbdt" evaluate "$1" --out "$scratch/evaluated" >"$scratch/evaluate.log" 2>&1 ||
    fail "it cannot be judged"
  grep -E '^(result against truth|1 sigma, worst axis)' "$scratch/evaluate.log"
  # "result against truth  0.014 deg 0.6 mm  0.014 deg 0.6 mm": both cameras, within four times what
  # they say of themselves, which for five views is less than half of this.
  awk '
    /^result against truth/ { for (i = 4; i <= NF; i += 2) error[++n] = $i }
    /^1 sigma, worst axis/ { for (i = 5; i <= NF; i += 2) sigma[++m] = $i }
    END {
      if (n != 4 || m != 4) exit 1
      for (i = 1; i <= 4; ++i) {
        if (error[i] > 4 * sigma[i] || error[i] > (i % 2 ? 0.1 : 5)) exit 1
      }
    }' "$scratch/evaluate.log" || fail "the result is not what it says it is"
}
