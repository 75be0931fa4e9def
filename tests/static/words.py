#!/usr/bin/env python3
"""Checks that the pages and the comments of decks keep to plain English.

Read are all pages (*.md) without tables, code and headings, and the comments of the decks below inputs/. Lines are
joined first: a phrase or a sentence may wrap. Bad are
- phrases that hide the noun, such as "what is left", "whoever" or "those of the": PHRASES;
- sentences of more than LONGEST words.

BUDGET says how many of these a file may still have; files that are not listed may have none. The test fails if a file
has more. It also fails if a file has fewer, and names the number to write: a budget only shrinks. Do not raise one:
mend the sentence.
"""
import pathlib
import re
import sys

PHRASES = ["what is left", "what was left", "whoever", "is told", "are told", "nothing is known of", "the other one", "as such",
           "none is", "is none", "are none", "nobody", "those that", "will not do", "would not do", "is to be had", "who has",
           "answers as", "(?:that|those) of (?:an?|the)"]
LONGEST = 45  # words of a sentence
BUDGET: dict = {}

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
PHRASE = re.compile(r"\b(?:" + "|".join(PHRASES) + r")\b", re.IGNORECASE)


def page(text):
    """The prose of a page, a blank line in place of tables, code and headings."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    return "\n".join("" if re.match(r"    |\s*\||#|<!--", line) else line for line in text.split("\n"))


def comments(text):
    """The comments of a deck, a blank line in place of what stands between them."""
    found = (re.search(r"(?:^|\s)#\s?(.*)", line) for line in text.split("\n"))
    return "\n".join(f[1] if f else "" for f in found)


def sentences(prose):
    for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", prose):
        yield from re.split(r"(?<=[.!?;:])\s+", " ".join(paragraph.split()))


files = [root / "README.md", *(p for f in ("docs", "include", "scripts", "src", "tests", "inputs") for p in sorted((root / f).rglob("*.md")))]
files += sorted((root / "inputs").rglob("*.yaml"))
errors = []
for file in files:
    name = str(file.relative_to(root))
    prose = (page if file.suffix == ".md" else comments)(file.read_text(encoding="utf-8"))
    joined = " ".join(prose.split())
    hits = [f"'{hit[0]}': name the thing: ...{joined[max(0, hit.start() - 50):hit.end() + 40]}..." for hit in PHRASE.finditer(joined)]
    hits += [f"a sentence of {len(s.split())} words: {s[:70]}..." for s in sentences(prose) if len(s.split()) > LONGEST]
    allowed = BUDGET.get(name, 0)
    if len(hits) > allowed:
        errors += [f"{name}: {hit}" for hit in hits]
    elif len(hits) < allowed:
        errors.append(f"{name} is better than its budget: write {len(hits)} into BUDGET of tests/static/words.py")
errors += [f"BUDGET names {name}, which is not there" for name in BUDGET if not (root / name).is_file()]
print("\n".join(errors) or f"{len(files)} pages and decks keep to plain words")
sys.exit(1 if errors or not files else 0)
