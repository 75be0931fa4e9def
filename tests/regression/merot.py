#!/usr/bin/env python3
"""Runs decks of inputs/merot and compares whirl frequencies and thresholds with those computed independently.

merot.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import math
import sys

from harness import Harness, value

# How far the lowest and the fifth pair may be off on the deck's twenty elements: 2 and 5 times what the orders leave. The linear and
# the hermitian elements are held to their order in tests/rotor.
WITHIN = {"rayleigh": (1e-6, 2e-4), "timoshenko": (1e-5, 2e-3), "timoshenko_linear": (1e-6, 2e-4), "timoshenko_hermitian": (2e-6, 2e-5)}


def disc_rotor(h):
    cases = json.loads((h.source / "tests/reference/rotor/trial_rotor.json").read_text())["cases"]
    deck = h.source / "inputs/merot/disc_rotor.yaml"
    few = "studies=[{modes: {name: two speeds, speeds: [0 rad/s, 10000 rad/s], count: 10}}]"
    for element, (low, high) in WITHIN.items():
        for disc in (True, False):
            name = f"{element}, {'disc' if disc else 'plain'}"
            more = [] if disc else ["rotor.discs=[]"]
            modes = h.run(deck, name, [few, f"rotor.element={element}", *more], launcher=[])["two speeds"]["modes"]
            for c in cases:
                if c["disc"] != disc or c["shear"] != (element != "rayleigh"):
                    continue
                found = [m for m in modes if m["speed"] == c["speed"]]
                h.true(f"{name}, {c['speed']:g} rad/s: ten modes", len(found) == 10)
                for k, (m, wanted) in enumerate(zip(found, c["frequency"])):
                    part = low if k < 2 else high
                    h.close(f"{name}, {c['speed']:g} rad/s, {k + 1}", m["imag"], abs(wanted), part * abs(wanted) + c["uncertainty"][k])
                    if c["speed"] > 0:  # at rest any mixture of a double pair is a mode
                        whirl = "backward" if wanted < 0 else "forward"
                        h.true(f"    {whirl}", m["whirl"] == whirl, m["whirl"])
    # As the deck is: one pair of critical speeds where the whirl turns with the shaft, and the same on two ranks.
    whole = h.run(deck, "whole", launcher=[])
    few_points = "studies.1.modes.points=3"
    two = h.run(deck, "ranks", [few_points], launcher=[*h.launcher, "-n", "2"])
    h.close("first forward critical speed [rad/s]", value(whole["Campbell"], "critical.2.speed"), 1240.8416, 0.02)
    for k in range(1, 6):
        f = value(whole["free shaft"], f"frequency.{k}")
        h.close(f"free shaft, {k} [rad/s], two ranks", value(two["free shaft"], f"frequency.{k}"), f, 1e-9 * f)
    ends = [[m for m in s["Campbell"]["modes"] if m["speed"] == 1e4] for s in (whole, two)]
    for a, b in zip(*ends):
        h.close("mode at 10,000 rad/s, two ranks", b["imag"], a["imag"], 1e-7 * a["imag"])


def internal_damping(h):
    deck = h.source / "inputs/merot/internal_damping.yaml"
    thresholds = json.loads((h.source / "tests/reference/rotor/trial_rotor.json").read_text())["thresholds"]
    for damping, wanted in ((t["bearing_damping"], t["speed"]) for t in thresholds if t["bearing_damping"] > 0):
        more = [f"bearings.*.film.damping={damping} N s/m",
                f"studies.1.equilibrium_branch.range={{from: {0.8 * wanted} rad/s, to: {1.1 * wanted} rad/s}}"]
        s = h.run(deck, f"{damping:g}", more, launcher=[])["internal damping"]
        points = [b for b in s["bifurcations"] if b["type"] == "hopf"]
        h.true(f"{damping:g} N s/m: one Hopf point", len(points) == 1)
        h.close(f"{damping:g} N s/m: threshold [rad/s]", points[0]["value"], wanted, 2e-5 * wanted)
        h.true("    before which it is stable", points[0]["others_unstable"] == 0)


def reduction(h):
    """Whirl frequencies of the reduced shafts: the whole shaft's, off by what was computed independently."""
    reference = json.loads((h.source / "tests/reference/rotor/reduction_trial_rotor.json").read_text())
    deck = h.source / "inputs/merot/reduction.yaml"
    modes = "studies=[{modes: {name: modes, supports: films, speeds: [10000 rad/s], count: 10}}]"
    whole = [m["imag"] for m in h.run(deck, "whole", [modes], launcher=[])["modes"]["modes"]]
    for k, (f, wanted) in enumerate(zip(whole, reference["frequency"])):
        h.close(f"whole, {k + 1}", f, wanted, 1e-7 * wanted)
    words = {"modal_supported": "{type: modal, masters: [1, 21], modes: 8, support: 1e7 N/m}",
             "modal_free": "{type: modal, masters: [1, 21], modes: 8}", "cb_real": "{type: craig_bampton, masters: [1, 21], modes: 6}",
             "cb_state": "{type: craig_bampton_state, masters: [1, 21], modes: 6, speed: 10000 rad/s}"}
    for name, word in words.items():
        for ranks in (1, 2):
            launcher = [*h.launcher, "-n", "2"] if ranks == 2 else []
            s = h.run(deck, f"{name}, {ranks}", [modes, f"rotor.reduction={word}"], launcher=launcher)
            for k, (m, f, error) in enumerate(zip(s["modes"]["modes"], whole, reference["error"]["16"][name])):
                h.close(f"{name}, {k + 1}, ranks {ranks}", abs(m["imag"] / f - 1), error, 2e-3 * error + 1e-8)
    # As the deck is.
    h.true("sweep ends", "reductions" in h.run(deck, "sweep", launcher=[]))


