#!/usr/bin/env bash
# Pages that a person reads are true: the example session prints what its page says, messages of the
# troubleshooting page are those of the programs, links lead somewhere. Usage: pages_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
python3 "$here/check_messages.py" "$root" >"$scratch/output" 2>&1 || complain "messages and links"
python3 "$here/check_page.py" "$root/scripts/examples/session/README.md" "$bin" "$scratch" \
  >"$scratch/output" 2>&1 || complain "the example session"

verdict
