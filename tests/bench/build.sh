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

# An archive of a revision, configured; the viewer's page is npm's and the same in both, so it is made
# before the clock runs.
prepare() {  # NAME REVISION
  local tree=$out/$1
  rm -rf "$tree"
  mkdir -p "$tree"
  git -C "$root" archive "$2" | tar -x -C "$tree"
  (cd "$tree" && cmake --preset release -DCMAKE_CXX_COMPILER_LAUNCHER= >"$out/configure.log" 2>&1) ||
    die "$1: cmake failed: $(tail -n 3 "$out/configure.log")"
  ninja -C "$tree/build" viewer_page >"$out/build-$1.log" 2>&1 || true
}

# A build in a session of its own, which can be halted and resumed as a whole.
start_build() {  # NAME TARGET...
  # shellcheck disable=SC2016 # expanded by that shell
  setsid bash -c 'TIMEFORMAT="%U %S"
    { time ninja -C "$1" -j "$2" "${@:5}" >"$3" 2>&1; } 2>"$4"' \
    build "$out/$1/build" "$jobs" "$out/build-$1.log" "$out/time-$1.txt" "${@:2}" &
  session[$1]=$!
}

# Both trees' builds in turns of some seconds: what else the machine does, and how fast it is just
# then, hits both alike. Their processor seconds go to cpu.csv.
build_in_turns() {  # WHAT TARGET...
  local what=$1 turn_s=15 name second
  local -A session=()
  shift
  for name in now before; do
    start_build "$name" "$@"
    pkill -STOP --session "${session[$name]}" || true
  done
  while [ ${#session[@]} -gt 0 ]; do
    for name in "${!session[@]}"; do
      pkill -CONT --session "${session[$name]}" || true
      for ((second = 0; second < turn_s; ++second)); do
        kill -0 "${session[$name]}" 2>/dev/null || break
        sleep 1
      done
      if kill -0 "${session[$name]}" 2>/dev/null; then
        pkill -STOP --session "${session[$name]}" || true
        continue
      fi
      wait "${session[$name]}" || die "$name, $what: $(tail -n 3 "$out/build-$name.log")"
      unset "session[$name]"
      awk -v row="$name,$what" '{ printf "%s,%.1f\n", row, $1 + $2 }' "$out/time-$name.txt" \
        >>"$out/cpu.csv"
      say "$name: $what took $(awk '{ print $1 + $2 }' "$out/time-$name.txt") s of processor time ($SECONDS s)"
    done
  done
}

mkdir -p "$out"
out=$(cd "$out" && pwd)
rm -f "$out"/{cpu.csv,deps-*.txt,table.txt,build.csv,build.png,summary.json}
echo "tree,what,seconds" >"$out/cpu.csv"
prepare now HEAD
prepare before "$base"
build_in_turns programs "${programs[@]/#/bin/}"
build_in_turns rest all
for name in now before; do
  ninja -C "$out/$name/build" -t deps >"$out/deps-$name.txt"
  rm -rf "${out:?}/$name"
done
rm -f "$out"/{build-now.log,build-before.log,configure.log,time-now.txt,time-before.txt}
/usr/bin/python3 "$root/tests/bench/build.py" "$out"
