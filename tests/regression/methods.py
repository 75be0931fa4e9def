#!/usr/bin/env python3
"""A branch by each solver of periodic solutions that is killed after its first checkpoint and resumed finds what an
undisturbed one finds.

methods.py PROGRAM SOURCE
"""
import sys

from compare import same_results
from harness import Harness

program, source = sys.argv[1], sys.argv[2]
h = Harness(program, source, [])
deck = str(h.source / "inputs/rigid_rotor/short_f1.yaml")
FORCED = "unbalance: [a], range: {from: 384 rad/s, to: 404 rad/s}"
SELF_EXCITED = "origin: hopf, range: {from: 424 rad/s, to: 480 rad/s}, max_points: 14"
METHODS = {"shooting": "method: shooting, scheme: radau_iia_3, steps: 40",
           "multiple shooting": "method: multiple_shooting, intervals: 8, steps: 8",
           "finite differences": "method: finite_difference, scheme: classical, intervals: 80",
           "Newton-Picard": "method: newton_picard, scheme: classical, intervals: 80, steps: 1"}


for name, words in METHODS.items():
    for kind, branch in ("forced", FORCED), ("self-excited", SELF_EXCITED):
        case = f"{name}, {kind}"
        overrides = [f"studies=[{{cycle_branch: {{{branch}, {words}}}}}]"]
        h.run(deck, case, overrides)
        out = h.work / f"{case}, killed"
        h.kill_at_checkpoint(deck, out, overrides)
        h.run(deck, f"{case}, killed", overrides, ["--resume"])
        for what, d, within in same_results(h.work / case, out):
            h.close(f"{case}: {what}", d, 0, within)
h.finish()
