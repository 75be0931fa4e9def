#!/usr/bin/env python3
"""Runs the rigid rotor in films that conserve their mass with states of their own, beside the same films without.

conserving.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]

Equilibria must be those of the films without states, an independent solver of the same equations. Where the rotor loses its
stability no other value exists: there the answer must not depend on the number of ranks.
"""
import sys

import numpy

from compare import datasets, same_results
from harness import GUYAN, RANKS, Harness, every_bearing, value

NEAR = "range={from: 120 rad/s, to: 140 rad/s}"
CONDENSED = "bearings.*.film.states=condensed"


def only(*studies):
    return "studies=[" + ", ".join(studies) + "]"


CYCLE = ("{cycle_branch: {name: cycle, unbalance: [gen_pair], parameter: speed, range: {from: 3550 rpm, to: 3600 rpm},"
         " step: {initial: 50 rpm, min: 0.01 rpm, max: 50 rpm}, at: [3600 rpm]}}")


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
    # A round hole beside the groove.
    hole = "bearings.*.film.holes=[{angle: 200 deg, z: 1 mm, diameter: 3 mm, pressure: 50 kPa}]"
    fed, still = (h.run(deck(h), name, [only(static), "bearings.*.film.cells=[48, 12]", hole, *more])["at rest"]
                  for name, more in (("hole", []), ("hole_condensed", [CONDENSED])))
    for what in ("eccentricity.x", "eccentricity.y", "hole.1.flow", "side_flow"):
        a, b = (value(s, "bearing.left." + what) for s in (fed, still))
        h.close(f"hole: {what} as without states", a, b, 1e-6 * max(abs(b), 1 if what.startswith("ecc") else 0))
    h.true("the hole feeds", value(fed, "bearing.left.hole.1.flow") > 0.5 * value(fed, "bearing.left.side_flow"))
    run = h.run(deck(h), "deck", [coarse, "studies.1.equilibrium_branch." + NEAR, "studies.2.cycle_branch.max_points=1",
                                  "studies.3.motion.revolutions=2"])
    h.true("the branch reaches its end", run["balanced"]["status"] == "completed", run["balanced"]["status"])
    h.true("no bifurcation there", not run["balanced"]["bifurcations"])
    h.true("the cycle is there", run["unbalanced"]["points"] >= 1, run["unbalanced"]["status"])
    # Another way to the same cycle: a state carried through the turn by steps of another scheme.
    shot = h.run(deck(h), "shooting", [coarse, only("{cycle_branch: {name: unbalanced, unbalance: [a], parameter: speed, "
                                                    + NEAR.replace("=", ": ") + ", method: shooting, max_points: 1}}")])
    h.true("the same cycle by shooting", shot["unbalanced"]["points"] == 1, shot["unbalanced"]["status"])
    ours, theirs = (datasets(h.work / name / "results.h5") for name in ("deck", "shooting"))
    head = "studies/unbalanced/"
    for part in ("real", "imag"):
        a, b = (found[f"{head}branch/multipliers_{part}"][0] for found in (ours, theirs))
        for k in (0, 1):
            h.close(f"multiplier {k + 1}, {part}, as by shooting", a[k], b[k], 3e-4)
    for axis in "xy":
        a, b = (found[f"{head}orbits/{axis}"][0] for found in (ours, theirs))
        h.close(f"orbit, {axis}, as by shooting [m]", abs(a - b).max(), 0, 2e-5 * 25e-6)
    h.true("the motion ends", run["return"]["status"] == "completed", run["return"]["status"])


def ranks(h):
    """Equilibria and the threshold on 1, 2 and 3 ranks that share the states of the films."""
    branch = "{equilibrium_branch: {name: balanced, parameter: speed, range: {from: 380 rad/s, to: 480 rad/s}}}"
    found = [h.run(deck(h), f"ranks_{n}", [only(branch), "bearings.*.film.cells=[24, 4]", "bearings.*.film.grooves.1.pressure=2 kPa",
                                                    "layout.machine=all_ranks"],
                   launcher=[*h.launcher, "-n", str(n)])["balanced"] for n in RANKS]
    for n, s in enumerate(found[1:], 2):
        h.true(f"{n} ranks: they share one machine", s["layout"] == f"one machine on {n} ranks (by the deck)", s["layout"])
        h.true(f"{n} ranks: as many points", s["points"] == found[0]["points"])
        for a, b in zip(found[0]["bifurcations"], s["bifurcations"], strict=True):
            h.close(f"{n} ranks: {a['type']}", b["value"], a["value"], 1e-7 * a["value"])
            h.close(f"{n} ranks: its period", b["period_s"], a["period_s"], 1e-6 * a["period_s"])
    h.true("there is a threshold", [b["type"] for b in found[0]["bifurcations"]] == ["hopf"])


