#!/usr/bin/env bash
# An example publisher against what the processes hold messages to. Run by scripts/in-namespace.
# Usage: example_test.sh BIN_DIR line_scan|cloud SOURCE_DIR; exit code 77: skipped
set -euo pipefail
# shellcheck source=tests/live/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

lcm_jar=/usr/share/java/lcm.jar
types_jar=$1/../java/rgbdt.jar
source_dir=$3

case $2 in
  line_scan)
    start example "$bin/publish_line_scan"
    helper hears LINE_SCAN 20 || fail "its lines are not as they should be"
    ;;
  cloud)
    if ! command -v javac >/dev/null || [ ! -f "$lcm_jar" ] || [ ! -f "$types_jar" ]; then
      echo "no rgbdt.jar: apt-get install default-jdk-headless liblcm-java; cmake -DRGBDT_JAVA=ON"
      exit 77
    fi
    javac -cp "$lcm_jar:$types_jar" -d "$scratch/classes" \
      "$source_dir/scripts/examples/PublishCloud.java"
    start example java -cp "$lcm_jar:$types_jar:$scratch/classes" PublishCloud
    helper hears CLOUD 3 || fail "its clouds are not as they should be"
    ;;
  *) fail "unknown example $2" ;;
esac
echo "passed"
