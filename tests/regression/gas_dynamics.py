#!/usr/bin/env python3
"""Runs decks of inputs/aerostatic that move the journal: enforced motion, its path, loads that are too large.

gas_dynamics.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import subprocess
import sys

import h5py
import numpy as np
from compare import same_results
from harness import Harness, value

DECKS = "inputs/aerostatic"


def pairs(ports):
    axes = ("x", "y", "slope_x", "slope_y")[:ports]
    return [a + ("." if "slope" in a + b else "") + b for a in axes for b in axes]


def enforced(h):
    """Against perturbation as the amplitude falls, and damping over the frequency against an independent computation."""
    deck = h.source / DECKS / "enforced.yaml"
    few = ["bearings.A.film.cells=[24, 8]"]
    s = h.run(deck, "small", few + ["studies.2.dynamic_coefficients.amplitudes=[0.3]", "studies.1.dynamic_coefficients.amplitudes=[0.005, 0.02, 0.2, 0.475]"], launcher=[])
    study = s["over amplitude"]
    head = "speed.2000.ratio.1."
    apart = {a: value(study, f"{head}amplitude.{a}.from_perturbation") for a in ("0.005", "0.02", "0.2", "0.475")}
    h.close("all 32 coefficients at 0.005 clearances, from perturbation", apart["0.005"], 0, 1e-3)
    h.close("    falls with the square of the amplitude", np.log2(apart["0.02"] / apart["0.005"]) / 2, 2, 0.1)
    for a, b in (("0.02", "0.2"), ("0.2", "0.475")):
        for axis in ("x", "y", "slope_x"):
            low, high = (value(study, f"{head}amplitude.{k}.distortion.{axis}") for k in (a, b))
            h.true(f"what K and B leave of the forces grows with the amplitude, {axis}", 0 < low < high < 0.5, f"{low:.3g} {high:.3g}")
    for axis in "xy":
        k = [value(study, f"{head}amplitude.{a}.C.{axis}{axis}") for a in ("0.02", "0.2", "0.475")]
        h.true(f"damping B.{axis}{axis} grows with the amplitude", k[0] < k[1] < k[2], " ".join(f"{v:.1f}" for v in k))
    mixed = max(abs(value(study, f"{head}amplitude.0.475.K.{p}")) for p in pairs(4) if p.count("slope") == 1)
    h.close("shifts make no moments, however large [N]", mixed, 0, 1e-6 * 1e7 * 0.03)
    # Errata (3.40): nu times the damping rises where the velocity lacks its factor.
    reference = json.loads((h.source / "tests/reference/aerostatic/bearing_b.json").read_text())["over_frequency"]
    found = []
    for r in (0.05, 1, 3, 5):
        wanted = next(w for w in reference if w["ratio"] == r)["B"][0][0]
        found.append(value(s["over frequency"], f"speed.2000.ratio.{r:g}.amplitude.0.3.C.yy"))
        small = h_small(h, deck, few, r)
        h.close(f"c_yy at {r:g} of the speed, small amplitude [N s/m]", small, wanted, 0.02 * wanted)
    h.true("damping falls with the frequency", all(a > b for a, b in zip(found, found[1:])), " ".join(f"{v:.0f}" for v in found))
    scaled = [r * b for r, b in zip((0.05, 1, 3, 5), found)]
    h.true("    its product with the frequency rises, then saturates", scaled[0] < scaled[1] < scaled[2] and abs(scaled[3] / scaled[2] - 1) < 0.1)


SMALL = {}


def h_small(h, deck, few, ratio):
    """C.yy at a small amplitude; all frequencies are run at once."""
    if not SMALL:
        study = "studies=[{dynamic_coefficients: {name: s, load: 49.05 N, speeds: [2000 rad/s], frequencies: [0.05, 1, 3, 5], method: enforced, amplitudes: [0.01]}}]"
        # On 24 x 8 cells the damping at high frequencies is 4 % off.
        s = h.run(deck, "frequencies", [*few, "bearings.A.film.cells=[64, 20]", study], launcher=[])["s"]
        SMALL.update({r: value(s, f"speed.2000.ratio.{r:g}.amplitude.0.01.C.yy") for r in (0.05, 1, 3, 5)})
        for r in SMALL:
            h.close(f"at {r:g} of the speed, from perturbation", value(s, f"speed.2000.ratio.{r:g}.amplitude.0.01.from_perturbation"), 0, 1e-3)
    return SMALL[ratio]


def pressures(h):
    """Appendix C: 0.3 to 0.6 MPa; the bearing that was tested; one rank and two."""
    few = "bearings.A.film.cells=[24, 8]"
    study = "studies.1={dynamic_coefficients: {name: coefficients, load: 49.05 N, speeds: [2000 rad/s], method: enforced, amplitudes: [0.02]}}"
    sweep = h.run(h.source / DECKS / "pressures.yaml", "pressures", [few, study], launcher=[])["supply"]
    variants = sweep["variants"]
    stiff = []
    for v in variants:
        values = v["studies"][0]["values"] if "studies" in v else v["values"]
        get = lambda n: next(e["value"] for k, e in values.items() if k.endswith(n))  # noqa: E731
        h.close("from perturbation", get("amplitude.0.02.from_perturbation"), 0, 3e-3)
        stiff.append(get("amplitude.0.02.K.yy"))
    h.true("stiffness over the supply", all(k > 0 for k in stiff), " ".join(f"{k / 1e6:.2f}" for k in stiff))
    tested = h.source / DECKS / "tested.yaml"
    cells = "bearings.A.film.cells=[24, 12]"
    one, two = (h.run(tested, n, [cells], launcher=l)["centred"] for n, l in (("one", []), ("two", [*h.launcher, "-n", "2"])))
    for speed in (500, 3000):
        at = f"speed.{speed}.ratio.1.amplitude.0.025."
        h.close(f"{speed} rad/s, from perturbation", value(one, at + "from_perturbation"), 0, 1e-3)
        k = {p: value(one, at + "K." + p) for p in ("xx", "xy", "yx", "yy")}
        b = {p: value(one, at + "C." + p) for p in ("xx", "xy", "yx", "yy")}
        # Eight orifices: the same in both directions, and the opposite across.
        h.close("    K.xx over K.yy", k["xx"] / k["yy"], 1, 1e-6)
        h.close("    K.xy over -K.yx", -k["xy"] / k["yx"], 1, 1e-5)
        h.close("    B.xx over B.yy", b["xx"] / b["yy"], 1, 1e-6)
        for p in k:
            h.close(f"    K.{p}, two ranks", value(two, at + "K." + p), k[p], 1e-8 * k["xx"])


def path(h):
    """Figure 3.18: from the centre to the place of `static`."""
    s = h.run(h.source / DECKS / "path.yaml", "path", launcher=[])
    with h5py.File(h.work / "path" / "results.h5") as f:
        orbit = f["studies/let go/orbit"]
        x, y = orbit["x"][()][:, 0], orbit["y"][()][:, 0]
    ex, ey = (value(s["its place"], f"bearing.A.{d}") for d in "xy")
    c = 20e-6
    h.close("begins in the centre [clearances]", np.hypot(x[0], y[0]) / c, 0, 0.02)
    h.close("    ends where `static` says", np.hypot(x[-1] - ex, y[-1] - ey) / c, 0, 1e-3)
    h.true("    swings beyond its place", y.min() < 1.5 * ey, f"{y.min() / c:.3f} {ey / c:.3f}")
    turned = np.unwrap(np.arctan2(y - ey, x - ex))
    h.true("    spirals with the rotation", turned[len(turned) // 3] > turned[0] + np.pi, f"{(turned[len(turned) // 3] - turned[0]) / 2 / np.pi:.2f} turns")


def whirl(h):
    """Self-excited cycles from the Hopf point that the equilibria show; before it the film's fast modes are no modes."""
    deck = h.source / DECKS / "whirl.yaml"
    coarse = ["bearings.A.film.cells=[16, 6]", "layout.refined_states=1"]
    both = ["studies+={equilibrium_branch: {name: rest, parameter: speed, range: {from: 2600 rad/s, to: 3300 rad/s}}}", "studies.1.cycle_branch.max_points=5",
            "studies.1.cycle_branch.range={from: 2600 rad/s, to: 3300 rad/s}"]
    s = h.run(deck, "whirl", coarse + both, launcher=[], code=None)
    hopf = [b for b in s["rest"]["bifurcations"] if b["type"] == "hopf"]
    h.true("one Hopf point of the equilibria", len(hopf) == 1 and len(s["rest"]["bifurcations"]) == 1 and hopf[0]["others_unstable"] == 0)
    born = next(b for b in s["whirl"]["bifurcations"] if b["type"] == "hopf")
    h.close("cycles are born there [rad/s]", born["value"], hopf[0]["value"], 0.02)
    with h5py.File(h.work / "whirl" / "results.h5") as f:
        branch = f["studies/whirl/branch"]
        speed, size, period, stable = (branch[k][()] for k in ("parameter", "y_max", "period", "stable"))
    h.close("    with its period [s]", period[0], 2 * np.pi / hopf[0]["whirl_frequency_rad_s"], 1e-3 * period[0])
    # The first cycle is too small for its multiplier to differ from one.
    h.true("    towards lower speeds, and unstable", speed[-1] < speed[0] and not stable[1:].any(), f"{speed[0]:.1f} to {speed[-1]:.1f} rad/s; stable: {stable}")
    h.true("    growing", (np.diff(size[:, 0]) > 0).all())
    # A push beyond it ends where the surfaces touch, whatever the tolerance: on the way pressures behind orifices pass that of
    # the supply, where their equations have kinks.
    pushes = ", ".join(f"{{motion: {{name: '{t}', speed: 3300 rad/s, start: {{offset: [0.7, 0]}}, discard: 0, revolutions: 60, samples: 32,"
                       f" tolerance: {t}, exponents: 0}}}}" for t in ("1e-3", "1e-4", "1e-5", "1e-6", "1e-7"))
    for tolerance, push in h.run(deck, "contact", coarse + [f"studies=[{pushes}]"], launcher=[], code=None).items():
        h.true(f"tolerance {tolerance}: contact in revolution 15", push["status"].startswith("ended in revolution 15") and push["status"].endswith("surfaces touch"), push["status"])


