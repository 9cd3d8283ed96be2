#!/usr/bin/env bash
# The Debian packages beside this script, in a Debian 12 that has nothing else: installed one after
# the other, each is enough for what it is for. As root, inside; scripts/check-fresh runs it there.
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

apt-get -qq update
step "the programs"
install ./rgbdt_*.deb
for program in /usr/bin/rgbdt /usr/bin/rgbdt-*; do
  "$program" --version >/dev/null || fail "$program does not run"
done
for package in $(dpkg-query -W -f '${Package}\n'); do
  case $package in *-dev) fail "the programs brought $package" ;; esac
done
rgbdt simulate session --views 8
rgbdt calibrate session
rgbdt evaluate session

step "the units"
install systemd
for unit in /usr/lib/systemd/system/rgbdt*@.service; do cp "$unit" "/tmp/$(basename "${unit/@/@rgb}")"; done
said=$(systemd-analyze verify --man=no /usr/lib/systemd/system/{rgbdt,lcm-}*[a-z].service \
  /usr/lib/systemd/system/rgbdt.target /tmp/*@rgb.service 2>&1) || fail "systemd-analyze: $said"
[ -z "$said" ] || fail "systemd-analyze: $said"

step "the library"
install g++ make cmake pkg-config ./librgbdt-dev_*.deb
if dpkg-query -W libpcl-dev libembree-dev libaravis-dev >/dev/null 2>&1; then
  fail "librgbdt-dev brought what only the other components need"
fi
./linking.sh /usr session

step "the library's other components"
install ./librgbdt-*-dev_*.deb
./linking.sh /usr session

step "gone again"
apt-get -qq -y purge 'rgbdt' 'librgbdt*' >/dev/null
left=$(find / -xdev -name '*rgbdt*' -not -path '/root/*' -not -path '/proc/*')
[ -z "$left" ] || fail "left behind: $left"
step "passed"
