#!/usr/bin/env python3
"""What motions are called, by known ones: sections and periods, rotation numbers, orders over a run-up, the train's motions.

assessment.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import math
import subprocess
import sys

import h5py
import numpy as np

from compare import same_results
from harness import Harness, value
from run_up import DAMPING, ECCENTRICITY, JEFFCOTT, MASS, STIFFNESS
from systems import CYCLES

TWO_PI = 2 * math.pi


def kind(study):
    return next(k.removeprefix("motion.") for k in study["values"] if k.startswith("motion."))


def bar(study, key):
    return study["values"][key]["uncertainty"]


def write(h, name, base, studies):
    path = h.work / f"{name}.yaml"
    path.write_text(f"base: {h.source / 'inputs' / base}\nstudies:\n{studies}")
    return path


# Rossler's equations with a = b = 0.2: loops of the cycle on its way to chaos at c = 4.2.
ROSSLER = {2.5: 1, 3.5: 2, 4.0: 4}


def sections(h):
    """Cycles that nothing forces: how often they cross a section until they close, and their period, which is that of the
    branch of cycles and does not depend on the section."""
    inputs = h.source / "inputs/other_systems"
    quick = "discard: 60, revolutions: 32, samples: 16, tolerance: 1.0e-6"
    for c, loops in ROSSLER.items():
        path = write(h, f"rossler_{c}", "other_systems/rossler.yaml",
                     f"  - motion: {{name: own, speed: 1 rad/s, start: {{offset: [1, 0]}}, {quick}, exponents: 2}}\n"
                     f"  - motion: {{name: tilted, speed: 1 rad/s, start: {{offset: [1, 0]}}, exponents: 0,"
                     f" section: {{plane: [{{of: state.1}}, {{of: state.2, factor: -0.5}}], value: 0.3, direction: both}}, {quick}}}\n")
        run = h.run(path, f"rossler_{c}", [f"rossler.c={c}"], launcher=[])
        for name, crossings in (("own", loops), ("tilted", 2 * loops)):
            h.true(f"c = {c}, {name}: a limit cycle", kind(run[name]) == "limit_cycle", kind(run[name]))
            h.close("    crossings until it closes", value(run[name], "period"), crossings, 0)
        h.close("    period by the tilted section [s]", value(run["tilted"], "period.time"), value(run["own"], "period.time"), 1e-4)
        if loops > 2:  # its slowest tone is none of the five loudest
            continue
        tone = min((value(run["own"], f"tone.flow.x.{k}.frequency") for k in range(1, 6)),
                   key=lambda f: abs(f * value(run["own"], "period.time") - 1))
        h.close("    the frequency of its slowest tone times its period", tone * value(run["own"], "period.time"), 1, 2e-3)
    path = write(h, "brusselator", "other_systems/brusselator.yaml",
                 "  - motion: {name: s, speed: 1 rad/s, start: {offset: [0.1, 0]}, discard: 40, revolutions: 12, samples: 16, tolerance: 1.0e-8, exponents: 0}\n")
    s = h.run(path, "brusselator", launcher=[])["s"]
    h.close("Brusselator: period, by an independent computation [s]", value(s, "period.time"), CYCLES[16][0], 2e-6)
    h.true("    said to be a limit cycle without exponents", kind(s) == "limit_cycle" and value(s, "period") == 1, kind(s))
    chaos = h.run(inputs / "lorenz.yaml", "chaos", ["studies.1.motion.revolutions=160", "studies.1.motion.tolerance=1e-6", "studies.1.motion.exponents=1",
                                                    "studies.1.motion.section={of: state.3, value: 27, direction: falling}"], launcher=[])["attractor"]
    h.true("Lorenz: chaotic by the largest exponent alone", kind(chaos) == "chaotic", kind(chaos))
    h.close("    which is", value(chaos, "lyapunov.1"), 0.9056, 1.5 * value(chaos, "lyapunov.1.uncertainty"))
    with h5py.File(h.work / "chaos/results.h5") as f:
        table = f["studies/attractor/section"]
        h.close("    points lie on z = 27, to", np.abs(table["y"][:, 0] - 27).max(), 0, 1e-11)
        h.true("    where it falls", (table["vy"][:] < 0).all())
        h.true("    many", len(table["time"]) > 100, len(table["time"]))


def unnoticed(h):
    """A section neither changes the motion nor what a resumed one finds, on one rank and on two."""
    study = ("  - motion: {{name: s, speed: 1 rad/s, start: {{offset: [0.1, 0]}}, discard: 3, revolutions: 8, samples: 16,"
             " tolerance: 1.0e-6, exponents: 2{}}}\n")
    plain, cut = (write(h, n, "other_systems/brusselator.yaml", study.format(t))
                  for n, t in (("plain", ""), ("cut", ", section: {of: middle.x, value: 2, direction: both}")))
    h.run(plain, "plain", launcher=[])
    h.run(cut, "cut", launcher=[])
    with h5py.File(h.work / "plain/results.h5") as a, h5py.File(h.work / "cut/results.h5") as b:
        for name in ("orbit/x", "exponents/running"):
            h.close(f"{name} with another section", np.abs(a[f"studies/s/{name}"][()] - b[f"studies/s/{name}"][()]).max(), 0, 0)
        h.true("other sections have other points", a["studies/s/section/x"].shape != b["studies/s/section/x"].shape)
    out = h.work / "killed"
    h.kill_at_checkpoint(plain, out, after=6)
    h.run(plain, "killed", flags=["--resume"], launcher=[])
    h.run(cut, "two", launcher=[*h.launcher, "-n", "2"])
    # An exponent is zero there, and rounding counts per its size.
    for name, other, within in (("plain", out, 1e-12), ("cut", h.work / "two", 1e-8)):
        for what, difference, allowed in same_results(h.work / name, other, within):
            h.close(f"{other.name}: {what}", difference, 0, allowed)


def rotation(h):
    """The rigid rotor's torus: points round the circle and tones give one number, not a ratio; its motion of period two turns by
    one half."""
    run = h.run(h.source / "inputs/rigid_rotor/figure_2_2.yaml", "figure",
                [f"studies.{k}.motion.{option}" for k, options in enumerate(
                    (("discard=4", "revolutions=4"), ("discard=120", "revolutions=32"), ("discard=80", "revolutions=256")), 1)
                 for option in (*options, "samples=16", "tolerance=1e-7", "exponents=1")])
    torus, two = run["quasi-periodic"], run["period 2"]
    h.true("quasi-periodic", kind(torus) == "quasi_periodic", kind(torus))
    rho = value(torus, "rotation")
    h.true("    bar of the rotation number", bar(torus, "rotation") < 1e-4, bar(torus, "rotation"))
    h.close("    by the loudest tone that is no order", value(torus, "rotation.tone"), rho, bar(torus, "rotation") + bar(torus, "rotation.tone"))
    h.true("    whose own bar is small", bar(torus, "rotation.tone") < 1e-3, bar(torus, "rotation.tone"))
    h.true("    not locked", value(torus, "rotation.locked.denominator") is None)
    h.close("period two: half a turn per revolution", value(two, "rotation"), 0.5, 0)
    h.close("    locked at 1 /", value(two, "rotation.locked.denominator"), 2, 0)


def jeffcott(speed):
    """Steady whirl z = x + i y over exp(i shaft angle)."""
    return (ECCENTRICITY * speed**2 / (STIFFNESS / MASS - speed**2 + 1j * speed * DAMPING / MASS)) * np.exp(1j * math.radians(40))


def orders(h):
    """A linear rotor run up and down: amplitude and phase of order 1 are those of steady whirl, with an error in proportion to
    the acceleration; nothing at the other orders; rows of the waterfall likewise."""
    path = h.work / "orders.yaml"
    spectra = "orders: {track: [0.5, 1, 2], revolutions: 4, advance: 1}, waterfall: {revolutions: 8, advance: 4, highest: 3}, samples: 16"
    path.write_text(JEFFCOTT + "".join(
        f"  - run_up: {{name: {name}, unbalance: [a], range: {{from: {a} rad/s, to: {b} rad/s}}, start: {{from: cycle}}, acceleration: {rate} rad/s^2, tolerance: 1e-8, {spectra}}}\n"
        for name, a, b, rate in (("fast", 130, 180, 8), ("slow", 130, 180, 4), ("down", 180, 130, 4))))
    h.run(path, "orders", launcher=[])
    error = {}
    with h5py.File(h.work / "orders/results.h5") as f:
        for name in ("fast", "slow", "down"):
            o, w = f[f"studies/{name}/orders"], f[f"studies/{name}/waterfall"]
            # Away from the free vibration that the start leaves, which dies out in a fifth of a second.
            late = np.abs(o["speed"][()] - 157) < 8
            speed, wanted = o["speed"][late], jeffcott(o["speed"][late])
            z = {axis: o[f"{axis}_amplitude"][late, :, 0] * np.exp(1j * o[f"{axis}_phase"][late, :, 0]) for axis in "xy"}
            error[name] = np.abs(z["x"][:, 1] - wanted).max() / np.abs(wanted).max()
            h.close(f"{name}: y lags a quarter of a turn behind x", np.abs(z["y"][:, 1] + 1j * z["x"][:, 1]).max() / np.abs(wanted).max(), 0, 2e-3)
            h.close(f"{name}: amplitudes of orders 1/2 and 2, per that of order 1", max(np.abs(z["x"][:, k]).max() for k in (0, 2)) / np.abs(wanted).max(), 0, 3e-3)
            row = np.argmin(np.abs(w["speed"][()] - 165))
            h.close(f"{name}: waterfall at {w['speed'][row]:.1f} rad/s, order 1", w["x"][row, 8, 0], abs(jeffcott(w["speed"][row])), 0.02 * abs(jeffcott(165)))
    h.true("order 1 of the slow run-up is steady whirl within 0.2 %", error["slow"] < 0.002, error)
    h.close("error at half the acceleration", error["slow"] / error["fast"], 0.5, 0.06)
    h.true("the same on the way down", error["down"] < 0.002, error["down"])


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"sections": sections, "unnoticed": unnoticed, "rotation": rotation, "orders": orders}[sys.argv[3]](harness)
    harness.finish()
