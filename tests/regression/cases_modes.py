#!/usr/bin/env python3
"""Modes of small machines: what is listed, what grows, and where.

cases_modes.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import math
import subprocess
import sys

import h5py
import numpy as np
from harness import Harness, value

GROWTH = (-100 + math.sqrt(1e4 + 4e7)) / 20  # of 10 kg on -1 MN/m with 100 N s/m [1/s]
RPM = math.pi / 30


def warned(study, *words):
    return any(all(word in w for word in words) for w in study.get("warnings", []))


def divergence(h):
    """A negative stiffness: s = +311.3 1/s, on any number of ranks, in a rigid rotor and in a shaft before and after a reduction."""
    deck = h.source / "tests/cases/negative_stiffness.yaml"
    few = "studies=[{modes: {name: m, speeds: [100 rad/s]}}, {static: {name: s, speed: 100 rad/s}}]"
    for ranks in (1, 2, 3):
        s = h.run(deck, f"ranks {ranks}", [few], launcher=[] if ranks == 1 else [*h.launcher, "-n", str(ranks)])
        first = s["m"]["modes"][0]
        h.close(f"real eigenvalue [1/s], {ranks} ranks", first["real"], GROWTH, 1e-9 * GROWTH)
        h.true("it is named", first["imag"] == 0 and first["stability"] == "diverges" and first["damping_ratio"] == -1)
        h.true("modes and static warn", warned(s["m"], "diverges", "+311.3") and warned(s["s"], "diverges", "+311.3"))
        h.close("modes that grow", value(s["m"], "at.100.unstable"), 1, 0)
        h.true("the other plane is stable", [m["stability"] for m in s["m"]["modes"]] == ["diverges", "stable"])
    symmetric(h)
    s = h.run(deck, "as it is", launcher=[])
    h.true("the branch is unstable, and the motion does not rest", s["b"]["stability"] == "unstable throughout" and "motion.unsettled" in s["mo"]["values"],
           f"{s['b']['stability']} {list(s['mo']['values'])}")
    h.true("the motion says why", warned(s["mo"], "has not settled", "diverges", "+311.3"), str(s["mo"].get("warnings")))
    # A run-up names the speeds, and what holds at the service speed; a forced motion names what carries it away.
    s = h.run(deck, "runs", ["unbalance={u: {planes: [{node: 1, amount: 1e-5 kg m}]}}", "service_speed=8500 rpm",
                             "studies=[{run_up: {name: up, unbalance: [u], range: {from: 8000 rpm, to: 9000 rpm}, duration: 0.05 s}},"
                             " {motion: {name: forced, unbalance: [u], speed: 100 rad/s, discard: 1, revolutions: 3}}]"], launcher=[])
    h.true("a run-up says where", warned(s["up"], "unstable from 8000 to 9000 rpm", "diverges", "+311.3") and s["up"]["stability"] == "unstable at the 3 speeds counted",
           f"{s['up']['stability']} {s['up'].get('warnings')}")
    whole = json.loads((h.work / "runs" / "summary.json").read_text())["service_speed"]
    h.true("its vibration is about an unstable equilibrium", any("unstable equilibrium" in f["mark"] for f in whole["facts"]), str(whole))
    h.true("a forced motion diverges", warned(s["forced"], "has not settled", "diverges", "+311.3"), str(s["forced"].get("warnings")))
    # Oscillations that the film feeds from 637 rad/s on: stable at the beginning of the way, unstable at its end.
    fed = "bearings={left: {node: 1, film: {type: linear, stiffness: [1e6 N/m, 0 N/m, 0 N/m, 1e6 N/m], damping: 100 N s/m}}}"
    drive = "elements={seal: {node: 1, role: seal, static_load: true, table: [{speed: 0 rad/s, k_xy: 0 N/m, k_yx: 0 N/m}, {speed: 1000 rad/s, k_xy: 50 kN/m, k_yx: -50 kN/m}]}}"
    s = h.run(deck, "crossed", ["unbalance={u: {planes: [{node: 1, amount: 1e-5 kg m}]}}", fed, drive,
                                "studies=[{run_up: {name: up, unbalance: [u], range: {from: 400 rad/s, to: 1000 rad/s}, duration: 0.1 s}}]"], launcher=[])["up"]
    # s = +-i 316.2 to first order grows from k_xy = 100 N s/m x 316.2 rad/s on, at 632 rad/s.
    h.true("it names the stable side", warned(s, "unstable from 650 to 1000 rad/s (stable at 600)", "an oscillation grows"), f"{s['stability']} {s.get('warnings')}")
    # What is linear cannot be chaotic: it grows without bound.
    cross = "bearings={left: {node: 1, film: {type: linear, stiffness: [1e6 N/m, 1e5 N/m, -1e5 N/m, 1e6 N/m], damping: 100 N s/m}}}"
    s = h.run(deck, "grows", ["unbalance={u: {planes: [{node: 1, amount: 1e-5 kg m}]}}", cross,
                              "studies=[{motion: {name: g, unbalance: [u], speed: 100 rad/s, discard: 20, revolutions: 20}}]"], launcher=[])["g"]
    h.true("a linear motion that grows", "motion.unsettled" in s["values"] and warned(s, "has not settled", "times as far"), f"{list(s['values'])[:3]} {s.get('warnings')}")
    # The same spring in the middle of a shaft, whole and reduced; another film speaks for seals.
    shaft = h.source / "tests/cases/friswell_591.yaml"
    seal = "bearings.seal={node: 4, film: {type: linear, stiffness: [-8e6 N/m, 0 N/m, 0 N/m, 1e5 N/m], damping: 500 N s/m}}"
    found = []
    for reduction in ("none", "{type: craig_bampton, masters: [1, 4, 7], modes: 4}", "{type: guyan, masters: [1, 3, 4, 5, 7]}"):
        over = [] if reduction == "none" else [f"rotor.reduction={reduction}"]
        s = h.run(shaft, f"seal {reduction[:10]}", [few, seal, *over], launcher=[])
        found.append(s["m"]["modes"][0])
        h.true(f"a shaft diverges, reduction {reduction[:20]}", found[-1]["stability"] == "diverges" and warned(s["s"], "diverges"))
    h.close("after a reduction [1/s]", found[1]["real"], found[0]["real"], 0.02 * found[0]["real"])


def softened(h):
    """A spring of negative stiffness at mid-span, less and less of it: the shaft stands once the sum of the flexibilities, of the bent and sheared
    shaft and of its two supports, is that of the spring. Pairs without damping lie on the border as well, and do not cross it."""
    second, area, shear = math.pi * 0.04**4 / 64, math.pi * 0.04**2 / 4, 6 * 1.3 / (7 + 6 * 0.3)
    holds = 1 / (1 / (48 * 210e9 * second) + 1 / (4 * shear * 210e9 / 2.6 * area) + 1 / (2 * 20e6))
    b, = h.run(h.source / "tests/cases/symmetric_shaft.yaml", "softened", [
        "elements={spring: {node: 11, role: other, static_load: false, stiffness: [-5e6 N/m, 0 N/m, 0 N/m, 0 N/m]}}",
        "studies=[{equilibrium_branch: {name: q, parameter: elements.spring.stiffness.1, speed: 100 rad/s, range: {from: -5e6 N/m, to: 1e6 N/m}}}]"],
        launcher=[])["q"]["bifurcations"]
    h.close("stiffness that holds the shaft [N/m]", -b["value"], holds, 1e-4 * holds)
    h.true("by a real eigenvalue", b["type"] == "branch_point" and b["stable_side"] == "above", str(b))


def stiff(h):
    """Light nodes in stiff bearings: rounding of rows that are 1e14 apart must not hide a threshold. Its whole shaft loses stability where a reduced one
    does, from whatever side and however far away the branch comes."""
    found = []
    for k, (start, end, reduction) in enumerate(((1000, 3000, "none"), (1400, 1300, "none"), (900, 2000, "{type: guyan, masters: [1, 4, 9, 12]}"))):
        study = f"studies=[{{equilibrium_branch: {{name: b, range: {{from: {start} rpm, to: {end} rpm}}, detect: [hopf]}}}}]"
        over = [] if reduction == "none" else [f"rotor.reduction={reduction}"]
        found.append(h.run(h.source / "tests/cases/turbocharger.yaml", f"turbocharger {k}", [study, *over], launcher=[])["b"]["bifurcations"])
    reduced, = found.pop()
    for hopf, in found:
        h.close("threshold [rpm]", hopf["value"], reduced["value"], 0.1 + abs(reduced.get("reduction_error") or 0))


def of_beam(n, damping, middle, speed):
    """Eigenvalues [1/s] of the shaft of symmetric_shaft.yaml in n linear elements with one shear point each, of second order (Hughes,
    Taylor and Kanoknukulchai (1977), IJNME 11, 1529); shear coefficient of Cowper (1966). `middle`: stiffness at mid-span [N/m]."""
    modulus, density, nu, diameter, length = 210e9, 7850.0, 0.3, 0.04, 1.0
    area, second = np.pi * diameter**2 / 4, np.pi * diameter**4 / 64
    shear = 6 * (1 + nu) / (7 + 6 * nu) * modulus / (2 * (1 + nu)) * area
    part, size = length / n, 2 * (n + 1)
    k, m, polar = (np.zeros((size, size)) for _ in range(3))
    for j in range(n):
        at = np.s_[2 * j:2 * j + 4, 2 * j:2 * j + 4]
        curvature, slip = np.array([0, -1, 0, 1]) / part, np.array([-1 / part, -0.5, 1 / part, -0.5])
        k[at] += part * (modulus * second * np.outer(curvature, curvature) + shear * np.outer(slip, slip))
        shifts, turns = (part / 6 * np.kron([[2, 1], [1, 2]], np.diag(which)) for which in ([1, 0], [0, 1]))
        m[at] += density * (area * shifts + second * turns)
        polar[at] += 2 * density * second * turns
    zero = np.zeros_like(k)
    k, m, c = np.block([[k, zero], [zero, k]]), np.block([[m, zero], [zero, m]]), speed * np.block([[zero, polar], [-polar, zero]])
    for end in (0, 2 * n):
        for place, stiffness in ((end, 2e7), (size + end, 3e7)):
            k[place, place] += stiffness
            c[place, place] += damping
    k[np.ix_([n, size + n], [n, size + n])] += middle  # n is even
    return np.linalg.eigvals(np.block([[np.zeros_like(k), np.eye(len(k))], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]]))


def fastest(damping, middle):
    """The eigenvalue below 100 Hz that grows fastest at 300 rad/s, its limit of fine meshes."""
    coarse, fine = (max((s for s in of_beam(n, damping, middle, 300) if 0 <= s.imag < 628), key=lambda s: s.real) for n in (20, 40))
    return (4 * fine - coarse) / 3


def symmetric(h):
    """Modes that rest at half of the places of a shaft: what rounding leaves there hides no growth."""
    deck = h.source / "tests/cases/symmetric_shaft.yaml"
    for damping in (100, 1000):
        s = h.run(deck, f"stage {damping}", [f"bearings.*.film.damping={damping} N s/m"], launcher=[])
        wanted = fastest(damping, [[0, 5e5], [-5e5, 0]])
        grows = [m for m in s["m"]["modes"] if m["stability"] == "unstable" and m["imag"] < 628]
        h.close(f"modes below 100 Hz that grow, {damping} N s/m", len(grows), 1, 0)
        h.close("frequency [rad/s]", grows[0]["imag"] if grows else None, wanted.imag, 1e-3 * wanted.imag)
        h.close("log decrement", -2 * math.pi * grows[0]["real"] / grows[0]["imag"] if grows else None, -2 * math.pi * wanted.real / wanted.imag, 5e-4)
        h.true("static warns", warned(s["s"], "unstable", f"{wanted.imag / (2 * math.pi):.2f} Hz"))
    spring = "elements={spring: {node: 11, role: other, static_load: false, stiffness: [-5e6 N/m, 0 N/m, 0 N/m, 0 N/m]}}"
    for damping in (0, 30, 1000):
        s = h.run(deck, f"spring {damping}", [spring, f"bearings.*.film.damping={damping} N s/m"], launcher=[])
        first = s["m"]["modes"][0]
        h.close(f"s of the shaft on a negative spring, {damping} N s/m [1/s]", first["real"], fastest(damping, [[-5e6, 0], [0, 0]]).real, 0.1)
        h.true("diverges", first["stability"] == "diverges" and warned(s["s"], "diverges"))


def missing(h):
    """Overdamped motions stand apart; the machine's modes and all that grows are listed, whatever their frequencies."""
    deck = h.source / "tests/cases/missing_modes.yaml"
    for parts, name in ((20, "given"), (40, "forty")):
        cut = [] if parts == 20 else ["rotor.segments=[" + ", ".join(["{length: 7.5 mm, diameter: 15 mm}"] * 40) + "]", "rotor.discs.1.node=17",
                                      "bearings.right.node=41"]
        s = h.run(deck, name, cut, launcher=[])["m"]
        for k, wanted in ((1, 1133), (2, 1135)):
            h.close(f"critical speed {k}, {parts} elements [rad/s]", value(s, f"critical.{k}.speed"), wanted, 1)
        h.true("no mode is overdamped", all(m["damping_ratio"] <= 0.9 for m in s["modes"]))
        h.true("they are counted", value(s, "overdamped") >= 14, str(value(s, "overdamped")))
        h.true("by frequency", all(a["imag"] <= b["imag"] for a, b in zip(s["modes"], s["modes"][1:]) if a["speed"] == b["speed"]))
    with h5py.File(h.work / "given" / "results.h5") as f:
        real, imag = (f["studies/m/overdamped"][k][()] for k in ("damping_real", "frequency"))
        h.true("and stand in a table", np.all(-real / np.hypot(real, imag) > 0.9))
    # Internal damping: forward whirl grows beyond 1466.98 rad/s, as the branch of equilibria says.
    deck = h.source / "tests/cases/missing_unstable.yaml"
    more = ["studies=[{modes: {name: m, speeds: [3000 rad/s], count: 6}}, {modes: {name: over, range: {from: 500 rad/s, to: 3000 rad/s}, points: 6, count: 4}}, "
            "{modes: {name: beyond, range: {from: 500 rad/s, to: 4500 rad/s}, points: 9, count: 4, max_frequency: 1000 rad/s}}]", "service_speed=1300 rad/s"]
    s = h.run(deck, "internal", more, launcher=[])
    growing = [m for m in s["m"]["modes"] if m["stability"] == "unstable"]
    h.true("one mode grows", len(growing) == 1 and growing[0]["whirl"] == "forward")
    h.close("    at [Hz]", growing[0]["imag"] / (2 * math.pi), 181, 0.5)
    h.close("    log decrement", growing[0]["log_decrement"], -0.009, 0.0005)
    h.close("    the least damped", value(s["m"], "at.3000.least_damped.log_decrement"), growing[0]["log_decrement"], 0)
    h.close("    threshold over the speed [rad/s]", value(s["over"], "threshold"), 1466.98, 0.01)
    h.close("    of a mode outside the list [rad/s]", value(s["beyond"], "threshold"), 1466.98, 0.01)
    h.true("    which is in the words", warned(s["beyond"], "unstable: from 1466.9") and not warned(s["beyond"], "from the start"), str(s["beyond"]["warnings"]))
    service = {f["what"]: f for f in json.loads((h.work / "internal" / "summary.json").read_text())["service_speed"]["facts"]}
    h.true("    stable between speeds of different fate", service["stability"]["mark"] == "stable", str(service["stability"]))
    h.close("    the margin of the service speed [%]", service["margin in speed to the threshold of stability"]["value"], 100 * (1466.98 / 1300 - 1), 0.001)
    decrement = service["smallest log decrement"]
    h.true("    a decrement computed at that speed", "mark" not in decrement and
           any(m["speed"] == 1300 and m["log_decrement"] == decrement["value"] for m in s["over"]["modes"]), str(decrement))
    h.close("    up to the end", value(s["over"], "unstable.1.to"), 3000, 1e-9)
    h.close("    its number", value(s["over"], "unstable.1.mode"), next(m["mode"] for m in s["over"]["modes"] if m["stability"] == "unstable"), 0)
    h.true("    both warn", warned(s["m"], "unstable", "forward") and warned(s["over"], "unstable", "forward", "to the end of the range, 3000"))


    # Two speeds between which the shape of a mode changes until it is not known again: the critical speed is that of 25 speeds and of the map.
    s = h.run(h.source / "tests/cases/overhung.yaml", "overhung", launcher=[])
    wanted = value(s["map"], "softest.backward.1") / RPM
    for name in ("many", "two", "few"):
        found = [v["value"] for k, v in s[name]["values"].items() if k.startswith("critical.") and k.endswith(".speed")]
        h.true(f"one critical speed, {name}", len(found) == 1 and not warned(s[name], "may be missing"), f"{found} {s[name].get('warnings')}")
        h.close("    as the map has it [rpm]", found[0] if found else None, wanted, 1e-4 * wanted)


