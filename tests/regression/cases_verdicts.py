#!/usr/bin/env python3
"""What branches conclude of small machines: ranges, thresholds, limits and sentences by points and bifurcations together.

cases_verdicts.py PROGRAM SOURCE [LAUNCHER WORDS...]
"""
import math
import sys

from harness import Harness, value


def stretches(study):
    return [r["stability"] for r in study["ranges"]]


def pair(h, s):
    h.true("a pair inside one step: loses stability", s["stability"] == "loses stability", s["stability"])
    h.true("stable, unstable, stable", stretches(s) == ["stable", "unstable", "stable"], str(s["ranges"]))
    found = sorted(b["value"] for b in s["bifurcations"])
    h.true("two Hopf points", len(found) == 2, str(found))
    h.close("the lower one [mPa s]", found[0], 0.1561, 1e-4)
    h.close("the upper one [mPa s]", found[1], 0.1683, 1e-4)
    words = {round(b["value"], 3): b["sentence"] for b in s["bifurcations"]}
    h.true("whirl begins at the lower one", words[0.156] == "above this viscosity whirl grows from nothing", str(words))
    h.true("and ends at the upper one", words[0.168].startswith("stable again above 0.168287 mPa s"), str(words))
    h.close("stable below [Pa s]", value(s, "stable_below.1"), found[0] * 1e-3, 1e-9)
    h.close("stable above [Pa s]", value(s, "stable_above.1"), found[1] * 1e-3, 1e-9)
    h.true("a viscosity has no threshold", "threshold" not in s["values"])


def load(h, s):
    b = s["bifurcations"][0]
    h.true("stable above a load", b["stable_side"] == "above" and b["unstable_below"] == 2 and b["unstable_above"] == 0, str(b))
    h.true("its sentence", b["sentence"].startswith("stable above ") and "jumps to" not in b["sentence"], b["sentence"])
    h.close("the limit [N]", value(s, "stable_above.1"), b["value"], 1e-9)


def falling(h, s):
    h.close("threshold of a falling range [rad/s]", value(s, "threshold"), 437.6421, 1e-3)
    b = s["bifurcations"][0]
    h.true("is stable below", b["stable_side"] == "below" and b["born"] == "whirl", str(b))
    h.true("its sentence", b["sentence"] == "above this speed the rotor jumps to large whirl; just below it a disturbance can trigger the same whirl", b["sentence"])


def coarse(h, s):
    h.true(f"{s['name']}: undetermined, not stable throughout", s["stability"] == "undetermined", s["stability"])
    h.true("with the number", any("largest multiplier" in w for w in s.get("warnings", [])), str(s.get("warnings")))


def flips(h, s):
    first = s["bifurcations"][0]
    h.true("half-frequency whirl is born", first["born"] == "half-frequency whirl" and first["stable_side"] == "below", str(first))
    h.true("its sentence", "half-frequency whirl" in first["sentence"], first["sentence"])


def duffing(h):
    """A softening oscillator that forces itself: folds and the largest first harmonic by harmonic balance with 15 harmonics."""
    s = h.run(h.source / "tests/cases/forced_duffing.yaml", "duffing")["resonance"]
    folds = sorted(b["value"] for b in s["bifurcations"] if b["type"] == "cyclic_fold")
    h.true("two folds", len(folds) == 2, str(folds))
    h.close("lower fold [rad/s]", folds[0], 0.86271, 1e-5)
    h.close("upper fold [rad/s]", folds[1], 0.89277, 1e-5)
    h.true("nothing turns there: the system jumps", all("the system jumps" in b["sentence"] for b in s["bifurcations"]), str(s["bifurcations"]))


