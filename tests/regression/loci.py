#!/usr/bin/env python3
"""Runs the deck of bifurcation curves of the rigid rotor and compares it with reference values.

loci.py PROGRAM SOURCE [LAUNCHER WORDS...]

The reference is that of the rigid rotor's diagrams: flips at a* = 0.1 and 0.2, the Neimark-Sacker point at a* = 0.3, all
over Omega*; the 1:2 resonance near (8.6537, 0.27277) and the point near (10.28, 0.2900) where two flips meet. Curves of
Hopf points and of folds of cycles of twice the period must end at points that branches with the option's last value find,
and branches on either side of a generalised flip must be born on other sides.
"""
import sys

import h5py
import numpy as np
from harness import BARS, Harness

SPEED, CLEARANCE = 160.0, 25.0  # rad/s, um: one unit of Omega* and of a*


HOPF = """
title: Hopf points of the balanced rotor over its load
base: {base}
studies:
  - equilibrium_branch: {{name: branch, parameter: speed, range: {{from: 320 rad/s, to: 720 rad/s}}}}
  - locus:
      name: curve
      of: branch
      parameter: rotor.load
      range: {{from: 0.6 N, to: 1.28 N}}
      first_range: {{from: 80 rad/s, to: 1600 rad/s}}
"""

BRANCH = """
base: {{base}}
studies:
  - cycle_branch:
      name: branch
      unbalance: [a]
      parameter: speed
      range: {{{{from: 360 rad/s, to: {end}}}}}
      step: {{{{initial: 4 rad/s, min: 0.001 rad/s, max: 16 rad/s}}}}
      intervals: 40
      degree: 4
      points: gauss
      adapt_mesh: false
      follow_flips: true
"""

DOUBLED = "title: Folds of the cycles of twice the period over the unbalance" + BRANCH.format(end="440 rad/s") + """\
  - locus:
      name: curve
      of: branch flip 1
      parameter: unbalance.a.planes.1.eccentricity
      range: {{from: 2.45 um, to: 2.6 um}}
      first_range: {{from: 160 rad/s, to: 1600 rad/s}}
"""

BORN = "title: On which side the cycles of twice the period are born" + BRANCH.format(end="700 rad/s") + """\
      detect: [flip]
"""


def generalised_flips(h, found):
    """Where the flips turn supercritical: branches on either side of the points are born on other sides."""
    wanted = ((2.440488, 0.123915), (10.29490, 0.289961), (3.970426, 0.139644))
    h.true("flips: three generalised ones, none where the journal stands still in its oil", len(found) == 3, found)
    for (speed, unbalance), (s, a) in zip(found, wanted):
        h.close(f"generalised flip at a* = {a}, Omega*", speed, s, 2e-5)
        h.close(f"generalised flip, a* = {a}", unbalance, a, 2e-6)
    deck = h.work / "born.yaml"
    deck.write_text(BORN.format(base=(h.source / "inputs/rigid_rotor/short_f1.yaml").resolve()))
    lower, upper = found[0][1] * CLEARANCE, found[-1][1] * CLEARANCE
    for eccentricity in (lower - 0.1, upper - 0.1, upper + 0.1):
        run = h.run(deck, f"born_{eccentricity:.3f}", overrides=[f"unbalance.a.planes.1.eccentricity={eccentricity:.6f} um"])
        flips = [b for b in run["branch"]["bifurcations"] if b["type"] == "flip"]
        for flip, turns in zip(flips, (lower, upper)):
            h.true(f"flip at {flip['value']:.1f} rad/s, {eccentricity:.3f} um: compared with its branch",
                   flip.get("branch_curvature") is not None, flip.get("criticality_by"))
            # The sign of the branch's curvature; at night its bar decides, too.
            wanted, coefficient = "subcritical" if eccentricity < turns else "supercritical", flip.get("criticality_coefficient")
            h.true(f"flip at {flip['value']:.1f} rad/s, {eccentricity:.3f} um: {wanted}", coefficient and (coefficient > 0) == (wanted == "subcritical")
                   and flip.get("criticality") == (wanted if BARS else "undetermined"), f"{coefficient}, {flip.get('criticality')}")
        h.true(f"two flips at {eccentricity:.3f} um", len(flips) == 2, len(flips))