def reduction_errors(h):
    """The study of reductions: errors of frequencies as computed independently, its own of vectors and orbits, all studies with a
    rotor reduced in state space."""
    reference = json.loads((h.source / "tests/reference/rotor/reduction_trial_rotor.json").read_text())
    deck = h.source / "inputs/merot/reduction_errors.yaml"
    s = h.run(deck, "whole", launcher=[])["reductions"]
    names = {"modal_supported": "modal_supported", "modal_free": "modal_free", "craig_bampton": "cb_real", "craig_bampton_state": "cb_state"}
    for freedoms, errors in reference["error"].items():
        for own, theirs in names.items():
            wanted = max(errors[theirs])
            h.close(f"{own}, {freedoms} freedoms, frequencies", value(s, f"{own}.{freedoms}.frequency_error"), wanted, 2e-3 * wanted + 1e-9)
    at = lambda name, freedoms, what: value(s, f"{name}.{freedoms}.{what}_error")
    for freedoms in reference["error"]:
        h.true(f"supported modes are the best, {freedoms} freedoms",
               min(names, key=lambda n: at(n, freedoms, "frequency")) == "modal_supported")
        if int(freedoms) >= 16:
            h.true(f"free modes are the worst, {freedoms} freedoms", max(names, key=lambda n: at(n, freedoms, "frequency")) == "modal_free")
    for name in names:
        h.true(f"{name}: vectors converge", at(name, 40, "vector") < 0.1 * at(name, 10, "vector"))
        ten, twenty = (value(s, f"orbit.{name}.{k}.error") for k in (10, 20))
        h.true(f"{name}: orbits converge", twenty < 0.2 * ten, f"{ten:.3g}, {twenty:.3g}")
        h.true(f"{name}: orbit with 20 freedoms within 1 %", twenty < 0.01, f"{twenty:.3g}")
    # The orbit of the whole shaft is that of other studies' equations: its size with a tolerance a hundred times larger, and on two ranks.
    few = ["studies.1.reduction_errors.freedoms=[12]", "studies.1.reduction_errors.methods=[craig_bampton_state]",
           "studies.1.reduction_errors.orbits.tolerance=1e-8", "studies.1.reduction_errors.maps=0"]
    two = h.run(deck, "ranks", few, launcher=[*h.launcher, "-n", "2"])["reductions"]
    size = value(s, "orbit.size")
    h.close("size of the orbit [m]", value(two, "orbit.size"), size, 1e-4 * size)
    h.close("two ranks", value(two, "craig_bampton_state.12.frequency_error"), at("craig_bampton_state", 12, "frequency"), 1e-6)
    # Other studies take such a rotor: its response to the unbalance is that of the whole shaft, at another speed than that of its modes too.
    response = "studies=[{unbalance_response: {name: response, unbalance: [disc], range: {from: 500 rad/s, to: 1500 rad/s}, points: 41, nodes: [11]}}]"
    damped = "bearings.*.film.damping=200 N s/m"
    state = "rotor.reduction={type: craig_bampton_state, masters: [1, 21], modes: 6, speed: 1200 rad/s}"
    full, small, spread = (h.run(deck, name, [response, damped, *more], launcher=launcher)["response"] for name, more, launcher in
                           (("full", [], []), ("small", [state], []), ("spread", [state], [*h.launcher, "-n", "2"])))
    keys = [k for k in full["values"] if k.startswith("peak") and k.endswith((".speed", ".amplitude"))]
    h.true("peaks", len(keys) > 1, keys)
    for k in keys:
        h.close(f"response: {k}", value(small, k), value(full, k), 1e-4 * value(full, k))
        h.close("    on two ranks", value(spread, k), value(small, k), 1e-8 * value(full, k))


def critical_speeds(h):
    deck = h.source / "inputs/merot/critical_speeds.yaml"
    s = h.run(deck, "whole", launcher=[])["map"]
    # At the springs of the Campbell diagram: the forward one is known, and both are where that diagram meets the speed.
    at = ["studies=[{critical_speed_map: {name: map, stiffness: {from: 1e7 N/m, to: 2e7 N/m}, points: 2}}]"]
    same = h.run(deck, "same", at, launcher=[])["map"]
    campbell = h.run(h.source / "inputs/merot/disc_rotor.yaml", "campbell", launcher=[])["Campbell"]
    h.close("first forward critical speed [rad/s]", value(same, "softest.forward.1"), 1240.8416, 0.02)
    for k, name in ((1, "backward"), (2, "forward")):
        wanted = value(campbell, f"critical.{k}.speed")
        h.close(f"    {name}, of the Campbell diagram", value(same, f"softest.{name}.1"), wanted, 1e-5 * wanted)
    # Soft springs of 1000 N/m: a rigid body, whose bounce the disc beside the middle couples to its pitch a little.
    bounce = (2e3 / (7860 * math.pi * 0.0075**2 * 0.3 + 0.5)) ** 0.5
    h.close("bounce on soft springs [rad/s]", value(s, "softest.forward.1"), bounce, 0.1 * bounce)
    for k in (1, 2, 3):
        h.true(f"stiff springs: forward {k} lies above backward {k}", value(s, f"stiffest.forward.{k}") > value(s, f"stiffest.backward.{k}"))
    two = h.run(deck, "ranks", launcher=[*h.launcher, "-n", "2"])["map"]
    h.close("two ranks", value(two, "stiffest.forward.1"), value(s, "stiffest.forward.1"), 1e-9)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"critical_speeds": critical_speeds, "disc_rotor": disc_rotor, "internal_damping": internal_damping, "reduction": reduction,
     "reduction_errors": reduction_errors}[sys.argv[3]](harness)
    harness.finish()