def fine(h):
    """A shaft beyond dense matrices finds the same modes, and a count says that none is missing."""
    deck = h.source / "tests/cases/missing_unstable.yaml"
    one = "studies=[{modes: {name: m, speeds: [3000 rad/s], count: 6}}]"
    cut = lambda n: ["rotor.segments=[" + ", ".join(["{length: %.9g mm, diameter: 15 mm}" % (300 / n)] * n) + "]",  # noqa: E731
                     f"rotor.discs.1.node={8 * n // 20 + 1}", f"bearings.right.node={n + 1}"]
    coarse = h.run(deck, "coarse", [one, *cut(60)], launcher=[])["m"]
    for ranks in (1, 2):
        s = h.run(deck, f"fine {ranks}", [one, *cut(120)], launcher=[] if ranks == 1 else [*h.launcher, "-n", "2"])["m"]
        h.close(f"as many modes, {ranks} ranks", len(s["modes"]), len(coarse["modes"]), 0)
        for a, b in zip(s["modes"], coarse["modes"]):
            h.close("    frequency [rad/s]", a["imag"], b["imag"], 1e-4 * b["imag"])
        h.close("    none is missed", value(s, "search.missed"), 0, 0)
        h.true("    they are counted", value(s, "search.counted") >= 2 * len(s["modes"]) and value(s, "search.frequency") > s["modes"][-1]["imag"])
        h.true("    one grows", sum(m["stability"] == "unstable" for m in s["modes"]) == 1)


