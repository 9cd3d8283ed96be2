# shellcheck shell=bash
# Sourced by the command-line tests. Usage of each: NAME_test.sh BIN_DIR

# shellcheck disable=SC2034 # for the tests
bin=$(cd "$1" && pwd)
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rgbdt-cli-XXXXXX")
trap 'chmod -R u+w "$scratch"; rm -rf "$scratch"' EXIT
failures=0

complain() {
  printf 'FAILED: %s\n' "$*" >&2
  sed 's/^/    /' "$scratch/output" >&2
  failures=$((failures + 1))
}

# refuses "what" COMMAND...: fails with exit code 1 to 4, not by a signal, with a line that holds
# each of the words given by `says` before; nothing in $scratch/kept changes.
says=()
refuses() {
  local what=$1 code=0 word before
  shift
  before=$(fingerprint)
  timeout "${patience:-120}" "$@" >"$scratch/output" 2>&1 </dev/null || code=$?
  [ "$code" -ne 0 ] || complain "$what: exit code 0"
  [ "$code" -le 4 ] || complain "$what: exit code $code: another reason, a signal or a time-out"
  for word in "${says[@]}"; do
    grep -qiF -- "$word" "$scratch/output" || complain "$what: no word of '$word'"
  done
  if grep -qE 'terminate called|Assertion|Aborted|libprotobuf|Segmentation' "$scratch/output"; then
    complain "$what: it broke down"
  fi
  [ "$(fingerprint)" = "$before" ] || complain "$what: existing outputs changed"
  says=()
  refused_with=$code
}

# The same of a command line that makes no sense: exit code 2, and one line that leads to --help.
misuses() {
  refuses "$@"
  [ "$refused_with" -eq 2 ] || complain "$1: exit code $refused_with"
  [ "$(wc -l <"$scratch/output")" -eq 1 ] || complain "$1: not one line"
  grep -qF -e '; see ' "$scratch/output" || complain "$1: no way to --help"
}

# ends_with CODE "what" COMMAND...
ends_with() {
  local expected=$1 what=$2 code=0
  shift 2
  timeout "${patience:-120}" "$@" >"$scratch/output" 2>&1 </dev/null || code=$?
  [ "$code" -eq "$expected" ] || complain "$what: exit code $code, not $expected"
}
accepts() { ends_with 0 "$@"; }

says_all() {  # WHAT WORD...
  local word
  for word in "${@:2}"; do
    grep -qF -- "$word" "$scratch/output" || complain "$1: no word of '$word'"
  done
}

lens_of() {  # RIG CAMERA: as a person writes it down
  local width height fx fy cx cy distortion
  read -r width height fx fy cx cy distortion <<<"$(
    sed -n "/name: \"$2\"/,/^}/s/^ *\(fx\|fy\|cx\|cy\|width\|height\|distortion\): //p" "$1" | tr '\n' ' '
  )"
  cat <<TEXT
image_width: $width
image_height: $height
distortion_model: plumb_bob
K: [$fx, 0, $cx, 0, $fy, $cy, 0, 0, 1]
D: $distortion
TEXT
}

fingerprint() {
  { [ ! -d "$scratch/kept" ] || find "$scratch/kept" -type f -exec md5sum {} +; } | sort | md5sum
}

verdict() {
  [ "$failures" -eq 0 ] || exit 1
  echo "passed"
}
