#!/usr/bin/env bash
# lcm-logger on a bus of ttl=0 dies of another machine's forged datagrams, and lives where the rule is
# that `rgbdt doctor` advises. Run by scripts/in-namespace. Usage: firewall_test.sh BIN_DIR; exit code
# 77: skipped
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

PATH=$PATH:/usr/sbin:/sbin
if [ "${RGBDT_IN_NAMESPACE-}" != namespace ] || ! command -v nft >/dev/null; then
  echo "skipped: needs a network namespace and nftables"
  exit 77
fi
sudo() { "$@"; }  # the command that doctor names begins with it
log=$scratch/bus.lcmlog

start_other_machine

start_logger() {
  start logger lcm-logger --quiet --force "--lcm-url=$LCM_DEFAULT_URL" "$log"
  for _ in $(seq 100); do
    ! ss -uln 'sport = :7667' | grep -q :7667 || return 0
    sleep 0.05
  done
  fail "lcm-logger did not come up"
}

attack() {
  at_other "$bin/live_helper" attack 10.79.0.1 7667 CLOUD STATUS >/dev/null
  at_other "$bin/live_helper" attack 239.255.76.67 7667 CLOUD STATUS >/dev/null
}

advised() { "$bin/rgbdt" doctor >"$scratch/doctor" 2>&1 || true; }

echo "== without the rule"
start_logger
attack
code=0
wait_for logger || code=$?
[ "$code" -gt 128 ] || fail "lcm-logger ended with exit code $code, not of what was forged"
echo "it ended with exit code $code"

echo "== with it"
advised
mend=$(grep -F -A1 '  LCM firewall: ' "$scratch/doctor" | sed -n 's/^  fix: //p')
[ -n "$mend" ] || fail "rgbdt doctor advises nothing: $(cat "$scratch/doctor")"
eval "$mend" || fail "the rule was not made: $mend"
advised
grep -q '^ok       LCM firewall: ' "$scratch/doctor" || fail "rgbdt doctor does not see the rule"
start_logger
attack
start assembler "$bin/rgbdt-assembler"
helper ready assembler || fail "what this machine sends is dropped, too"
kill -0 "${pids[logger]}" || fail "lcm-logger died all the same"
sleep 1
stop INT logger
stop TERM assembler
grep -q assembler "$log" || fail "lcm-logger did not log what this machine sent"
echo "passed"