def ocvirk(load, speed, viscosity, diameter, length, clearance):
    """Eccentricity and stiffness of a short bearing (Friswell et al., 5.5.1): an octic in the eccentricity, closed forms of the coefficients."""
    s = diameter * speed * viscosity * length**3 / (8 * load * clearance**2)
    octic = lambda x: x**4 - 4 * x**3 + (6 - s * s * (16 - math.pi**2)) * x * x - (4 + math.pi**2 * s * s) * x + 1  # noqa: E731
    low, high = 0.0, 1.0  # of the eccentricity squared
    for _ in range(100):
        low, high = ((low + high) / 2, high) if octic((low + high) / 2) > 0 else (low, (low + high) / 2)
    e2, e, p2 = low, math.sqrt(low), math.pi**2
    q, h0 = math.sqrt(1 - e2), 1 / (p2 * (1 - e2) + 16 * e2)**1.5
    return e, {"xx": load / clearance * h0 * 4 * (p2 * (2 - e2) + 16 * e2),
               "xy": load / clearance * h0 * math.pi * (p2 * (1 - e2)**2 - 16 * e2**2) / (e * q),
               "yx": -load / clearance * h0 * math.pi * (p2 * (1 - e2) * (1 + 2 * e2) + 32 * e2 * (1 + e2)) / (e * q),
               "yy": load / clearance * h0 * 4 * (p2 * (1 + 2 * e2) + 32 * e2 * (1 + e2) / (1 - e2))}


