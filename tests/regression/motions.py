#!/usr/bin/env python3
"""Motions of the rigid rotor: what kind they are, and their exponents against eigenvalues and Floquet multipliers.

motions.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import math
import os
import signal
import subprocess
import sys
import time

from compare import same_results
from harness import Harness, value

TWO_PI = 2 * math.pi


def deck(h, name, text):
    path = h.work / f"{name}.yaml"
    path.write_text(f"base: {h.source / 'inputs/rigid_rotor/figure_2_2.yaml'}\nstudies:\n{text}")
    return path


def kind(study):
    """What the motion was found to be."""
    return next(k.removeprefix("motion.") for k in study["values"] if k.startswith("motion."))


def exponents(study, count=4):
    return [value(study, f"lyapunov.{k + 1}") for k in range(count)]


def figure(h):
    """The first three panels of figure 2.2, as in the deck."""
    run = h.run(h.source / "inputs/rigid_rotor/figure_2_2.yaml", "figure")
    for name, wanted in (("fixed point", "fixed_point"), ("period 2", "period-2"), ("quasi-periodic", "quasi_periodic")):
        h.true(f"{name} is one", kind(run[name]) == wanted, kind(run[name]))
    two, torus = run["period 2"], run["quasi-periodic"]
    h.close("period 2: the loudest tone is at half the speed", value(two, "tone.left.x.1.order"), 0.5, 1e-6)
    h.close("period 2: Poincare points return", value(two, "return.2"), 0, 1e-6)
    h.true("period 2: and not after one revolution", value(two, "return.1") > 0.5)
    h.close("quasi-periodic: one exponent per revolution is zero", value(torus, "lyapunov.1.per_revolution"), 0, 2e-3)
    h.true("quasi-periodic: the others are not", value(torus, "lyapunov.2") < -10 * value(torus, "lyapunov.2.uncertainty"))
    whirl = value(torus, "tone.left.x.1.order")
    h.true("quasi-periodic: whirl near half the speed, but not there", 0.4 < whirl < 0.499, f"{whirl:.5f}")


def chaos(h):
    """The last panel, shortened."""
    run = h.run(h.source / "inputs/rigid_rotor/figure_2_2_chaos.yaml", "chaos",
                ["studies.1.motion.revolutions=400", "studies.1.motion.discard=100", "studies.1.motion.tolerance=1e-6",
                 "studies.1.motion.samples=32"])
    s = run["chaotic"]
    h.true("it is chaotic", kind(s) == "chaotic", kind(s))
    h.true("the largest exponent is positive", value(s, "lyapunov.1") > 2 * value(s, "lyapunov.1.uncertainty"))
    h.true("fractal dimension between one and two", 1 < value(s, "dimension.kaplan_yorke") < 2,
           str(value(s, "dimension.kaplan_yorke")))


def floquet(h):
    """Exponents of stable motions are decay rates: of the equilibrium, of the synchronous cycle, of that of period 2."""
    run = h.run(deck(h, "floquet", """
  - equilibrium_branch: {name: at rest, range: {from: 80 rad/s, to: 100 rad/s}}
  - motion: {name: rest, speed: 80 rad/s, start: {offset: [0.3, 0]}, discard: 100, revolutions: 40, samples: 32, exponents: 2}
  - motion: {name: synchronous, unbalance: [a2], speed: 960 rad/s, start: {from: cycle}, discard: 16, revolutions: 64, exponents: 4, samples: 32}
  - cycle_branch: {name: branch, unbalance: [a2], parameter: speed, range: {from: 440 rad/s, to: 1000 rad/s}, at: [960 rad/s],
      step: {initial: 4 rad/s, min: 0.0001 rad/s, max: 64 rad/s}, intervals: 40, degree: 4, points: gauss, mesh_tolerance: 1e-7,
      adapt_every: 2, follow_flips: true, max_points: 60}
  - motion: {name: double, unbalance: [a2], speed: 960 rad/s, start: {offset: [0.3, 0]}, discard: 200, revolutions: 64, exponents: 4, samples: 128}