def bearing_map(h):
    """From 0.3 the film at 0.6 is not found at once, but it exists."""
    s = h.run(h.source / "inputs/compliant_rotor/short.yaml", "map",
              ["bearings.half.film.compliance=0.05", "studies=[{bearing_map: {name: map, speed: 160 rad/s, points: 2, max_eccentricity: 0.6}}]"])["map"]
    h.true("the map of a soft bearing is complete with two points", s["status"] == "completed" and s["points"] == 2, s["status"])
    # Central differences fold the locus. Its folds on 60 cells by an independent continuation (NumPy, dense): 0.84324, 0.75561
    # and 0.96119, from where it turns back to contact.
    for points in (5, 7, 10):
        s = h.run(h.source / "inputs/compliant_rotor/short.yaml", f"map{points}",
                  ["bearings.half.film.compliance=0.05", "bars=none",
                   f"studies=[{{bearing_map: {{name: map, speed: 160 rad/s, points: {points}, max_eccentricity: 1.2}}}}]"])["map"]
        h.close(f"{points} points: the locus ends at its last fold", value(s, "limit.eccentricity"), 0.96119, 1e-4)
        h.true("and says so", s["status"].startswith("ended at eccentricity 0.961") and "turns back there" in s["status"], s["status"])
        h.true("with the folds before", any("0.7556" in w and "to 0.8432" in w for w in s["warnings"]), str(s["warnings"]))
        h.true("which upwind differences do not have", any("upwind" in w for w in s["warnings"]), str(s["warnings"]))
        h.true("all points before are there", s["points"] == sum(1.2 * k / points < 0.961 for k in range(1, points + 1)), str(s["points"]))


def several(h):
    """Between the folds at 856.73 and 867.08 rad/s the branch of whirl has three cycles at one speed, below them one."""
    branch = ("studies=[{cycle_branch: {name: w, origin: hopf, parameter: speed, range: {from: 800 rad/s, to: 900 rad/s}, at: [860 rad/s, 880 rad/s], "
              "step: {initial: 1 rad/s, min: 0.0001 rad/s, max: 8 rad/s}, intervals: 40, degree: 4, points: gauss}}]")
    s = h.run(h.source / "inputs/rigid_rotor/stability_chart.yaml", "several", [branch])["w"]
    h.true("says that 860 rad/s has three cycles", any("passes 860 rad/s 3 times" in w for w in s.get("warnings", [])), str(s.get("warnings")))
    h.true("880 rad/s has one", not any("passes 880" in w for w in s.get("warnings", [])))


def many_bearings(h):
    """Twenty pairs of multipliers of nearly one modulus. Under small unbalance they are those of the modes of the equilibrium."""
    deck = h.source / "tests/cases/uniform_shaft.yaml"
    s = h.run(deck, "uniform", bars=False)
    cycle, period = s["forced"], value(s["forced"], "at.5800.period")
    largest = max(math.exp(m["real"] * period) for m in s["modes"]["modes"])
    h.close("largest multiplier of a shaft on twenty bearings", value(cycle, "at.5800.multiplier.modulus"), largest, 2e-5)
    h.true("stable", cycle["stability"] == "stable throughout" and not cycle.get("suspected"), str(cycle["stability"]))
    # Where the search may not go on it does not converge: the cycles are there all the same.
    lost = h.run(deck, "unknown", [], ["--", "-monodromy_products", "1"], bars=False)["forced"]
    h.true("cycles without multipliers are a result", lost["status"] == "completed" and lost["points"] == 2, str(lost["status"]))
    h.true("whose stability is not known", lost["stability"] != "stable throughout" and "undetermined" in stretches(lost), str(lost["ranges"]))
    h.true("with the reason", any("did not converge" in x["reason"] for x in lost["suspected"]), str(lost.get("suspected")))
    h.true("and a warning", any("search for multipliers did not converge at 2 of 2 points" in w for w in lost["warnings"]), str(lost["warnings"]))


if __name__ == "__main__":
    program, source, *launcher = sys.argv[1:]
    harness = Harness(program, source, launcher)
    studies = harness.run(harness.source / "tests/cases/verdicts.yaml", "verdicts")
    pair(harness, studies["pair"])
    load(harness, studies["load"])
    falling(harness, studies["falling"])
    coarse(harness, studies["coarse"])
    coarse(harness, studies["sixty"])
    flips(harness, studies["flips"])
    duffing(harness)
    bearing_map(harness)
    several(harness)
    many_bearings(harness)
    harness.finish()
