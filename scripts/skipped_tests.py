"""Prints how many tests were skipped and why, from a JUnit file as ctest writes it.

An entry of ctest is a script that says itself that it was skipped, or a program of GoogleTest, which
prints `file:line: Skipped` and the reason for each of its tests."""

import collections
import re
import sys
import xml.etree.ElementTree


def reasons(case):
    """One for each test of the entry that was skipped."""
    output = case.findtext("system-out") or ""
    said = re.findall(r": Skipped\n(.+)", output)
    if said or case.find("skipped") is None:
        return [reason.strip() for reason in said]
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return [lines[-1] if lines else case.find("skipped").get("message") or "no reason given"]


def main(path):
    cases = xml.etree.ElementTree.parse(path).getroot().findall("testcase")
    skipped = collections.defaultdict(list)
    for case in cases:
        for reason in reasons(case):
            skipped[reason].append(case.get("name"))
    count = sum(map(len, skipped.values()))
    print(f"{count} tests skipped" + (":" if count else ""))
    for why, names in sorted(skipped.items()):
        print(f"  {len(names)}: {why}  ({', '.join(sorted(set(names)))})")


if __name__ == "__main__":
    main(sys.argv[1])
