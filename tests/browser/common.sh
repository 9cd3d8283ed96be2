# shellcheck shell=bash
# Sourced by the browser tests: processes on the bus, the bridge, and a script that drives the page.
# Usage of each test: NAME_test.sh BIN_DIR BUILD_DIR; exit code 77: skipped
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../live/common.sh"

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$2
test=$(basename "$0" _test.sh)
mkdir -p "$build/screenshots"

skip() {
  echo "skipped: $*"
  exit 77
}
command -v node >/dev/null || skip "no node: apt-get install nodejs"
chromium=$(command -v chromium) || skip "no chromium: apt-get install chromium"
[ -s "$build/viewer/page/dist/index.html" ] || skip "the viewer's page was not built"
[ -d "$build/viewer/page/node_modules/playwright-core" ] || skip "no playwright-core"

export RGBDT_CHROMIUM=$chromium RGBDT_PACKAGES=$build/viewer/page/package.json RGBDT_TEST=$test
export RGBDT_SCRATCH=$scratch RGBDT_SCREENSHOTS=$build/screenshots
export RGBDT_HELPER=$bin/browser_helper

wait_for_line() {  # NAME PATTERN: until NAME.log has it; prints the first such line
  local _
  for _ in $(seq 300); do
    ! grep -m 1 -e "$2" "$scratch/$1.log" 2>/dev/null || return 0
    kill -0 "${pids[$1]}" 2>/dev/null || fail "$1 ended before it said $2"
    sleep 0.1
  done
  fail "$1 did not say $2"
}

# shellcheck disable=SC2120 # most have none
start_viewer() {  # ARGUMENT...: sets RGBDT_URL
  start viewer "$bin/rgbdt-viewer" --listen 127.0.0.1:0 "$@"
  RGBDT_URL=$(wait_for_line viewer '^http') || exit 1
  export RGBDT_URL
}

# shellcheck disable=SC2120
drive() {  # ARGUMENT...: the test's script in node
  node "$here/$test.mjs" "$@" 2>&1 | tee "$scratch/page.log" >&2 || fail "the page is not as it should be"
}

no_gaps_in() {  # PROCESS...: by their last words
  local process
  for process in "$@"; do
    grep -q "$process: stopped" "$scratch/$process.log" || fail "$process said no goodbye"
    ! grep "$process: stopped" "$scratch/$process.log" | grep -Eq ', gaps [1-9]' ||
      fail "$process missed messages"
  done
}
