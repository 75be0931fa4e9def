#!/usr/bin/env python3
"""Checks that the version stands in CMakeLists.txt, and that the pages which have to repeat it say the same."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
read = lambda path: (root / path).read_text(encoding="utf-8")  # noqa: E731
version = re.search(r"project\(whirl VERSION (\d+\.\d+\.\d+) ", read("CMakeLists.txt"))[1]
errors = []
for path, pattern in (("docs/CITATION.cff", r"^version: (.*)$"), ("docs/CHANGELOG.md", r"^## ([\d.]+)")):
    found = re.search(pattern, read(path), re.MULTILINE)
    if not found or found[1] != version:
        errors.append(f"{path}: version {found[1] if found else 'missing'}, not {version}")
for path in ("scripts/pyproject.toml", "scripts/setup.py", "scripts/whirl/__init__.py", "docs/whirl.1"):
    if version in read(path):
        errors.append(f"{path} repeats the version {version}, which it has to derive")
print("\n".join(errors) or f"version {version}")
sys.exit(1 if errors else 0)
