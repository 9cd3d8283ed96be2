#!/usr/bin/env bash
# The Debian packages beside this script, in a Debian 12 that has nothing else: installed one after
# the other, each is enough for what it is for. As root, inside; scripts/check-fresh runs it there.
# Usage: bare_test.sh programs | library | purge, in this order
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")"
export DEBIAN_FRONTEND=noninteractive

step() { printf '\n-- %s (%d s)\n' "$*" "$SECONDS"; }
fail() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}
install() { apt-get -qq -o Dpkg::Use-Pty=0 install -y --no-install-recommends "$@" >install.log 2>&1 || {
  tail -n 30 install.log
  fail "apt-get install $*"
}; }

try_programs() {
  apt-get -qq update
  install ./rgbdt_*.deb
  local program package
  for program in /usr/bin/rgbdt /usr/bin/rgbdt-*; do
    "$program" --version >/dev/null || fail "$program does not run"
  done
  for package in $(dpkg-query -W -f '${Package}\n'); do
    case $package in *-dev) fail "the programs brought $package" ;; esac
  done
  step "a session"
  rgbdt simulate session --views 8
  rgbdt calibrate session
  rgbdt evaluate session
}

try_library() {
  step "librgbdt-dev"
  install g++ make cmake pkg-config ./librgbdt-dev_*.deb
  if dpkg-query -W libpcl-dev libembree-dev libaravis-dev >/dev/null 2>&1; then
    fail "librgbdt-dev brought what only the other components need"
  fi
  ./linking.sh /usr session
  step "the other components"
  install ./librgbdt-*-dev_*.deb
  ./linking.sh /usr session
}

try_purge() {
  apt-get -qq -y purge rgbdt 'librgbdt*' >/dev/null
  local left
  left=$(find / -xdev -name '*rgbdt*' -not -path '/root/*' -not -path '/proc/*' -not -path '/etc/rgbdt*' \
    -not -path '/var/lib/rgbdt*' -not -path '/var/lib/private/*')
  [ -z "$left" ] || fail "left behind: $left"
}

"try_$1"
step "passed"
