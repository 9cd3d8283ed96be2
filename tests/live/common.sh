# shellcheck shell=bash
# Sourced by the live tests: processes in the background, a folder that goes away.

bin=$1
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rgbdt-live-XXXXXX")
declare -A pids=()

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  local log
  for log in "$scratch"/*.log; do
    [ -s "$log" ] && printf -- '-- %s\n%s\n' "${log##*/}" "$(tail -n 8 "$log")" >&2
  done
  exit 1
}

clean_up() {
  local pid
  for pid in "${pids[@]}"; do kill -KILL "$pid" 2>/dev/null || true; done
  rm -rf "$scratch"
}
trap clean_up EXIT

start() {  # NAME COMMAND...: in the background, its output in NAME.log
  local name=$1
  shift
  # A background job of a script ignores SIGINT unless told otherwise, and lcm-logger stops by it.
  env --default-signal=INT "$@" >"$scratch/$name.log" 2>&1 &
  pids[$name]=$!
}

wait_for() {  # NAME: its exit code
  local code=0
  wait "${pids[$1]}" || code=$?
  unset "pids[$1]"
  return "$code"
}

stop() {  # SIGNAL NAME...: each must end with exit code 0
  local signal=$1 name
  shift
  for name in "$@"; do kill "-$signal" "${pids[$name]}" || fail "$name was gone"; done
  for name in "$@"; do wait_for "$name" || fail "$name ended with exit code $? by SIG$signal"; done
}

kill_process() {  # NAME
  kill -KILL "${pids[$1]}"
  wait_for "$1" || true
}

helper() { "$bin/live_helper" "$@"; }
