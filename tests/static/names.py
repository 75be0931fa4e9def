#!/usr/bin/env python3
"""Checks that a name of a class, struct or enumeration has one meaning.

Two headers of different rooms may define the same name only where `same` says that it means the same in both. A type of
one .cpp file has another name than those of the headers of its own room. Namespaces would let both pass; readers would
not know which one is meant.
"""
import collections
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
same = {
    "Event": "a bifurcation: found by solve, asked for in a study",
    "Material": "what a solid is made of: mechanical in rotor, thermal in thermal",
    "Options": "of the room",
    "Quantity": "a number with its unit: io and deck",
    "Suspicion": "a stretch where events may lie: found by solve, written by io",
}
defined = re.compile(r"^(?:class|struct|enum class) ([A-Z]\w*)\b(?!::|<|\s*;)")
headers, sources = collections.defaultdict(dict), []
files = 0
for folder in ("include/whirl", "src"):
    for path in sorted((root / folder).rglob("*.[hc]pp")):
        files += 1
        room = path.relative_to(root / folder).parts[0]
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if match := defined.match(line):
                place = f"{path.relative_to(root)}:{number}"
                if path.suffix == ".hpp":
                    headers[match.group(1)].setdefault(room, place)
                else:
                    sources.append((match.group(1), room, place))

errors = [f"{name}: {' and '.join(sorted(places.values()))} mean different things: each needs a name of its own"
          for name, places in sorted(headers.items()) if len(places) > 1 and name not in same]
errors += [f"{place}: {name} is another type in {headers[name][room]}" for name, room, place in sources if room in headers.get(name, {})]
errors += [f"{name} of the list is in one room only" for name in sorted(same) if len(headers.get(name, {})) < 2]
print("\n".join(errors) or f"{len(headers)} names in headers of {files} files")
sys.exit(1 if errors or not files else 0)
