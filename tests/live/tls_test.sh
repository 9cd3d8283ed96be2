#!/usr/bin/env bash
# rgbdt-viewer by TLS, to curl and openssl: beyond loopback by itself, with the fingerprint that it
# prints; by files; in clear where it is told to. Run by scripts/in-namespace.
# Usage: tls_test.sh BIN_DIR; exit code 77: skipped
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

for tool in curl openssl; do
  command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
done

start_viewer() {  # ARGUMENT...: sets $port
  start viewer "$bin/rgbdt-viewer" "$@"
  for _ in $(seq 300); do
    ! grep -q "^$begins" "$scratch/viewer.log" || break
    kill -0 "${pids[viewer]}" 2>/dev/null || fail "rgbdt-viewer ended"
    sleep 0.1
  done
  port=$(sed -n "1s|^$begins//[^/]*:\\([0-9]*\\).*|\\1|p" "$scratch/viewer.log")
  [ -n "$port" ] || fail "no address: $(cat "$scratch/viewer.log")"
}

page() {  # OPTION... URL: its status, the answer in $scratch/answer
  curl --silent --show-error --max-time 60 --output "$scratch/answer" --write-out '%{http_code}' "$@"
}

refuses() {  # WORD ARGUMENT...: rgbdt-viewer ends, with one line that has the word
  local word=$1 code=0
  shift
  timeout 60 "$bin/rgbdt-viewer" --listen 127.0.0.1:0 "$@" >"$scratch/refused.log" 2>&1 || code=$?
  [ "$code" = 1 ] || fail "$*: exit code $code"
  [ "$(wc -l <"$scratch/refused.log")" = 1 ] || fail "$*: not one line"
  grep -qF -- "$word" "$scratch/refused.log" || fail "$*: $(cat "$scratch/refused.log")"
}

echo "== beyond loopback, with a certificate of its own"
begins=https:
start_viewer --listen 0.0.0.0:0
grep -q '#token=' "$scratch/viewer.log" || fail "no token"
openssl s_client -connect "127.0.0.1:$port" </dev/null 2>/dev/null | openssl x509 >"$scratch/shown.crt"
shown=$(openssl x509 -in "$scratch/shown.crt" -noout -fingerprint -sha256 | sed 's/.*=//')
until grep -q '^certificate: ' "$scratch/viewer.log"; do sleep 0.1; done
printed=$(sed -n 's/^certificate: SHA-256 //p' "$scratch/viewer.log")
[ "$shown" = "$printed" ] || fail "it prints the fingerprint $printed and shows $shown"
code=$(page --cacert "$scratch/shown.crt" "https://127.0.0.1:$port/")
[ "$code" = 200 ] || fail "the page was answered by $code"
if page "https://127.0.0.1:$port/" >/dev/null 2>&1; then fail "curl trusts it without being told to"; fi
code=$(page "http://127.0.0.1:$port/")
[ "$code" = 400 ] || fail "in clear it was answered by $code"
grep -q 'write https://' "$scratch/answer" || fail "in clear it is not said what to do"
if page --tls-max 1.1 --ciphers DEFAULT@SECLEVEL=0 --cacert "$scratch/shown.crt" \
  "https://127.0.0.1:$port/" >/dev/null 2>&1; then fail "it speaks TLS 1.1"; fi
stop TERM viewer

echo "== with files"
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=localhost \
  -addext subjectAltName=DNS:localhost -keyout "$scratch/key.pem" -out "$scratch/crt.pem" 2>/dev/null
start_viewer --listen 127.0.0.1:0 --tls "$scratch/crt.pem" "$scratch/key.pem"
code=$(page --cacert "$scratch/crt.pem" "https://localhost:$port/")
[ "$code" = 200 ] || fail "the page was answered by $code"
stop TERM viewer

echo "== in clear, where it is told to"
begins=http:
start_viewer --listen 0.0.0.0:0 --no-tls
until grep -q '^in clear: ' "$scratch/viewer.log"; do sleep 0.1; done
code=$(page "http://127.0.0.1:$port/")
[ "$code" = 200 ] || fail "the page was answered by $code"
stop TERM viewer
start_viewer --listen 127.0.0.1:0
code=$(page "http://127.0.0.1:$port/")
[ "$code" = 200 ] || fail "on loopback the page was answered by $code"
stop TERM viewer

echo "== files that are none"
openssl ecparam -name prime256v1 -genkey -noout -out "$scratch/other.pem"
openssl ec -in "$scratch/key.pem" -aes128 -passout pass:secret -out "$scratch/locked.pem" 2>/dev/null
refuses "another certificate's" --tls "$scratch/crt.pem" "$scratch/other.pem"
refuses "has a passphrase" --tls "$scratch/crt.pem" "$scratch/locked.pem"
refuses "the certificate is none" --tls "$scratch/key.pem" "$scratch/key.pem"
refuses "nowhere" --tls "$scratch/nowhere" "$scratch/key.pem"
echo "passed"
