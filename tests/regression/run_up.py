#!/usr/bin/env python3
"""Run-up through a critical speed: a Jeffcott rotor against an integration of its own, and what must not depend on how it runs.

run_up.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import cmath
import math
import sys

import h5py
import numpy as np

from compare import same_results
from harness import Harness, value

MASS, STIFFNESS, DAMPING, ECCENTRICITY = 1.0, 1e4, 10.0, 1e-5  # critical speed 100 rad/s, 5 % of critical damping
JEFFCOTT = f"""title: Jeffcott rotor
rotor: {{type: rigid, mass: {MASS} kg}}
gravity: 0 m/s^2
bearings:
  spring:
    node: 1
    film: {{type: linear, stiffness: [{STIFFNESS} N/m, 0 N/m, 0 N/m, {STIFFNESS} N/m], damping: [{DAMPING} N s/m, 0 N s/m, 0 N s/m, {DAMPING} N s/m]}}
unbalance:
  a: {{planes: [{{node: 1, eccentricity: {ECCENTRICITY} m, phase: 40 deg}}]}}
studies:
"""


def write(h, name, studies):
    path = h.work / f"{name}.yaml"
    path.write_text(JEFFCOTT + studies)
    return path


def study(name, acceleration, start=20, end=250):
    return (f"  - run_up: {{name: {name}, unbalance: [a], range: {{from: {start} rad/s, to: {end} rad/s}}, nodes: [1],"
            f" acceleration: {acceleration} rad/s^2, tolerance: 1e-9}}\n")


def jeffcott(acceleration, start, angles):
    """z at some angles of m z'' + d z' + k z = -m e d^2/dt^2 exp(i (angle + 40 deg)), from rest.

    Classical Runge-Kutta with eight steps from one wanted angle to the next."""
    phase = math.radians(40)
    omega_0, decay = math.sqrt(STIFFNESS / MASS), DAMPING / MASS

    def rate(t, z, v):
        angle, speed = start * t + acceleration * t * t / 2 + phase, start + acceleration * t
        force = ECCENTRICITY * (speed**2 - 1j * acceleration) * cmath.exp(1j * angle)
        return v, force - decay * v - omega_0**2 * z

    y, t, out = [0j, 0j], 0.0, []
    for angle in angles:
        end = 2 * angle / (start + math.copysign(math.sqrt(start**2 + 2 * acceleration * angle), start))
        for left in range(8, 0, -1):
            dt = (end - t) / left
            k1 = rate(t, *y)
            k2 = rate(t + dt / 2, *[a + dt / 2 * b for a, b in zip(y, k1)])
            k3 = rate(t + dt / 2, *[a + dt / 2 * b for a, b in zip(y, k2)])
            k4 = rate(t + dt, *[a + dt * b for a, b in zip(y, k3)])
            y = [a + dt / 6 * (p + 2 * q + 2 * r + w) for a, p, q, r, w in zip(y, k1, k2, k3, k4)]
            t += dt
        out.append(y[0])
    return np.array(out)


def mean_positions(z):
    """Mean of nine revolutions about each, by Hann's window; within the record near its ends. z [revolution][sample]."""
    means = []
    for k in range(len(z)):
        begin = min(max(k - 4, 0), max(len(z) - 9, 0))
        window = z[begin:begin + 9].ravel()
        weights = 1 - np.cos(2 * math.pi * (np.arange(len(window)) + 0.5) / len(window))
        means.append((weights * window).sum() / weights.sum())
    return np.array(means)


