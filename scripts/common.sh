# shellcheck shell=bash
# Sourced by the other scripts; does nothing by itself.

# The project's root, wherever the script was called from.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '%s: %s\n' "${0##*/}" "$*"; }
die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# Which CMake preset to build; .ci/run sets `ci`, so that the same scripts do not build twice.
: "${RGBDT_PRESET:=release}"

# Where a preset of CMakePresets.json builds: build for `release`, build-NAME for NAME.
build_dir() {
  if [ "$RGBDT_PRESET" = release ]; then
    printf '%s\n' "$root/build"
  else
    printf '%s\n' "$root/build-$RGBDT_PRESET"
  fi
}

# True where as_root can work without somebody being asked a password that nobody can type.
can_be_root() {
  [ "$(id -u)" -eq 0 ] || { command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; }
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}