def separatrix(h):
    """The unstable cycle parts motions that come to rest from those that end in contact: from either side of it a rotor that is
    let go leaves its amplitude, by little at first."""
    speed, revolutions = 2900, 100
    let_go = "".join(f", {{motion: {{name: '{offset}', speed: {speed} rad/s, start: {{offset: [{offset}, 0]}}, discard: 0, samples: 32,"
                     f" revolutions: {revolutions}, orbit: {revolutions}, tolerance: 1e-6, exponents: 0}}}}" for offset in (0.66, 0.69))
    s = h.run(h.source / DECKS / "whirl.yaml", "separatrix",
              [f"studies.1.cycle_branch.at=[{speed} rad/s]", "studies.1.cycle_branch.range={from: 2880 rad/s, to: 3100 rad/s}",
               f"studies+=[{let_go[2:]}]"], launcher=[], code=None)
    cycle = {axis: value(s["whirl"], f"at.{speed}.peak_to_peak.A.{axis}") for axis in "xy"}
    with h5py.File(h.work / "separatrix" / "results.h5") as f:
        for offset, inside in ((0.66, True), (0.69, False)):
            for axis in "xy":
                track = f[f"studies/{offset}/orbit/{axis}"][()].reshape(-1)
                # In pieces of twenty revolutions, behind what dies out at once.
                sizes = [np.ptp(piece) for piece in track.reshape(-1, 20 * 32)[1:]]
                h.close(f"{offset} clearances: {axis} at first over the cycle's", sizes[0] / cycle[axis], 1, 0.05)
                h.true("    inside and ever smaller" if inside else "    outside and ever larger",
                       (sizes[0] < cycle[axis]) == inside and (np.diff(sizes) < 0).all() == inside and (np.diff(sizes) > 0).all() != inside,
                       " ".join(f"{1e6 * size:.2f}" for size in (cycle[axis], *sizes)))


