#!/usr/bin/env python3
"""Runs the rigid rotor in films that conserve their mass with states of their own, beside the same films without.

conserving.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]

Equilibria must be those of the films without states, an independent solver of the same equations. Where the rotor loses its
stability no other value exists: there the answer must not depend on the number of ranks.
"""
import sys

from harness import Harness, value

NEAR = "range={from: 120 rad/s, to: 140 rad/s}"
CONDENSED = "bearings.*.film.states=condensed"


def only(*studies):
    return "studies=[" + ", ".join(studies) + "]"


def deck(h):
    return h.source / "inputs/rigid_rotor/mass_conserving.yaml"


def whole(h):
    """Static positions and flows with and without states; the cycle and the return to rest are stable alike."""
    static = "{static: {name: at rest, speed: 120 rad/s}}"
    coarse = "bearings.*.film.cells=[24, 4]"
    with_states = h.run(deck(h), "dynamic", [only(static)])["at rest"]
    without = h.run(deck(h), "condensed", [only(static), CONDENSED])["at rest"]
    for name in ("left", "right"):
        head = f"bearing.{name}."
        for what, within in (("eccentricity.x", 1e-7), ("eccentricity.y", 1e-7), ("side_flow", 1e-6), ("inlet_flow", 1e-6),
                             ("max_pressure", 1e-6), ("power_loss", 1e-6)):
            reference = value(without, head + what)
            h.close(f"{name}: {what} as without states", value(with_states, head + what), reference,
                    within * max(abs(reference), 1 if what.startswith("ecc") else 0))
    run = h.run(deck(h), "deck", [coarse, "studies.1.equilibrium_branch." + NEAR, "studies.2.cycle_branch.max_points=1",
                                  "studies.3.motion.revolutions=2"])
    h.true("the branch reaches its end", run["balanced"]["status"] == "completed", run["balanced"]["status"])
    h.true("no bifurcation there", not run["balanced"]["bifurcations"])
    h.true("the cycle is there", run["unbalanced"]["points"] >= 1, run["unbalanced"]["status"])
    h.true("the motion ends", run["return"]["status"] == "completed", run["return"]["status"])


def ranks(h):
    """Equilibria and the threshold on 1, 2 and 3 ranks that share the states of the films."""
    branch = "{equilibrium_branch: {name: balanced, parameter: speed, range: {from: 380 rad/s, to: 480 rad/s}}}"
    found = [h.run(deck(h), f"ranks_{n}", [only(branch), "bearings.*.film.cells=[24, 4]", "bearings.*.film.grooves.1.pressure=2 kPa",
                                                    "layout.machine=all_ranks"],
                   launcher=[*h.launcher, "-n", str(n)])["balanced"] for n in (1, 2, 3)]
    for n, s in enumerate(found[1:], 2):
        h.true(f"{n} ranks: they share one machine", s["layout"] == f"one machine on {n} ranks (by the deck)", s["layout"])
        h.true(f"{n} ranks: as many points", s["points"] == found[0]["points"])
        for a, b in zip(found[0]["bifurcations"], s["bifurcations"], strict=True):
            h.close(f"{n} ranks: {a['type']}", b["value"], a["value"], 1e-7 * a["value"])
            h.close(f"{n} ranks: its period", b["period_s"], a["period_s"], 1e-6 * a["period_s"])
    h.true("there is a threshold", [b["type"] for b in found[0]["bifurcations"]] == ["hopf"])


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"whole": whole, "ranks": ranks}[sys.argv[3]](harness)
    harness.finish()
