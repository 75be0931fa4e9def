#!/usr/bin/env python3
"""Motions under external forces against exact answers, and the linearity of a rotor on a film of gas.

linearity.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import cmath
import math
import sys

import h5py
import numpy as np

from compare import same_results
from harness import Harness, value

MASS, STIFFNESS, DAMPING = 2.0, 8e4, 40.0  # 200 rad/s, 5 % of critical damping
SPEED = 300.0
OSCILLATOR = f"""title: Oscillator
rotor: {{type: rigid, mass: {MASS} kg}}
gravity: 9.81 m/s^2
bearings:
  spring:
    node: 1
    film: {{type: linear, stiffness: [{STIFFNESS} N/m, 0 N/m, 0 N/m, {STIFFNESS} N/m], damping: [{DAMPING} N s/m, 0 N s/m, 0 N s/m, {DAMPING} N s/m]}}
unbalance:
  none: {{planes: [{{node: 1, eccentricity: 1 pm}}]}}
studies:
"""
FREE = cmath.sqrt(STIFFNESS / MASS - (DAMPING / (2 * MASS))**2).real
DECAY = DAMPING / (2 * MASS)


def write(h, name, studies):
    path = h.work / f"{name}.yaml"
    path.write_text(OSCILLATOR + studies)
    return path


def motion(name, forces, revolutions=24, more=""):
    return f"  - motion: {{name: {name}, speed: {SPEED} rad/s, discard: 0, revolutions: {revolutions}, orbit: {revolutions}, exponents: 0, tolerance: 1e-9, forces: {{{forces}}}{more}}}\n"


def orbit(h, run, study):
    with h5py.File(h.work / run / "results.h5") as f:
        g = f["studies"][study]["orbit"]
        return g["time"][()], g["x"][()].ravel(), g["y"][()].ravel()


def after_step(t):
    """Answer of the oscillator to a unit step at t = 0."""
    t = np.maximum(t, 0)
    return (1 - np.exp(-DECAY * t) * (np.cos(FREE * t) + DECAY / FREE * np.sin(FREE * t))) / STIFFNESS


def after_ramp(t):
    """To a force of 1 N/s from t = 0 on: the integral of that of a step."""
    s = np.maximum(t, 0)
    z = complex(-DECAY, FREE)  # exp(-d s)(cos + d/w sin) = Re((1 - i d/w) exp(z s))
    return (s - np.real((1 - 1j * DECAY / FREE) * (np.exp(z * s) - 1) / z)) / STIFFNESS


def kind(study):
    return next(k.removeprefix("motion.") for k in study["values"] if k.startswith("motion."))


def forces(h):
    """Steps, a table, a shaker: the oscillator's answers in closed form, all the way."""
    (h.work / "force.csv").write_text("time [ms],force [N]\n20,0\n60,8\n100,-4\n")
    deck = write(h, "oscillator",
                 motion("step", "push: {node: 1, direction: x, signal: step, amplitude: 5 N, start: 31 ms, end: 0.21 s}")
                 + motion("series", "push: {bearing: spring, direction: y, signal: series, table: force.csv}")
                 + motion("shaker", "push: {node: 1, direction: x, signal: harmonic, amplitude: 3 N, frequency: 23 Hz, phase: 30 deg}", 60)
                 + motion("two", "a: {node: 1, direction: x, signal: step, amplitude: 5 N, start: 31 ms}, b: {node: 1, direction: x, signal: step, amplitude: -5 N, start: 0.21 s}")
                 + motion("over", "push: {node: 1, direction: x, signal: impulse, amplitude: 5 N, duration: 1 ms}", 8, ", start: {from: equilibrium}").replace("discard: 0", "discard: 60"))
    run = h.run(deck, "forces")
    t, x, y = orbit(h, "forces", "step")
    h.close("step: largest error of x over the largest x", np.abs(x - 5 * (after_step(t - 0.031) - after_step(t - 0.21))).max() / np.abs(x).max(), 0, 1e-6)
    sag = -MASS * 9.81 / STIFFNESS
    h.close("    y stays where it is, over the sag", np.abs(y - sag).max() / -sag, 0, 1e-9)
    _, both, _ = orbit(h, "forces", "two")
    h.close("    two forces for one, over the largest x", np.abs(both - x).max() / np.abs(x).max(), 0, 1e-6)
    t, x, y = orbit(h, "forces", "series")
    ramps = 200 * after_ramp(t - 0.02) - 500 * after_ramp(t - 0.06) + 300 * after_ramp(t - 0.1) + 4 * after_step(t - 0.1)
    h.close("table: largest error of y over the largest", np.abs(y - sag - ramps).max() / np.abs(ramps).max(), 0, 1e-6)
    t, x, _ = orbit(h, "forces", "shaker")
    w = 2 * math.pi * 23
    z = 3 * cmath.exp(1j * math.radians(30)) / (STIFFNESS - MASS * w * w + 1j * DAMPING * w)
    late = t > 0.9  # the transient has died to exp(-9) of its size
    h.close("shaker: x at the end", np.abs(x - np.real(z * np.exp(1j * w * t)))[late].max() / abs(z), 0, 2e-4)
    for name in ("step", "series", "shaker"):
        h.true(f"{name}: no kind of motion is claimed", kind(run[name]) == "driven", kind(run[name]))
    h.true("over before the record: judged as ever", kind(run["over"]) == "fixed_point", kind(run["over"]))
    # A knock on a shaft that speeds up, from a node and from the journal.
    up = "  - run_up: {name: %s, unbalance: [none], range: {from: 200 rad/s, to: 400 rad/s}, acceleration: 500 rad/s^2, tolerance: 1e-9, nodes: [1], samples: 256%s}\n"
    knock = ", forces: {knock: {node: 1, direction: x, signal: impulse, amplitude: 50 N, start: 0.1 s, duration: 1 ms}}"
    found = h.run(write(h, "up", up % ("still", "") + up % ("knocked", knock)), "up")
    h.close("run-up: without a force nothing moves [m]", value(found["still"], "bearing.spring.peak.amplitude"), 0, 1e-10)
    jump = 2 * 50 * 1e-3 / math.pi / MASS  # a half-sine is short against the period
    first = jump / FREE * math.exp(-DECAY * math.pi / 2 / FREE)
    h.close("run-up: the swing after a knock over that of a jump of the velocity", value(found["knocked"], "bearing.spring.peak.amplitude") / first, 1, 0.25)


