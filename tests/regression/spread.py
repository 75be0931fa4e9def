#!/usr/bin/env python3
"""Cycles of films whose states the ranks share, by collocation: those of one rank with a whole machine, on any number of
ranks, and what is left of a killed run serves any number of them.

spread.py PROGRAM SOURCE LAUNCHER WORDS...
"""
import sys

import h5py
import numpy

from compare import datasets, same_results
from harness import Harness

h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])


def on(ranks):
    return [*h.launcher, "-n", str(ranks)]


def deck(name, machine):
    path = h.work / f"{name}.yaml"
    path.write_text(f"""base: {h.source / 'inputs/compliant_rotor/finite_curve.yaml'}
layout: {{machine: {machine}}}
bearings: {{half: {{film: {{cells: [16, 4]}}}}}}
studies:
  - cycle_branch:
      name: s
      unbalance: [a]
      parameter: speed
      range: {{from: 320 rad/s, to: 350 rad/s}}
      step: {{initial: 4 rad/s, min: 0.001 rad/s, max: 20 rad/s}}
      method: collocation
      intervals: 12
      degree: 2
      mesh_tolerance: 1e-3
      at: [325 rad/s]
""")
    return path
