#!/usr/bin/env python3
"""Runs decks of inputs/merot and compares whirl frequencies and thresholds with those computed independently.

merot.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import cmath
import json
import math
import sys

import h5py
import numpy as np

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
    # The deck over fewer speeds: one pair of critical speeds where the whirl turns with the shaft, and the same on two ranks.
    few_points = "studies.1.modes.points=3"
    whole = h.run(deck, "whole", ["studies.1.modes.points=6"], launcher=[])
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
    # The other way round: the damping at which the same speed is the threshold.
    speed = next(t["speed"] for t in thresholds if t["bearing_damping"] == 100)
    over = ["studies=[{equilibrium_branch: {name: damping, parameter: rotor.internal_damping, speed: %.9g rad/s, range: {from: 5e-7 s, to: 2e-6 s},"
            " step: {initial: 1e-7 s, min: 1e-11 s, max: 4e-7 s}, detect: [hopf]}}]" % speed]
    points = [b for b in h.run(deck, "over damping", over, launcher=[])["damping"]["bifurcations"] if b["type"] == "hopf"]
    h.true("over the damping: one Hopf point", len(points) == 1)
    h.close("over the damping: threshold [s]", points[0]["value"], 1e-6, 3e-11)


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
            # Nothing is damped and nothing drives: a real part is rounding of the reduction.
            told = [w for w in s["modes"].get("warnings", []) if "unstable" in w]
            h.true(f"{name}, ranks {ranks}: nothing grows", not told and all(m["stability"] not in ("unstable", "diverges") for m in s["modes"]["modes"]), str(told))
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
        h.true(f"{name}: orbit with 20 freedoms within 2 %", twenty < 0.02, f"{twenty:.3g}")
    # The same on two ranks.
    few = ["studies.1.reduction_errors.freedoms=[12]", "studies.1.reduction_errors.methods=[craig_bampton_state]", "studies.1.reduction_errors.maps=0"]
    two = h.run(deck, "ranks", few, launcher=[*h.launcher, "-n", "2"])["reductions"]
    size = value(s, "orbit.size")
    h.close("size of the orbit [m], two ranks", value(two, "orbit.size"), size, 1e-8 * size)
    h.close("two ranks", value(two, "craig_bampton_state.12.frequency_error"), at("craig_bampton_state", 12, "frequency"), 1e-9)
    # Dashpots that creep in place of four modes leave ten freedoms six that vibrate: that size has no answer, the other has.
    creeping = ("studies=[{reduction_errors: {name: creeping, speed: 1e-3 rad/s, freedoms: [10, 20], methods: [modal_supported, craig_bampton]}}]")
    for ranks in (1, 2):
        s = h.run(deck, f"creeping {ranks}", [creeping, "bearings.*.film.damping=1e4 N s/m"], launcher=[*h.launcher, "-n", "2"] if ranks == 2 else [])["creeping"]
        for name in ("modal_supported", "craig_bampton"):
            h.true(f"creeping: {name}, 10 freedoms have no answer", value(s, f"{name}.10.frequency_error") is None
                   and any(w.startswith(f"{name}, 10 freedoms: no errors: ") and "vibrate" in w for w in s["warnings"]), str(s.get("warnings")))
            h.true("    20 freedoms have one", value(s, f"{name}.20.frequency_error") < 0.1)
        h.true("    two sizes counted", s["points"] == 2, s["points"])
    with h5py.File(h.work / "creeping 1/results.h5") as f:
        table = f["studies/creeping/errors/frequency"][()]
        h.true("creeping: the table keeps its shape", table.shape == (2, 2, 10) and np.all(np.isnan(table[:, 0])) and np.all(np.isfinite(table[:, 1])))
    # The same orbit integrated in time: that of the left journal of a reduced shaft, with an unbalance large against the tolerance.
    motion = ("studies=[{motion: {name: motion, unbalance: [disc], speed: 10000 rad/s, discard: 0, revolutions: 2, orbit: 2, samples: 96,"
              " exponents: 0, tolerance: 1e-7}}, {reduction_errors: {name: orbits, speed: 10000 rad/s, freedoms: [12], methods: [craig_bampton_state],"
              " orbits: {unbalance: [disc], node: 1, freedoms: [12], revolutions: 2}}}]")
    moved = ["unbalance.disc.planes.1.amount=1e-4 kg m", "rotor.reduction={type: craig_bampton_state, masters: [1, 21], modes: 4, speed: 10000 rad/s}"]
    h.run(deck, "motion", [*moved, motion], launcher=[])
    with h5py.File(h.work / "motion/results.h5") as f:
        found = np.array([f[f"studies/motion/orbit/{d}"][:, 0] for d in "xy"])
        wanted = np.array([f[f"studies/orbits/orbits/reduced_{d}"][0, 0, 1:] for d in "xy"])
        h.true("as many samples", found.shape == wanted.shape, f"{found.shape}, {wanted.shape}")
        h.close("orbit of the left journal integrated in time, worst, per size", np.abs(found - wanted).max() / np.abs(wanted).max(), 0, 1e-4)
    # Other studies take such a rotor: its response to the unbalance is that of the whole shaft, at another speed than that of its modes too.
    response = "studies=[{unbalance_response: {name: response, unbalance: [disc], range: {from: 500 rad/s, to: 1500 rad/s}, points: 41, nodes: [11]}}]"
    damped = "bearings.*.film.damping=200 N s/m"
    state = "rotor.reduction={type: craig_bampton_state, masters: [1, 21], modes: 6, speed: 1200 rad/s}"
    full, small, spread = (h.run(deck, name, [response, damped, *more], launcher=launcher)["response"] for name, more, launcher in
                           (("full", [], []), ("small", [state], []), ("spread", [state], [*h.launcher, "-n", "2"])))
    keys = [k for k in full["values"] if "peak.1." in k and k.endswith((".speed", ".semi_major"))]
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
    campbell = h.run(h.source / "inputs/merot/disc_rotor.yaml", "campbell", ["studies.1.modes={name: Campbell, range: {from: 0 rad/s, to: 2000 rad/s}, points: 2, count: 4}"], launcher=[])["Campbell"]
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


# A stiff shaft without mass, so that only the disc at node 7, 90 mm from the left of 300 mm, and the springs are left.
LEFT, RIGHT = 0.09, 0.21
MASS, DIAMETRAL, POLAR, OFFSET, ECCENTRICITY, SKEW = 0.5, 7.81e-5, 1.56e-4, 4e-3, 5e-6, 1e-3
SPRING, DASHPOT = 1e5, 20.0
AS_BODY = ["rotor.material.modulus=1e16 Pa", "rotor.material.density=1e-6 kg/m^3", "rotor.reduction={type: guyan, masters: [1, 21]}",
           f"bearings.*.film={{type: linear, stiffness: {SPRING} N/m, damping: {DASHPOT} N s/m}}"]


class Body:
    """z = (u, s) at node 7, complex x + i y: M z'' + (C - i Omega G) z' + K z = b (Omega^2 - i alpha) exp(i angle)."""

    def __init__(self):
        ends = np.array([[1, -LEFT], [1, RIGHT]])
        self.k, self.c = SPRING * ends.T @ ends, DASHPOT * ends.T @ ends
        self.m = np.array([[MASS, MASS * OFFSET], [MASS * OFFSET, DIAMETRAL + MASS * OFFSET**2]])
        self.g = np.diag([0, POLAR])
        e = MASS * ECCENTRICITY * cmath.exp(1j * math.radians(30))
        self.b = np.array([e, e * OFFSET + (DIAMETRAL - POLAR) * SKEW * cmath.exp(1j * math.radians(100))])
        self.ends = ends

    def response(self, speed):
        return np.linalg.solve(self.k - speed**2 * self.m + speed * (1j * self.c + speed * self.g), speed**2 * self.b)

    def run_up(self, acceleration, start, angles, steps=24):
        """z at the angles, from the response at the first speed; classical Runge-Kutta."""
        inverse = np.linalg.inv(self.m)

        def rate(t, y):
            speed, angle = start + acceleration * t, start * t + acceleration * t * t / 2
            force = self.b * (speed**2 - 1j * acceleration) * cmath.exp(1j * angle)
            return np.concatenate([y[2:], inverse @ (force - (self.c - 1j * speed * self.g) @ y[2:] - self.k @ y[:2])])

        z = self.response(start)
        y, t, out = np.concatenate([z, 1j * start * z]), 0.0, []
        for angle in angles:
            end = 2 * angle / (start + math.sqrt(start**2 + 2 * acceleration * angle))
            dt = (end - t) / steps
            for _ in range(steps):
                k1 = rate(t, y)
                k2 = rate(t + dt / 2, y + dt / 2 * k1)
                k3 = rate(t + dt / 2, y + dt / 2 * k2)
                k4 = rate(t + dt, y + dt * k3)
                y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
                t += dt
            out.append(y[:2])
        return np.array(out)