NOISE = "noise: {bearing: A, direction: x, signal: random, rms: 3 N, cutoff: 2 kHz, seed: 5}"


def same(h):
    """Random forces on a film of gas: killed and resumed, and on two ranks."""
    deck = h.source / "inputs/aerostatic/bearing_a.yaml"
    more = ["bearings.A.film.cells=[16, 8]",
            "studies=[{motion: {name: shaken, speed: 2000 rad/s, discard: 0, revolutions: 40, samples: 16, exponents: 0, orbit: 40, tolerance: 1e-6, forces: {%s}}}]" % NOISE]
    whole = h.run(deck, "whole", more, launcher=[])["shaken"]
    h.true("it is driven", kind(whole) == "driven", kind(whole))
    h.true("it moves", value(whole, "peak_to_peak.A.x") > 1e-8, str(value(whole, "peak_to_peak.A.x")))
    h.kill_at_checkpoint(deck, h.work / "killed", more)
    h.run(deck, "killed", more, flags=["--resume"], launcher=[])
    for what, difference, within in same_results(h.work / "whole", h.work / "killed", 0):
        h.close("killed and resumed: the same to the bit: " + what, difference, 0, within)
    h.run(deck, "two", more, launcher=[*h.launcher, "-n", "2"])
    for what, difference, within in same_results(h.work / "whole", h.work / "two", 1e-7):
        h.close("two ranks: the same: " + what, difference, 0, within)


def transfer(k, b, mass, frequency):
    w = 2 * math.pi * frequency
    return np.linalg.inv(np.array(k) + 1j * w * np.array(b) - mass * w * w * np.eye(2))


def tables(h, run, study):
    with h5py.File(h.work / run / "results.h5") as f:
        g = f["studies"][study]
        return {f"{a}/{b}": g[a][b][()] for a in g for b in g[a] if isinstance(g[a][b], h5py.Dataset)}


SHORT = ["studies=[{linearity: {name: short, speed: 2000 rad/s, levels: [0.2 N, 3 N], cutoff: 1 kHz, highest: 800 Hz, duration: 0.9 s, segments: 23, "
         "settle: 0.05 s, tolerance: 1e-6}}]", "bearings.A.film.cells=[16, 8]"]


