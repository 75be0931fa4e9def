#!/usr/bin/env python3
"""Motions of the rigid rotor: what kind they are, and their exponents against eigenvalues and Floquet multipliers.

motions.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import math
import re
import resource
import subprocess
import sys

import h5py
import numpy

from compare import same_results
from harness import RANKS, Harness, value

TWO_PI = 2 * math.pi


def deck(h, name, text):
    path = h.work / f"{name}.yaml"
    path.write_text(f"base: {h.source / 'inputs/rigid_rotor/figure_2_2.yaml'}\nstudies:\n{text}")
    return path


def kind(study):
    """What the motion was found to be."""
    return next(k.removeprefix("motion.") for k in study["values"] if k.startswith("motion."))


def exponents(study, count=2):
    return [value(study, f"lyapunov.{k + 1}") for k in range(count)]


def combination(order, whirl):
    """Distance of a tone from the nearest sum of multiples of the speed and the whirl."""
    return min(abs(order - m - n * whirl) for m in range(-4, 5) for n in range(-4, 5))


def figure(h):
    """The first three panels of figure 2.2, shortened."""
    run = h.run(h.source / "inputs/rigid_rotor/figure_2_2.yaml", "figure",
                [f"studies.{k}.motion.{option}" for k, options in enumerate(
                    (("discard=30", "revolutions=16"), ("discard=120", "revolutions=32"), ("discard=60", "revolutions=192")), 1)
                 for option in (*options, "samples=16", "tolerance=1e-6", "exponents=2")])
    for name, wanted in (("fixed point", "fixed_point"), ("period 2", "period-2"), ("quasi-periodic", "quasi_periodic")):
        h.true(f"{name} is one", kind(run[name]) == wanted, kind(run[name]))
    two, torus = run["period 2"], run["quasi-periodic"]
    h.close("period 2: the loudest tone is at half the speed", value(two, "tone.left.x.1.order"), 0.5, 1e-6)
    h.close("period 2: Poincare points return", value(two, "return.2"), 0, 1e-5)
    h.true("period 2: and not after one revolution", value(two, "return.1") > 0.5)
    h.close("quasi-periodic: one exponent per revolution is zero", value(torus, "lyapunov.1.per_revolution"), 0, 1e-2)
    h.true("quasi-periodic: the other is not", value(torus, "lyapunov.2.per_revolution") < -0.1)
    h.close("quasi-periodic: the loudest tone is at the speed", value(torus, "tone.left.x.1.order"), 1, 1e-5)
    whirl = value(torus, "tone.left.x.2.order")
    h.true("quasi-periodic: whirl near half the speed, but not there", 0.01 < abs(whirl - 0.5) < 0.02, f"{whirl:.6f}")
    for k in (3, 4, 5):
        order = value(torus, f"tone.left.x.{k}.order")
        # A tenth of a line: neighbours are five lines away.
        h.close(f"quasi-periodic: tone {k} at {order:.5f} is m + n whirl", combination(order, whirl), 0, 0.1 / 192)


def chaos(h):
    """The last panel, shortened."""
    run = h.run(h.source / "inputs/rigid_rotor/figure_2_2_chaos.yaml", "chaos",
                ["studies.1.motion.revolutions=160", "studies.1.motion.discard=32", "studies.1.motion.tolerance=1e-4",
                 "studies.1.motion.samples=16", "studies.1.motion.exponents=3"])
    s = run["chaotic"]
    h.true("it is chaotic", kind(s) == "chaotic", kind(s))
    h.true("the largest exponent is positive", value(s, "lyapunov.1") > value(s, "lyapunov.1.uncertainty"))
    h.true("fractal dimension between one and two", 1 < value(s, "dimension.kaplan_yorke") < 2,
           str(value(s, "dimension.kaplan_yorke")))


def floquet(h):
    """Exponents of stable motions are decay rates: of the equilibrium, of the synchronous cycle, of that of period 2."""
    run = h.run(deck(h, "floquet", """
  - equilibrium_branch: {name: at rest, range: {from: 80 rad/s, to: 100 rad/s}}
  - motion: {name: rest, speed: 80 rad/s, start: {offset: [0.3, 0]}, discard: 40, revolutions: 16, samples: 16, exponents: 2}
  - motion: {name: synchronous, unbalance: [a2], speed: 320 rad/s, start: {from: cycle}, discard: 120, revolutions: 16, exponents: 2, samples: 16}
  - cycle_branch: {name: branch, unbalance: [a2], parameter: speed, range: {from: 320 rad/s, to: 970 rad/s}, at: [320 rad/s, 960 rad/s],
      step: {initial: 4 rad/s, min: 0.0001 rad/s, max: 64 rad/s}, intervals: 40, degree: 4, points: gauss, mesh_tolerance: 1e-7,
      adapt_every: 2, follow_flips: true, max_points: 60}
  - motion: {name: double, unbalance: [a2], speed: 960 rad/s, discard: 120, revolutions: 32, exponents: 2, samples: 64, tolerance: 1e-7}
