#!/usr/bin/env python3
"""Runs decks whose films are meshes, and single bearings, against limits of fine meshes, closed forms and published tables.

expected.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]

Where no independent value exists the limits are this program's own, from runs on meshes doubled up to three times, Richardson's
with a safety factor of 1.25; so a test on coarse meshes must come from its side to the limit that finer ones found, with the
order that was observed, and within the error that the run states for itself.
"""
import math
import sys

import h5py
import numpy as np

from harness import Harness, value

SPEED = 160.0  # rad/s: one unit of Omega* of the decks with F0* = 1
# (Omega*, uncertainty). Hopf point of finite.yaml: 30 x 6 to 120 x 24 cells, central differences; third-order ones come from
# below, 2.4978 on 60 x 12. Cycles of finite_curve.yaml: 50 x 10 to 400 x 80 cells, steps in time 5e-5 and 1e-4.
FINITE_HOPF = 2.49964, 2e-4
FINITE_FLIPS = (2.05439, 1.5e-4), (4.3339, 7e-4)
FINITE_FOLD = 6.5085, 1.4e-3
# short.yaml and long.yaml: Hopf points of an independent computation without a mesh; cycles on 60 to 480 cells.
SHORT = {"balanced": [(2.732563, 0)], "unbalanced": [(4.28239, 6e-4), (5.97699, 1e-4)]}
LONG = {"balanced": [(0.498391, 0)], "unbalanced": [(0.500669, 2e-5)]}


def deck(h, name):
    return h.source / "inputs" / name


def within_stated(h, what, b, limit, scale=SPEED):
    """A located bifurcation lies within its own stated uncertainty of the limit, which says something: at most 3 %."""
    (wanted, known), stated = limit, b["uncertainty"]
    h.true(f"{what}: states an uncertainty", stated is not None and 0 < stated < 0.03 * b["value"], str(stated))
    h.close(f"{what}, Omega*", b["value"] / scale, wanted, (stated or 0) / scale + known)


def finite(h):
    """Hopf point: both meshes by their own word, together by extrapolation."""
    found = []
    for cells in ([30, 6], [60, 12]):
        s = h.run(deck(h, "compliant_rotor/finite.yaml"), f"cells_{cells[0]}", [f"bearings.half.film.cells={cells}"])["balanced"]
        points = [b for b in s["bifurcations"] if b["type"] == "hopf"]
        h.true(f"{cells}: one Hopf point", len(points) == 1 and len(s["bifurcations"]) == 1, s["status"])
        within_stated(h, f"Hopf point on {cells} cells", points[0], FINITE_HOPF)
        found.append(points[0]["value"] / SPEED)
    coarse, fine = (x - FINITE_HOPF[0] for x in found)
    h.close("order of the error", math.log2(coarse / fine), 2, 0.25)
    h.close("limit of both, Omega*", fine * 4 / 3 - coarse / 3 + FINITE_HOPF[0], *FINITE_HOPF)


def converged(h, what, file, study, bifurcation, limit, orders):
    """A bifurcation on the deck's mesh and on the doubled one: the error falls with the order, the stated limit holds."""
    with h5py.File(file) as f:
        table = f[f"studies/{study}/convergence"]
        mine = table["bifurcation"][()] == bifurcation
        coarse, fine = table["parameter"][mine] / SPEED
        stated = f[f"studies/{study}/bifurcations/uncertainty"][bifurcation - 1] / SPEED
        got = f[f"studies/{study}/bifurcations/parameter"][bifurcation - 1] / SPEED
    low, high = orders
    order = math.log2(abs(coarse - limit[0]) / abs(fine - limit[0]))
    h.true(f"{what}: order of the error {order:.2f} is {low} to {high}", low < order < high, f"{coarse:.6f}, {fine:.6f}")
    h.close(f"{what}: the limit of two meshes, Omega*", got, limit[0], limit[1] + stated)
    h.true(f"{what}: at most 2 % is left open", 0 < stated < 0.02 * got, f"{stated:.3g}")


def finite_curve(h):
    """Cheap: the stretch around the first flip on 24 x 6 cells, once doubled."""
    branch, film = "studies.1.cycle_branch.", "bearings.half.film."
    run = h.run(deck(h, "compliant_rotor/finite_curve.yaml"), "curve",
                [film + "cells=[24, 6]", branch + "range={from: 320 rad/s, to: 340 rad/s}", branch + "follow_flips=false",
                 branch + "flips=[]", "studies.2.mesh_convergence.doublings=1",
                 "studies.3={static: {name: at rest, speed: 320 rad/s}}"])
    found = run["unbalanced"]["bifurcations"]
    h.true("one flip, nothing else", [b["type"] for b in found] == ["flip"])
    converged(h, "first flip", h.work / "curve/results.h5", "fine", 1, FINITE_FLIPS[0], (1.2, 2.5))
    limit = run["fine"]["bifurcations"][0]
    parts = sum(limit[f"uncertainty_{part}"] for part in ("film_mesh", "time_mesh", "location"))
    h.close("fine: the parts of the bar are the whole bar", parts, limit["uncertainty"], 1e-9 * limit["uncertainty"])


