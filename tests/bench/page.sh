#!/usr/bin/env bash
# How quickly the viewer's page draws: table, CSV, pictures and summary.json in DIR (page.mjs).
# Usage: tests/bench/page.sh DIR [BUILD_DIR]
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

out=$1
build=${2:-$root/build}
command -v node >/dev/null || die "no node: apt-get install nodejs"
RGBDT_CHROMIUM=$(command -v chromium) || die "no chromium: apt-get install chromium"
RGBDT_PAGE=$build/viewer/page/dist/index.html
RGBDT_PACKAGES=$build/viewer/page/package.json
[ -s "$RGBDT_PAGE" ] || die "no $RGBDT_PAGE: build the target viewer_page first"
export RGBDT_CHROMIUM RGBDT_PAGE RGBDT_PACKAGES
mkdir -p "$out"
node "$(dirname "${BASH_SOURCE[0]}")/page.mjs" "$out"