"""), "floquet")
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
    turn = TWO_PI / 320
    moduli = [value(one, f"cycle.multiplier.{k}.modulus") for k in (1, 2)]
    h.close("multiplier by the study's own cycle and along the branch", moduli[0],
            value(run["branch"], "at.320.multiplier.modulus"), 1e-6)
    # Two real multipliers, both negative, and two that are tiny.
    for k in (0, 1):
        rate = math.log(moduli[k]) / turn
        h.close(f"synchronous: exponent {k + 1} is log|mu|/T [1/s]", exponents(one)[k], rate, 1e-5 * abs(rate))
    turn = TWO_PI / 960

    h.true("double", kind(two) == "period-2", kind(two))
    born = run["branch flip 1"]
    h.close("period 2 along the branch [s]", value(born, "at.960.period"), 2 * turn, 1e-9)
    # The largest of 64 samples per turn misses a peak by up to (pi/64)^2/2 of its amplitude.
    for axis in "xy":
        h.close(f"double: peak to peak {axis} [m]", value(two, f"peak_to_peak.left.{axis}"),
                value(born, f"at.960.peak_to_peak.left.{axis}"), 2e-3 * value(born, f"at.960.peak_to_peak.left.{axis}"))
    rate = math.log(value(born, "at.960.multiplier.modulus")) / (2 * turn)
    pairs = 1e-3 < value(born, "at.960.multiplier.angle") < math.pi - 1e-3
    h.close("double: the largest exponent is log|mu|/2T [1/s]",
            sum(exponents(two, 2)) / 2 if pairs else exponents(two)[0], rate, 1e-3 * abs(rate))


def compliant(h):
    """A film with states of its own: exponents of the synchronous motion are log|mu|/T, where the force has no kinks."""
    path = h.work / "compliant.yaml"
    path.write_text(f"base: {h.source / 'inputs/compliant_rotor/figure_5_8.yaml'}\n"
                    "bearings: {half: {film: {cells: [24, 4], quadrature: sub_cell, differences: central}}}\n"
                    "studies:\n"
                    "  - motion: {name: synchronous, unbalance: [a], speed: 400 rad/s, start: {from: cycle}, discard: 120,\n"
                    "      revolutions: 20, samples: 16, exponents: 2, tolerance: 1e-6}\n")
    s = h.run(path, "compliant")["synchronous"]
    h.true("it is synchronous", kind(s) == "period-1", kind(s))
    for k in (1, 2):
        rate = value(s, f"cycle.exponent.{k}")
        h.close(f"exponent {k} is log|mu|/T [1/s]", value(s, f"lyapunov.{k}"), rate, 2e-3 * abs(rate))


def train(h):
    """Five bearings: the synchronous motion; the four largest exponents together, because pairs of multipliers lie close."""
    path = h.work / "train.yaml"
    path.write_text(f"base: {h.train / 'unbalance.yaml'}\nstudies:\n"
                    "  - motion: {name: forced, unbalance: [gen_pair], speed: 3000 rpm, start: {from: cycle}, discard: 200,\n"
                    "      revolutions: 60, samples: 8, exponents: 4, tolerance: 1e-4}\n"
                    "  - cycle_branch: {name: branch, unbalance: [gen_pair], range: {from: 3000 rpm, to: 3010 rpm}, at: [3000 rpm]}\n")
    run = h.run(path, "train")
    s = run["forced"]
    h.true("it is synchronous", kind(s) == "period-1", kind(s))
    rates = [value(s, f"cycle.exponent.{k}") for k in (1, 2, 3, 4)]
    h.close("sum of four exponents [1/s]", sum(exponents(s, 4)), sum(rates), 0.05 * abs(sum(rates)))
    h.close("largest multiplier by the study's own cycle and along the branch", value(s, "cycle.multiplier.1.modulus"),
            value(run["branch"], "at.3000.multiplier.modulus"), 1e-5)
    for b in range(1, 6):
        for axis in "xy":
            wanted = value(run["branch"], f"at.3000.peak_to_peak.B{b}.{axis}")
            # Eight samples a turn miss a peak by up to (pi/8)^2/2 of its amplitude.
            h.close(f"B{b}: peak to peak {axis} [m]", value(s, f"peak_to_peak.B{b}.{axis}"), wanted, 0.08 * wanted)


SHORT = """
  - motion: {name: short, unbalance: [a3], speed: 1920 rad/s, discard: 10, revolutions: 30, samples: 32, exponents: 2, tolerance: 1e-6}