def as_by_reynolds(h, found, reynolds, statics, thresholds):
    """A film that runs full from its leading edge and ruptures once is that of Swift and Stieber, which Reynolds' condition
    finds by another discretisation: the same limit of fine meshes, within both bars."""
    def same(what, a, b):
        bars = [e.get("uncertainty", float("nan")) for e in (a, b)]
        h.true(f"{what}: has bars", min(bars) > 0, f"{bars}")
        h.close(what, a["value"], b["value"], sum(bars))

    a, b = found[statics]["values"], reynolds[statics]["values"]
    for name in (f"B{k}" for k in range(1, 6)):
        for key in (f"load.{name}", f"bearing.{name}.x", f"bearing.{name}.y"):
            same(key, a[key], b[key])
    a, b = found[thresholds]["bifurcations"], reynolds[thresholds]["bifurcations"]
    h.true("one threshold by each", len(a) == len(b) == 1 and a[0]["type"] == b[0]["type"] == "hopf", f"{len(a)}, {len(b)}")
    same("threshold [rpm]", a[0], b[0])
    h.close("its period [s]", a[0]["period_s"], b[0]["period_s"], 0.02 * b[0]["period_s"])
    # A jump of the tangents is enclosed, where no root is.
    h.true("located", a[0]["uncertainty_location"] <= 1e-5 * a[0]["value"], f"{a[0]['uncertainty_location']}")


def covers(h, found, finer, longest):
    """The bar of a threshold holds what a better mesh says, is not long beside the scatter of meshes, and says what it contains."""
    a, b = found["bifurcations"][0], finer["bifurcations"][0]
    h.close("threshold [rpm], covered by its bar", a["value"], b["value"], a["uncertainty"])
    h.true("its bar is not long [rpm]", a["uncertainty"] <= longest, f"{a['uncertainty']}")
    parts = sum(a[f"uncertainty_{part}"] for part in ("film_mesh", "kinks", "location"))
    h.close("its parts add up", parts, a["uncertainty"], 1e-9 * a["uncertainty"])
    h.true("kinks are a part of it", a["uncertainty_kinks"] > 0)


def train(h):
    """Condensed films on the train, on a coarse mesh with a reduced shaft, beside Reynolds' condition."""
    coarse = [*GUYAN, *every_bearing("film.cells", "[60, 12]"), "studies.3.cycle_branch.max_points=1"]
    found = h.run("mass_conserving.yaml", "train", coarse)
    reynolds = h.run("mass_conserving.yaml", "reynolds", [*coarse, *every_bearing("film.cavitation", "reynolds")])
    as_by_reynolds(h, found, reynolds, "at service speed", "balanced")
    covers(h, found["balanced"], reynolds["balanced"], 400)
    h.true("the cycle is there", found["G2.5"]["points"] == 1, found["G2.5"]["status"])


def cycle(h, study, overrides=()):
    """The cycle on 1, 2 and, at night, 3 ranks, and killed and resumed."""
    overrides = [only(study), *overrides]
    for n in RANKS:
        h.run("mass_conserving.yaml", f"cycle_{n}", overrides, launcher=[*h.launcher, "-n", str(n)])
        for what, difference, within in same_results(h.work / "cycle_1", h.work / f"cycle_{n}") if n > 1 else []:
            h.close(f"{n} ranks: {what}", difference, 0, within)
    h.kill_at_checkpoint("mass_conserving.yaml", h.work / "killed", overrides)
    h.run("mass_conserving.yaml", "killed", overrides, flags=["--resume"], launcher=[])
    for what, difference, within in same_results(h.work / "cycle_1", h.work / "killed"):
        h.close(f"killed and resumed: {what}", difference, 0, within)


