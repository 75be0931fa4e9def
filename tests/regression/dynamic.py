#!/usr/bin/env python3
"""Runs decks of inputs/aerostatic and compares stiffness and damping with those computed independently.

dynamic.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import subprocess
import sys

import numpy as np
from harness import Harness, value

AXES = ("x", "y", "slope_x", "slope_y")
LOAD = "studies=[{dynamic_coefficients: {name: c, load: 49.05 N, speeds: [2000 rad/s]%s}}]"


# The reference calls the damping B.
NAMES = {"K": "K", "B": "C"}


def matrix(study, letter, ratio, ports):
    """K or C of a study at 2000 rad/s."""
    pair = lambda a, b: a + ("." if "slope" in a + b else "") + b  # noqa: E731
    return np.array([[value(study, f"speed.2000.ratio.{ratio:g}.{NAMES[letter]}.{pair(a, b)}") for b in AXES[:ports]] for a in AXES[:ports]])


def bars(study, letter, ratio, ports):
    pair = lambda a, b: a + ("." if "slope" in a + b else "") + b  # noqa: E731
    return np.array([[study["values"][f"speed.2000.ratio.{ratio:g}.{NAMES[letter]}.{pair(a, b)}"]["uncertainty"] for b in AXES[:ports]]
                     for a in AXES[:ports]])


def turned(m):
    """From the axes of the reference: the first is y, the second -x; shifts and rotations apart."""
    m = np.array(m)
    turn = np.zeros((4, 4))
    turn[0, 1], turn[1, 0], turn[2, 2], turn[3, 3] = -1, 1, 1, 1
    return turn @ m @ turn.T


def coefficients(h):
    reference = json.loads((h.source / "tests/reference/aerostatic/bearing_b.json").read_text())
    deck = h.source / "inputs/aerostatic/bearing_b.yaml"
    found = h.run(deck, "whole", launcher=[])
    study = found["four by four"]
    same = next(r for r in reference["synchronous"] if r["cells"] == [96, 32])
    finest = max(reference["synchronous"], key=lambda r: r["cells"][0])
    h.close("y [um]", 1e6 * value(study, "speed.2000.y"), same["place_um"][0], 1e-4)
    h.close("x [um]", 1e6 * value(study, "speed.2000.x"), -same["place_um"][1], 1e-4)
    h.close("y [um], against the finest", 1e6 * value(study, "speed.2000.y"), finest["place_um"][0],
            1e6 * study["values"]["speed.2000.y"]["uncertainty"])
    for letter in "KB":
        m, wanted, error = matrix(study, letter, 1, 4), turned(same[letter]), bars(study, letter, 1, 4)
        best = turned(finest[letter])
        for name, block in (("translation", np.s_[:2, :2]), ("tilt", np.s_[2:, 2:])):
            size = np.abs(wanted[block]).max()
            for (i, j), w in np.ndenumerate(wanted[block]):
                h.close(f"{letter} {name} {i}{j}, same mesh", m[block][i, j], w, 1e-3 * size)
                h.close(f"{letter} {name} {i}{j}, finest, within its bar", m[block][i, j], best[block][i, j], error[block][i, j] + 1e-3 * size)
            if name == "translation":
                h.true(f"{letter} {name}: within 0.5 % of the finest", np.abs(m[block] - best[block]).max() < 5e-3 * size)
        # The film is its own mirror image in the middle plane.
        mixed = max(np.abs(m[:2, 2:]).max(), np.abs(m[2:, :2]).max())
        h.close(f"{letter}: translation by tilt over what could be", mixed / np.sqrt(np.abs(m[:2, :2]).max() * np.abs(m[2:, 2:]).max()), 0, 1e-9)
    # Damping falls and stiffness rises with the frequency, as in the reference on a finer mesh.
    ratios = [r["ratio"] for r in reference["over_frequency"]]
    s = h.run(deck, "frequencies", [LOAD % f", frequencies: [{', '.join(map(str, ratios))}]"], launcher=[])["c"]
    for r in reference["over_frequency"]:
        for letter in "KB":
            m, wanted = matrix(s, letter, r["ratio"], 2), turned(r[letter])[:2, :2]
            size = np.abs(wanted).max()
            h.close(f"{letter} at {r['ratio']:g} of the speed: largest difference", np.abs(m - wanted).max() / size, 0, 5e-3)
    damping = [matrix(s, "B", r, 2)[1, 1] for r in sorted(ratios)]
    h.true("damping falls with the frequency", all(a > b for a, b in zip(damping, damping[1:])), f"{damping[0]:.0f} to {damping[-1]:.0f} N s/m")
    over = found["over speed"]
    h.close("K.yy as over speeds", value(over, "speed.2000.ratio.1.K.yy"), value(study, "speed.2000.ratio.1.K.yy"), 10)


def pressures(h):
    """At the threshold a rigid rotor of 5 kg whirls freely in the film's stiffness and damping: m w^2 is an eigenvalue of K + i w B."""
    deck = h.source / "inputs/aerostatic/pressures.yaml"
    for t in json.loads((h.source / "tests/reference/aerostatic/bearing_b.json").read_text())["thresholds"]:
        if t["N"] != 96:
            continue
        name = f"{t['bearing']}, {t['ps'] / 1e6:g} MPa"
        speed, ratio = t["omega_threshold"], t["whirl_frequency"] / t["omega_threshold"]
        rings = "{count: 8, diameter: 0.2 mm, supply: %g Pa%s}"
        places = [""] if t["bearing"] == "A" else [", z: -7.5 mm", ", z: 7.5 mm"]
        s = h.run(deck, name, ["bearings.A.film.orifices=[%s]" % ", ".join(rings % (t["ps"], z) for z in places),
                  f"studies=[{{dynamic_coefficients: {{name: c, load: 49.05 N, speeds: [{speed!r} rad/s], frequencies: [{ratio!r}]}}}}]"], launcher=[])["c"]
        head = next(k for k in s["values"] if k.endswith("K.xx"))[:-4]
        k, b = ([[value(s, f"{head}{letter}.{i}{j}") for j in "xy"] for i in "xy"] for letter in "KC")
        w = t["whirl_frequency"]
        found = np.linalg.eigvals(np.array(k) + 1j * w * np.array(b))
        free = min(found, key=lambda e: abs(e - 5 * w * w))
        h.close(f"{name}: stiffness of the free whirl over m w^2", free.real / (5 * w * w), 1, 5e-3)
        h.close("    its damping, likewise", free.imag / (5 * w * w), 0, 5e-3)
        h.close("    eccentricity", next(v["value"] for n, v in s["values"].items() if n.endswith("eccentricity")), t["ecc"], 2e-3)
    # All that 0.3 MPa press on bearing A at rest is less than the load; a turning shaft carries the rest by its wedge.
    out = h.work / "slow"
    slow = ["bearings.A.film.orifices=[{count: 8, diameter: 0.2 mm, supply: 0.3 MPa}]",
            "studies=[{dynamic_coefficients: {name: c, load: 49.05 N, speeds: [1 rad/s]}}]"]
    done = subprocess.run(h.command(deck, out, slow, (), []), capture_output=True, text=True)
    status = h.studies("slow")["c"]["status"]
    h.true("bearing A, 0.3 MPa, a shaft that hardly turns: no equilibrium", done.returncode == 3 and "no equilibrium" in status, status)
    # As the deck is.
    h.true("sweep ends", len(h.run(deck, "sweep", launcher=[])["supply"]["variants"]) == 6)


