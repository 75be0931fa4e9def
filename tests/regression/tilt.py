#!/usr/bin/env python3
"""Runs the train in films that follow the slope of its shaft, beside the same films that do not; the tables of moments and slopes.

tilt.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import math
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


def cells_of(study, caption):
    """The numbers of a table of the answer: {bearing: [...]}."""
    table = next(t for t in study["brief"]["tables"] if t["caption"] == caption)
    return {row[0]: [cell["value"] for cell in row[1:]] for row in table["rows"]}


SHIFTS, BY_SLOPE, OF_SHIFT, SLOPES = ("Stiffness K and damping C of the films", "Forces by the slope of the journal",
                                      "Moments by the displacement of the journal", "Moments by the slope of the journal")


def table(h):
    """A machine that is the same from both ends; full films about centred journals, which have a closed form."""
    deck = h.source / "tests/cases/tilt.yaml"
    rest = h.run(deck, "rest")["rest"]
    size = {caption: [max(abs(v) for row in cells_of(rest, caption).values() for v in row[k:k + 4]) for k in (0, 4)]
            for caption in (SHIFTS, BY_SLOPE, OF_SHIFT, SLOPES)}  # of K, of C
    # Seen from the other end z and all slopes change their signs, forces and places do not.
    for caption, sign in ((SHIFTS, 1), (BY_SLOPE, -1), (OF_SHIFT, -1), (SLOPES, 1)):
        found = cells_of(rest, caption)
        for k, (left, right) in enumerate(zip(found["left"], found["right"], strict=True)):
            h.close(f"{caption}, number {k + 1}: opposite tilt", right, sign * left, 1e-8 * size[caption][k // 4])
    h.true("opposite tilts make forces", size[BY_SLOPE][0] > 100, str(size))
    for axis in "xy":
        for what in ("tilt", "moment"):
            left, middle, right = (value(rest, f"bearing.{b}.{what}.{axis}") for b in ("left", "middle", "right"))
            h.close(f"{what}.{axis}: opposite", right, -left, 1e-8 * abs(left))
            h.close("    and none in the middle", middle, 0, 1e-8 * abs(left))
    # So a force changes by the square of a tilt, and a journal without tilt has the coefficients of a film that knows none.
    for caption in (BY_SLOPE, OF_SHIFT):
        for k, v in enumerate(cells_of(rest, caption)["middle"]):
            h.close(f"{caption}, number {k + 1}: none in the middle", v, 0, 1e-9 * size[caption][k // 4])
    parallel = h.run(deck, "parallel", ["bearings.middle.film={type: reynolds, cavitation: half_sommerfeld, cells: [48, 16]}"])["rest"]
    for k, (a, b) in enumerate(zip(cells_of(parallel, SHIFTS)["middle"], cells_of(rest, SHIFTS)["middle"], strict=True)):
        h.close(f"{SHIFTS}, number {k + 1}: as without tilt", a, b, 1e-7 * size[SHIFTS][k // 4])

    # p = P(z) cos(theta): P'' - P/R^2 = 12 mu/c^3 (z or 1) (d/dt + Omega/2 d/dtheta) of slope or place, P = 0 at both ends.
    centred = h.run(deck, "centred", ["gravity=0 m/s^2", "bearings.*.film.cavitation=none", "bearings.*.film.cells=[96, 64]"])["rest"]
    mu, radius, length, clearance, speed = 0.02, 0.04, 0.06, 80e-6, 100 * math.pi
    l = length / (2 * radius)
    pressure = 12 * mu * math.pi * radius**3 / clearance**3
    of_shift = pressure * (length - 2 * radius * math.tanh(l))
    of_slope = pressure * (length**3 / 12 + radius**2 * length - radius * length**2 / 2 / math.tanh(l))
    for caption, damping, zero in ((SHIFTS, of_shift, False), (SLOPES, of_slope, False), (BY_SLOPE, math.sqrt(of_shift * of_slope), True),
                                   (OF_SHIFT, math.sqrt(of_shift * of_slope), True)):
        cross = damping * speed / 2
        wanted = [0] * 8 if zero else [0, cross, -cross, 0, damping, 0, 0, damping]
        for k, (found, exact) in enumerate(zip(cells_of(centred, caption)["left"], wanted, strict=True)):
            h.close(f"{caption}, number {k + 1}: centred", found, exact, (3e-3 if exact else 1e-9) * (damping if k > 3 else cross))


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
    {"machine": machine, "ranks": ranks, "table": table}[sys.argv[3]](harness)
    harness.finish()
