#!/usr/bin/env bash
# The tutorials of bags and of packets print what their pages say, of recordings that are made here.
# Usage: tutorial_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
accepts "a session" "$bin/rgbdt" simulate "$scratch/session" --views 12 --seed 7 --picked rgb
mkdir "$scratch/monday"
accepts "its bags" python3 "$here/make_bag.py" "$scratch/session" --seconds 2 --mosaic --tf \
  "$scratch/monday.bag:lz4" "$scratch/monday/monday_0.db3"
rm -r "$scratch/session"
python3 "$here/check_page.py" "$here/../../scripts/examples/bag/README.md" "$bin" "$scratch" \
  >"$scratch/output" 2>&1 || complain "the tutorial"

rm -r "$scratch/monday"
accepts "a session of 128 rings" "$bin/rgbdt" simulate "$scratch/session" --lidar 128 --views 9 --seed 7 \
  --picked rgb
accepts "its packets" python3 "$here/make_session_pcap.py" "$scratch/session" "$scratch/monday"
rm -r "$scratch/session"
python3 "$here/check_page.py" "$here/../../scripts/examples/pcap/README.md" "$bin" "$scratch" \
  >"$scratch/output" 2>&1 || complain "the tutorial of packets"
# The same by folders: sweep by sweep, then paired.
monday=$scratch/monday
accepts "its sweeps" "$bin/rgbdt" import "$monday/monday.pcap" --metadata "$monday/os.json" --out "$scratch/clouds"
accepts "its folders" "$bin/rgbdt" session --images "$monday/images" --clouds "$scratch/clouds" \
  --lens "$monday/camera_info.yaml" --board 11x8@0.1,1.2192x0.9144 --out "$scratch/folders"
accepts "its folders, calibrated" "$bin/rgbdt" calibrate "$scratch/folders"
cmp "$scratch/folders/calibration.textproto" "$scratch/out/monday/calibration.textproto" >>"$scratch/output" ||
  complain "the tutorial of packets: another calibration than of folders"

verdict
