#!/usr/bin/env python3
"""Checks that every deck under inputs/ has its row in tests/regression/README.md and that the tests named there exist.

decks.py SOURCE CTEST BUILD
"""
import pathlib
import re
import subprocess
import sys

root, ctest, build = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
listed = subprocess.run([ctest, "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout
tests = set(re.findall(r"Test +#\d+: (\S+)", listed))
rows = {}
for line in (root / "tests/regression/README.md").read_text().splitlines():
    if line.startswith("| `"):
        deck, named, held = (cell.strip() for cell in line.strip("|").split("|"))
        rows[deck.strip("`")] = re.findall(r"`([^`]+)`", named), held
decks = {str(p.relative_to(root / "inputs")) for p in (root / "inputs").rglob("*.yaml")}
errors = [f"{deck} has no row" for deck in sorted(decks - rows.keys())]
errors += [f"there is no deck {deck}" for deck in sorted(rows.keys() - decks)]
for deck, (named, held) in rows.items():
    errors += [f"{deck}: there is no test {name}" for name in named if name not in tests]
    if not named or not held:
        errors.append(f"{deck}: no test or nothing that it is held against")
print("\n".join(errors) or f"{len(decks)} decks have a test")
sys.exit(1 if errors or not decks else 0)