def ends(h, name, text, study, kind, option, last):
    """The curve of that deck, whose end must be the bifurcation found with the option's last value."""
    deck = h.work / f"{name}.yaml"
    deck.write_text(text.format(base=(h.source / "inputs/rigid_rotor/short_f1.yaml").resolve()))
    run = h.run(deck, name)
    there = h.run(deck, f"{name}_there", overrides=[f"{option}={last}"])
    found = [b["value"] for b in there[study]["bifurcations"] if b["type"] == kind]
    with h5py.File(h.work / name / "results.h5") as f:
        speed = f["studies/curve/locus/parameter"][-1]
    h.true(f"{name}: reaches its ends", run["curve"]["status"] == "completed", run["curve"]["status"])
    h.true(f"{name}: a {kind} at {last}", len(found) == 1, found)
    for value in found[:1]:
        h.close(f"{name}: speed at {last}", speed, value, 1e-7 * value)
    return run["curve"]


def crossings(speed, unbalance, at):
    """Speeds at which a curve passes an unbalance, by cubics through four points."""
    out = []
    for k in np.flatnonzero(np.diff(unbalance >= at)):
        near = slice(max(k - 1, 0), min(k + 3, len(speed)))
        a, s = unbalance[near] - at, speed[near]
        out.append(sum(s[i] * np.prod([-a[j] / (a[i] - a[j]) for j in range(len(a)) if j != i]) for i in range(len(a))))
    return sorted(out)


def off_the_lines(curve):
    """How far a curve lies from the lines between its points, in units of its picture: half-way, by cubics through four points."""
    p = np.transpose([curve[c][()] / np.ptp(curve[c]) for c in ("parameter", "second")])
    s = np.append(0, np.cumsum(np.hypot(*np.diff(p, axis=0).T)))
    most = 0.0
    for k in range(1, len(p) - 2):
        at, near = (s[k] + s[k + 1]) / 2, range(k - 1, k + 3)
        there = sum(p[i] * np.prod([(at - s[j]) / (s[i] - s[j]) for j in near if j != i]) for i in near) - p[k]
        along = p[k + 1] - p[k]
        most = max(most, abs(along[0] * there[1] - along[1] * there[0]) / np.hypot(*along))
    return most


