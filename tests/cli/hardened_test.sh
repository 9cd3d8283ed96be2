#!/usr/bin/env bash
# What our programs are hardened by, as their ELF files tell. Usage: hardened_test.sh BIN_DIR
set -euo pipefail
bin=$1

fail() {
  echo "hardened_test: $*" >&2
  exit 1
}

has() {  # PROGRAM WHAT PATTERN: of its headers, dynamic section and symbols
  grep -qE -- "$3" <<<"$elf" || fail "$1 is built without $2"
}

checked=0
fortified=0
for file in "$bin/rgbdt" "$bin"/rgbdt-*; do
  program=$(basename "$file")
  elf=$(readelf --wide --file-header --program-headers --dynamic --dyn-syms "$file")
  has "$program" "a position that is random (PIE)" 'Type: +DYN'
  has "$program" "read-only relocations (RELRO)" '^ +GNU_RELRO'
  has "$program" "symbols bound before it starts (now)" '\(FLAGS_1\).*NOW'
  has "$program" "a stack that cannot be executed" '^ +GNU_STACK .* RW +0x'
  has "$program" "a stack protector" '__stack_chk_fail'
  # The sanitizers look at copies themselves; both do not go together.
  ! grep -qE '__asan_init|__(memcpy|memmove|memset|snprintf|vsnprintf|read|recv)_chk' <<<"$elf" ||
    fortified=$((fortified + 1))
  checked=$((checked + 1))
done
[ "$checked" -ge 10 ] || fail "only $checked programs in $bin"
# Not in each is there a copy whose room the compiler knows and whose length it does not.
[ "$fortified" -gt 0 ] || fail "no program is fortified (_FORTIFY_SOURCE)"
echo "passed: $checked programs, $fortified with checked copies"