def exact(h):
    """Every revolution of run-ups and a coast-down; the peak lower and later, the faster."""
    runs = {"slow": (20, 20, 250), "fast": (200, 20, 250), "down": (-60, 250, 20)}
    run = h.run(write(h, "exact", "".join(study(n, abs(a), s, e) for n, (a, s, e) in runs.items())), "exact")
    with h5py.File(h.work / "exact/results.h5") as results:
        for name, (acceleration, start, _) in runs.items():
            table = results[f"studies/{name}/run_up"]
            n = len(table["revolution"])
            z = jeffcott(acceleration, start, 2 * math.pi * np.arange(1, 64 * n + 1) / 64).reshape(n, 64)
            amplitude = np.abs(z - mean_positions(z)[:, None]).max(axis=1)
            peak = amplitude.max()
            h.close(f"{name}: amplitude in every revolution, worst of {n}, per peak",
                    np.abs(table["amplitude"][:, 0] - amplitude).max() / peak, 0, 1e-6)
            # Without weight the mean position is the axis: the mean of one revolution was 3 % (slow) and 14 % (fast) off.
            h.close(f"{name}: the peak is the largest distance from the axis", peak, np.abs(z).max(), 1e-3 * peak)
            h.close(f"{name}: largest x in every revolution", np.abs(table["x_max"][:, 0] - z.real.max(axis=1)).max() / peak,
                    0, 1e-6)
            h.close(f"{name}: smallest y in every revolution", np.abs(table["y_min"][:, 0] - z.imag.min(axis=1)).max() / peak,
                    0, 1e-6)
            h.close(f"{name}: node 1 is the journal", np.abs(table["node_amplitude"][:] - table["amplitude"][:]).max(), 0, 1e-18)
            speed = np.sqrt(start**2 + 4 * math.pi * acceleration * (np.arange(n) + 0.5))
            h.close(f"{name}: speeds [rad/s]", np.abs(table["speed"][:] - speed).max(), 0, 1e-9)
            h.close(f"{name}: peak in the summary", value(run[name], "bearing.spring.peak.amplitude"), peak, 1e-6 * peak)
    steady = ECCENTRICITY / 0.1  # e/(2 zeta), at the critical speed itself
    height = {n: value(run[n], "node.1.peak.amplitude") for n in runs}
    place = {n: value(run[n], "node.1.peak.speed") for n in runs}
    h.true("lower, the faster", steady > height["slow"] > height["down"] > height["fast"], str(height))
    h.true("later, the faster: above the critical speed on the way up", 100 < place["slow"] < place["fast"], str(place))
    h.true("and below it on the way down", place["down"] < 100)
    # Where the speed changes slowly the amplitude hardly lags behind the steady one.
    h.close("slow run-up: peak per steady one", height["slow"] / steady, 1, 0.05)


def travel(table, column, revolutions):
    """Largest minus smallest x over some of the revolutions."""
    return table["x_max"][revolutions, column].max() - table["x_min"][revolutions, column].min()


def rigid(h):
    """The rigid rotor's deck: at its ends the motion is the cycle of that speed, simple at 320 rad/s, of twice the period at
    640 rad/s; in between it is found where integrations with tolerances of 1e-6 and 1e-8 put it, within three revolutions. Slowly
    it leaves the unstable cycle by what disturbs it: with steps alike in all revolutions, which disturb nothing, at 495.4 rad/s;
    with others earlier, the less so the smaller their errors are. The passages are of distances from the mean of a whole period: the way
    down, with 1e-6 and with 1e-8, at 384.67 rad/s."""
    path = h.source / "inputs/rigid_rotor/run_up.yaml"
    h.run(path, "deck")
    cycles = h.work / "cycles.yaml"
    cycles.write_text(f"base: {path}\nstudies:\n"
                      "  - cycle_branch: {name: a, unbalance: [a], range: {from: 320 rad/s, to: 660 rad/s},"
                      " at: [320 rad/s, 640 rad/s], step: {initial: 4 rad/s, min: 0.0001 rad/s, max: 64 rad/s},\n"
                      "      intervals: 40, degree: 4, points: gauss, mesh_tolerance: 1e-7, adapt_every: 2, follow_flips: true,"
                      " flips: [1], max_points: 60}\n")
    run = h.run(cycles, "cycles")
    simple = value(run["a"], "at.320.peak_to_peak.left.x")
    doubled = value(run["a flip 1"], "at.640.peak_to_peak.left.x")
    h.true("the doubled cycle is ten times as large", doubled > 10 * simple, f"{doubled}, {simple}")
    with h5py.File(h.work / "deck/results.h5") as f:
        for name, passage, within in (("slow", 495.4, 2), ("fast", 540.5, 15), ("down", 384.7, 2)):
            t = f[f"studies/{name}/run_up"]
            table = {k: t[k][()] for k in ("speed", "amplitude", "x_max", "x_min")}
            up = name != "down"
            # Each way the shaft starts on a cycle and is small then; 32 samples miss a peak by up to (pi/32)^2/2.
            h.close(f"{name}: travel at 320 rad/s [m]", travel(table, 0, [0 if up else -1]), simple, 0.01 * simple)
            if up:
                h.close(f"{name}: travel at 640 rad/s [m]", travel(table, 0, [-2, -1]), doubled, 0.015 * doubled)
            large = np.flatnonzero(table["amplitude"][:, 0] > 10e-6)
            passed = table["speed"][large[0 if up else -1]]
            if name == "slow":
                h.true("slow: passes 10 um late, no later than without disturbance", 440 < passed < passage + within, f"{passed:.1f}")
                loose = passed
            else:
                h.close(f"{name}: passes 10 um at [rad/s]", passed, passage, within)
        down = f["studies/down/run_up"]
        short = [f"studies.{k}.run_up.range={{from: 330 rad/s, to: {to} rad/s}}" for k, to in ((2, 340), (3, 320))]
        h.run(path, "tight", [*short, "studies.1.run_up.tolerance=1e-9"])
        with h5py.File(h.work / "tight/results.h5") as g:
            t = g["studies/slow/run_up"]
            tight = t["speed"][np.flatnonzero(t["amplitude"][:, 0] > 10e-6)[0]]
        h.true("slow: no earlier with smaller errors of steps", loose - 2 < tight < 495.4 + 2, f"{loose:.1f}, {tight:.1f}")
        h.true("down: starts on the small cycle, which is unstable there", down["amplitude"][0, 0] < 3e-6)