"""), "floquet")
    import h5py
    with h5py.File(h.work / "floquet" / "results.h5") as f:
        branch = f["studies/at rest/branch"]
        h.close("first point of the branch [rad/s]", float(branch["parameter"][0]), 80, 1e-9)
        rate = float(branch["leading_real"][0])
    rest, one, two = run["rest"], run["synchronous"], run["double"]
    h.true("at rest", kind(rest) == "fixed_point", kind(rest))
    for k in (1, 2):
        # A pair turns the directions: what is left of a turn counts over the whole record.
        h.close(f"rest: exponent {k} is the eigenvalue's real part [1/s]", value(rest, f"lyapunov.{k}"), rate,
                max(1e-4 * abs(rate), value(rest, f"lyapunov.{k}.uncertainty")))
    h.close("rest: mean of the pair", sum(exponents(rest, 2)) / 2, rate, 1e-5 * abs(rate))

    h.true("synchronous", kind(one) == "period-1", kind(one))
    turn = TWO_PI / 960
    moduli = [value(one, f"cycle.multiplier.{k}.modulus") for k in range(1, 5)]
    h.close("multiplier by the study's own cycle and along the branch", moduli[0],
            value(run["branch"], "at.960.multiplier.modulus"), 1e-6)
    h.close("synchronous: sum of all exponents is log det M/T [1/s]", sum(exponents(one)),
            sum(math.log(m) for m in moduli) / turn, 1e-5 * abs(sum(exponents(one))))
    pairs = value(one, "cycle.multiplier.1.angle") > 1e-3
    first = sum(exponents(one, 2)) / 2 if pairs else exponents(one)[0]
    h.close("synchronous: the largest is log|mu|/T [1/s]", first, math.log(moduli[0]) / turn,
            1e-4 * abs(math.log(moduli[0]) / turn))

    h.true("double", kind(two) == "period-2", kind(two))
    born = run["branch flip 1"]
    h.close("period 2 along the branch [s]", value(born, "at.960.period"), 2 * turn, 1e-9)
    for axis in "xy":
        h.close(f"double: peak to peak {axis} [m]", value(two, f"peak_to_peak.left.{axis}"),
                value(born, f"at.960.peak_to_peak.left.{axis}"), 1e-3 * value(born, f"at.960.peak_to_peak.left.{axis}"))
    rate = math.log(value(born, "at.960.multiplier.modulus")) / (2 * turn)
    pairs = 1e-3 < value(born, "at.960.multiplier.angle") < math.pi - 1e-3
    h.close("double: the largest exponent is log|mu|/2T [1/s]",
            sum(exponents(two, 2)) / 2 if pairs else exponents(two)[0], rate, 1e-3 * abs(rate))


SHORT = """
  - motion: {name: short, unbalance: [a3], speed: 1920 rad/s, discard: 10, revolutions: 30, samples: 32, exponents: 2, tolerance: 1e-6}
"""


def ranks(h):
    path = deck(h, "short", SHORT)
    for n in (1, 2, 3):
        h.run(path, f"short.{n}", launcher=[*h.launcher, "-n", str(n)])
        if n > 1:
            for what, difference, within in same_results(h.work / "short.1", h.work / f"short.{n}"):
                h.close(f"{n} ranks: {what}", difference, 0, within)


def resume(h):
    """A chaotic motion forgets its start, but not for being killed: it goes on to the bit."""
    path = h.source / "inputs/rigid_rotor/figure_2_2_chaos.yaml"
    short = ["studies.1.motion.revolutions=120", "studies.1.motion.discard=40", "studies.1.motion.tolerance=1e-6"]
    h.run(path, "whole", short)
    out = h.work / "killed"
    process = subprocess.Popen(h.command(path, out, short), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    limit = time.monotonic() + 200
    while not list(out.glob("*.checkpoint.h5")) and process.poll() is None and time.monotonic() < limit:
        time.sleep(0.01)
    h.true("a checkpoint before the end", process.poll() is None)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    h.run(path, "killed", short, ["--resume"])
    for what, difference, within in same_results(h.work / "whole", out, 1e-14):
        h.close(f"resumed: {what}", difference, 0, within)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"figure": figure, "chaos": chaos, "floquet": floquet, "ranks": ranks, "resume": resume}[sys.argv[3]](harness)
    harness.finish()
