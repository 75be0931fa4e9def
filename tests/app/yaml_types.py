#!/usr/bin/env python3
"""Decks must mean the same to readers of YAML 1.1 as to Whirl: numbers are numbers, text is text.

yaml_types.py DECK...   compares the types that PyYAML finds with those that Whirl finds; exit 1 if any differs.
"""
import re
import sys

import yaml

# libyaml's parser where PyYAML has it: the same nodes and types, several times faster. Its plain scalars have the style "".
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def ours(node):
    """Type and value of a scalar as Whirl reads it."""
    if node.style:
        return "str", node.value
    if node.value in ("", "~", "null"):
        return "null", None
    if node.value in ("true", "false"):
        return "bool", node.value == "true"
    if NUMBER.fullmatch(node.value):
        return "number", float(node.value)
    return "str", node.value


def theirs(node, loader):
    value = loader.construct_object(node)
    kind = {bool: "bool", int: "number", float: "number", str: "str", type(None): "null"}.get(type(value), type(value).__name__)
    return kind, float(value) if kind == "number" else value


def differences(path):
    with open(path, encoding="utf-8") as file:
        loader = LOADER(file)
        root = loader.get_single_node()
    seen, stack = set(), [root]
    while stack:
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            stack += [part for pair in node.value for part in pair]
        elif isinstance(node, yaml.SequenceNode):
            stack += node.value
        elif ours(node) != theirs(node, loader):
            mark = node.start_mark
            yield f"{path}:{mark.line + 1}:{mark.column + 1}: '{node.value}' is {ours(node)} to Whirl, {theirs(node, loader)} to PyYAML"


def main():
    wrong = [line for path in sys.argv[1:] for line in differences(path)]
    print("\n".join(wrong) if wrong else f"{len(sys.argv) - 1} decks alike")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
