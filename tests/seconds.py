#!/usr/bin/env python3
"""Seconds of processor time that tests take, and those that they may take: tests/budget.txt.

seconds.py table BUILD          passes the output of ctest on, with a table before its closing lines
seconds.py budget CTEST BUILD   checks that the budgets of a tier fit its minutes on two cores
seconds.py over BUILD           checks that no test has taken much more than its budget
seconds.py lines BUILD          lines for budget.txt: what tests took when they ran last, and a third more
"""
import json
import math
import pathlib
import re
import subprocess
import sys

# Minutes of a tier on two idle cores, a tenth of which may pass with one core idle.
MINUTES = {"commit": 5, "main": 12}
CORES, IN_USE = 2, 0.9
SMALL = 2  # seconds that any test may take without a line in the file
BEYOND = 1.5  # other work on the same cores costs that much


def budgets():
    """Seconds by test."""
    lines = (line.split() for line in (pathlib.Path(__file__).parent / "budget.txt").read_text().splitlines())
    return {words[0]: float(words[1]) for words in lines if words and words[0] != "#"}


def taken(build):
    """Processor seconds of each test when it ran last."""
    found = {}
    for path in (pathlib.Path(build) / "tests/seconds").glob("*"):
        if len(words := path.read_text().split()) == 2:
            found[path.name] = float(words[0]) + float(words[1])
    return found


def table(build):
    """Rows of tests that ran just now, the dearest first; cheap ones together."""
    allowed, wall, held = budgets(), {}, []
    for line in sys.stdin:
        if held or re.match(r"\d+% tests passed", line):
            held.append(line)
            continue
        sys.stdout.write(line)
        sys.stdout.flush()
        if ran := re.match(r" *\d+/\d+ Test +#\d+: (\S+) [.* ]*[A-Z].*? +([\d.]+) sec", line):
            wall[ran[1]] = float(ran[2])
    seconds = {name: s for name, s in taken(build).items() if name in wall}
    dear = sorted((name for name, s in seconds.items() if s >= SMALL), key=lambda name: -seconds[name])
    if seconds:
        print(f"\n{'processor s':>11} {'wall s':>8} {'budget':>8}  test")
        for name in dear:
            budget = allowed.get(name, SMALL)
            print(f"{seconds[name]:11.1f} {wall[name]:8.1f} {budget:8.0f}  {name}{'  !' if seconds[name] > BEYOND * budget else ''}")
        rest = seconds.keys() - set(dear)
        print(f"{sum(seconds[n] for n in rest):11.1f} {sum(wall[n] for n in rest):8.1f} {'':8}  {len(rest)} others, below {SMALL} s each")
        print(f"{sum(seconds.values()):11.1f} {sum(wall.values()):8.1f} {'':8}  together")
    sys.stdout.writelines(["\n", *held])


def tests_of(ctest, build):
    """Labels of each test."""
    listed = subprocess.run([ctest, "--test-dir", build, "--show-only=json-v1"], capture_output=True, text=True, check=True).stdout
    labels = lambda test: next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
    return {test["name"]: labels(test) for test in json.loads(listed)["tests"]}


def budget(ctest, build):
    allowed, tests = budgets(), tests_of(ctest, build)
    errors = [f"budget.txt: there is no test {name}" for name in allowed.keys() - tests.keys()]
    tiers = {"commit": [n for n, labels in tests.items() if "commit" in labels],
             "main": [n for n, labels in tests.items() if "heavy" not in labels]}
    for tier, names in tiers.items():
        may = MINUTES[tier] * 60 * CORES * IN_USE
        # A line is a third more than what was measured; most of the small tests take far less than they may.
        own = sum(allowed[name] * 3 / 4 if name in allowed else SMALL / 4 for name in names)
        print(f"{tier}: {len(names)} tests, {own:.0f} of {may:.0f} s of processor time")
        if own > may:
            errors.append(f"the tests of '{tier}' take {own:.0f} s of processor time of {may:.0f} s: make them cheaper, or give some the label heavy")
    return errors


def over(build):
    allowed = budgets()
    return [f"{name}: {s:.1f} s of processor time, its budget is {allowed.get(name, SMALL):g} s" for name, s in sorted(taken(build).items())
            if s > BEYOND * allowed.get(name, SMALL)]


def lines(build):
    for name, s in sorted(taken(build).items()):
        if s > SMALL:
            print(name, math.ceil(s * 4 / 3))


if __name__ == "__main__":
    if sys.argv[1] in ("table", "lines"):
        {"table": table, "lines": lines}[sys.argv[1]](sys.argv[2])
    else:
        found = {"budget": budget, "over": over}[sys.argv[1]](*sys.argv[2:])
        print("\n".join(found))
        sys.exit(1 if found else 0)
