#!/usr/bin/env bash
# rgbdt import of bags that ROS 1 itself wrote: the same views as of ours, byte by byte. Skipped
# without python3-rosbag. Usage: import_reference_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$(dirname "${BASH_SOURCE[0]}")

# Debian's own: another python3 in PATH would not have its rosbag.
if ! /usr/bin/python3 -c 'import rosbag, sensor_msgs.msg' 2>"$scratch/output"; then
  echo "needs Debian's python3-rosbag and python3-sensor-msgs"
  exit 77
fi

accepts "a session" "$bin/rgbdt" simulate "$scratch/session" --views 2 --picked rgb
accepts "ours" /usr/bin/python3 -B "$here/make_bag.py" "$scratch/session" "$scratch/ours.mcap"
accepts "theirs" /usr/bin/python3 -B "$here/make_reference_bag.py" "$scratch/session" \
  "$scratch/none.bag:none" "$scratch/bz2.bag:bz2" "$scratch/lz4.bag:lz4"
imports() {  # FILE: its views and rig into $scratch/FILE.out
  accepts "$1" "$bin/rgbdt" import "$scratch/$1" --board 11x8@0.1,1.2192x0.9144 --every 1 \
    --out "$scratch/$1.out"
  ! grep -E '^(problem|left over)' "$scratch/output" || complain "$1: not all of it"
}
imports ours.mcap
for compression in none bz2 lz4; do
  imports "$compression.bag"
  diff -r "$scratch/ours.mcap.out" "$scratch/$compression.bag.out" >"$scratch/output" ||
    complain "$compression: another session than of our bag"
done

verdict
