#!/usr/bin/env python3
"""Runs a stability chart and compares where its curves begin, pass and end with values found one by one.

charts.py PROGRAM SOURCE rigid|compliant|folds [LAUNCHER WORDS...]

rigid: independent reference values at F0* = 0.5, 1 and 2 (0.16, 0.64 and 2.56 N; Omega_0 = 80, 160 and 320 rad/s); the
curve of upper folds must end at the generalised Hopf point, which is found from the Lyapunov coefficient alone.
folds: the curve of upper folds, begun at several loads with several steps, ends at one place: bars overlap.
compliant: Hopf point and flip at B = 1 as branches of short.yaml with that compliance find them, on the same mesh.
"""
import sys

import h5py
import numpy as np
from harness import Harness
from loci import crossings


def curve(h, run, name):
    with h5py.File(h.work / run / "results.h5") as f:
        table = f[f"studies/{name}/locus"]
        return table["parameter"][()], table["second"][()]


def amplitudes(h, run, name):
    with h5py.File(h.work / run / "results.h5") as f:
        return f[f"studies/{name}/locus/amplitude"][()]


def at_end(speed, load, wanted):
    return [s for s, w in zip(speed, load) if abs(w - wanted) < 1e-9 * wanted]


def rigid(h):
    run = h.run((h.source / "inputs/rigid_rotor/stability_chart.yaml").resolve(), "chart", bars=True)
    hopf, flips = curve(h, "chart", "whirl begins"), curve(h, "chart", "half-speed whirl begins")
    last = curve(h, "chart", "half-speed whirl ends")
    jump, large = curve(h, "chart", "small whirl jumps"), curve(h, "chart", "large whirl ends")
    for name in ("whirl begins", "large whirl ends", "half-speed whirl begins", "half-speed whirl ends"):
        h.true(f"{name}: reaches its ends", run[name]["status"] == "completed", run[name]["status"])
    # Exact at the ends of a curve; between its points it is read by cubics.
    for what, (speed, load), at, wanted, within in (
            ("Hopf point, F0* = 2", hopf, 2.56, 2.67117718 * 320, 1e-5), ("Hopf point, F0* = 0.5", hopf, 0.16, 2.75634869 * 80, 1e-5),
            ("upper fold, F0* = 2", jump, 2.56, 2.70964 * 320, 1e-4), ("lower fold, F0* = 2", large, 2.56, 2.67728 * 320, 1e-4),
            ("lower fold, F0* = 0.5", large, 0.16, 2.57874 * 80, 1e-4), ("flip, F0* = 2", flips, 2.56, 2.396433 * 320, 1e-5),
            ("flip, F0* = 0.5", flips, 0.16, 8.882138 * 80, 1e-5),
            ("upper flip, F0* = 2", last, 2.56, 3.959917 * 320, 1e-5), ("upper flip, F0* = 0.5", last, 0.16, 10.054424 * 80, 1e-5)):
        found = at_end(speed, load, at)
        h.true(f"{what}: an end there", found != [], found)
        for s in found[:1]:
            h.close(f"{what} [rad/s]", s, wanted, within * wanted)
    for what, table, wanted in (("Hopf point", hopf, 2.73526314), ("lower fold", large, 2.61397), ("flip", flips, 2.874299),
                                ("upper flip", last, 5.760622)):
        found = crossings(*table, 0.64)
        h.true(f"{what}s at F0* = 1", len(found) == 1, found)
        for s in found[:1]:
            h.close(f"{what}, F0* = 1 [rad/s]", s, wanted * 160, 3e-4 * wanted * 160)
    points = [c for c in run["whirl begins"]["codimension_two"] if c["type"] == "generalised_hopf"]
    h.true("one generalised Hopf point", len(points) == 1, points)
    ends = [c for c in run["small whirl jumps"]["codimension_two"] if c["type"] == "generalised_hopf"]
    h.true("upper folds end there", run["small whirl jumps"]["status"] == "completed" and len(ends) == 1
           and ends[0]["end_of_curve"] == 1, f"{run['small whirl jumps']['status']}, {ends}")
    for c, end in zip(points, ends):
        h.close("upper folds end there, load [N]", end["second_value"], c["second_value"], c["second_value_uncertainty"] + end["second_value_uncertainty"])
        # Both places lie on the Hopf curve, whose slope carries the load's bar over to the speed.
        slope = np.gradient(hopf[0], hopf[1])[np.argmin(np.abs(hopf[1] - c["second_value"]))]
        h.close("upper folds end there, speed [rad/s]", end["value"], c["value"],
                end["value_uncertainty"] + abs(slope) * c["second_value_uncertainty"])
        h.true("bars of a hundredth of a percent", max(c["second_value_uncertainty"], end["second_value_uncertainty"]) < 1e-4 * c["second_value"],
               f"{c['second_value_uncertainty']}, {end['second_value_uncertainty']}")
        h.close("last point of the curve, speed [rad/s]", jump[0][np.argmin(jump[1])], c["value"], 1e-3 * c["value"])
    h.true("amplitudes fall to a fiftieth of a clearance", 0.0199 < amplitudes(h, "chart", "small whirl jumps").min() < 0.0201)


