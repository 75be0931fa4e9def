#!/usr/bin/env python3
"""Checks that every room includes only the rooms that cmake/rooms.json allows it.

Looks at each `#include "whirl/ROOM/..."` and `#include "ROOM/..."` in include/ and src/, and that the table has no cycle.
Headers that no other room needs stand in src: those of include/whirl/ROOM are included by another room, or by one that is.
A room with sub-rooms in the table (`ROOM/SUB`) has all its files in them, and these include each other by the table too.
"""
import json
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
allowed = json.loads((root / "cmake/rooms.json").read_text())
include = re.compile(r'^\s*#\s*include\s*["<](?:whirl/)?([a-z_]+)/([^">]+)[">]')
divided = {name.split("/")[0] for name in allowed if "/" in name}
for_tests = {"problem/taylor.hpp"}  # the derivative check of the systems of all rooms
users = {}  # of the headers of include/whirl: files of include and src
errors = []


def check_cycles():
    done, path = set(), []

    def visit(room):
        if room in path:
            errors.append(f"cmake/rooms.json: cycle {' -> '.join(path[path.index(room):] + [room])}")
            return
        if room in done:
            return
        path.append(room)
        for other in allowed.get(room, []):
            if other not in allowed:
                errors.append(f"cmake/rooms.json: {room} may include {other}, which is no room")
            visit(other)
        path.pop()
        done.add(room)

    for room in allowed:
        visit(room)


def check_file(path, room):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = include.match(line)
        if not match:
            continue
        other = match.group(1)
        if '"whirl/' in line:
            users.setdefault(f"{other}/{match.group(2)}", set()).add(path)
        if other == room and room in divided:
            here, there = (f"{room}/{name}" for name in (path.parent.name, match.group(2).split("/")[0]))
            if there != here and there not in allowed.get(here, []):
                errors.append(f"{path.relative_to(root)}:{number}: {here} may not include {there}")
            continue
        if other not in allowed or other == room:
            if '"whirl/' in line and other not in allowed:
                errors.append(f"{path.relative_to(root)}:{number}: {other} is no room of cmake/rooms.json")
            continue
        if other not in allowed[room]:
            errors.append(f"{path.relative_to(root)}:{number}: room {room} may not include {other}")
        elif '"whirl/' not in line:
            errors.append(f"{path.relative_to(root)}:{number}: a private header of {other}")


def check_private():
    """Headers of include/whirl that only their own room reads."""
    public = root / "include/whirl"
    private = {str(p.relative_to(public)) for p in public.rglob("*.hpp")} - for_tests

    def needed(header):
        for user in users.get(header, ()):
            if user.is_relative_to(public):
                name = str(user.relative_to(public))
                if name not in private or name.split("/")[0] != header.split("/")[0]:
                    return True
            elif user.relative_to(root / "src").parts[0] != header.split("/")[0]:
                return True
        return False

    while True:
        found = {header for header in private if needed(header)}
        if not found:
            break
        private -= found
    errors.extend(f"include/whirl/{h}: no other room includes it: its place is src/{h}" for h in sorted(private))


check_cycles()
files = 0
for folder in ("include/whirl", "src"):
    for path in sorted((root / folder).rglob("*")):
        if path.suffix not in (".hpp", ".cpp", ".h"):
            continue
        files += 1
        room = path.relative_to(root / folder).parts[0]
        if room not in allowed:
            errors.append(f"{path.relative_to(root)}: {room} is no room of cmake/rooms.json")
        elif room in divided and f"{room}/{path.parent.name}" not in allowed:
            errors.append(f"{path.relative_to(root)}: {room}/{path.parent.name} is no sub-room of cmake/rooms.json")
        else:
            check_file(path, room)
check_private()

print("\n".join(errors) or f"{files} files keep to the table")
sys.exit(1 if errors or not files else 0)