def resume(h):
    """Killed and resumed to the bit: factors that implicit schemes and deviations keep are forgotten at each end of a revolution."""
    options = "speed: 2700 rad/s, start: {offset: [0.3, 0]}, samples: 16"
    noise = "forces: {f: {bearing: A, direction: x, signal: random, rms: 3 N, cutoff: 2 kHz, seed: 5}}"
    for name, more in (("exponents", "discard: 4, revolutions: 24, exponents: 2, tolerance: 1e-6"),
                       ("newmark", "discard: 4, revolutions: 24, exponents: 0, integrator: {type: newmark, steps: 512}"),
                       ("noise", "discard: 0, revolutions: 24, exponents: 2, tolerance: 1e-5, " + noise)):
        deck = h.source / DECKS / "whirl.yaml"
        overrides = ["bearings.A.film.cells=[16, 6]", "layout.refined_states=1", f"studies=[{{motion: {{name: m, {options}, {more}}}}}]"]
        h.run(deck, name, overrides, launcher=[])
        out = h.work / f"{name} killed"
        h.kill_at_checkpoint(deck, out, overrides, after=12)
        h.run(deck, out.name, overrides, flags=["--resume"], launcher=[])
        for what, difference, within in same_results(h.work / name, out, 0):
            h.close(f"{name}: {what}", difference, 0, within)


