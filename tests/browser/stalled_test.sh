#!/usr/bin/env bash
# A browser whose page hangs costs nobody else anything: the other browser goes on, nothing is lost
# on the bus, the bridge does not grow, and the page that hung shows the newest sweep afterwards.
# Run by scripts/in-namespace. Usage: stalled_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

most_growth_kb=15000

start fuser "$bin/rgbdt-fuser"
start stream "$bin/browser_helper" stream 2 100000 10 5
helper ready fuser || fail "rgbdt-fuser did not come up"
start_viewer

drive "${pids[viewer]}" "$most_growth_kb"

kill -0 "${pids[stream]}" || fail "the stream ended"
stop TERM fuser viewer
no_gaps_in fuser viewer
echo "passed"
