"""Makes manual pages from what programs print at --help: one a program, one a verb of rgbdt. A verb
that is called as a program (rgbdt session, rgbdt-session) follows on that one's page.

Usage: man_pages.py OUT_DIR VERSION PROGRAM...
"""
import gzip
import pathlib
import re
import subprocess
import sys

MANUAL = "rgbdt manual"


def help_of(command):
    return subprocess.run(
        [*command, "--help"], check=True, capture_output=True, text=True
    ).stdout


def parse(text):
    """Description's lines, the usage line, and {section: [[name, line...]...]}."""
    description, usage, sections = [], "", {}
    entries = None
    for line in text.splitlines():
        if line.startswith("Usage: "):
            usage = line.removeprefix("Usage: ")
        elif not usage:
            description.append(line)
        elif re.fullmatch(r"\S.*:", line):
            entries = sections.setdefault(line[:-1], [])
        elif re.match(r"  \S", line):
            entries.append(re.split(r"  +", line.strip(), maxsplit=1))
        elif line.strip():
            entries[-1].append(line.strip())
    return description, usage, sections


def escape(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith(".") else text


def split_examples(description):
    """Prose and the commands after "Example:" or "Examples:", which go on to the end."""
    for i, line in enumerate(description):
        found = re.search(r"Examples?: ", line)
        if found:
            before, example = line[:found.start()], line[found.end():]
            prose = description[:i] + ([before] if before else [])
            return prose, [example] + [after.strip() for after in description[i + 1:]]
    return description, []


def first_sentence(prose):
    return re.split(r"[.:;] |[.:;]?$", " ".join(prose), maxsplit=1)[0]


def page(name, text, version, see_also):
    description, usage, sections = parse(text)
    prose, examples = split_examples(description)
    prose = [line.removeprefix(name + ": ") for line in prose]
    lines = [f'.TH "{name.upper()}" 1 "" "rgbdt {version}" "{MANUAL}"', ".SH NAME",
             f"{escape(name)} \\- {escape(first_sentence(prose))}",
             ".SH SYNOPSIS", escape(usage), ".SH DESCRIPTION", *map(escape, prose)]
    for section, entries in sections.items():
        lines.append(f".SH {section.upper()}")
        for term, *text in entries:
            if section == "Subcommands":  # each has a page
                text = [first_sentence(split_examples(text)[0])]
            lines += [".TP", ".B " + escape(term), *map(escape, text)]
    if examples:
        lines += [".SH EXAMPLES", ".nf", *map(escape, examples), ".fi"]
    lines.append(".SH SEE ALSO")
    lines += [f".BR {escape(other)} (1)" for other in see_also if other != name]
    return "\n".join(lines) + "\n"


def main(out, version, *programs):
    texts, verbs = {}, {}
    for program in programs:
        name = pathlib.Path(program).name
        texts[name] = help_of([program])
        for verb, *_ in parse(texts[name])[2].get("Subcommands", []):
            verbs[f"{name}-{verb}"] = f"{name} {verb}", help_of([program, verb])
    names = sorted({*texts, *verbs})
    folder = pathlib.Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    for stale in folder.glob("*.1.gz"):
        stale.unlink()
    for name in names:
        pages = [page(name, texts[name], version, names)] if name in texts else []
        if name in verbs:
            title, text = verbs[name]
            pages.append(page(title if pages else name, text, version, names))
        source = "".join(pages).encode()
        (folder / f"{name}.1.gz").write_bytes(gzip.compress(source, mtime=0))


if __name__ == "__main__":
    main(*sys.argv[1:])
