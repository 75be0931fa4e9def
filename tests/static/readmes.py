#!/usr/bin/env python3
"""Checks that every room has its page, src/ROOM/README.md, and that the page is one."""
import pathlib
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
errors = []
rooms = sorted(p for p in (root / "src").iterdir() if p.is_dir())
for room in rooms:
    page = room / "README.md"
    if not page.is_file():
        errors.append(f"src/{room.name} has no README.md")
    elif len(page.read_text().split()) < 40:
        errors.append(f"src/{room.name}/README.md says nothing")
print("\n".join(errors) or f"{len(rooms)} rooms have their page")
sys.exit(1 if errors or not rooms else 0)
