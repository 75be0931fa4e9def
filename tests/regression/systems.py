#!/usr/bin/env python3
"""The Brusselator and small flows through decks: Hopf point, cycles by every method, a force, a motion, and what a deck of it must not ask.

systems.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import math
import subprocess
import sys

import h5py

from harness import Harness, value

# Period and largest multipliers at L = 1 over the number of cells, from an independent computation in Python with fixed
# steps of order 4 and tolerances of 1e-11 (the same numbers as in tests/reference/brusselator.hpp).
CYCLES = {8: (3.432149541959533, [0.7752320798755273, 0.1970272023592422 + 0.2842442412930182j, 0.1689496242126161]),
          16: (3.434425873566731, [0.7567033019584792, 0.1708552330295754 + 0.26365708085106615j, 0.2154539186414105])}

METHODS = {
    "collocation": "method: collocation, intervals: 40, degree: 4",
    "shooting": "method: shooting, scheme: radau_iia_3, steps: 120",
    "multiple_shooting": "method: multiple_shooting, scheme: classical, intervals: 12, steps: 40",
    "finite_difference": "method: finite_difference, scheme: radau_iia_3, intervals: 120",
    "newton_picard": "method: newton_picard, scheme: sdirk_4, intervals: 1, steps: 240, radius: 0.1",
    # A third of the steps, and 81 times the error.
    "newton_picard_short": "method: newton_picard, scheme: sdirk_4, intervals: 1, steps: 80, radius: 0.1",
}


def hopf_length(cells, a=2, b=5.45, diffusion=0.012):
    """Where the trace of the linearised equations of one half wave in the tube vanishes."""
    wave = 2 * cells * math.sin(math.pi / (2 * cells))
    return wave * math.sqrt(diffusion / (b - 1 - a * a))


def deck(h, name, studies):
    path = h.work / f"{name}.yaml"
    path.write_text(f"base: {h.source / 'inputs/other_systems/brusselator.yaml'}\nstudies:\n{studies}")
    return path


def cycles(h, methods, cells):
    """Cycles from the Hopf point to L = 1."""
    within, tolerance = {"newton_picard_short": 8e-5}, {"newton_picard_short": "1e-8"}
    period, multipliers = CYCLES[cells]
    studies = "".join(f"  - cycle_branch: {{name: {name}, origin: hopf, parameter: brusselator.length,"
                      f" range: {{from: 0.45, to: 1}}, step: {{initial: 0.01, min: 1e-6, max: 0.1}},"
                      f" {METHODS[name]}, tolerance: {tolerance.get(name, '1e-11')}, at: [1], detect: []}}\n" for name in methods)
    run = h.run(deck(h, "cycles", studies), "cycles", [f"brusselator.cells={cells}"])
    with h5py.File(h.work / "cycles/results.h5") as results:
        for name in methods:
            study = run[name]
            h.true(f"{name}: completed", study["status"] == "completed", study["status"])
            h.close(f"{name}: Hopf point", value(study, "hopf"), hopf_length(cells), 2e-6)
            h.close(f"{name}: period", value(study, "at.1.period"), period, within.get(name, 1e-6))
            branch = results[f"studies/{name}/branch"]
            found = [complex(*mu) for mu in zip(branch["multipliers_real"][-1], branch["multipliers_imag"][-1])]
            h.close(f"{name}: the branch ends at L", branch["parameter"][-1], 1, 1e-12)
            for mu in multipliers:
                nearest = min(found, key=lambda z: abs(z - mu))
                h.close(f"{name}: multiplier {mu:.4f}", abs(nearest - mu), 0, within.get(name, 1e-6))


def whole(h):
    """The deck as it is."""
    run = h.run(h.source / "inputs/other_systems/brusselator.yaml", "whole")
    first, second = run["uniform"]["bifurcations"]
    h.true("two Hopf points", first["type"] == second["type"] == "hopf")
    h.close("Hopf point of one half wave", first["value"], hopf_length(16), 1e-6)
    wave = 32 * math.sin(2 * math.pi / 32)
    h.close("Hopf point of two half waves", second["value"], wave * math.sqrt(0.012 / 0.45), 2e-6)
    # The determinant of the same matrix is the square of the frequency.
    mu = (32 * math.sin(math.pi / 32) / hopf_length(16)) ** 2
    omega = math.sqrt(4 * 5.45 - (4 + 0.004 * mu) ** 2)
    h.close("its frequency [rad/s]", value(run["uniform"], "stable_below.1.whirl_frequency"), omega, 1e-6)
    h.true("supercritical, by equilibrium and by cycle branch",
           first["criticality"] == run["oscillation"]["bifurcations"][0]["criticality"] == "supercritical")
    motion = run["from the uniform state"]
    h.true("the motion ends on a limit cycle", "motion.limit_cycle" in motion["values"], str(list(motion["values"])[:3]))
    h.close("its size at L = 1 is that of the cycle", value(motion, "peak_to_peak.middle.x"),
            value(run["oscillation"], "at.1.peak_to_peak.middle.x"), 2e-3)
    h.close("its frequency times the period of the cycle", value(motion, "tone.middle.x.1.frequency")
            * value(run["oscillation"], "at.1.period"), 1, 1e-4)
    h.close("one exponent is zero", value(motion, "lyapunov.1"), 0, value(motion, "lyapunov.1.uncertainty"))
    h.close("the other is that of the cycle [1/s]", value(motion, "lyapunov.2"),
            math.log(value(run["oscillation"], "at.1.multiplier.modulus"))
            / value(run["oscillation"], "at.1.period"), value(motion, "lyapunov.2.uncertainty"))
    h.true("and not zero", value(motion, "lyapunov.2.uncertainty") < 0.3 * 0.0812)


def linear_response(cells, length, amplitude, frequency, a=2, b=5.45, diffusion=(0.008, 0.004)):
    """Peak to peak in the middle of the tube under a small force: each half wave of the tube by itself, two equations."""
    out = [0, 0]
    for mode in range(1, cells):
        share = 2 / cells * sum(math.sin(mode * math.pi * i / cells) for i in range(1, cells))
        wave = (2 * cells * math.sin(mode * math.pi / (2 * cells)) / length) ** 2
        top, bottom = 1j * frequency - (b - 1) + diffusion[0] * wave, 1j * frequency + a * a + diffusion[1] * wave
        force = amplitude * share * math.sin(mode * math.pi / 2) / (top * bottom + a * a * b)
        out = [out[0] + force * bottom, out[1] - force * b]
    return [2 * abs(z) for z in out]


# The deck of the forced oscillator: where the multipliers of its cycle lie on the unit circle, and the cycle at an amplitude of
# 0.6, by Newton's method on one period of SciPy's DOP853 (relative tolerance 1e-12) with the variational equations.
FOLLOWS, ANGLE, PEAKS, MODULUS = 0.293845731, 1.976220139, (1.63661057, 1.67511176), 0.68689054


def forced(h):
    """A periodic feed: the linear response in closed form, and where the motion follows the feed."""
    base = h.source / "inputs/other_systems/forced_brusselator.yaml"
    cycle = "{name: small, parameter: brusselator.frequency, range: {from: 1.8 rad/s, to: 2.2 rad/s}, tolerance: 1e-11,"
    small = h.run(base, "small", ["brusselator.length=0.4", "brusselator.amplitude=1e-4", "bars=none",
                                  "studies=[{cycle_branch: " + cycle + " step: {initial: 0.1 rad/s, min: 1e-4 rad/s, max: 0.2 rad/s},"
                                  " intervals: 30, degree: 4, at: [1.8 rad/s, 2.2 rad/s]}}]"])["small"]
    for frequency in (1.8, 2.2):
        for axis, exact in zip("xy", linear_response(16, 0.4, 1e-4, frequency)):
            h.close(f"small force at {frequency} rad/s, {axis}", value(small, f"at.{frequency}.peak_to_peak.middle.{axis}") / exact, 1, 2e-5)
    following = h.run(base, "following")["following"]
    point = following["bifurcations"][0]
    h.true("a Neimark-Sacker point, stable above", point["type"] == "neimark_sacker" and point["stable_side"] == "above", str(point))
    h.close("its amplitude", point["value"], FOLLOWS, 1e-6)
    h.close("its angle [rad]", point["angle_rad"], ANGLE, 1e-6)
    for axis, exact in zip("xy", PEAKS):
        h.close(f"travel at 0.6, {axis}", value(following, f"at.0.6.peak_to_peak.middle.{axis}"), exact, 1e-5)
    h.close("largest multiplier", value(following, "at.0.6.multiplier.modulus"), MODULUS, 1e-6)
    # Newton-Picard knows products of the monodromy matrix only.
    products = h.run(base, "products", ["bars=none", "studies=[{cycle_branch: {name: products, parameter: brusselator.amplitude,"
                                        " range: {from: 0.25, to: 0.35}, step: {initial: 0.05, min: 1e-5, max: 0.05},"
                                        " method: newton_picard, scheme: sdirk_4, intervals: 1, steps: 60, radius: 0.1}}]"])["products"]
    by_products = products["bifurcations"][0]
    h.close("Newton-Picard: its amplitude", by_products["value"], FOLLOWS, 1e-6)
    h.close("Newton-Picard: coefficient of the normal form", by_products["criticality_coefficient"], point["criticality_coefficient"], 1e-3)
    for amplitude, kind in ((0.2, "quasi_periodic"), (0.6, "period-1")):
        motion = h.run(base, f"motion_{amplitude}", [f"brusselator.amplitude={amplitude}", "studies=[{motion: {name: motion, speed: 3 rad/s,"
                                                     " discard: 40, revolutions: 100, tolerance: 1e-6, start: {offset: [0.1, 0]}}}]"])["motion"]
        h.true(f"amplitude {amplitude}: {kind}", f"motion.{kind}" in motion["values"], str(list(motion["values"])[:3]))


def refused(h):
    """Each wrong deck gets a place, a reason and where possible the right key."""
    rest = "equilibrium_branch: {parameter: brusselator.length, range: {from: 0.4, to: 1.2}}"
    cases = [
        ("  - static: {speed: 1 rad/s}\n", 3, 13, "'static' asks about a rotor in bearings"),
        ("  - modes: {range: {from: 1 rpm, to: 2 rpm}}\n", 3, 12, "'modes' asks about a rotor in bearings"),
        (f"  - {rest}\nbearings: {{}}\n", 4, 1, "'bearings' does not apply where system is brusselator"),
        (f"  - {rest}\nbrusselator: {{lenght: 1}}\n", 4, 15, "unknown key 'lenght' (did you mean 'length'?)"),
        (f"  - {rest}\nsystem: brusselater\n", 4, 9, "did you mean 'brusselator'?"),
        ("  - equilibrium_branch: {parameter: brusselator.lenght, range: {from: 0.4, to: 1.2}}\n", 3, 37,
         "did you mean 'length'?"),
        ("  - equilibrium_branch: {range: {from: 1 rpm, to: 2 rpm}}\n", 3, 25, "a brusselator has no 'speed'"),
        ("  - cycle_branch: {parameter: brusselator.length, range: {from: 0.4, to: 1.2}}\n", 3, 19,
         "'unbalance' is missing"),
        (f"  - {rest}\nbrusselator: {{amplitude: -0.1}}\n", 4, 26, "amplitude"),
        ("  - motion: {speed: 2 rad/s}\nbrusselator: {amplitude: 0.1, frequency: 3 rad/s}\n", 3, 21, "its speed is 3 rad/s"),
    ]
    for k, (studies, line, column, text) in enumerate(cases):
        path = deck(h, f"wrong_{k}", studies)
        done = subprocess.run([h.program, "check", str(path)], capture_output=True, text=True)
        said = done.stdout + done.stderr
        h.true(f"refused: {text}", done.returncode == 2 and f"{path}:{line}:{column}" in said and text in said, said.strip())


def main():
    h = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"whole": lambda: whole(h), "forced": lambda: forced(h), "refused": lambda: refused(h),
     "flows": lambda: flows(h), "flows.whole": lambda: flows(h, whole=True), "direct": lambda: cycles(h, ["collocation", "shooting"], 16),
     "others": lambda: cycles(h, ["multiple_shooting", "finite_difference", "newton_picard_short"], 8), "newton_picard": lambda: cycles(h, ["newton_picard"], 8)}[sys.argv[3]]()
    h.finish()


# Amplitude of the force on Duffing's oscillator and what its motion is then (Holmes 1979; Jordan and Smith 2007, sec. 13.3).
DUFFING = {0.2: "period-1", 0.28: "period-2", 0.29: "period-4", 0.37: "period-5", 0.5: "chaotic", 0.65: "period-2"}


def flows(h, whole=False):
    """Motions whose kind and exponents are known. Short ones, whose bars are longer, or at night as long as the decks say."""
    inputs = h.source / "inputs/other_systems"

    def flow(deck, name, revolutions, *more):
        short = [] if whole else ["studies.1.motion.tolerance=1e-6"]
        if revolutions:
            short.append(f"studies.1.motion.revolutions={revolutions}")
        return next(iter(h.run(inputs / f"{deck}.yaml", name, [*short, *more], launcher=[]).values()))

    attractor = flow("lorenz", "lorenz", None if whole else 200)
    for k, wanted in enumerate((0.9056, 0.0, -14.572), 1):
        bar = value(attractor, f"lyapunov.{k}.uncertainty")
        h.true(f"Lorenz, exponent {k}: a small bar", bar < (0.09 if whole else 0.2))
        h.close(f"Lorenz, exponent {k}", value(attractor, f"lyapunov.{k}"), wanted, 1.5 * bar)
    h.close("    their sum", sum(value(attractor, f"lyapunov.{k}") for k in (1, 2, 3)), -(10 + 1 + 8 / 3), 1e-3)
    h.true("    chaotic", "motion.chaotic" in attractor["values"])
    h.close("    dimension of Kaplan and Yorke", value(attractor, "dimension.kaplan_yorke"), 2.062, 0.005)
    spiral = flow("rossler", "rossler", 400 if whole else 120)
    for k, wanted in enumerate((0.0714, 0.0, -5.3943), 1):
        h.close(f"Rossler, exponent {k}", value(spiral, f"lyapunov.{k}"), wanted, 1.5 * value(spiral, f"lyapunov.{k}.uncertainty"))
    h.true("    chaotic", "motion.chaotic" in spiral["values"])
    for c, kind in ((2.5, "limit_cycle"), (3.5, "limit_cycle")):
        s = flow("rossler", f"rossler {c}", 150 if whole else 60, f"rossler.c={c}")
        h.true(f"Rossler, c = {c}: {kind}", f"motion.{kind}" in s["values"])
    for amplitude, kind in DUFFING.items():
        s = flow("duffing", f"duffing {amplitude}", 300 if whole else 128, f"duffing.amplitude={amplitude}")
        h.true(f"Duffing, amplitude {amplitude}: {kind}", f"motion.{kind}" in s["values"])
        h.close("    sum of the exponents", value(s, "lyapunov.1") + value(s, "lyapunov.2"), -0.3, 1e-4)
    wrong = subprocess.run([h.program, "check", str(inputs / "duffing.yaml"), "--set", "duffing.frequency=1.3 rad/s"], capture_output=True, text=True)
    h.true("another speed than that of the force is refused", wrong.returncode != 0 and "its speed is 1.3 rad/s" in wrong.stderr, wrong.stderr)


if __name__ == "__main__":
    main()
