#!/usr/bin/env bash
# Compiles the present commit and an older one, each once and from nothing, and writes what that
# cost into DIR: cpu.csv (tree, what, seconds), deps-TREE.txt (what ninja knows of includes) and, at
# the end, table, CSV, picture and summary.json (build.py).
# Usage: tests/bench/build.sh DIR [REVISION]
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

out=$1
base=${2:-481fe18}
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
# What scripts/demo runs; the same in both trees.
programs=(rgbdt rgbdt-{assembler,detector,solver,fuser,session,simulator,viewer})
export CCACHE_DISABLE=1
unset CMAKE_CXX_COMPILER_LAUNCHER CMAKE_C_COMPILER_LAUNCHER

git -C "$root" rev-parse --quiet --verify "$base^{commit}" >/dev/null ||
  die "no commit '$base' here; a shallow clone lacks it: git fetch --unshallow"
[ -z "$(git -C "$root" status --porcelain --untracked-files=no)" ] ||
  say "what is not committed is not measured"

# Processor seconds of a command and all that it started.
cpu_seconds() {
  local TIMEFORMAT='%U %S'
  { time "$@" >"$out/build.log" 2>&1; } 2>"$out/time.txt" ||
    die "$*: $(tail -n 3 "$out/build.log")"
  awk '{ print $1 + $2 }' "$out/time.txt"
}

measure() {  # NAME REVISION
  local name=$1 tree=$out/$1 seconds
  rm -rf "$tree"
  mkdir -p "$tree"
  git -C "$root" archive "$2" | tar -x -C "$tree"
  (cd "$tree" && cmake --preset release -DCMAKE_CXX_COMPILER_LAUNCHER= >"$out/configure.log" 2>&1) ||
    die "$name: cmake failed: $(tail -n 3 "$out/configure.log")"
  # The viewer's page is npm's and the same in both; it is made before the clock runs.
  ninja -C "$tree/build" viewer_page >"$out/build.log" 2>&1 || true
  seconds=$(cpu_seconds ninja -C "$tree/build" -j "$jobs" "${programs[@]/#/bin/}")
  echo "$name,programs,$seconds" >>"$out/cpu.csv"
  say "$name: the demo's programs took $seconds s of processor time ($SECONDS s)"
  seconds=$(cpu_seconds ninja -C "$tree/build" -j "$jobs")
  echo "$name,rest,$seconds" >>"$out/cpu.csv"
  say "$name: all the rest, tests included, took $seconds s of processor time ($SECONDS s)"
  ninja -C "$tree/build" -t deps >"$out/deps-$name.txt"
  rm -rf "${tree:?}"
}

mkdir -p "$out"
out=$(cd "$out" && pwd)
rm -f "$out"/{cpu.csv,deps-*.txt,table.txt,build.csv,build.png,summary.json}
echo "tree,what,seconds" >"$out/cpu.csv"
measure now HEAD
measure before "$base"
rm -f "$out"/{build.log,configure.log,time.txt}
/usr/bin/python3 "$root/tests/bench/build.py" "$out"
