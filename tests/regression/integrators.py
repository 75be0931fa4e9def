#!/usr/bin/env python3
"""Schemes of steps in time that a deck chooses: the same motion by all, on any number of ranks, killed and resumed.

integrators.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import sys

import h5py
import numpy as np

from compare import same_results
from harness import RANKS, Harness, value

SCHEMES = {"sdirk4": "type: sdirk4", "generalized_alpha": "type: generalized_alpha", "bdf": "type: bdf, order: 3",
           "irk": "type: irk, stages: 2, steps: 64", "newmark": "type: newmark, steps: 256",
           "newmark_linearised": "type: newmark_linearised, steps: 256",
           "newmark_fixed_point": "type: newmark_fixed_point, steps: 1024",
           "runge_kutta_4": "type: runge_kutta_4, steps: 1024", "adams_moulton": "type: adams_moulton, steps: 2048"}
SEVERAL_STEPS = ("generalized_alpha", "bdf")


def study(name, kind, revolutions, discard=0):
    return (f"{{motion: {{name: {name}, integrator: {{{kind}}}, unbalance: [disc], speed: 1000 rad/s, discard: {discard},"
            f" revolutions: {revolutions}, samples: 16, exponents: 0, tolerance: 1e-6}}}}")


def agree(h):
    """The deck: every scheme draws the orbit of sdirk4."""
    deck = h.source / "inputs/merot/integrators.yaml"
    overrides = []
    for k in range(1, 10):
        overrides += [f"studies.{k}.motion.discard=4", f"studies.{k}.motion.revolutions=4"]
    run = h.run(deck, "agree", overrides)
    for name in SCHEMES:
        for bearing in ("left", "right"):
            for axis in "xy":
                key = f"peak_to_peak.{bearing}.{axis}"
                wanted = value(run["sdirk4"], key)
                h.close(f"{name}: {key} per sdirk4", value(run[name], key) / wanted, 1, 2e-3)


def ranks(h):
    """One, two and three ranks: the same."""
    deck = h.source / "inputs/merot/integrators.yaml"
    studies = ", ".join(study(n, k, 2) for n, k in SCHEMES.items())
    for n in RANKS:
        h.run(deck, f"on {n}", [f"studies=[{studies}]"], launcher=[*h.launcher, "-n", str(n)])
        if n > 1:
            for what, difference, within in same_results(h.work / "on 1", h.work / f"on {n}"):
                h.close(f"{n} ranks: {what}", difference, 0, within)


def resume(h):
    """Killed and resumed: to the bit what remembers no steps, else to what a new start of the history costs."""
    deck = h.source / "inputs/merot/integrators.yaml"
    for name in ("newmark", "adams_moulton", *SEVERAL_STEPS):
        steps = SCHEMES[name].replace("2048", "1024")
        overrides = [f"studies=[{study(name, steps, 24)}]"]
        h.run(deck, name, overrides, launcher=[])
        out = h.work / f"{name} killed"
        h.kill_at_checkpoint(deck, out, overrides, after=8)
        h.run(deck, out.name, overrides, ["--resume"], launcher=[])
        if name not in SEVERAL_STEPS:
            for what, difference, within in same_results(h.work / name, out, 1e-14):
                h.close(f"{name} resumed: {what}", difference, 0, within)
            continue
        ends = []
        for path in (h.work / name, out):
            with h5py.File(path / "results.h5") as f:
                ends.append(np.array([f[f"studies/{name}/poincare/{axis}"][()] for axis in "xy"]))
        size = np.abs(ends[0]).max()
        h.close(f"{name} resumed: points once per revolution", np.abs(ends[1] - ends[0]).max() / size, 0, 1e-3)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"agree": agree, "ranks": ranks, "resume": resume}[sys.argv[3]](harness)
    harness.finish()