def limits(h):
    """Unstable up to 205, stable to 694.87 rad/s: modes and branches say the same, and so does the response that looks at speeds beyond tables."""
    deck = h.source / "tests/cases/two_ranges.yaml"
    s = h.run(deck, "given", launcher=[])
    m, b, down, r = (s[k] for k in ("m", "b", "down", "r"))
    for name, study in (("modes", m), ("branch", b), ("downwards", down)):
        h.close(f"threshold, {name} [rad/s]", value(study, "threshold"), 694.87, 0.01)
    for a, wanted in zip(m["ranges"], b["ranges"], strict=True):
        h.true("the ranges of modes are those of the branch", a["stability"] == wanted["stability"] and abs(a["from"] - wanted["from"]) < 0.01 and
               abs(a["to"] - wanted["to"]) < 0.01, f"{a} {wanted}")
    h.true("a linear machine does not jump", all("jump" not in x["sentence"] and x["sentence"] for x in b["bifurcations"]), str(b["bifurcations"]))
    h.true("the response does not reach the service speed, and the rest stands", r["status"] == "completed" and r["points"] >= 60 and
           warned(r, "service_speed of 1200 rad/s") and warned(r, "(service_speed among them)"), f"{r['status']} {r.get('warnings')}")
    # A window between the speeds that are counted in any case, about the service speed.
    rows = ", ".join("{speed: %g rad/s, k_xy: %g N/m, k_yx: %g N/m}" % (v, k, -k) for v, k in ((0, 0), (520, 0), (522, 1e5), (532, 1e5), (534, 0), (2000, 0)))
    window = ["service_speed=528 rad/s", f"elements.seal.table=[{rows}]",
              "studies=[{unbalance_response: {name: r, unbalance: [u], range: {from: 100 rad/s, to: 1300 rad/s}, points: 601}}, {static: {name: s, speed: 5042 rpm}}, "
              "{modes: {name: m, range: {from: 100 rad/s, to: 1300 rad/s}, points: 3}}, "
              "{equilibrium_branch: {name: b, parameter: speed, range: {from: 1300 rad/s, to: 100 rad/s}}}]"]
    s = h.run(deck, "window", window, launcher=[])
    h.close("eigenvalues that grow in the window", value(s["r"], "operating_speed.unstable_count"), 2, 0)
    h.true("    the verdict names it", s["r"]["stability"].startswith("unstable from 52"), s["r"]["stability"])
    # Three speeds of modes and the steps of a branch pass over it: C omega_n = K_xy at sqrt(1e5) rad/s, so that half of the rise is the border.
    for name in ("m", "b"):
        ranges = sorted(([r["from"], r["to"]], r["stability"]) if r["from"] < r["to"] else ([r["to"], r["from"]], r["stability"]) for r in s[name]["ranges"])
        h.true(f"    it lies between stable ranges: {name}", [word for _, word in ranges] == ["stable", "unstable", "stable"], str(ranges))
        for edge, row in zip(ranges[1][0], (520, 532), strict=True):
            h.true(f"    its border lies between rows: {name}", row < edge < row + 2, str(edge))
    h.true("    modes say what they looked at", "speeds computed" in s["m"]["stability"], s["m"]["stability"])
    h.true("    static in its own unit", warned(s["s"], "at 5042 rpm the equilibrium is unstable"), str(s["s"].get("warnings")))