def train(h):
    """The train's deck, its fast run: the generator's peak comes later and lower than at constant speed. Place and height are
    those of integrations with tolerances of 1e-5 and 1e-6 (apart by 1e-6), within one revolution; behind the resonance the motion
    is the cycle of that speed."""
    path = h.train / "run_up.yaml"
    fast = h.work / "fast.yaml"
    fast.write_text(f"base: {path}\nstudies:\n"
                    "  - run_up: {name: fast, unbalance: [gen_pair], range: {from: 2200 rpm, to: 3200 rpm}, duration: 2 s,"
                    " start: {from: cycle}, nodes: [120], samples: 32, tolerance: 1e-5}\n"
                    "  - cycle_branch: {name: cycles, unbalance: [gen_pair], range: {from: 3190 rpm, to: 3200 rpm}, at: [3195.3 rpm],"
                    " intervals: 60, degree: 2}\n")
    run = h.run(fast, "fast")
    steady = h.run(path, "steady", ["studies.2.run_up.range={from: 3100 rpm, to: 3200 rpm}", "studies.2.run_up.duration=0.1 s",
                                    "studies.3.run_up.range={from: 3100 rpm, to: 3200 rpm}", "studies.3.run_up.duration=0.1 s"])["steady"]
    height, place = (value(run["fast"], f"node.120.peak.{k}") for k in ("amplitude", "speed"))
    h.close("peak of node 120 [m]", height, 80.215e-6, 5e-8)
    h.close("its speed [rpm]", place, 2773.1, 12)
    h.true("lower than at constant speed", height < 0.97 * value(steady, "peak.1.semi_major"), value(steady, "peak.1.semi_major"))
    h.true("later by five revolutions or more", place > value(steady, "peak.1.speed") + 55, value(steady, "peak.1.speed"))
    with h5py.File(h.work / "fast/results.h5") as f:
        t = f["studies/fast/run_up"]
        table = {k: t[k][()] for k in ("speed", "x_max", "x_min")}
        travels = np.maximum(t["node_x"][:, 0], t["node_y"][:, 0]).max()
        h.true("the peak is half the travel on an ellipse that leans a little", travels < height < 1.02 * travels, f"{travels}, {height}")
    h.close("speed of the last revolution [rpm]", table["speed"][-1], 3195.3, 0.1)
    for k in range(5):
        wanted = value(run["cycles"], f"at.3195.3.peak_to_peak.B{k + 1}.x")
        h.close(f"B{k + 1}: travel there [m]", travel(table, k, [-1]), wanted, 0.05 * wanted)


def follows(h):
    """A slow run-up of the train at G2.5 keeps to the cycles where they are stable, and leaves them where the branch has lost its
    stability to a flip. Each amplitude of seven revolutions is held against the cycle of the middle one."""
    stable, lost = (1200, 1600, 2000, 2400, 2600, 2700, 2800, 3000, 3400, 3800, 4600, 4900), 4200
    path = h.work / "slow.yaml"
    path.write_text(f"""base: {h.train / 'motions.yaml'}
studies:
  - run_up: {{name: slow, unbalance: [gen_pair], range: {{from: 1000 rpm, to: 5000 rpm}}, duration: 200 s, start: {{from: cycle}},
      nodes: [120], samples: 32, tolerance: 1e-5}}
  - cycle_branch: {{name: cycles, unbalance: [gen_pair], range: {{from: 1000 rpm, to: 5000 rpm}}, intervals: 60, degree: 2,
      step: {{initial: 20 rpm, min: 0.01 rpm, max: 100 rpm}}, at: [{", ".join(f"{n} rpm" for n in sorted((*stable, lost)))}]}}
""")
    cycles = h.run(path, "slow", launcher=[])["cycles"]
    with h5py.File(h.work / "slow/results.h5") as f:
        t = f["studies/slow/run_up"]
        table = {k: t[k][()] for k in ("speed", "x_max", "x_min", "y_max", "y_min")}

    def off(speed):
        middle = int(abs(table["speed"] - speed).argmin())
        rows = slice(middle - 3, middle + 4)
        return max(abs((table[f"{axis}_max"] - table[f"{axis}_min"])[rows, k].mean() /
                       value(cycles, f"at.{speed}.peak_to_peak.B{k + 1}.{axis}") - 1) for k in range(5) for axis in "xy")

    for speed in stable:
        h.true(f"{speed} rpm: the cycle is stable", value(cycles, f"at.{speed}.multiplier.modulus") < 1)
        # The curve bends within the revolutions of a resonance.
        h.close("    largest difference of ten amplitudes", off(speed), 0, 0.03 if 2500 < speed < 2750 else 0.02)
    h.true(f"{lost} rpm: the cycle is unstable", value(cycles, f"at.{lost}.multiplier.modulus") > 1.01)
    h.true("    and has been left", off(lost) > 0.5, f"{off(lost):.2f}")