def whole_curve(h):
    """The deck with the coarse meshes of its comment: both flips and the fold."""
    run = h.run(deck(h, "compliant_rotor/finite_curve.yaml"), "curve",
                ["bearings.half.film.cells=[24, 6]", "studies.2.mesh_convergence.doublings=1",
                 "studies.3.mesh_convergence.doublings=1"])
    for name, kinds in (("unbalanced", ["flip", "flip"]), ("unbalanced flip 1", ["cyclic_fold"])):
        s = run[name]
        found = [b["type"] for b in s["bifurcations"]]
        h.true(f"{name}: {kinds}", found == kinds, str(found))
        h.true(f"{name}: reaches its end", s["status"] == "completed", s["status"])
    h.true("the doubled cycle runs back into the simple one", value(run["unbalanced flip 1"], "returned") is not None)
    for k, limit in enumerate(FINITE_FLIPS, 1):
        converged(h, f"flip {k}", h.work / "curve/results.h5", "fine", k, limit, (1.2, 2.8))
    converged(h, "fold", h.work / "curve/results.h5", "fine_fold", 1, FINITE_FOLD, (1.2, 2.8))


def as_they_stand(h, name, limits, kind, scale):
    run = h.run(deck(h, f"compliant_rotor/{name}.yaml"), name)
    for study, wanted in limits.items():
        found = run[study]["bifurcations"]
        kinds = ["hopf"] if study == "balanced" else [kind] * len(wanted)
        h.true(f"{study}: {kinds}", [b["type"] for b in found] == kinds, run[study]["status"])
        for b, limit in zip(found, wanted):
            within_stated(h, f"{study}: {b['type']}", b, limit, scale)


def short_bearing(e):
    """S and attitude of the short bearing without pressure below zero (Ocvirk)."""
    q = 1 - e * e
    return e * math.sqrt(16 * e * e + math.pi**2 * q) / (2 * q * q), math.atan(math.pi * math.sqrt(q) / (4 * e))


def long_bearing(e):
    """The same of the long one (half Sommerfeld)."""
    q = 1 - e * e
    return 3 * e * math.sqrt(math.pi**2 * q + 4 * e * e) / ((2 + e * e) * q), math.atan(math.pi * math.sqrt(q) / (2 * e))


def finite_approximation(e):
    """The same by the finite impedance of van de Vrande (2001) at L/D = 1, with the misprint of its table put right."""
    q, a, b = 1 - e * e, 5 - 2 * e * e, 8 - 5 * e * e
    return (3 * e * math.sqrt(4 * b * b * e * e + math.pi**2 * a * a * q) / (a * b * q),
            math.atan(math.pi * a * math.sqrt(q) / (2 * b * e)))


def reynolds_ring(e, waves=80, modes=40):
    """S and attitude of a bearing of L/D = 1 by Reynolds' equation for h = 1 + e cos(theta) where p > 0, that is 0 < theta < pi.

    (h^3 p')' + h^3 p_zz = 6 h' with p = sum_k a_k(theta) cos(l_k z) on -1 < z < 1, l_k = (2k + 1) pi/2, and sines around."""
    theta, weight = np.polynomial.legendre.leggauss(4 * waves)
    theta, weight = math.pi / 2 * (theta + 1), math.pi / 2 * weight
    h, n = 1 + e * np.cos(theta), np.arange(1, waves + 1)
    sine, slope = np.sin(np.outer(n, theta)), n[:, None] * np.cos(np.outer(n, theta))
    around, along = (slope * (weight * h**3)) @ slope.T, (sine * (weight * h**3)) @ sine.T
    load = sine @ (weight * 6 * e * np.sin(theta))
    force = np.zeros(2)
    for k in range(modes):
        wave = (2 * k + 1) * math.pi / 2
        a = np.linalg.solve(around + wave**2 * along, load) @ sine
        # 1 = sum_k 2 (-1)^k/l_k cos(l_k z), whose integral over z is 2 (-1)^k/l_k again.
        force += 4 / wave**2 / 4 * np.array([weight @ (a * np.cos(theta)), weight @ (a * np.sin(theta))])
    return math.hypot(*force), math.atan2(force[1], -force[0])


def rigid_bearings(h):
    """Three closed forms along the whole locus; Reynolds' equation against a solution by series."""
    run = h.run(deck(h, "rigid_rotor/figure_4_7.yaml"), "maps")
    with h5py.File(h.work / "maps/results.h5") as f:
        locus = {name: {k: f[f"studies/{name}/locus/{k}"][()] for k in ("eccentricity", "sommerfeld", "attitude")}
                 for name in ("short", "long", "finite", "reynolds")}
    for name, form in (("short", short_bearing), ("long", long_bearing), ("finite", finite_approximation)):
        t = locus[name]
        load, attitude = np.transpose([form(e) for e in t["eccentricity"]])
        h.close(f"{name}: S, worst of {len(load)}, relative", np.abs(t["sommerfeld"] / load - 1).max(), 0, 1e-11)
        h.close(f"{name}: attitude, worst", np.abs(t["attitude"] - attitude).max(), 0, 1e-11)
        e = value(run[name], "sommerfeld.2.5.eccentricity")
        h.close(f"{name}: S at the eccentricity found for 2.5", form(e)[0], 2.5, 1e-8)
    t = locus["reynolds"]
    for e in (0.2, 0.4, 0.6, 0.8, 0.9):
        k = int(np.argmin(np.abs(t["eccentricity"] - e)))
        load, attitude = reynolds_ring(e)
        h.close("an eccentricity of the locus", t["eccentricity"][k], e, 1e-12)
        h.close(f"reynolds: S at {e}, 120 x 24 cells", t["sommerfeld"][k], load, 6e-3 * load)
        h.close(f"reynolds: attitude at {e} [deg]", math.degrees(t["attitude"][k]), math.degrees(attitude), 0.1)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"finite": finite, "finite_curve": finite_curve, "whole_curve": whole_curve,
     "short": lambda h: as_they_stand(h, "short", SHORT, "flip", SPEED),
     "long": lambda h: as_they_stand(h, "long", LONG, "neimark_sacker", 2 * SPEED),
     "rigid_bearings": rigid_bearings}[sys.argv[3]](harness)
    harness.finish()
