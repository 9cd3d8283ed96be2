#!/usr/bin/env bash
# A board that is half hidden in the thermal image: the view is rejected there, a person clicks the
# board's corners, and it is accepted. Run by scripts/in-namespace.
# Usage: pick_test.sh BIN_DIR BUILD_DIR
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seed=5
session=$scratch/session
truth=$scratch/truth.textproto
log=$scratch/session.lcmlog
# The simulator's own bus: between it and the others stands who hides the board.
behind='udpm://239.255.76.68:7668?ttl=0&recv_buf_size=33554432'

start logger lcm-logger --quiet --force "--lcm-url=$LCM_DEFAULT_URL" "$log"
for process in "${services[@]}"; do start "$process" "$bin/rgbdt-$process"; done
start relay "$bin/browser_helper" cover "$behind" "$truth" thermal
start simulator "$bin/rgbdt-simulator" --lcm-url "$behind" --seed "$seed" --speed 20 \
  --rig "$scratch/rig.textproto" --truth "$truth"
helper ready "${services[@]}" simulator || fail "not every process came up"
start session "$bin/rgbdt-session" --rig "$scratch/rig.textproto" --out "$session"
start_viewer

drive "$seed" "$truth"

kill -0 "${pids[relay]}" || fail "the relay stopped"
grep -q 'picked' "$session/views/0001/view.textproto" || fail "the view does not keep the picks"
stop INT logger
[ "$("$bin/browser_helper" count "$log" CORNER_SELECTION)" = 1 ] || fail "the log lacks the picks"
echo "passed"
