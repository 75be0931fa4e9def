#!/usr/bin/env python3
"""A branch that ends where a film becomes too thin ends at the same speed on 1, 2 and 3 ranks, and after a kill.

contact.py PROGRAM SOURCE LAUNCHER WORDS...

The doubled cycle of figure 5.2 at a* = 0.1 (branch 'a1 flip 1') goes up to 3007 rad/s, turns back at a fold and nears the wall.
The place of its end was once what the last step left: 529.80, 529.63 and 529.91 rad/s on 2, 1 and 3 ranks.
"""
import sys

from harness import RANKS, Harness, value

h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])
deck = str(h.source / "inputs/rigid_rotor/figure_5_2.yaml")
BRANCH = ["studies=[{cycle_branch: {name: a1, unbalance: [a1], parameter: speed, range: {from: 320 rad/s, to: 3360 rad/s}, "
          "step: {initial: 4 rad/s, min: 0.0001 rad/s, max: 64 rad/s}, intervals: 40, degree: 4, points: gauss, "
          "mesh_tolerance: 1.0e-7, adapt_every: 2, max_eccentricity: 0.999, follow_flips: true, flips: [1]}}]"]
NAME, CONTACT, WITHIN = "a1 flip 1", 529.97726, 2e-5

runs = {"1 rank": h.run(deck, "1", BRANCH, launcher=[])[NAME]}
for n in map(str, RANKS[1:]):
    runs[f"{n} ranks"] = h.run(deck, n, BRANCH, launcher=[*h.launcher, "-n", n])[NAME]
h.kill_at_checkpoint(deck, h.work / "killed", BRANCH)
runs["1 rank, killed and resumed"] = h.run(deck, "killed", BRANCH, flags=["--resume"], launcher=[])[NAME]
one = runs["1 rank"]
for what, s in runs.items():
    h.close(f"{what}: contact [rad/s]", value(s, "contact"), CONTACT, WITHIN)
    bar = s["values"]["contact"]["uncertainty"]
    h.true(f"{what}: its bar, {bar:.2g} rad/s, is that of location and mesh in time", 1e-6 < bar < 1e-4)
    h.close(f"{what}: points", s["points"], one["points"], 0)
    h.true(f"{what}: it has arrived", s["status"] == "completed", s["status"])
h.finish()