def capacity(h):
    """Bearing A at 0.3 MPa and a shaft that hardly turns: all studies say what the film carries."""
    deck = h.source / DECKS / "gas_bearing.yaml"
    weak = ["bearings.A.film.orifices.1.supply=0.3 MPa", "bearings.A.film.cells=[48, 16]",
            "studies=[{gas_bearing: {name: g, speeds: [1 rad/s], eccentricities: [0.5], load: 49.05 N}}, "
            "{dynamic_coefficients: {name: d, load: 49.05 N, speeds: [1 rad/s]}}, {static: {name: s, speed: 1 rad/s}}]"]
    s = h.run(deck, "weak", weak, launcher=[], code=3)
    most = value(s["g"], "capacity.load")
    h.close("largest load [N]", most, 30.6, 0.3)
    for k in "gds":
        h.true(f"{s[k]['kind'] if 'kind' in s[k] else k}: no equilibrium, with the capacity", "no equilibrium" in s[k]["status"] and f"at most {most:.6g} N" in s[k]["status"], s[k]["status"])
    h.close("    the same", value(s["d"], "capacity.load"), most, 1e-9 * most)
    # A fast shaft carries its load: the capacity of the slow one has the bar that gas_bearing gives it.
    both = [*weak[:2], "studies=[{gas_bearing: {name: g, speeds: [1 rad/s], eccentricities: [0.5], load: 35 N}}, "
            "{dynamic_coefficients: {name: d, load: 35 N, speeds: [1 rad/s, 8000 rad/s]}}]"]
    s = h.run(deck, "one of two", both, launcher=[], code=None, bars=True)
    bar = [s[k]["values"]["capacity.load"].get("uncertainty") for k in "gd"]
    h.true("    with the same bar", None not in bar and abs(bar[0] - bar[1]) <= 1e-9 * bar[0], str(bar))


def refused(h):
    """What decks may not ask for."""
    deck = h.source / DECKS / "bearing_b.yaml"
    def run(what, said, *changes):
        done = subprocess.run(h.command(deck, h.work / what.replace(" ", "_"), changes, (), []), capture_output=True, text=True)
        h.true(what, done.returncode == 2 and said in done.stderr, done.stderr.strip()[:200])
    study = "studies=[{dynamic_coefficients: {name: c, load: 49.05 N, speeds: [2000 rad/s]%s}}]"
    run("enforced without amplitudes", "give 'amplitudes: [0.05]'", study % ", method: enforced")
    run("amplitudes by perturbation", "add 'method: enforced'", study % ", amplitudes: [0.1]")
    run("an amplitude as large as the clearance", "amplitudes", study % ", method: enforced, amplitudes: [1]")
    done = subprocess.run(h.command(h.train / "run_up.yaml", h.work / "train", ["studies.2.run_up.start={from: centre}"], (), []), capture_output=True, text=True)
    h.true("a train from the centre", done.returncode == 2 and "rigid rotor on one bearing" in done.stderr, done.stderr.strip()[:200])
    # Through the wall: the rest of the study is there.
    s = h.run(deck, "wall", ["bearings.A.film.cells=[24, 8]", study % ", method: enforced, amplitudes: [0.05, 0.9]"], launcher=[])["c"]
    h.true("    and a warning says why", any("along y with amplitude 0.9" in w and "touch" in w for w in s.get("warnings", [])), str(s.get("warnings")))
    tail = [value(s, f"speed.2000.ratio.1.amplitude.{a}.tail.y") for a in (0.05, 0.9)]
    h.true("    the other is resolved in time", 0 <= tail[0] <= 1e-7 and tail[1] is None, str(tail))
    h.true("an amplitude through the wall has no values", value(s, "speed.2000.ratio.1.amplitude.0.9.K.yy") is None and value(s, "speed.2000.ratio.1.amplitude.0.05.K.yy") > 0)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"enforced": enforced, "pressures": pressures, "path": path, "whirl": whirl, "separatrix": separatrix, "resume": resume, "capacity": capacity,
     "refused": refused}[sys.argv[3]](harness)
    harness.finish()