def short(h):
    """A short record: the linear functions against K + i w B, coherence and bounds, its fall with the force, two ranks."""
    deck = h.source / "inputs/aerostatic/linearity.yaml"
    study = h.run(deck, "short", SHORT, launcher=[])["short"]
    h.true("the equilibrium is known to be stable", study["stability"] == "stable" and not any("unstable" in w for w in study.get("warnings", [])), study["stability"])
    t = tables(h, "short", "short")
    # (3.43), with K and B at each frequency.
    lines = [0, 10, 25, 40, 55]
    at = t["linear/frequency"][lines]
    ratios = ", ".join(repr(2 * math.pi * f / 2000) for f in at)
    c = h.run(deck, "coefficients", [SHORT[1], "studies=[{dynamic_coefficients: {name: c, load: 49.05 N, speeds: [2000 rad/s], frequencies: [%s]}}]" % ratios],
              launcher=[])["c"]
    for line, f in zip(lines, at):
        head = next(k for k in c["values"] if k.endswith("K.xx") and abs(float(k.split("ratio.")[1].split(".K")[0]) / (2 * math.pi * f / 2000) - 1) < 1e-4)[:-4]
        k, b = ([[value(c, f"{head}{letter}.{i}{j}") for j in "xy"] for i in "xy"] for letter in "KC")
        wanted = transfer(k, b, 5, f)
        found = np.array([[t[f"linear/g_{i}{j}"][line] * cmath.exp(1j * t[f"linear/g_{i}{j}_phase"][line]) for j in "xy"] for i in "xy"])
        h.close(f"G at {f:.4g} Hz against K + i w B", np.abs(found - wanted).max() / np.abs(wanted).max(), 0, 1e-4)
    h.close("independent averages of 23 segments", value(study, "averages"), 23 / (1 + 2 * (22 / 23) / 36), 1e-2)
    for k in (1, 2):
        get = lambda key: value(study, f"level.{k}.{key}")  # noqa: E731
        h.true(f"level {k}: multiple coherence off resonance", get("coherence.least") > 0.9, f"{get('coherence.least'):.4f} at {get('coherence.least_at'):.4g} Hz")
        h.close(f"level {k}: share of entries whose 95 % bounds hold the linear ones", get("within"), 0.95, 0.15)
        h.close(f"level {k}: rms of |H1 - G| over the gain", get("deviation"), 0, 0.1)
        ratio = t["excitation/density_x"] / t["excitation/density"]
        low = t["excitation/frequency"] < 900
        h.close(f"level {k}: density of the force over that in closed form, mean", ratio[low].mean(), 1, 0.1)
    h.true("its fall with the force", value(study, "level.2.unexplained") > 1.2 * value(study, "level.1.unexplained"),
           f"unexplained off resonance: {value(study, 'level.1.unexplained'):.5f} to {value(study, 'level.2.unexplained'):.5f}")
    h.close("displacements grow with the force", value(study, "level.2.rms.x") / value(study, "level.1.rms.x") / 15, 1, 0.1)
    h.run(deck, "two", SHORT, launcher=[*h.launcher, "-n", "2"])
    for what, difference, within in same_results(h.work / "short", h.work / "two", 1e-9):
        h.close("two ranks: the same: " + what, difference, 0, within)


def whole(h):
    """The deck as it is."""
    study = h.run(h.source / "inputs/aerostatic/linearity.yaml", "whole", launcher=[])["linearity"]
    h.close("level 1: peak [um], at most 0.5", 1e6 * value(study, "level.1.peak"), 0.25, 0.25)
    for k in (1, 2):
        h.true(f"level {k}: multiple coherence off resonance above 0.95", value(study, f"level.{k}.coherence.least") > 0.95,
               f"{value(study, f'level.{k}.coherence.least'):.4f} at {value(study, f'level.{k}.coherence.least_at'):.4g} Hz")
        h.close(f"level {k}: share of entries whose 95 % bounds hold the linear ones", value(study, f"level.{k}.within"), 0.95, 0.05)
    falls = [value(study, f"level.{k}.unexplained") for k in (1, 2, 3)]
    h.true("coherence falls with the force", falls[2] > falls[1], str(falls))


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"forces": forces, "same": same, "short": short, "whole": whole}[sys.argv[3]](harness)
    harness.finish()
