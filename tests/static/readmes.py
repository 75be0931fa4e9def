#!/usr/bin/env python3
"""Checks that every room and sub-room has its page, src/ROOM[/SUB]/README.md, and that the page is one."""
import json
import pathlib
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
errors = []
rooms = [root / "src" / name for name in json.loads((root / "cmake/rooms.json").read_text())]
for room in rooms:
    page = room / "README.md"
    if not page.is_file():
        errors.append(f"{room.relative_to(root)} has no README.md")
    elif len(page.read_text().split()) < 40:
        errors.append(f"{room.relative_to(root)}/README.md says nothing")
print("\n".join(errors) or f"{len(rooms)} rooms have their page")
sys.exit(1 if errors or not rooms else 0)