def skewed_disc(h):
    """Eccentric and skewed disc: response and run-up of a rigid body on springs, and the deck as it is."""
    deck = h.source / "inputs/merot/skewed_disc.yaml"
    body, start, end, acceleration = Body(), 400, 650, 2e3
    few = ["studies=[{unbalance_response: {name: response, unbalance: [discs], range: {from: 100 rad/s, to: 900 rad/s}, points: 17,"
           " refine: false, nodes: [1, 21]}}, {run_up: {name: run-up, unbalance: [discs], range: {from: %d rad/s, to: %d rad/s},"
           " acceleration: %g rad/s^2, start: {from: cycle}, nodes: [1, 21], tolerance: 1e-8}}]" % (start, end, acceleration)]
    h.run(deck, "body", [*AS_BODY, *few], launcher=[])
    with h5py.File(h.work / "body/results.h5") as f:
        r = f["studies/response/response"]
        x = r["x_amplitude"][:] * np.exp(1j * r["x_phase"][:])
        wanted = np.array([body.ends @ body.response(speed) for speed in r["speed"][:]])
        h.close("body: response at both ends over the speed, worst", np.abs(x / wanted - 1).max(), 0, 2e-5)
        table = f["studies/run-up/run_up"]
        n = len(table["revolution"])
        z = body.run_up(acceleration, start, 2 * math.pi * np.arange(1, 64 * n + 1) / 64) @ body.ends.T
        x = z.real.reshape(n, 64, 2)
        peak = np.abs(z).max()
        h.close(f"body: largest x in each of {n} revolutions, worst, per peak", np.abs(table["x_max"][:] - x.max(axis=1)).max() / peak, 0, 1e-4)
        slow = max(np.abs(body.ends @ body.response(speed)).max() for speed in np.linspace(start, end, 400))
        h.true("body: the run-up stays below the slow response", peak < 0.98 * slow, f"{peak / slow:.3f}")
    # As the deck is; the same on two ranks.
    one = h.run(deck, "deck", launcher=[])
    two = h.run(deck, "ranks", launcher=[*h.launcher, "-n", "2"])
    for key, within in (("node.7.peak.1.semi_major", 1e-6), ("node.7.peak.1.speed", 1e-6)):
        h.close(f"response, two ranks: {key}", value(two["response"], key), value(one["response"], key), within * value(one["response"], key))
    top = value(one["run-up"], "node.7.peak.amplitude")
    h.close("run-up, two ranks", value(two["run-up"], "node.7.peak.amplitude"), top, 1e-5 * top)
    h.true("the run-up peaks later and lower than the slow response", top < value(one["response"], "node.7.peak.1.semi_major")
           and value(one["run-up"], "node.7.peak.speed") > value(one["response"], "node.7.peak.1.speed"))