def textbook(h):
    """Printed values of Friswell's machines; an undamped pair at rest is two modes, neither of which grows."""
    s = h.run(h.source / "tests/cases/friswell_591.yaml", "591", launcher=[])["campbell"]
    rest, turning = ([m for m in s["modes"] if m["speed"] == speed] for speed in (0, 4000))
    for m, wanted in zip(rest, (86.66, 86.66, 274.31, 274.31, 716.78, 716.78), strict=True):
        h.close("5.9.1 at rest [rad/s]", m["imag"], wanted, 0.01)
        h.true("    undamped", m["stability"] == "undamped", m["stability"])
    for m, wanted in zip(turning, (85.39, 87.80, 251.78, 294.71, 600.18)):
        h.close("5.9.1 at 4000 rpm [rad/s]", m["imag"], wanted, 0.01)
    s = h.run(h.source / "tests/cases/friswell_594.yaml", "594", launcher=[])["campbell"]
    rest = [m for m in s["modes"] if m["speed"] == 0]
    for m, wanted in zip(rest, (11.66, 14.80, 33.97, 49.19, 97.97, 126.6), strict=True):
        h.close("5.9.4 at rest [Hz]", m["imag"] / (2 * math.pi), wanted, 0.01 if wanted < 100 else 0.1)
    # 5.9.6, short films: the closed forms of the book from the load that the bearing carries; one threshold from modes and branch.
    s = h.run(h.source / "tests/cases/friswell_596.yaml", "596", launcher=[])
    load = value(s["s"], "bearing.a.force.y")
    eccentricity, stiffness = ocvirk(load, 4000 * RPM, 0.1, 0.1, 0.03, 1e-4)
    h.close("5.9.6: eccentricity at 4000 rpm", math.hypot(*(value(s["s"], f"bearing.a.eccentricity.{d}") for d in "xy")), eccentricity, 1e-7)
    for k, wanted in stiffness.items():
        h.close(f"    K_{k} [N/m]", value(s["s"], f"bearing.a.K.{k}"), wanted, 1e-6 * abs(wanted))
    branch = s["t"]["bifurcations"][0]
    h.close("    threshold of modes and branch [rpm]", value(s["campbell"], "threshold"), branch["value"], 0.01)
    # The table of the ends of the branch: by the same octic, and tan(attitude angle) = pi sqrt(1 - e^2)/(4 e).
    ends = [row for t in s["t"]["brief"]["tables"] if t["caption"] == "At the ends of the branch" for row in t["rows"] if row[0] == "a"]
    h.true("    ends of the branch, bearing a", [round(row[1]["value"], 6) for row in ends] == [200, 6000], str(ends))
    for _, speed, x, y in ends:
        e, _ = ocvirk(load, speed["value"] * RPM, 0.1, 0.1, 0.03, 1e-4)
        phi = math.atan(math.pi * math.sqrt(1 - e * e) / (4 * e))
        h.close(f"    x at {speed['text']} rpm [m]", x["value"], 1e-4 * e * math.sin(phi), 1e-10)
        h.close(f"    y at {speed['text']} rpm [m]", y["value"], -1e-4 * e * math.cos(phi), 1e-10)
    # Coupled across with a skew part it is unstable at every speed above rest.
    skew = ["studies=[{modes: {name: m, speeds: [400 rpm, 4000 rpm], count: 6}}]"]
    s = h.run(h.source / "tests/cases/always_unstable.yaml", "skew", skew, launcher=[])["m"]
    for speed, low, high in ((400, -0.189, -0.053), (4000, -0.37, -0.17)):
        worst = [m["log_decrement"] for m in s["modes"] if m["speed"] == speed and m["stability"] == "unstable"]
        h.true(f"unstable at {speed} rpm", len(worst) >= 3 and warned(s, str(speed), "unstable"), str(worst))
        h.close("    least log decrement", min(worst[:3]), low, 0.006)
    told = [w for w in s["warnings"] if "unstable" in w]
    h.true("one warning of all speeds", len(told) == 1 and told[0].startswith("at 400 and 4000 rpm the machine is unstable; at 4000 rpm: "), str(told))
    disc = h.source / "inputs/merot/disc_rotor.yaml"
    rest = "studies=[{modes: {name: m, speeds: [0 rad/s], count: 6}}]"
    for element in ("rayleigh", "timoshenko", "timoshenko_linear", "timoshenko_hermitian"):
        s = h.run(disc, element, [rest, f"rotor.element={element}", "bearings.*.film.damping=0 N s/m"], launcher=[])["m"]
        pairs = [m["imag"] for m in s["modes"]]
        h.true(f"{element}: undamped pairs at rest", all(m["stability"] == "undamped" for m in s["modes"]) and
               all(abs(a - b) < 1e-6 * a for a, b in zip(pairs[::2], pairs[1::2])), str([m["stability"] for m in s["modes"]]))


