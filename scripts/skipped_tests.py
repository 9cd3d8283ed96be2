"""Prints how many tests of a JUnit file, as ctest writes it, were skipped and why."""

import collections
import re
import sys
import xml.etree.ElementTree


def reason(case):
    """What the test itself said: GoogleTest prints it after `file:line: Skipped`."""
    output = case.findtext("system-out") or ""
    said = re.search(r": Skipped\n(.+)", output)
    if said:
        return said.group(1).strip()
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    skipped = case.find("skipped")
    return lines[-1] if lines else skipped.get("message", "") if skipped is not None else ""


def main(path):
    cases = xml.etree.ElementTree.parse(path).getroot().findall("testcase")
    skipped = collections.defaultdict(list)
    for case in cases:
        if case.find("skipped") is not None:
            skipped[reason(case) or "no reason given"].append(case.get("name"))
    count = sum(map(len, skipped.values()))
    print(f"{count} of {len(cases)} tests skipped" + (":" if count else ""))
    for why, names in sorted(skipped.items()):
        print(f"  {len(names)}: {why}  ({', '.join(sorted(names))})")


if __name__ == "__main__":
    main(sys.argv[1])