def compliant(h):
    run = h.run((h.source / "inputs/compliant_rotor/stability_chart.yaml").resolve(), "chart",
                ["studies.{2,4}.locus.range={from: 0.08, to: 1.3}"])
    there = h.run((h.source / "inputs/compliant_rotor/short.yaml").resolve(), "there", overrides=[
        "bearings.half.film.compliance=1", "studies.1.equilibrium_branch.range={from: 320 rad/s, to: 400 rad/s}",
        "studies.2.cycle_branch.range={from: 340 rad/s, to: 400 rad/s}"])
    for name, study, kind in (("whirl begins", "balanced", "hopf"), ("half-speed whirl", "unbalanced", "flip")):
        h.true(f"{name}: reaches its ends", run[name]["status"] == "completed", run[name]["status"])
        wanted = [b["value"] for b in there[study]["bifurcations"] if b["type"] == kind]
        found = crossings(*curve(h, "chart", name), 1.0)
        h.true(f"{name}: one {kind} at B = 1", len(wanted) == len(found) == 1, f"{wanted} {found}")
        for s, w in zip(found, wanted):
            h.close(f"{kind} at B = 1 [rad/s]", s, w, 3e-4 * w)


FOLDS = """
title: Where the curve of upper folds ends
base: {base}
rotor: {{load: {load} N}}
studies:
  - equilibrium_branch: {{name: balanced, parameter: speed, range: {{from: 500 rad/s, to: 600 rad/s}}}}
  - cycle_branch:
      name: whirl
      origin: hopf
      parameter: speed
      range: {{from: {speed} rad/s, to: 583 rad/s}}
      step: {{initial: {initial} rad/s, min: 0.000001 rad/s, max: {longest} rad/s}}
      max_points: {points}
      intervals: 40
      degree: 4
      points: gauss
      mesh_tolerance: 1.0e-7
      adapt_every: 2
  - locus:
      name: curve
      of: whirl
      bifurcation: 2
      parameter: rotor.load
      range: {{from: {load} N, to: 0.16 N}}
      step: {{initial: {step} N, min: 0.00001 N, max: 0.05 N}}
      first_range: {{from: 80 rad/s, to: 2400 rad/s}}
"""


def folds(h):
    found = []
    for load, step, speed, initial, longest, points in ((1.04, 0.05, 554.6, 0.01, 0.05, 40), (1.15, 0.005, 550, 0.05, 8, 400),
                                                        (1.06, 0.0045, 559, 0.01, 0.1, 60)):
        deck, name = h.work / "folds.yaml", f"folds_{load}"
        deck.write_text(FOLDS.format(base=(h.source / "inputs/rigid_rotor/short_f1.yaml").resolve(), load=load, step=step,
                                     speed=speed, initial=initial, longest=longest, points=points))
        run = h.run(deck, name, code=None, bars=True)["curve"]
        ends = run.get("codimension_two") or []
        h.true(f"from {load} N: ends at a generalised Hopf point", run["status"] == "completed" and len(ends) == 1, run["status"])
        found += [(load, c["value"], c["value_uncertainty"], c["second_value"], c["second_value_uncertainty"]) for c in ends]
    h.true("three ends", len(found) == 3)
    for k, a in enumerate(found):
        # From 1.15 N with a tolerance of 1e-12; twelve points of a run in long steps extrapolate to the same.
        h.close(f"from {a[0]} N: covers the exactly converged end, load [N]", a[3], 1.0208466, a[4] + 2e-7)
        h.true(f"from {a[0]} N: bar of two thousandths of a percent", 0 < a[4] < 2e-5 * a[3], a[4])
        for b in found[:k]:
            h.close(f"from {a[0]} N as from {b[0]} N, load [N]", a[3], b[3], a[4] + b[4])
            h.close(f"from {a[0]} N as from {b[0]} N, speed [rad/s]", a[1], b[1], a[2] + b[2])


def main():
    h = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"rigid": rigid, "compliant": compliant, "folds": folds}[sys.argv[3]](h)
    h.finish()


if __name__ == "__main__":
    main()
