"""Pages against the project: what stands in backticks in the first column of TROUBLESHOOTING.md's
tables, and of the glossary's of what verbs print, is said by a program; every relative link of a
page leads to something, a heading included; no program and no page has words that are not plain
English (WORDS).
Usage: check_messages.py SOURCE_DIR"""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
problems = []


def read(path):
    return path.read_text(encoding="utf-8", errors="replace")


def said_by_programs():
    """All literals of the sources, put together where they go on in the next line."""
    text = ""
    for folder in ("calib", "services", "viewer"):
        for path in sorted((root / folder).rglob("*.cc")) + sorted((root / folder).rglob("*.h")):
            text += read(path)
    literals = re.findall(r'"((?:[^"\\\n]|\\.)*)"', re.sub(r'"\s*\n\s*"', "", text))
    return "\n".join(literals).replace('\\"', '"')


# What a person cannot understand at once, and what stands instead.
WORDS = {
    r"finds? itself\b": "is detected automatically",
    r"\b[Hh]ow sure\b": "the uncertainty",
    r"sigma is meant": "1 sigma",
    r"\bis to go from\b": "expected to improve from",
    r"\bthing away\b": "remove the other object",
    r"[Nn]othing can be asked": "not available",
}
STARTS = r"(?:^|[.:;|*] )So,? [a-z]"  # "So" in front of a sentence


def check_words(where, text, wrong):
    for words, instead in wrong.items():
        for found in re.findall(words, text, re.M):
            problems.append(f'{where}: says "{found}"; plainer: {instead}')


def check_all_words(pages):
    """The viewer's page has its words between tags, too: its files are read whole, comments, too,
    in which a sentence may begin with "So"."""
    starts = {STARTS: "leave it out, or say what follows from what"}
    check_words("a program", said_by_programs(), WORDS | starts)
    for path in sorted(pages):
        check_words(path, read(path), starts)
    scripts = subprocess.run(["git", "-C", str(root), "ls-files", "scripts", "viewer/page/src"],
                             capture_output=True, text=True).stdout.splitlines()
    for path in sorted(pages | {root / name for name in scripts}):
        check_words(path, re.sub(r'"?\s*\n\s*"?', " ", read(path)), WORDS)


def check_messages(page, text):
    sources = said_by_programs()
    quotes = 0
    for line in text.splitlines():
        if not line.startswith("|"):
            continue
        first = line.split(" | ")[0].lstrip("| ")
        for _, quote in re.findall(r"(?<!`)(`{1})(?!`)((?:[^`]|``)+)`(?!`)", first):
            if " " not in quote:
                continue  # a name, not a message
            quotes += 1
            for part in quote.replace("``", "`").split("..."):
                if part.strip() and part.strip() not in sources:
                    problems.append(f'{page}: no program says "{part}"')
    if quotes < 15:
        problems.append(f"{page}: only {quotes} messages")


def check_figures(page):
    """The part of the glossary that no unit test holds to what is printed."""
    verbs = ("sync", "scanner", "map", "terrain")
    parts = [part for part in read(page).split("\n## Of rgbdt ") if part.startswith(verbs)]
    if len(parts) != len(verbs):
        problems.append(f"{page}: lacks the figures of one of {verbs}")
    check_messages(page, "\n".join(parts))


def anchors(page):
    heads = re.findall(r"^#+ (.*)$", read(page), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def check_links(page):
    text = re.sub(r"^```.*?^```$", "", read(page), flags=re.M | re.S)
    links = re.findall(r"\]\(([^)\s]+)\)", text)
    for link in links:
        if re.match(r"[a-z]+:", link):
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        if target.is_dir() and anchor:
            target /= "README.md"
        if not target.exists():
            problems.append(f"{page}: {link} leads nowhere")
        elif anchor and anchor not in anchors(target):
            problems.append(f"{page}: no heading {anchor} in {file}")
    return links


PAGES = ["calib/present/report/GLOSSARY.md", "services/rgbdt/TROUBLESHOOTING.md",
         "scripts/examples/session/README.md"]
listed = subprocess.run(["git", "-C", str(root), "ls-files", "*.md"], capture_output=True, text=True)
pages = {root / name for name in [*listed.stdout.splitlines(), *PAGES, "README.md"]}
for page in pages:
    check_links(page)
for name in PAGES:
    if name not in check_links(root / "README.md"):
        problems.append(f"README.md does not lead to {name}")
troubleshooting = root / "services/rgbdt/TROUBLESHOOTING.md"
check_messages(troubleshooting, read(troubleshooting))
check_figures(root / "calib/present/report/GLOSSARY.md")
check_all_words(pages)
for problem in sorted(set(problems)):
    print(problem)
print(f"{len(pages)} pages")
sys.exit(bool(problems))