def resume(h):
    """Killed and resumed it goes on to the bit, also on two ranks, which both hold the whole of so small a rotor."""
    path = h.source / "inputs/rigid_rotor/run_up.yaml"
    short = ["studies=[{run_up: {name: up, unbalance: [a], range: {from: 160 rad/s, to: 800 rad/s}, acceleration: 400 rad/s^2}}]"]
    h.run(path, "whole", short, launcher=[])
    out = h.work / "killed"
    h.kill_at_checkpoint(path, out, short)
    h.run(path, "killed", short, ["--resume"], launcher=[*h.launcher, "-n", "2"])
    for what, difference, within in same_results(h.work / "whole", out, 1e-14):
        h.close(f"resumed: {what}", difference, 0, within)


LONG_SHAFT = """title: A shaft of so many freedoms that the ranks divide it
rotor: {{segments: segments.csv, material: {{density: 7850 kg/m^3, poisson: 0.3, modulus: 210 GPa}}, stiffness_damping: 1e-5 s}}
lubricants: {{oil: {{viscosity: 10 mPa s, density: 850 kg/m^3}}}}
bearings:
  A: {{node: 500, geometry: &bore {{type: cylindrical, radius: 100 mm, length: 100 mm, clearance: 200 um}}, film: {{type: short}}, lubricant: oil}}
  B: {{node: 4501, geometry: *bore, film: {{type: short}}, lubricant: oil}}
unbalance:
  a: {{planes: [{{node: 2500, amount: 2 g m}}]}}
studies:
  - run_up: {{name: up, unbalance: [a], range: {{from: 100 rad/s, to: {end} rad/s}}, acceleration: 160 rad/s^2, nodes: [1, 2500, 5001], samples: 8, tolerance: 1e-3}}
"""


def ranks(h):
    """20 004 freedoms, which two ranks divide: one revolution gives the same as on one."""
    (h.work / "segments.csv").write_text("length [m],outer_mass_diameter [m]\n" + "0.002,0.2\n" * 5000)
    path = h.work / "long.yaml"
    path.write_text(LONG_SHAFT.format(end=110))
    for n in (1, 2):
        h.run(path, f"on_{n}", launcher=[*h.launcher, "-n", str(n)])
    with h5py.File(h.work / "on_2/results.h5") as f:
        moved = f["studies/up/run_up/node_amplitude"][0]
    h.true("the shaft moves, its ends and its middle differently", moved.min() > 1e-7 and moved[1] > 1.01 * moved[0], str(moved))
    # The ranks take other steps than one rank does: what differs is the error of the steps, a thousandth of the clearance.
    with h5py.File(h.work / "on_1/results.h5") as one, h5py.File(h.work / "on_2/results.h5") as two:
        for what in ("amplitude", "x_max", "x_min", "y_max", "y_min", "node_amplitude", "node_x", "node_y"):
            a, b = (f[f"studies/up/run_up/{what}"][()] for f in (one, two))
            h.close(f"two ranks: {what} [m]", abs(a - b).max(), 0, 1e-3 * 200e-6)


def hysteresis(h):
    """The bent resonance of a stiffening liner: between the folds (540 and 544 rad/s) large on the way up, small on the
    way down; the same on both sides of them."""
    h.run((h.source / "inputs/compliant_rotor/figure_5_13_sweep.yaml").resolve(), "sweep")
    with h5py.File(h.work / "sweep/results.h5") as f:
        sweep = {name: (f[f"studies/{name}/run_up/speed"][()], f[f"studies/{name}/run_up/amplitude"][:, 0])
                 for name in ("up", "down")}

    def amplitude(name, speed):
        at, values = sweep[name]
        return values[np.argmin(np.abs(at - speed))]
    for speed in (542, 544):
        h.true(f"at {speed} rad/s large on the way up, small on the way down",
               amplitude("up", speed) > 1.4 * amplitude("down", speed), f"{amplitude('up', speed)}, {amplitude('down', speed)}")
    for speed, within in ((528, 0.005), (552, 0.05)):
        h.close(f"the same at {speed} rad/s", amplitude("up", speed), amplitude("down", speed), within * amplitude("down", speed))


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"exact": exact, "rigid": rigid, "train": train, "resume": resume, "ranks": ranks, "hysteresis": hysteresis,
     "follows": follows}[sys.argv[3]](harness)
    harness.finish()
