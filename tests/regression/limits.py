#!/usr/bin/env python3
"""Curves of cycles that keep an amplitude, a period or a whirl ratio, against branches of cycles with the second parameter changed.

limits.py PROGRAM SOURCE LAUNCHER WORDS...

Where such a branch comes to the speed of the curve, its cycle must have the amplitude that the curve keeps: the amplitude of the
branch is read off samples, that of the curve is the maximum of the polynomials.
"""
import sys

import h5py
import numpy as np

from compare import same_results
from harness import Harness

CURVES = ("vibration", "whirl")
# In place of the curves.
NO_CURVES = [f"studies.{k}={{static: {{name: rest {k}, speed: 400 rad/s}}}}" for k in (2, 4, 6)]
MORE = """
title: Other quantities of self-excited whirl
base: {base}
studies:
  - cycle_branch: {{name: whirl, origin: hopf, parameter: speed, range: {{from: 320 rad/s, to: 480 rad/s}}, intervals: 20, degree: 4}}
  - locus: {{name: period, of: whirl, limit: {{quantity: period, value: 30 ms}}, parameter: rotor.load, range: {{from: 0.62 N, to: 0.7 N}}}}
  - locus: {{name: ratio, of: whirl, limit: {{quantity: whirl_ratio, value: 0.498, passing: 2}}, parameter: rotor.load, range: {{from: 0.62 N, to: 0.7 N}}}}
  - locus: {{name: node, of: whirl, limit: {{quantity: peak_to_peak, node: 1, direction: x, value: 38 um}}, parameter: bearings.left.geometry.clearance, range: {{from: 24.5 um, to: 25.5 um}}}}
  - locus: {{name: clearance, of: whirl, limit: {{quantity: eccentricity, bearing: left, value: 0.8}}, parameter: bearings.left.geometry.clearance, range: {{from: 24.5 um, to: 25.5 um}}}}
"""


def columns(h, run, study):
    with h5py.File(h.work / run / "results.h5") as f:
        group = f[f"studies/{study}/locus"]
        return [group[c][()] for c in ("parameter", "second", "period", "others_unstable")]


def largest_eccentricity(h, run, study, speed):
    """Of the first bearing at a speed that the branch has as the end of its range."""
    with h5py.File(h.work / run / "results.h5") as f:
        branch = f[f"studies/{study}/branch"]
        k = int(np.argmin(abs(branch["parameter"][()] - speed)))
        return float(branch["eccentricity_max"][k, 0]), float(branch["parameter"][k])


def ends(curve):
    return [tuple(c[k] for c in curve) for k in (0, -1)]


def main():
    h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])
    deck = (h.source / "inputs/rigid_rotor/limits.yaml").resolve()
    run = h.run(deck, "one", launcher=[])
    for name in CURVES:
        h.true(f"{name}: reaches its ends", run[name]["status"] == "completed", run[name]["status"])
        h.true(f"{name}: nothing suspected", not run[name].get("suspected"), run[name].get("suspected"))
    # Cycles found by themselves at the ends of the curves.
    for k, (speed, viscosity, *_) in enumerate(ends(columns(h, "one", "vibration"))):
        there = h.run(deck, f"vibration_{k}", launcher=[], overrides=[
            *NO_CURVES, f"lubricants.water.viscosity={viscosity!r} mPa s",
            f"studies.1.cycle_branch.range={{from: {speed - 20!r} rad/s, to: {speed!r} rad/s}}", f"studies.1.cycle_branch.at=[{speed!r} rad/s]"])
        found = next(v["value"] for name, v in there["unbalanced"]["values"].items() if name.endswith("peak_to_peak.left.y"))
        h.close(f"vibration at {viscosity:.4g} mPa s, 0-peak [um]", 1e6 * found / 2, 5, 5e-6)
    for k, (speed, viscosity, *_) in enumerate(ends(columns(h, "one", "whirl"))):
        h.run(deck, f"whirl_{k}", launcher=[], overrides=[
            *NO_CURVES, f"lubricants.water.viscosity={viscosity!r} mPa s", f"studies.5.cycle_branch.range={{from: 160 rad/s, to: {speed!r} rad/s}}"])
        found, at = largest_eccentricity(h, f"whirl_{k}", "self-excited", speed)
        h.close(f"whirl at {viscosity:.4g} mPa s: the branch ends there, rad/s", at, speed, 1e-9 * speed)
        h.close(f"whirl at {viscosity:.4g} mPa s, eccentricity", found, 0.95, 1e-6)

    # The period is that of the curve, and the amplitude of a shaft in space.
    more = h.work / "more.yaml"
    more.write_text(MORE.format(base=(h.source / "inputs/rigid_rotor/short_f1.yaml").resolve()))
    other = h.run(more, "more", launcher=[])
    for name in ("period", "ratio", "node", "clearance"):
        h.true(f"{name}: reaches its ends", other[name]["status"] == "completed", other[name]["status"])
    speed, _, period, _ = columns(h, "more", "period")
    h.close("period: all along the curve [s]", max(abs(period - 0.03)), 0, 1e-9)
    speed, _, period, _ = columns(h, "more", "ratio")
    h.close("whirl ratio: all along the curve", max(abs(2 * np.pi / (period * speed) - 0.498)), 0, 1e-8)

    # Never reached, and passed less often than asked for.
    none = h.run(deck, "none", launcher=[], code=None, overrides=["studies.2.locus.limit.value=7 um", "studies.6.locus.limit.passing=4"])
    h.true("an amplitude never reached names the range", "runs from 4.1977 um to 5.6736 um along" in none["vibration"]["status"] and "never passes 7 um" in none["vibration"]["status"],
           none["vibration"]["status"])
    h.true("a passing that there is not", "passing 4 is wanted" in none["whirl"]["status"], none["whirl"]["status"])

    h.run(deck, "two", launcher=[*h.launcher, "-n", "2"])
    what, worst, within = same_results(h.work / "one", h.work / "two")[1]  # of the tables the curves alone, which it has too
    h.true(f"two ranks: {what}", worst <= within, f"{worst:.2g}")
    # On the branch behind the passing, and on either way along the curve.
    for after in (60, 74, 94):
        out = f"killed_{after}"
        h.kill_at_checkpoint(deck, h.work / out, after=after)
        h.run(deck, out, launcher=[], flags=["--resume"])
        for what, worst, within in same_results(h.work / "one", h.work / out):
            h.true(f"killed at checkpoint {after} and resumed: {what}", worst <= within, f"{worst:.2g}")
    h.finish()


if __name__ == "__main__":
    main()