# A light shaft on stiff bearings with a heavy point in its middle: k and m of Jeffcott's rotor.
JEFFCOTT = ["rotor.material.density=1 kg/m^3", "rotor.discs=[{node: 11, mass: 0.5 kg}]", "bearings.*.film={type: linear, stiffness: 1e12 N/m}",
            "unbalance={disc: {planes: [{node: 11, amount: 1e-6 kg m}]}}"]


def hysteresis(h):
    deck = h.source / "inputs/merot/hysteresis.yaml"
    eta = 0.02
    modes = lambda speeds: "studies=[{modes: {name: modes, speeds: [%s], count: 2}}]" % ", ".join(f"{s:.12g} rad/s" for s in speeds)  # noqa: E731
    # With next to no loss: the bearings are so stiff that the dense solver alone leaves an error of 6e-5, which Newton's method takes.
    omega = h.run(deck, "no loss", [*JEFFCOTT, modes([0]), "rotor.loss_factor=1e-12"], launcher=[])["modes"]["modes"][0]["imag"]
    for frame in ("shaft", "stationary"):
        for ranks in (1, 2) if frame == "shaft" else (1,):
            more = [*JEFFCOTT, modes([0, 0.5 * omega, 2 * omega]), f"rotor.loss_frame={frame}"]
            found = h.run(deck, f"{frame} {ranks}", more, launcher=[*h.launcher, "-n", "2"] if ranks == 2 else [])["modes"]["modes"]
            for m in found:
                driven = frame == "shaft" and m["speed"] > omega and m["whirl"] == "forward"
                wanted = 1j * omega * cmath.sqrt(1 - 1j * eta if driven else 1 + 1j * eta)
                what = f"{frame}, {m['speed']:.0f} rad/s, {m['whirl']}, ranks {ranks}"
                # The light shaft's own gyroscopic effect parts the two by 8e-8 of the speed.
                h.close(what, m["imag"], wanted.imag, 1e-8 * omega + 1e-7 * m["speed"])
                h.close("    real part", m["real"], wanted.real, 1e-8 * omega)
            at_twice = [m["whirl"] for m in found if m["speed"] > omega]
            h.true(f"{frame}: the planes part above the critical speed", frame == "stationary" or sorted(at_twice) == ["backward", "forward"], str(at_twice))
    # Free in space: every bending mode has the whole loss factor.
    free = ["bearings.*.film={type: linear, stiffness: 0.1 N/m}", "studies=[{modes: {name: modes, speeds: [0 rad/s], count: 10}}]"]
    damped = h.run(deck, "free", free, launcher=[])["modes"]["modes"]
    undamped = h.run(deck, "free, no loss", [*free, "rotor.loss_factor=0"], launcher=[])["modes"]["modes"]
    for k in range(4, 10):
        wanted = 1j * undamped[k]["imag"] * cmath.sqrt(1 + 1j * eta)
        h.close(f"free, mode {k + 1}: real part", damped[k]["real"], wanted.real, 1e-6 * abs(wanted))
        h.close("    frequency", damped[k]["imag"], wanted.imag, 1e-7 * abs(wanted))
    # Response: e/eta at resonance in the stationary frame; in that of the shaft none is lost.
    e = 1e-6 / 0.5
    for frame in ("stationary", "shaft"):
        for ratio in (1.0, 1.05):
            response = ("studies=[{unbalance_response: {name: response, unbalance: [disc], range: {from: %.14g rad/s, to: %.14g rad/s}, points: 2,"
                        " refine: false, nodes: [11]}}]" % (ratio * omega, 1.5 * ratio * omega))
            if frame == "shaft" and ratio == 1:
                continue
            for ranks in (1, 2) if ratio > 1 else (1,):
                name = f"{frame} {ratio} {ranks}"
                h.run(deck, name, [*JEFFCOTT, response, f"rotor.loss_frame={frame}"], launcher=[*h.launcher, "-n", "2"] if ranks == 2 else [])
                with h5py.File(h.work / name / "results.h5") as f:
                    found = f["studies/response/response/semi_major"][0, 0]
                loss = eta if frame == "stationary" else 0
                wanted = abs(e * ratio**2 / (1 + 1j * loss - ratio**2))
                h.close(f"{frame}: response at {ratio} times the critical speed", found, wanted, 2e-4 * wanted)
    # As the deck is: the first mode is driven above its critical speed in spite of the bearings, or less damped.
    s = h.run(deck, "deck", launcher=[])
    first = [m for m in s["modes"]["modes"] if m["whirl"] == "forward" and m["imag"] < 1400]
    below, above = [m["real"] for m in first if m["speed"] < 1000], [m["real"] for m in first if m["speed"] > 1500]
    h.true("the first forward mode loses its damping above its critical speed", max(below) < min(above), f"{max(below)}, {min(above)}")