def train_dynamic(h):
    """A cycle of the train in films with states of their own: near that of condensed films, whose cavities neither fill nor
    empty."""
    few = [*GUYAN, *every_bearing("film.cells", "[16, 4]"), only(CYCLE.replace("at: [3600 rpm]", "max_points: 1, intervals: 30"))]
    with_states = h.run("mass_conserving.yaml", "dynamic", [*few, *every_bearing("film.states", "dynamic")])["cycle"]
    without = h.run("mass_conserving.yaml", "condensed", few)["cycle"]
    h.true("both are there", with_states["points"] == without["points"] == 1, f"{with_states['status']}, {without['status']}")
    a, b = (datasets(h.work / name / "results.h5") for name in ("dynamic", "condensed"))
    h.true("Newton's method takes few steps", a["studies/cycle/branch/newton_iterations"][0] <= 6,
           f"{a['studies/cycle/branch/newton_iterations'][0]}")
    largest = [max(abs(complex(x, y)) for x, y in zip(f["studies/cycle/branch/multipliers_real"][0],
                                                     f["studies/cycle/branch/multipliers_imag"][0])) for f in (a, b)]
    h.close("largest multiplier, as without states", largest[0], largest[1], 0.01)
    for end in ("x_max", "x_min", "y_max", "y_min"):
        x, y = (f[f"studies/cycle/branch/{end}"][0] for f in (a, b))
        h.close(f"{end}, largest difference [m]", abs(x - y).max(), 0, 5e-7)


def train_contents(h):
    """The cycle in films with states of their own on the meshes of the deck, with its multipliers: near that of condensed films."""
    study = CYCLE.replace("at: [3600 rpm]", "max_points: 2, intervals: 32")
    cycle(h, study, [*GUYAN, *every_bearing("film.states", "dynamic")])
    h.run("mass_conserving.yaml", "condensed", [only(study), *GUYAN])
    a, b = (datasets(h.work / name / "results.h5") for name in ("cycle_1", "condensed"))
    for end in ("x_max", "x_min", "y_max", "y_min"):
        x, y = (f[f"studies/cycle/branch/{end}"] for f in (a, b))
        h.close(f"{end}, largest difference [m]", abs(x - y).max(), 0, 3e-7)
    largest = [numpy.nanmax(abs(f["studies/cycle/branch/multipliers_real"] + 1j * f["studies/cycle/branch/multipliers_imag"]))
               for f in (a, b)]
    h.close("largest multiplier", largest[0], largest[1], 1e-3)


def train_ranks(h):
    cycle(h, CYCLE, [*GUYAN, *every_bearing("film.cells", "[24, 8]")])


def train_whole(h):
    """The deck as it is, with all 740 freedoms."""
    found = h.run("mass_conserving.yaml", "deck", launcher=[*h.launcher, "-n", "2"])
    reynolds = h.run("mass_conserving.yaml", "reynolds", every_bearing("film.cavitation", "reynolds"),
                     launcher=[*h.launcher, "-n", "2"])
    as_by_reynolds(h, found, reynolds, "at service speed", "balanced")
    # Nine meshes scatter by 40 rpm. Four times as many cells, whose own bar is shorter.
    balanced = ("{equilibrium_branch: {name: balanced, parameter: speed, range: {from: 6500 rpm, to: 7200 rpm}, "
                "step: {initial: 50 rpm, min: 0.01 rpm, max: 250 rpm}, detect: [hopf, fold]}}")
    fine = h.run("mass_conserving.yaml", "fine", [only(balanced), *every_bearing("film.cells", "[240, 48]")])["balanced"]
    covers(h, found["balanced"], fine, 160)
    h.true("criticality by cycles at amplitudes", found["balanced"]["bifurcations"][0]["criticality"] == "subcritical",
           found["balanced"]["bifurcations"][0]["criticality_by"])
    h.close("threshold of the finer mesh [rpm]", fine["bifurcations"][0]["value"], reynolds["balanced"]["bifurcations"][0]["value"],
            fine["bifurcations"][0]["uncertainty"] + reynolds["balanced"]["bifurcations"][0]["uncertainty"])
    cycle(h, CYCLE.replace("at: [3600 rpm]", "max_points: 2"))


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"whole": whole, "ranks": ranks, "train": train, "train_ranks": train_ranks,
     "train_dynamic": train_dynamic, "train_contents": train_contents, "train_whole": train_whole}[sys.argv[3]](harness)
    harness.finish()
