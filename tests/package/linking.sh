#!/usr/bin/env bash
# What is installed below PREFIX can be linked: the example by CMake and by pkg-config, every public
# header by itself, every component with all that it needs.
# Usage: linking.sh PREFIX SESSION_DIR, a session that is calibrated
set -euo pipefail

prefix=$1
session=$2
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rgbdt-linking-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
compiler=(g++ -std=c++17)
if command -v ccache >/dev/null; then
  compiler=(ccache "${compiler[@]}")
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi

step() { printf -- '-- %s\n' "$*"; }
fail() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}

pkg_config_folder=$(echo "$prefix"/lib/*/pkgconfig)
export PKG_CONFIG_PATH=$pkg_config_folder
components=()
for file in "$pkg_config_folder"/rgbdt-*.pc; do
  name=${file##*/rgbdt-}
  components+=("${name%.pc}")
done
step "components: ${components[*]}"

step "the example, by CMake"
example=$prefix/share/rgbdt/examples/fuse_view
if ! { cmake -S "$example" -B "$scratch/by_cmake" -DCMAKE_PREFIX_PATH="$prefix" &&
  cmake --build "$scratch/by_cmake"; } >"$scratch/log" 2>&1; then
  cat "$scratch/log"
  fail "find_package or the build"
fi
"$scratch/by_cmake/fuse_view" "$session" | tee "$scratch/said_by_cmake"
grep -qE '^[^:]+: [1-9][0-9]* points, [1-9][0-9]* with a temperature' "$scratch/said_by_cmake" ||
  fail "the example coloured nothing"

step "the example, by pkg-config"
read -ra flags < <(pkg-config --cflags --libs rgbdt-messages)
"${compiler[@]}" "$example/fuse_view.cc" -o "$scratch/by_pkg_config" "${flags[@]}"
"$scratch/by_pkg_config" "$session" | diff "$scratch/said_by_cmake" - ||
  fail "it says something else than the one made by CMake"

step "each component, by CMake"
mkdir "$scratch/each"
cat >"$scratch/each/CMakeLists.txt" <<'END_OF_LIST'
cmake_minimum_required(VERSION 3.25)
project(each CXX)
foreach(component ${COMPONENTS})
  find_package(rgbdt 0.1 REQUIRED COMPONENTS ${component})
  if(NOT TARGET rgbdt::${component})
    message(FATAL_ERROR "no target rgbdt::${component}")
  endif()
endforeach()
find_package(rgbdt QUIET COMPONENTS nonsense)
if(rgbdt_FOUND)
  message(FATAL_ERROR "there is no component nonsense, but it was found")
endif()
END_OF_LIST
for component in "${components[@]}"; do
  rm -rf "$scratch/each/build"
  cmake -S "$scratch/each" -B "$scratch/each/build" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCOMPONENTS="$component" >"$scratch/log" 2>&1 || {
    cat "$scratch/log"
    fail "component $component"
  }
done

step "each component with all of its objects, by pkg-config"
echo 'int main() {}' >"$scratch/empty.cc"
for component in "${components[@]}"; do
  read -ra flags < <(pkg-config --libs "rgbdt-$component")
  ours=() others=()
  for flag in "${flags[@]}"; do
    case $flag in
      -lrgbdt_*) ours+=("$flag") ;;
      *) others+=("$flag") ;;
    esac
  done
  "${compiler[@]}" "$scratch/empty.cc" -o "$scratch/whole" -L"${pkg_config_folder%/pkgconfig}" \
    -Wl,--whole-archive "${ours[@]}" -Wl,--no-whole-archive "${others[@]}" ||
    fail "component $component needs more than its .pc file says"
done

step "each public header"
(cd "$prefix/include/rgbdt" && find calib services -name '*.h' | sort) >"$scratch/headers"
[ -s "$scratch/headers" ] || fail "there are none"
sed 's/.*/#include "&"/' "$scratch/headers" >"$scratch/headers.cc"
read -ra flags < <(pkg-config --cflags "${components[@]/#/rgbdt-}")
"${compiler[@]}" -fsyntax-only "${flags[@]}" "$scratch/headers.cc" ||
  fail "a public header needs something that is not installed"
step "passed: ${#components[@]} components, $(wc -l <"$scratch/headers") headers"