def equal(h):
    """An isotropic machine at rest: equal modes turn either way. At a speed, or with springs that differ, each has its sense."""
    deck = h.source / "tests/cases/shaft_mesh.yaml"
    one = "studies=[{modes: {name: m, speeds: [%s], count: 7, shapes_at: [1 rad/s]}}]"
    for ranks in (1, 2, 3):
        s = h.run(deck, f"rest {ranks}", [one % "0 rad/s, 1 rad/s"], launcher=[] if ranks == 1 else [*h.launcher, "-n", str(ranks)])["m"]
        words = [(m["speed"], m["whirl"]) for m in s["modes"]]
        h.true(f"at rest, {ranks} ranks", all(m["whirl"] == m["whirl_rule"] == "either" for m in s["modes"][:7]), str(words))
        h.true("at 1 rad/s", [m["whirl"] for m in s["modes"][7:]] == ["backward", "forward"] * 3 + ["backward"], str(words))
        with h5py.File(h.work / f"rest {ranks}" / "results.h5") as f:
            table = f["studies/m/spectrum"]
            share = table["forward_share"][()]
            h.close("    these two are circles, backward first", np.abs(share[:7] - [-1, 1, -1, 1, -1, 1, -1]).max(), 0, 1e-9)
            h.true("    the column says what it is", "either" in table["whirl"].attrs["description"] and table["whirl"].asstr()[0] == "either")
        h.true("    nothing is the first forward mode", value(s, "at.0.first_forward.frequency") is None and value(s, "at.1.first_forward.frequency") > 0)
    held = "rotor.loss_factor=0.01"
    s = h.run(deck, "loss", [one % "0 rad/s", "rotor.internal_damping=", held], launcher=[])["m"]
    h.true("with a loss factor", all(m["whirl"] == "either" for m in s["modes"]), str([m["whirl"] for m in s["modes"]]))
    said = subprocess.run(h.command(deck, h.work / "said", [one % "0 rad/s"], launcher=[], bars=False), capture_output=True, text=True).stdout
    h.true("the screen explains", "either: equal modes" in said, said)
    s = h.run(deck, "springs", [one % "0 rad/s", "bearings.*.film.stiffness=[20 MN/m, 0 N/m, 0 N/m, 20.001 MN/m]"], launcher=[])["m"]
    h.true("springs that differ by 5e-5", all(m["whirl"] == m["whirl_rule"] == "planar" for m in s["modes"]), str([m["whirl"] for m in s["modes"]]))
    s = h.run(deck, "range", ["studies=[{modes: {name: m, range: {from: 0 rad/s, to: 900 rad/s}, points: 4, count: 4}}]"], launcher=[])["m"]
    tracks = [[m["whirl"] for m in s["modes"] if m["mode"] == k] for k in (1, 2, 3, 4)]
    h.true("from rest on", tracks == [["either"] + [w] * 3 for w in ("backward", "forward") * 2], str(tracks))


