#!/usr/bin/env python3
"""Run-up through a critical speed: a Jeffcott rotor against an integration of its own, and what must not depend on how it runs.

run_up.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import cmath
import math
import os
import signal
import subprocess
import sys
import time

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


def exact(h):
    """Every revolution of run-ups and a coast-down; the peak lower and later, the faster."""
    runs = {"slow": (20, 20, 250), "fast": (200, 20, 250), "down": (-60, 250, 20)}
    run = h.run(write(h, "exact", "".join(study(n, abs(a), s, e) for n, (a, s, e) in runs.items())), "exact")
    with h5py.File(h.work / "exact/results.h5") as results:
        for name, (acceleration, start, _) in runs.items():
            table = results[f"studies/{name}/run_up"]
            n = len(table["revolution"])
            z = jeffcott(acceleration, start, 2 * math.pi * np.arange(1, 64 * n + 1) / 64).reshape(n, 64)
            amplitude = np.abs(z - z.mean(axis=1, keepdims=True)).max(axis=1)
            peak = amplitude.max()
            h.close(f"{name}: amplitude in every revolution, worst of {n}, per peak",
                    np.abs(table["amplitude"][:, 0] - amplitude).max() / peak, 0, 1e-6)
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
    h.close("slow run-up: peak per steady one", height["slow"] / steady, 1, 0.03)


def resume(h):
    """Killed and resumed it goes on to the bit; on two ranks it is the same."""
    path = h.source / "inputs/rigid_rotor/run_up.yaml"
    short = ["studies=[{run_up: {name: up, unbalance: [a], range: {from: 160 rad/s, to: 800 rad/s}, acceleration: 400 rad/s^2}}]"]
    h.run(path, "whole", short, launcher=[])
    h.run(path, "two", short, launcher=[*h.launcher, "-n", "2"])
    for what, difference, within in same_results(h.work / "whole", h.work / "two"):
        h.close(f"two ranks: {what}", difference, 0, within)
    out = h.work / "killed"
    process = subprocess.Popen(h.command(path, out, short, launcher=[]), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    limit = time.monotonic() + 200
    while not list(out.glob("*.checkpoint.h5")) and process.poll() is None and time.monotonic() < limit:
        time.sleep(0.01)
    h.true("a checkpoint before the end", process.poll() is None)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    h.run(path, "killed", short, ["--resume"], launcher=[])
    for what, difference, within in same_results(h.work / "whole", out, 1e-14):
        h.close(f"resumed: {what}", difference, 0, within)


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
    {"exact": exact, "resume": resume, "hysteresis": hysteresis}[sys.argv[3]](harness)
    harness.finish()