def torsion_of_coupled_shafts():
    """Frequencies of torsion of the deck's two shafts, lumped on a mesh four times as fine: right to one part in a thousand."""
    g, rho, fine = 210e9 / 2.6, 7850.0, 4
    polar = lambda d, b=0.0: math.pi / 32 * (d**4 - b**4)  # noqa: E731
    pieces = [(0.05 / fine, polar(0.03))] * (6 * fine)
    n = 12 * fine + 2
    k, inertia = np.zeros((n, n)), np.zeros(n)

    def join(i, stiffness, half):
        k[i:i + 2, i:i + 2] += stiffness * np.array([[1, -1], [-1, 1]])
        inertia[i:i + 2] += half

    at = 0
    for side in range(2):
        for length, j in pieces:
            join(at, g * j / length, rho * j * length / 2)
            at += 1
        if side == 0:
            join(at, 2e4, rho * polar(0.09, 0.04) * 0.03)
            at += 1
    for node, d in ((3 * fine, 0.2), (6 * fine + 1 + 3 * fine, 0.16)):
        inertia[node] += rho * polar(d, 0.03) * 0.02
    root = np.diag(inertia**-0.5)
    return np.sqrt(np.maximum(np.linalg.eigvalsh(root @ k @ root), 0))[1:]


def coupled_shafts(h):
    deck = h.source / "inputs/merot/coupled_shafts.yaml"
    s = h.run(deck, "deck", launcher=[])
    wanted = torsion_of_coupled_shafts()
    for k in range(2):
        h.close(f"torsion, {k + 1} [rad/s]", value(s["torsion"], f"frequency.{k + 1}"), wanted[k], (1e-3, 5e-3)[k] * wanted[k])
    modes = [m for m in s["Campbell"]["modes"] if m["whirl"] == "forward"]
    lowest = {speed: min((m for m in modes if m["speed"] == speed), key=lambda m: m["imag"]) for speed in (100, 1500)}
    h.true("the damping of the coupling is lost in forward whirl above its speed", lowest[1500]["real"] > lowest[100]["real"], str(lowest))
    two = h.run(deck, "ranks", ["studies.1.modes.points=2"], launcher=[*h.launcher, "-n", "2"])
    ends = [[m for m in x["Campbell"]["modes"] if m["speed"] == 1500] for x in (s, two)]
    for a, b in zip(*ends):
        h.close("mode at 1500 rad/s, two ranks", b["imag"], a["imag"], 1e-7 * a["imag"])
        h.close("    real part", b["real"], a["real"], 1e-6 * a["imag"])
    h.close("torsion, two ranks", value(two["torsion"], "frequency.1"), value(s["torsion"], "frequency.1"), 1e-9)
    # Along, the right shaft moves as a whole on the coupling.
    rho, ring = 7850, lambda d, b=0.0: math.pi / 4 * (d * d - b * b)  # noqa: E731
    mass = rho * (ring(0.16, 0.03) * 0.02 + ring(0.03) * 0.3 + ring(0.09, 0.04) * 0.03)
    h.close("along, held at the left end [rad/s]", value(s["along"], "frequency.1"), (1e6 / mass)**0.5, 4)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {f.__name__: f for f in (coupled_shafts, critical_speeds, disc_rotor, hysteresis, internal_damping, reduction, reduction_errors,
                             skewed_disc)}[sys.argv[3]](harness)
    harness.finish()