def many(h):
    """Nearly all modes of a mesh: those that a finer one has, too, have bars, and a warning names the others; or says why there are none."""
    deck = h.source / "tests/cases/shaft_mesh.yaml"
    cut = ["rotor.segments=[" + ", ".join(["{length: 25 mm, diameter: 40 mm}"] * 40) + "]", "bearings.right.node=41", "rotor.internal_damping=", "studies=[{modes: {name: m, speeds: [0 rad/s], count: 139}}]"]
    s = h.run(deck, "many", cut, launcher=[], bars=True)["m"]
    known = [m["imag_uncertainty"] is not None for m in s["modes"]]
    h.true("bars of the lower modes", all(known[:80]), str(known))
    h.close("    a small one, of the first [rad/s]", s["modes"][0]["imag_uncertainty"], 0, 0.01)
    h.true("    no bars of some", not all(known) and sum(known) > 100, str(sum(known)))
    first = 1 + known.index(False)
    h.true("    which are named", warned(s, "no error bars of mode", f" {first}", "cut in two"), str(s.get("warnings")))
    s = h.run(deck, "none", [*cut[:3], "studies=[{modes: {name: m, speeds: [0 rad/s], count: 6}}]"], flags=["--", "-modes_eps_ncv", "110", "-modes_eps_max_it", "1", "-modes_eps_tol", "1e-15"], launcher=[], bars=True)["m"]
    h.true("a search without an answer", warned(s, "no error bars of modes 1 to 6", "gave no modes", "converged"), str(s.get("warnings")))