ONE_RING = "bearings.A.film.orifices=[{count: 8, diameter: 0.2 mm, supply: 0.6 MPa}]"


def threshold(h, bearing, cells):
    """Where a rigid rotor of 5 kg begins to whirl at 0.6 MPa."""
    wanted = next(t for t in json.loads((h.source / "tests/reference/aerostatic/bearing_b.json").read_text())["thresholds"]
                  if (t["bearing"], t["ps"], t["N"]) == (bearing, 6e5, cells))
    speed = wanted["omega_threshold"]
    changes = [f"bearings.A.film.cells=[{cells}, {cells // 3}]",
               f"studies.*.equilibrium_branch.range={{from: {0.97 * speed} rad/s, to: {1.03 * speed} rad/s}}"]
    study = h.run(h.source / "inputs/aerostatic/threshold.yaml", "threshold", changes + ([ONE_RING] if bearing == "A" else []), launcher=[])["threshold"]
    hopf = [b for b in study["bifurcations"] if b["type"] == "hopf"]
    h.true("one Hopf point", len(hopf) == 1 and len(study["bifurcations"]) == 1)
    h.close(f"{bearing}, {cells} cells around: threshold [rad/s]", hopf[0]["value"], speed, 3e-3 * speed)
    h.close("    its whirl [rad/s]", hopf[0]["whirl_frequency_rad_s"], wanted["whirl_frequency"], 3e-3 * wanted["whirl_frequency"])
    h.true("    before which it is stable", hopf[0]["others_unstable"] == 0)


