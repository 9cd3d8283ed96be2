#!/usr/bin/env bash
# What our programs load, by `ldd`, and what they carry in themselves, by their symbols: each only
# what its job needs. Usage: linked_test.sh BIN_DIR
set -euo pipefail
bin=$1

fail() {
  echo "linked_test: $*" >&2
  exit 1
}

loads() {  # PROGRAM: names of all shared libraries, also of those that others load
  ldd "$bin/$1" | awk '{ print $1 }'
}

carries() {  # PROGRAM NAMESPACE: whether it holds code of that C++ namespace
  nm "$bin/$1" | grep -E "NK?${#2}$2" >/dev/null
}

must_not() {  # PROGRAM LIBRARY...: neither loaded nor linked in
  local program=$1 library
  shift
  for library in "$@"; do
    ! loads "$program" | grep "^lib$library" || fail "$program loads $library"
    ! carries "$program" "$library" || fail "$program holds code of $library"
  done
}

must_load() {  # PROGRAM LIBRARY: else this test would see nothing
  loads "$1" | grep "^lib$2" >/dev/null || fail "$1 does not load $2; is it still called so?"
}

must_load rgbdt-detector pcl
must_load rgbdt-camera aravis
must_load rgbdt-lidar pcap
loads rgbdt-solver | grep '^libceres' >/dev/null || carries rgbdt-solver ceres ||
  fail "rgbdt-solver does without ceres; is it still called so?"

must_not rgbdt-solver pcl aravis pcap
must_not rgbdt-fuser pcl aravis pcap ceres
must_not rgbdt-viewer aravis pcap
must_not viewer_server_test pcl ceres aravis
echo passed