def supports(h):
    """Masses below the bearings: modes as published, and a map that meets the Campbell diagram."""
    deck = h.source / "tests/cases/support_mass.yaml"
    s = h.run(deck, "given", launcher=[])
    for m, wanted in zip(s["modes"]["modes"], (12.73, 13.61, 27.00, 29.63, 47.64, 51.77)):
        h.close("mode at 1800 rpm [Hz]", m["imag"] / (2 * math.pi), wanted, 0.005)
    # Springs of 1 MN/m in both planes: with the pedestals as they are, and with equal ones.
    springs = "bearings.*.film={type: linear, stiffness: 1 MN/m, damping: 0 N s/m}"
    both = "studies=[{modes: {name: c, range: {from: 10 rad/s, to: 400 rad/s}, points: 14, count: 8}}, {critical_speed_map: {name: map, stiffness: {from: 1 MN/m, to: 2 MN/m}, points: 2, count: 3}}]"
    for name, pedestal in (("equal", ["bearings.left.pedestal.stiffness=1 MN/m"]), ("given", [])):
        s = h.run(deck, f"map {name}", [springs, both, *pedestal], launcher=[])
        campbell = sorted(v["value"] for k, v in s["c"]["values"].items() if k.startswith("critical.") and k.endswith(".speed"))
        mapped = sorted(v["value"] for k, v in s["map"]["values"].items() if k.startswith("softest."))
        h.true(f"{name} pedestals: six critical speeds", len(mapped) == 6 and len(campbell) >= 5, f"{mapped}, {campbell}")
        for a, b in zip(mapped, campbell):
            h.close("    the map meets the Campbell diagram [rad/s]", a, b, 1e-5 * b)


def level_1(h):
    """A sweep of modes over a cross-coupling at mid-span: log decrements of the first forward mode (API level I)."""
    deck = h.source / "tests/cases/steam_turbine.yaml"
    cross = "bearings.Q={node: 12, film: {type: linear, stiffness: [0 N/m, 0 N/m, 0 N/m, 0 N/m], damping: 0 N s/m}}"
    table = ", ".join("q%d: {bearings.Q.film.stiffness: [0 N/m, %g N/m, %g N/m, 0 N/m]}" % (k, q, -q) for k, q in enumerate((0, 1e6, 2e6)))
    s = h.run(deck, "level 1", [cross, "studies=[{modes: {name: m, speeds: [7500 rpm], count: 3}}, {sweep: {name: Q, of: [m], as_given: false, variants: {%s}}}]" % table], launcher=[])
    column = {c["name"]: c["values"] for c in s["Q"]["columns"]}
    for found, wanted in zip(column["m.at.7500.first_forward.log_decrement"], (0.0438, 0.0052, -0.0334), strict=True):
        h.close("log decrement of the first forward mode", found, wanted, 1e-4)
    d = column["m.at.7500.first_forward.log_decrement"]
    h.close("Q_0 [MN/m]", 1 + d[1] / (d[1] - d[2]), 1.14, 0.01)
    h.true("frequencies beside them", all(f > 0 for f in column["m.at.7500.first_forward.frequency"]))
    h.true("and how many grow", column["m.at.7500.unstable"] == [0, 0, 1], str(column["m.at.7500.unstable"]))


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {f.__name__: f for f in (divergence, equal, fine, level_1, limits, many, missing, softened, stiff, supports, textbook)}[sys.argv[3]](harness)
    harness.finish()