"""


def growing(h, whole=False):
    """The train at G6.3: a whirl at 766 +- 12 rpm (independent computation, Guyan, 30 x 10) leaves the unstable cycle of 2650 rpm.
    At night: it settles on a torus at 2600 rpm, beyond the supercritical Neimark-Sacker point."""
    one = ["studies.1.cycle_branch.max_points=1", "studies.2={static: {name: at rest, speed: 2600 rpm}}", "studies.3.motion.exponents=1"]
    found = h.run(h.source / "inputs/turbine_train/motions.yaml", "growing", [] if whole else one, launcher=[], bars=False)
    s = found["G6.3 at 2650 rpm"]
    h.true("the cycle is unstable", value(s, "cycle.multiplier.1.modulus") > 1)
    whirl = value(s, "cycle.multiplier.1.angle") / TWO_PI * 2650
    h.close("its whirl [rpm]", whirl, 766, 12)
    for bearing in ("B2", "B3", "B4"):
        tones = [value(s, f"tone.{bearing}.y.{k}.frequency") * 60 for k in range(1, 6)]
        h.close(f"the growing tone in {bearing} [rpm]", min(tones, key=lambda f: abs(f - 766)), whirl, 3)
        h.close("    and its mirror beside the shaft's speed", min(tones, key=lambda f: abs(f - 1884)), 2650 - whirl, 3)
    h.true("on its way", kind(s) == "unsettled", kind(s))
    # Begun on unstable equilibria beyond 5021 rpm it rests there to rounding of its state: no cycle.
    speeds = (5050, 5500, 5800)
    rest = h.run(h.source / "inputs/turbine_train/self_excited.yaml", "at rest",
                 ["studies=[" + ", ".join(f"{{motion: {{name: '{n}', speed: {n} rpm, discard: 5, revolutions: 10, exponents: 0}}}}" for n in speeds) + "]"], launcher=[], bars=False)
    for n in speeds:
        s = rest[str(n)]
        h.true(f"{n} rpm: at rest where an oscillation grows", any("at rest at an unstable equilibrium" in w and "an oscillation grows" in w for w in s.get("warnings", [])), str(s.get("warnings")))
        h.true("    it moves by rounding", value(s, "size") < 1e-8, str(value(s, "size")))
    if not whole:
        return
    s = found["G6.3 at 2600 rpm"]
    h.true("the cycle of 2600 rpm is unstable", value(s, "cycle.multiplier.1.modulus") > 1)
    h.true("its motion is quasi-periodic", kind(s) == "quasi_periodic", kind(s))
    h.close("whirl on the torus [rpm]", value(s, "rotation") * 2600, 766, 12)


def torus(h, whole=False):
    """The train at G2.5 beyond its Neimark-Sacker point: what leaves the cycle there has the growth and the whirl of its multiplier;
    at 5050 rpm it ends on a torus. Shortened to what is on its way."""
    short = [f"studies.{k}.motion.{option}" for k, options in
             ((2, ("discard=60", "revolutions=200", "exponents=1")), (3, ("discard=250", "revolutions=300", "exponents=1"))) for option in options]
    short.append("studies.1.cycle_branch.range={from: 4900 rpm, to: 5150 rpm}")
    found = h.run(h.source / "inputs/turbine_train/torus.yaml", "torus", [] if whole else short, launcher=[])
    with h5py.File(h.work / "torus/results.h5") as f:
        curves = {name: numpy.column_stack([f[f"studies/{name}/poincare/{c}"][:] for c in ("x", "y")])
                  for name in ("5050 rpm", "5500 rpm")}
    first = next(b for b in found["cycles"]["bifurcations"] if b["type"] == "neimark_sacker")
    h.close("the branch loses its stability near the first motion [rpm]", first["value"], 5050, first["uncertainty"])
    h.close("and nearly at the whirl of the first [turns]", first["angle_rad"] / TWO_PI,
            value(found["5050 rpm"], "cycle.multiplier.1.angle") / TWO_PI, 2e-3)
    for name, speed in (("5050 rpm", 5050), ("5500 rpm", 5500)):
        s, points = found[name], curves[name]
        growth, angle = (value(s, f"cycle.multiplier.1.{what}") for what in ("modulus", "angle"))
        h.true(f"{name}: the cycle is unstable, by less than 1 %", 1 < growth < 1.01, f"{growth}")
        tones = [value(s, f"tone.B4.y.{k}.order") for k in range(1, 6)]
        h.close(f"{name}: the whirl per revolution", min(tones, key=lambda t: abs(t - angle / TWO_PI)), angle / TWO_PI, 3e-3)
        half = len(points) // 2
        part = numpy.hanning(half) * numpy.exp(-1j * angle * numpy.arange(half))  # the whirl's, of others none
        early, late = (numpy.linalg.norm(part @ (points[k:k + half] - points.mean(axis=0))) for k in (0, half))
        slope = math.log(late / early) / half
        if name == "5500 rpm":
            h.close(f"{name}: growth per revolution over that of the multiplier", slope / math.log(growth), 1, 0.1)
            h.true(f"{name}: on its way", kind(s) == "unsettled", kind(s))
        elif whole:
            h.close(f"{name}: no growth any more", slope / math.log(growth), 0, 0.1)
            h.true(f"{name}: quasi-periodic", kind(s) == "quasi_periodic", kind(s))
            for bearing in ("B2", "B3", "B5"):
                order = min((value(s, f"tone.{bearing}.y.{k}.order") for k in range(1, 6)), key=lambda t: abs(t - angle / TWO_PI))
                h.close(f"{name}: {bearing} whirls as B4 does", order, value(s, "tone.B4.y.1.order"), 1e-4)


def ranks(h):
    path = deck(h, "short", SHORT)
    for n in RANKS:
        h.run(path, f"short.{n}", launcher=[*h.launcher, "-n", str(n)])
        if n > 1:
            for what, difference, within in same_results(h.work / "short.1", h.work / f"short.{n}"):
                h.close(f"{n} ranks: {what}", difference, 0, within)


def resume(h):
    """A chaotic motion forgets its start, but not for being killed: it goes on to the bit."""
    path = h.source / "inputs/rigid_rotor/figure_2_2_chaos.yaml"
    short = ["studies.1.motion.revolutions=40", "studies.1.motion.discard=10", "studies.1.motion.tolerance=1e-4"]
    h.run(path, "whole", short)
    out = h.work / "killed"
    h.kill_at_checkpoint(path, out, short)
    h.run(path, "killed", short, ["--resume"])
    for what, difference, within in same_results(h.work / "whole", out, 1e-14):
        h.close(f"resumed: {what}", difference, 0, within)


def shared(h):
    """Of a machine whose states all ranks share no rank has a whole one, in checkpoints neither: a motion and a run-up begin
    on two ranks and end on one. Both by matrices of all states: by the structure of the machine, as one rank would, steps are
    the same but deviations are carried to 1e-6."""
    assembled = ["--", "-motion_assembled"]
    studies = {
        "motion": "motion: {name: s, unbalance: [a], speed: 320 rad/s, discard: 0, revolutions: 6, samples: 8, exponents: 1, tolerance: 1e-4}",
        "run_up": "run_up: {name: s, unbalance: [a], range: {from: 160 rad/s, to: 200 rad/s}, acceleration: 400 rad/s^2, samples: 8, tolerance: 1e-4}"}
    for kind, study in studies.items():
        path = h.work / f"{kind}.yaml"
        path.write_text(f"base: {h.source / 'inputs/compliant_rotor/finite_curve.yaml'}\nlayout: {{machine: all_ranks}}\n"
                        f"bearings: {{half: {{film: {{cells: [12, 4]}}}}}}\nstudies:\n  - {study}\n")
        h.run(path, kind, flags=assembled, launcher=[])
        out = h.work / f"{kind} killed"
        h.kill_at_checkpoint(path, out, launcher=[*h.launcher, "-n", "2"])
        with h5py.File(next(p for p in (out / "s.checkpoint.h5", out / "s.checkpoint.h5.prev") if p.exists())) as f:
            how = f["state/u"].id.get_create_plist()
            h.true(f"{kind}: states are written by rows", how.get_fill_time() == h5py.h5d.FILL_TIME_NEVER)
        h.run(path, out.name, flags=["--resume", *assembled], launcher=[])
        for what, difference, within in same_results(h.work / kind, out):
            h.close(f"{kind} resumed: {what}", difference, 0, within)


def pump(h):
    """A film that ruptures costs little more than one that is cut off, a finer tolerance changes nothing, and progress says
    where the motion is within a revolution."""
    path = h.source / "inputs/pump/pump.yaml"
    few = ["studies.2.motion.discard=0", "studies.2.motion.revolutions=2"]
    cost = {}
    for cavitation in ("reynolds", "half_sommerfeld"):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        h.run(path, cavitation, [*few, "bearings.*.film.inlet.type=free", f"bearings.*.film.cavitation={cavitation}"])
        cost[cavitation] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    ratio = cost["reynolds"] / cost["half_sommerfeld"]
    h.true("a revolution with Reynolds cavitation costs at most 3 of half-Sommerfeld", ratio < 3, f"{ratio:.2f}")
    usual = h.run(path, "usual", few)["running"]
    done = subprocess.run(h.command(path, h.work / "fine", [*few, "studies.2.motion.tolerance=1e-6"], ["--progress"]),
                          capture_output=True, text=True)
    fine = h.studies("fine")["running"]
    for name in ("dry", "wet"):
        for axis in "xy":
            key = f"peak_to_peak.{name}.{axis}"
            h.close(f"{key}, a tolerance ten times finer [m]", value(usual, key), value(fine, key), 2e-3 * value(fine, key))
    where = re.findall(r"running: revolution \d+ of 2, (\d+\.\d) deg, step \S+ deg, \d+\.\d s", done.stderr)
    h.true("progress names revolution, angle, step and time within the revolutions", len(set(where)) >= 3, f"{where[:5]}")


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    cases = {"figure": figure, "chaos": chaos, "floquet": floquet, "compliant": compliant, "train": train, "growing": growing, "growing.whole": lambda h: growing(h, True),
             "torus": torus, "torus.whole": lambda h: torus(h, True), "ranks": ranks, "resume": resume, "shared": shared,
             "pump": pump}
    cases[sys.argv[3]](harness)
    harness.finish()
