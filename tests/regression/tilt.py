#!/usr/bin/env python3
"""Runs the train in films that follow the slope of its shaft, beside the same films that do not.

tilt.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import sys

from compare import same_results
from harness import GUYAN, RANKS, Harness, every_bearing, value

FEW = [*GUYAN, *every_bearing("film.cells", "[30, 8]")]
BEARINGS = [f"B{k}" for k in range(1, 6)]


def machine(h):
    """Loads, moments and coefficients at rest; where the train loses its stability with and without."""
    found = h.run("tilt.yaml", "tilt", FEW)
    variant = next(v for v in found["journals"]["variants"] if v["name"] == "parallel")
    parallel = {s["name"]: s for s in variant["studies"]}
    # A sweep changes what a run by itself would: the deck without tilt is the train of before.
    alone = h.run("tilt.yaml", "alone", [*FEW, *every_bearing("film.tilt", "false"),
                                         "studies=[{static: {name: at service speed, speed: 3600 rpm}}]"])["at service speed"]
    a, b = found["at service speed"], parallel["at service speed"]
    for name in BEARINGS:
        h.close(f"{name}: load, parallel, as by itself", value(b, f"load.{name}"), value(alone, f"load.{name}"),
                1e-8 * value(b, f"load.{name}"))
        head = f"bearing.{name}."
        h.true(f"{name}: no slopes without tilt", value(b, head + "K.slope_y.slope_y") is None and value(b, head + "tilt.y") is None)
        # The film works against the tilt: along it, and by its own stiffness and damping.
        tilt, moment = ([value(a, f"{head}{what}.{axis}") for axis in "xy"] for what in ("tilt", "moment"))
        h.true(f"{name}: the moment turns the journal back", sum(t * m for t, m in zip(tilt, moment, strict=True)) < 0, f"{moment}, {tilt}")
        for what in "KC":
            h.true(f"{name}: {what} of the slope", value(a, f"{head}{what}.slope_y.slope_y") > 0)
        h.close(f"{name}: K.yy, nearly that of a parallel journal", value(a, head + "K.yy") / value(b, head + "K.yy"), 1, 0.1)
        h.true(f"{name}: it is thinner at an end", name == "B1" or value(a, head + "min_thickness") < value(b, head + "min_thickness"))
        h.close(f"{name}: its axis is level in the plane", value(a, head + "slope.x"), 0, 0)
    h.close("the loads carry the same weight [N]", sum(value(a, f"load.{n}") for n in BEARINGS),
            sum(value(b, f"load.{n}") for n in BEARINGS), 1e-6 * sum(value(b, f"load.{n}") for n in BEARINGS))
    hopf = [[x for x in s["threshold"]["bifurcations"] if x["type"] == "hopf"][0] for s in (found, parallel)]
    h.true("thresholds have bars", all(x["uncertainty"] > 0 for x in hopf))
    h.close("threshold with tilt, near that without [rpm]", hopf[0]["value"], hopf[1]["value"], 0.05 * hopf[1]["value"])
    h.true("and not the same", abs(hopf[0]["value"] - hopf[1]["value"]) > 1, f"{hopf[0]['value']}, {hopf[1]['value']}")


def ranks(h):
    """The same on 1, 2 and 3 ranks, with films that hold their content in one bearing."""
    # Eigenvalues of such a film by itself are ill-conditioned. By rounding some of them vibrate, slower than the shaft: they
    # are none of its modes.
    few = [*FEW, "bearings.B2.film={type: reynolds, cavitation: mass_conserving, states: dynamic, tilt: true, cells: [16, 6]}",
           "studies=[{static: {name: rest, speed: 3600 rpm}}, {modes: {name: modes, speeds: [3600 rpm], count: 6, max_frequency: 6000 rpm}}]",
           "layout.machine=all_ranks"]
    for n in RANKS:
        h.run("tilt.yaml", f"ranks_{n}", few, launcher=[*h.launcher, "-n", str(n)])
        for what, difference, within in same_results(h.work / "ranks_1", h.work / f"ranks_{n}") if n > 1 else []:
            h.close(f"{n} ranks: {what}", difference, 0, within)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"machine": machine, "ranks": ranks}[sys.argv[3]](harness)
    harness.finish()
