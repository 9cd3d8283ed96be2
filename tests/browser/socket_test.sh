#!/usr/bin/env bash
# A bus in a network namespace of its own, and its page from outside: the listening socket is handed
# in, as scripts/demo does. Run by scripts/in-namespace, which is the outside here.
# Usage: socket_test.sh BIN_DIR BUILD_DIR; exit code 77: skipped
set -euo pipefail
# shellcheck source=tests/browser/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

[ "${RGBDT_IN_NAMESPACE-}" = namespace ] || skip "no network namespace may be made here"

# shellcheck disable=SC2016 # $$, "$1" and "$2" are the inner shells'
inside='
  ip link set lo up && ip link set lo multicast on && ip route add 239.0.0.0/8 dev lo
  "$1/rgbdt-detector" >"$2/detector.log" 2>&1 &
  echo $! >"$2/detector.pid"
  LISTEN_PID=$$ exec "$1/rgbdt-viewer"'
start viewer "$bin/rgbdt-viewer" --listen 127.0.0.1:0 --run unshare --net sh -c "$inside" sh "$bin" "$scratch"
RGBDT_URL=$(wait_for_line viewer '^http') || exit 1
export RGBDT_URL
# Nothing of the inner bus comes out here: it is the socket alone that goes through.
start outside timeout 3 "$bin/live_helper" ready detector

drive

code=0
wait_for outside || code=$?
[ "$code" = 124 ] || fail "the inner bus is heard outside (exit code $code)"
kill -TERM "$(cat "$scratch/detector.pid")"
stop TERM viewer
echo "passed"
