"""Runs the commands of a page's console blocks, in order, and holds what they print against it.
Words are to be the same; figures as far as a page shows them; "..." is anything, in a line or for
any number of lines. Usage: check_page.py PAGE BIN_DIR SCRATCH_DIR"""
import os
import re
import subprocess
import sys

page, bin_dir, scratch = sys.argv[1:]
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
environment = dict(os.environ, PATH=f"{os.path.abspath(bin_dir)}:{os.environ['PATH']}", LC_ALL="C")


def blocks(text):
    """[(command, [line...])...]"""
    steps = []
    for block in re.findall(r"^```console\n(.*?)^```$", text, re.M | re.S):
        for line in block.splitlines():
            if line.startswith("$ "):
                steps.append((line[2:], []))
            else:
                steps[-1][1].append(line)
    return steps


def near(expected, actual):
    """To what the page shows of it, and to a third: another machine rounds otherwise."""
    digits = len(expected.partition(".")[2])
    a, b = float(expected), float(actual)
    if "." not in expected and abs(a) < 100:  # a count
        return a == b
    return abs(a - b) <= 0.34 * max(abs(a), abs(b)) + 2 * 10 ** -digits


def same(expected, actual):
    words, *more = " ".join(expected.split()).split("...")
    expected_numbers = NUMBER.findall(words)
    pattern = r"\s*".join(re.escape(word) for word in NUMBER.sub(" \0 ", words).split())
    pattern = pattern.replace(re.escape("\0"), f"({NUMBER.pattern})")
    match = re.match(pattern + (r"\s*" if more else r"\s*$"), actual.strip())
    if not match or not all(map(near, expected_numbers, match.groups())):
        return False
    rest = actual.strip()[match.end():]
    return not more or all(part.strip() in rest for part in more)


def matches(expected, actual):
    if not expected:
        return not actual
    if expected[0].strip() == "...":
        return any(matches(expected[1:], actual[i:]) for i in range(len(actual) + 1))
    return bool(actual) and same(expected[0], actual[0]) and matches(expected[1:], actual[1:])


def self_test():
    assert same("a 1.20 +- 0.3 mm", "a   1.31 +- 0.2  mm")
    assert not same("a 1.20 mm", "a 9.20 mm") and not same("a 1.20 mm", "b 1.20 mm")
    assert not same("8 / 4 / 0", "8 / 3 / 1") and same("12 views ...", "12 views, 3 more")
    assert matches(["a", "...", "d"], ["a", "b", "c", "d"]) and not matches(["a", "d"], ["a", "b"])
    assert not matches(["a"], ["a", "b"]) and not matches(["a", "..."], ["b"])


self_test()
with open(page, encoding="utf-8") as f:
    steps = blocks(f.read())
if not steps:
    sys.exit(f"{page}: no console block")
for command, expected in steps:
    run = subprocess.run(["bash", "-c", command], cwd=scratch, env=environment, text=True,
                         stdin=subprocess.DEVNULL, capture_output=True, check=False)
    actual = run.stdout.splitlines()
    if not matches(expected, actual):
        sys.exit("\n".join([f"{page}: $ {command}", "the page says:", *expected, "it prints:", *actual,
                            "and on stderr:", *run.stderr.splitlines()]))
print(f"{len(steps)} commands as the page says")