def main():
    h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])
    run = h.run((h.source / "inputs/rigid_rotor/loci.yaml").resolve(), "loci")
    flips, turns = run["flips"], run["Neimark-Sacker points"]
    for study in (flips, turns):
        h.true(f"{study['name']}: reaches its ends", study["status"] == "completed", study["status"])
        h.true(f"{study['name']}: nothing suspected", not study.get("suspected"), study.get("suspected"))

    def points(study, kind):
        return [(c["nondimensional_speed"], c["nondimensional_unbalance"]) for c in study["codimension_two"]
                if c["type"] == kind]

    for study in (flips, turns):
        found = points(study, "resonance_1_2")
        h.true(f"{study['name']}: one 1:2 resonance", len(found) == 1, found)
        for speed, unbalance in found[:1]:
            h.close(f"{study['name']}: 1:2 resonance, Omega*", speed, 8.6537, 2e-4)
            h.close(f"{study['name']}: 1:2 resonance, a*", unbalance, 0.27277, 2e-5)
    found = points(flips, "meeting")
    h.true("flips: one point where two meet", len(found) == 1, found)
    for speed, unbalance in found[:1]:
        h.close("flips meet, Omega*", speed, 10.28, 2e-2)
        h.close("flips meet, a*", unbalance, 0.2900, 1e-4)
    generalised_flips(h, points(flips, "generalised_flip"))
    with h5py.File(h.work / "loci" / "results.h5") as f:
        curve = f["studies/flips/locus"]
        speed, unbalance = curve["parameter"][()] / SPEED, curve["second"][()] / CLEARANCE
    # The curve is known at its points, and read between them by cubics; it passes a* = 0.2 on its steep side in one step.
    for a, count, wanted in ((0.1, 2, (2.468901, 3.412566)), (0.2, 2, (None, 5.760622))):
        got = crossings(speed, unbalance, a)
        h.true(f"flips at a* = {a}", len(got) == count, got)
        for x, y in zip(got, wanted):
            if y:
                h.close(f"flip at a* = {a}, Omega*", x, y, 1e-4)
    # A curve ends at its limit, not near it.
    h.run((h.source / "inputs/rigid_rotor/loci.yaml").resolve(), "short",
          overrides=["studies.2.locus.range={from: 2 um, to: 5 um}", "studies.2.locus.picture_tolerance=0.001"])
    with h5py.File(h.work / "short" / "results.h5") as f:
        curve = f["studies/flips/locus"]
        # The steps alone leave it 0.5 % off.
        h.close("points where it bends: off the lines", off_the_lines(curve), 0, 1.2e-3)
        h.close("the curve ends at a* =", curve["second"][-1] / CLEARANCE, 0.2, 1e-9)
        h.close("flip at a* = 0.2, Omega*", curve["parameter"][-1] / SPEED, 2.874299, 1e-5)
    # A bend is cut by steps that turn by beta_1: a smaller angle takes more points.
    counts = []
    for angle in ("30 deg", "3 deg"):
        bent = h.run((h.source / "inputs/rigid_rotor/loci.yaml").resolve(), f"beta {angle[:-4]}",
                     overrides=["studies.2.locus.range={from: 2 um, to: 5 um}", "studies.2.locus.picture_tolerance=0",
                                f"studies.2.locus.beta_1={angle}", "bars=none"])
        counts.append(bent["flips"]["points"])
    h.true("beta_1 of a curve bounds its turns", counts[1] > counts[0], counts)
    # The first Lyapunov coefficient changes its sign on the way to F0* = 2: single points are subcritical at a load of
    # 0.99 N and supercritical at 1.025 N.
    curve = ends(h, "hopf", HOPF, "branch", "hopf", "rotor.load", "1.28 N")
    turned = [c["second_value"] for c in curve["codimension_two"] if c["type"] == "generalised_hopf"]
    h.true("hopf: turns supercritical once", len(turned) == 1 and 0.99 < turned[0] < 1.025, turned)
    ends(h, "doubled", DOUBLED, "branch flip 1", "cyclic_fold", "unbalance.a.planes.1.eccentricity", "2.6 um")
    # A film with states, by sweeps; the reference was computed with dense intervals.
    compliant = h.run((h.source / "inputs/compliant_rotor/loci.yaml").resolve(), "compliant",
                      overrides=["studies.2.locus.range={from: 3 um, to: 5.1 um}", "studies.2.locus.first_range={from: 375 rad/s, to: 1600 rad/s}"])["flips"]
    h.true("compliant: reaches its ends", compliant["status"] == "completed", compliant["status"])
    turns = [(c["value"], c["second_value"]) for c in compliant["codimension_two"] if c["type"] == "meeting_over_second"]
    # The one that the rigid bearing has near a* = 0.124 is blurred by the mesh of the film: suspected at most.
    h.true("compliant: no generalised flip among the kinks of the force",
           not [c for c in compliant["codimension_two"] if c["type"] == "generalised_flip"])
    # Kinks of the truncated force may bend the curve elsewhere, too.
    speed, unbalance = min(turns, key=lambda t: abs(t[0] - 386.91217311))
    h.close("compliant: the curve turns, speed", speed, 386.91217311, 1e-4)
    h.close("compliant: the curve turns, eccentricity", unbalance, 3.62789436, 1e-5)
    h.finish()


if __name__ == "__main__":
    main()
