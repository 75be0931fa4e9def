#!/usr/bin/env python3
"""More ranks than intervals: the answer of one rank, by every solver that shares intervals, and along a locus.

idle.py PROGRAM SOURCE LAUNCHER WORDS...
"""
import sys

from compare import same_results
from harness import Harness

h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])
deck = str(h.source / "inputs/rigid_rotor/short_f1.yaml")
FORCED = "unbalance: [a], parameter: speed, range: {from: 384 rad/s, to: 404 rad/s}"
STUDIES = {
    "collocation": f"{{cycle_branch: {{{FORCED}, intervals: 4, degree: 4, points: gauss, adapt_mesh: false}}}}",
    "adapted": f"{{cycle_branch: {{{FORCED}, intervals: 4, degree: 4, points: gauss, adapt_every: 2, mesh_tolerance: 1e-4}}}}",
    "multiple shooting": f"{{cycle_branch: {{{FORCED}, method: multiple_shooting, intervals: 2, steps: 32}}}}",
    "Newton-Picard": f"{{cycle_branch: {{{FORCED}, method: newton_picard, scheme: classical, intervals: 2, steps: 40}}}}",
    "locus": f"{{cycle_branch: {{name: c, {FORCED}, intervals: 4, degree: 6, points: gauss, adapt_mesh: false}}}}, "
             "{locus: {of: c, bifurcation: 1, parameter: unbalance.a.planes.1.eccentricity, range: {from: 2.3 um, to: 2.7 um}}}",
}
for name, studies in STUDIES.items():
    overrides = [f"studies=[{studies}]"]
    # Collocation wants four intervals.
    ranks = 3 if "intervals: 2" in studies else 5
    one = h.run(deck, name, overrides, launcher=[])
    h.run(deck, f"{name}, {ranks} ranks", overrides, launcher=[*h.launcher, "-n", str(ranks)])
    h.true(f"{name}: points were found", all(s["points"] > 1 for s in one.values()), str({k: s["points"] for k, s in one.items()}))
    for what, d, within in same_results(h.work / name, h.work / f"{name}, {ranks} ranks"):
        h.close(f"{name}: {what}", d, 0, within)
h.finish()
