#!/usr/bin/env python3
"""Do the bars along curves of bifurcations, and of their points of codimension two, cover the error?

locus_bars.py PROGRAM SOURCE [LAUNCHER WORDS...]

The Hopf points of a balanced rotor in compliant bearings over the compliance of their liners, on a coarse film mesh and
on one four times as fine. Where the curve turns in the speed, near a compliance of 0.04, there is a point of codimension two.
The 1:2 resonance of the rigid rotor lies on two curves, which must agree within its bars.
"""
import math
import sys

from harness import Harness

DECK = """
title: Hopf points of the balanced rotor over the compliance of the liners
base: {base}
studies:
  - equilibrium_branch: {{name: balanced, parameter: speed, range: {{from: 160 rad/s, to: 640 rad/s}}}}
  - locus:
      name: curve
      of: balanced
      parameter: bearings.half.film.compliance
      range: {{from: 0.01, to: 2}}
      first_range: {{from: 80 rad/s, to: 1600 rad/s}}
"""
SCALES = 1600 - 80, 2 - 0.01  # of the normal distance: widths of the ranges


def through(points, at):
    """The cubic through four points (x, y) next to x = at."""
    near = sorted(points, key=lambda p: abs(p[0] - at))[:4]
    return sum(y * math.prod((at - u) / (x - u) for u, _ in near if u != x) for x, y in near)


def main():
    h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])
    deck = h.work / "hopf.yaml"
    deck.write_text(DECK.format(base=(h.source / "inputs/compliant_rotor/short.yaml").resolve()))
    coarse, fine = (h.run(deck, f"cells{n}", overrides=[f"bearings.half.film.cells=[{n}, 4]"])["curve"] for n in (30, 120))
    curve = {name: c["values"] for name, c in coarse["curve"].items()}
    units = {name: c["unit"] for name, c in coarse["curve"].items()}
    h.true("units", (units["parameter_uncertainty"], units["second_uncertainty"], units["normal_uncertainty"]) == ("rad/s", "1", "1"),
           str(units))
    there = list(zip(fine["curve"]["second"]["values"], fine["curve"]["parameter"]["values"]))
    rows = [dict(zip(curve, row)) for row in zip(*curve.values())]
    computed = [k for k, row in enumerate(rows) if row["uncertainty_computed"]]
    h.true("both ends and some points between are computed", computed[0] == 0 and computed[-1] == len(rows) - 1
           and 3 <= len(computed) <= 10, str(computed))
    for k in computed:
        row = rows[k]
        error, bar = abs(row["parameter"] - through(there, row["second"])), row["parameter_uncertainty"]
        h.true(f"speed at compliance {row['second']:.4g}: {row['parameter']:.6g} +- {bar:.2g}", bar / 5 < error < bar, f"error {error:.2g}")
    for a, b in zip(computed, computed[1:]):
        low, high = sorted((rows[a]["normal_uncertainty"], rows[b]["normal_uncertainty"]))
        between = [row["normal_uncertainty"] for row in rows[a:b + 1]]
        h.true(f"rows {a} to {b} lie between", all(low <= n <= high for n in between), str(between))
    for row in rows:  # one distance normal to the curve, seen along either axis: 1/first^2 + 1/second^2 = 1/normal^2
        if None in (row["parameter_uncertainty"], row["second_uncertainty"]):
            continue
        first, second = row["parameter_uncertainty"] / SCALES[0], row["second_uncertainty"] / SCALES[1]
        h.close(f"normal distance at compliance {row['second']:.4g}", 1 / math.hypot(1 / first, 1 / second),
                row["normal_uncertainty"], 1e-6 * row["normal_uncertainty"])
    turn = {s: next(c for c in run["codimension_two"] if c["type"] == "meeting_over_second") for s, run in
            (("coarse", coarse), ("fine", fine))}
    for value, bar in (("value", "value_uncertainty"), ("second_value", "second_value_uncertainty")):
        error = abs(turn["coarse"][value] - turn["fine"][value])
        h.true(f"turn, {value}: {turn['coarse'][value]:.6g} +- {turn['coarse'][bar]:.2g}", error < turn["coarse"][bar], f"error {error:.2g}")
        h.true(f"turn, {value}: its bar shrinks with the mesh", turn["fine"][bar] < turn["coarse"][bar] / 4, str(turn["fine"][bar]))
    resonances = []
    loci = h.run((h.source / "inputs/rigid_rotor/loci.yaml").resolve(), "loci")
    for study in ("flips", "Neimark-Sacker points"):
        c = next(c for c in loci[study]["codimension_two"] if c["type"] == "resonance_1_2")
        resonances.append(c)
        h.true(f"1:2 resonance on the curve of {study}: bars of both parameters", c["second_value_uncertainty"] > 0 and
               c.get("value_uncertainty", 0) > 0, f"{c['second_value_uncertainty']}, {c.get('value_uncertainty')}")
    a, b = resonances
    for value, bar in (("value", "value_uncertainty"), ("second_value", "second_value_uncertainty")):
        h.close(f"1:2 resonance on both curves, {value}", a[value], b[value], a.get(bar, 0) + b.get(bar, 0))
    h.finish()


if __name__ == "__main__":
    main()
