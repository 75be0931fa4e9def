#!/usr/bin/env python3
"""Checks that every link of every page leads to a file of the sources, and that its heading exists."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
fence = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def anchors(page):
    """The names that a page gives its headings: lower case, words joined by hyphens."""
    text = fence.sub("", page.read_text(encoding="utf-8"))
    names = set()
    for heading in re.findall(r"^#+ +(.*?) *$", text, re.MULTILINE):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        names.add(re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-"))
    return names


pages = [root / "README.md", *(p for f in ("docs", "inputs", "include", "scripts", "src", "tests") for p in sorted((root / f).rglob("*.md")))]
errors, links = [], 0
for page in pages:
    for link in re.findall(r"\]\(([^)\s]+)\)", fence.sub("", page.read_text(encoding="utf-8"))):
        if "://" in link or link.startswith("mailto:"):
            continue
        links += 1
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists():
            errors.append(f"{page.relative_to(root)}: there is no {link}")
        elif anchor and target.suffix == ".md" and anchor not in anchors(target):
            errors.append(f"{page.relative_to(root)}: {link}: no such heading")
print("\n".join(errors) or f"{links} links of {len(pages)} pages lead somewhere")
sys.exit(1 if errors or not links else 0)
