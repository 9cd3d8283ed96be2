#!/usr/bin/env bash
# `cmake --install` puts all where it belongs, and what it put there works.
# Usage: install_test.sh BUILD_DIR
set -euo pipefail

build=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rgbdt-install-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix
failures=0

complain() {
  printf 'FAILED: %s\n' "$*" >&2
  failures=$((failures + 1))
}

cmake --install "$build" --prefix "$prefix" >"$scratch/log"
version=$("$prefix/bin/rgbdt" --version)
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+(\ \(commit\ [0-9a-f]+\))?$ ]] || complain "rgbdt --version says '$version'"

for program in "$prefix"/bin/*; do
  name=${program##*/}
  [ "$("$program" --version)" = "$version" ] || complain "$name --version"
  [ -s "$prefix/share/man/man1/$name.1.gz" ] || complain "no manual page of $name"
  [ -s "$prefix/share/bash-completion/completions/$name" ] || complain "no completion of $name"
done
for file in share/rgbdt/lcmtypes/cloud_t.lcm include/rgbdt/lcmtypes/rgbdt/cloud_t.hpp \
  share/rgbdt/rigs/paper_rig.rig.textproto share/rgbdt/sessions/demo.session.textproto \
  share/rgbdt/proto/calib/files/schema/rig.proto lib/systemd/system/rgbdt.target \
  lib/systemd/system/rgbdt-.service.d/rig.conf lib/sysctl.d/60-rgbdt.conf; do
  [ -s "$prefix/$file" ] || complain "no $file"
done
[ -z "$(find "$prefix/include" -path '*internal*')" ] || complain "internal headers are installed"
if grep -rIl -- "$build" "$prefix" >"$scratch/named"; then
  complain "these name the build's folder: $(tr '\n' ' ' <"$scratch/named")"
fi

# The manual: no warning, each verb's page, the examples as they are.
if command -v man >/dev/null; then
  for page in "$prefix"/share/man/man1/*.1.gz; do
    said=$(MANROFFSEQ='' MANWIDTH=100 man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)
    [ -z "$said" ] || complain "$page: $said"
  done
fi
"$prefix/bin/rgbdt" --help | sed '0,/^Subcommands:/d' | awk '/^  [a-z]/ { print $1 }' >"$scratch/verbs"
[ "$(wc -l <"$scratch/verbs")" -ge 10 ] || complain "rgbdt --help names $(wc -l <"$scratch/verbs") verbs"
while read -r verb; do
  zgrep -q "^rgbdt $verb" "$prefix/share/man/man1/rgbdt-$verb.1.gz" || complain "the page of rgbdt $verb"
done <"$scratch/verbs"

# Completion, as bash asks for it.
completes() {  # WANTED WORD...: among what completes the last word is this
  local wanted=$1
  shift
  # shellcheck disable=SC2016 # for the inner shell
  bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _rgbdt "$1"
           printf "%s\n" "${COMPREPLY[@]}"' bash \
    "$prefix/share/bash-completion/completions/rgbdt" "$@" | grep -xF -- "$wanted" >/dev/null ||
    complain "'${*:2}' is not completed to '$wanted'"
}
completes calibrate "$prefix/bin/rgbdt" cal
completes --method "$prefix/bin/rgbdt" calibrate --m
completes --version "$prefix/bin/rgbdt" --v
completes --lcm-url "$prefix/bin/rgbdt-fuser" --

# The units: systemd finds nothing to say about them.
if command -v systemd-analyze >/dev/null; then
  mkdir "$scratch/units"
  cp -r "$prefix/lib/systemd/system/." "$scratch/units"
  # systemd looks for programs in the system's folders only; an instance stands for its template.
  sed -i "s|^ExecStart=rgbdt-|ExecStart=$prefix/bin/rgbdt-|" "$scratch"/units/*.service
  for unit in "$scratch"/units/*@.service; do cp "$unit" "${unit/@/@rgb}"; done
  said=$(systemd-analyze verify --man=no --recursive-errors=no "$scratch"/units/*.{service,target} 2>&1) ||
    complain "systemd-analyze verify fails"
  [ -z "$said" ] || complain "systemd-analyze verify: $said"
fi

"$prefix/bin/rgbdt" simulate "$scratch/session" --views 6 >"$scratch/log"
"$prefix/bin/rgbdt" calibrate "$scratch/session" >"$scratch/log" 2>&1 || complain "rgbdt calibrate"
"$here/linking.sh" "$prefix" "$scratch/session" || complain "linking"
[ "$failures" -eq 0 ] || exit 1
echo "passed"
