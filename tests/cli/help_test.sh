#!/usr/bin/env bash
# What every program and every verb says at --help, and every program at --version.
# Usage: help_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

helps() {  # "what" COMMAND...: an example, exit codes in order, nothing of the inside
  accepts "$@" --help
  grep -qE '(Example|Examples): ' "$scratch/output" || complain "$1: no example"
  sed -n '/^Exit codes:$/,$p' "$scratch/output" | grep -oE '^  [0-9]' | tr -d ' \n' >"$scratch/codes"
  grep -qE '^012' "$scratch/codes" || complain "$1: exit codes $(cat "$scratch/codes")"
  ! sed '1,/^Usage:/d' "$scratch/output" | grep -E '[{}]|->|NONNEGATIVE|FLOAT in|[A-Z]+:[A-Z{]' ||
    complain "$1: the inside shows"
}

count=0
for program in "$bin"/rgbdt "$bin"/rgbdt-*; do
  name=$(basename "$program")
  accepts "$name --version" "$program" --version
  grep -qE '^[0-9]+\.[0-9]+\.[0-9]+( \(commit [0-9a-f]{12,}\))?$' "$scratch/output" ||
    complain "$name --version"
  [ "$(wc -l <"$scratch/output")" = 1 ] || complain "$name --version: not one line"
  helps "$name" "$program"
  count=$((count + 1))
done
[ "$count" -ge 12 ] || complain "$count programs"

"$bin/rgbdt" --help >"$scratch/all"
mapfile -t verbs < <(sed '1,/^Subcommands:/d; /^Exit codes:/,$d' "$scratch/all" | grep -oP '^  \K[a-z]+')
[ "${#verbs[@]}" -ge 12 ] || complain "${#verbs[@]} verbs"
for verb in "${verbs[@]}"; do helps "rgbdt $verb" "$bin/rgbdt" "$verb"; done

verdict