def same_everywhere(h):
    """Two ranks; a film with and without tilt; the study `static` at the same load; an oil film; a load too large."""
    deck = h.source / "inputs/aerostatic/bearing_b.yaml"
    few = "bearings.A.film.cells=[48, 16]"
    tilted = h.run(deck, "tilted", [few, LOAD % ", tilt: true"], launcher=[])["c"]
    both = "studies=[{dynamic_coefficients: {name: c, load: 49.05 N, speeds: [2000 rad/s]}}, {static: {name: s, speed: 2000 rad/s}}]"
    plain = h.run(deck, "plain", [few, both], launcher=[*h.launcher, "-n", "2"])
    for pair in ("xx", "xy", "yx", "yy"):
        k = value(tilted, f"speed.2000.ratio.1.K.{pair}")
        h.close(f"K.{pair}, two ranks and no tilt", value(plain["c"], f"speed.2000.ratio.1.K.{pair}"), k, 1e-8 * 1.2e7)
        h.close(f"K.{pair}, static", value(plain["s"], f"bearing.A.K.{pair}"), k, 1e-5 * 1.2e7)
        b = value(tilted, f"speed.2000.ratio.1.C.{pair}")
        h.close(f"C.{pair}, static", value(plain["s"], f"bearing.A.C.{pair}"), b, 1e-5 * 9e2)
    # An oil film has no frequency: its coefficients are those of `static` at any.
    oil = h.run(h.source / "inputs/pump/pump.yaml", "oil", ["studies=[{dynamic_coefficients: {name: c, bearing: dry, eccentricity: 0.5, "
                "attitude: -60 deg, speeds: [2950 rpm], frequencies: [0.1, 3], tilt: false}}]"], launcher=[])["c"]
    for letter in "KC":
        one, three = (value(oil, f"speed.2950.ratio.{r}.{letter}.yy") for r in ("0.1", "3"))
        h.close(f"oil: {letter}.yy at two frequencies", three / one, 1, 1e-9)
    load = "studies=[{dynamic_coefficients: {name: c, load: 5000 N, speeds: [2000 rad/s]}}]"
    out = h.work / "heavy"
    done = subprocess.run(h.command(deck, out, [few, load], (), []), capture_output=True, text=True)
    status = h.studies("heavy")["c"]["status"]
    h.true("a load too large is no equilibrium, with the capacity", done.returncode == 3 and "no equilibrium" in status and "carries" in status, status)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    if ":" in sys.argv[3]:
        where, around = sys.argv[3].split(":")
        threshold(harness, where, int(around))
    else:
        {"coefficients": coefficients, "same": same_everywhere, "pressures": pressures}[sys.argv[3]](harness)
    harness.finish()
