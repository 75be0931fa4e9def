#!/usr/bin/env python3
"""Elements that are no bearings and static loads, on small decks of tests/cases whose right values are known.

cases_elements.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import math
import subprocess
import sys

import h5py
import numpy as np
from harness import RANKS, Harness, value

HZ = 2 * math.pi


def deck(h, name):
    return h.source / "tests/cases" / f"{name}.yaml"


def same(h, what, a, b, within=1e-9):
    """Two values that have to agree to a part of their size."""
    h.close(what, a, b, within * abs(b) if b is not None else 0)


def pump(h):
    """Seals as elements: pins, map, alignment and place at rest are those of the machine in its two bearings."""
    s, bare = h.run(deck(h, "feed_pump_elements"), "elements", launcher=[]), h.run(deck(h, "feed_pump_bare"), "bare", launcher=[])
    tables = [t["caption"] for t in s["at speed"]["brief"]["tables"]]
    h.true("elements without static load have no row", not any(c.startswith("Elements") for c in tables), str(tables))
    carried = h.run(deck(h, "feed_pump_elements"), "carried", ["elements.drum.static_load=true", "studies=[{static: {name: s, speed: 3000 rpm}}]"], launcher=[])["s"]
    rows = next(t["rows"] for t in carried["brief"]["tables"] if t["caption"].startswith("Elements"))
    h.true("one that carries it has", [r[0] for r in rows] == ["drum"], str(rows))
    h.close("    and the rest of the weight [N]", rows[0][2]["value"], (sum(value(s["at speed"], f"load.{b}") for b in ("DE", "NDE"))
            - sum(value(carried, f"load.{b}") for b in ("DE", "NDE"))), 1e-6)
    h.close("first mode on pins [Hz], not 388.2", value(s["pinned"], "frequency.1") / HZ, 68.2, 0.05)
    for study, what in (("pinned", "frequency"), ("map", "softest"), ("map", "stiffest"), ("align", "reaction"), ("at speed", "load"), ("at speed", "bearing")):
        keys = [k for k in bare[study]["values"] if k.startswith(what + ".") and "uncertainty" not in k]
        h.true(f"{study}: values of {what}", len(keys) > 0)
        for k in keys:
            a, b = value(s[study], k), value(bare[study], k)
            h.close(f"{study}, {k}", a, b, 1e-6 * max(abs(b), 1e-9 if b else 1e-12))
    weight = sum(value(s["align"], f"reaction.{b}") for b in ("DE", "NDE"))
    h.close("weight on both bearings [N]", weight, 196.66 * 9.81, 0.5)
    for name in ("ring1", "ring5", "drum"):
        for axis in "xy":
            h.close(f"{name}: force at rest [N]", value(s["at speed"], f"element.{name}.force.{axis}"), 0, 1e-2)
    h.true("the branch of equilibria", s["branch"]["status"] == "completed", s["branch"]["status"])
    # The seals are in the equations of motion: they damp what the films hardly do. Without their coefficients nothing is left of them.
    none = [f"elements.{e}.{k}=x0" for e in ("*",) for k in ("stiffness", "cross_coupling", "damping", "mass")]
    only = "studies=[{modes: {name: modes, speeds: [5000 rpm], count: 4}}]"
    empty, two = (h.run(deck(h, d), n, o, launcher=[])["modes"]["modes"] for d, n, o in (("feed_pump_elements", "empty", [only, *none]), ("feed_pump_bare", "two bearings", [only])))
    for a, b in zip(empty, two, strict=True):
        same(h, "modes without coefficients", a["imag"], b["imag"], 1e-6)
    def shapes(run):
        """Complex motion (x, y) of the nodes in each mode, of length one."""
        with h5py.File(h.work / run / "results.h5") as f:
            g = f["studies/modes/shapes"]
            z = np.hstack([g[f"{axis}_real"][()] + 1j * g[f"{axis}_imag"][()] for axis in "xy"])
        return z / np.linalg.norm(z, axis=1)[:, None]
    alike = lambda a, b: np.abs(np.sum(shapes(a).conj()[:4] * shapes(b)[:4], axis=1))  # noqa: E731
    h.true("the shapes of the modes without coefficients are those in two bearings", np.all(alike("empty", "two bearings") > 1 - 1e-6), str(alike("empty", "two bearings")))
    h.true("with seals they are others", np.any(alike("elements", "two bearings") < 0.99), str(alike("elements", "two bearings")))
    h.true("modes with seals differ", all(abs(a["imag"] - b["imag"]) > 1 for a, b in zip(s["modes"]["modes"], two)))
    for ranks in map(str, RANKS[1:]):
        few = "studies=[{static: {name: at speed, speed: 5000 rpm}}, {modes: {name: modes, speeds: [5000 rpm], count: 4}}]"
        r = h.run(deck(h, "feed_pump_elements"), f"ranks {ranks}", [few, "layout.machine=all_ranks"], launcher=[*h.launcher, "-n", ranks])
        for a, b in zip(r["modes"]["modes"], s["modes"]["modes"], strict=True):
            same(h, f"modes on {ranks} ranks", a["imag"], b["imag"], 1e-7)
        same(h, f"load on {ranks} ranks", value(r["at speed"], "load.DE"), value(s["at speed"], "load.DE"), 1e-7)


def level_1(h):
    """API level I: the log decrement over the cross-coupling at mid-span, and the cross-coupling at which it is zero."""
    s = h.run(deck(h, "level_1"), "level 1", launcher=[])
    column = {c["name"]: c["values"] for c in s["Q"]["columns"]}
    for q, found, wanted in zip((0, 1e6, 2e6), column["modes.at.7500.first_forward.log_decrement"], (0.0438, 0.0052, -0.0334), strict=True):
        h.close(f"log decrement, Q = {q:g} N/m", found, wanted, 5e-5)
    said = subprocess.run(h.command(deck(h, "level_1"), h.work / "service", ["elements.Q.cross_coupling=1e6 N/m", "service_speed=7500 rpm",
                                    "studies=[{modes: {name: m, speeds: [7500 rpm], count: 3}}]"], launcher=[]), capture_output=True, text=True).stdout
    h.true("at the speed of service the same as in the sweep", "stability: stable" in said and "smallest log decrement: 0.0052178" in said, said)
    hopf = [b for b in s["Q_0"]["bifurcations"] if b["type"] == "hopf"]
    h.true("one Hopf point over Q", len(hopf) == 1)
    h.close("Q_0 [N/m]", hopf[0]["value"] if hopf else None, 1.14e6, 5e3)


def node(h):
    """Two bearings and two seals at one node: the modes of one bearing with the sum of the coefficients, the place at rest of the bearings."""
    one = ["bearings.DE.film={type: linear, stiffness: [2.43e8 N/m, 3e6 N/m, -3e6 N/m, 2.43e8 N/m], damping: 2.9e4 N s/m}"]
    studies = ("studies=[{static: {name: static, speed: 7500 rpm}}, {modes: {name: modes, speeds: [7500 rpm], count: 3}},"
               " {modes: {name: pinned, supports: pinned, count: 2}}, {critical_speed_map: {name: map, stiffness: {from: 1e7 N/m, to: 1e9 N/m}, points: 3, count: 2}}]")
    s, sum_of = h.run(deck(h, "two_at_a_node"), "two", launcher=[]), h.run(deck(h, "steam_turbine"), "one", [*one, studies], launcher=[])
    for a, b in zip(s["modes"]["modes"], sum_of["modes"]["modes"], strict=True):
        same(h, "frequency [rad/s]", a["imag"], b["imag"], 1e-8)
        h.close("log decrement", a["log_decrement"], b["log_decrement"], 1e-8)
    same(h, "pinned, frequency.1", value(s["pinned"], "frequency.1"), value(sum_of["pinned"], "frequency.1"))
    h.true("each bearing has its spring in the map", value(s["map"], "softest.forward.1") > 1.01 * value(sum_of["map"], "softest.forward.1"))
    h.close("weight on three bearings [N]", sum(value(s["static"], f"load.{b}") for b in ("DE", "NDE", "second")), value(s["static"], "mass.total") * 9.81, 1e-3)
    h.close("no load on a seal [N]", value(s["static"], "element.seal.force.y"), 0, 1e-6)


def vertical(h):
    """Belt and thrust as loads are what springs a kilometre away do, of which 2 N/m are left."""
    s, trick = h.run(deck(h, "vertical_pump_loads"), "loads", launcher=[]), h.run(deck(h, "vertical_pump_trick"), "trick", launcher=[])
    for b in ("B1", "B2", "B3", "B4"):
        h.close(f"load on {b} [N]", value(s["s"], f"load.{b}"), value(trick["s"], f"load.{b}"), 0.05)
        for axis in "xy":
            h.close(f"eccentricity of {b}, {axis}", value(s["s"], f"bearing.{b}.eccentricity.{axis}"), value(trick["s"], f"bearing.{b}.eccentricity.{axis}"), 1e-5)
    h.close("sum of the loads [N]", sum(value(s["s"], f"load.{b}") for b in ("B1", "B2", "B3", "B4")), 3000, 1e-3)
    for a, b in zip(s["m"]["modes"], trick["m"]["modes"], strict=True):
        same(h, "frequency [rad/s]", a["imag"], b["imag"], 1e-3)


def of_elements(h):
    """A shaft without damping of its own: two vibrations of its elements at 26.6 kHz grow by 1e-10 of their frequency. They decide on nothing."""
    Q = "elements={Q: {node: 12, role: other, static_load: false, cross_coupling: %s N/m}}"
    studies = ("studies=[{modes: {name: m, speeds: [7500 rpm], count: 4}}, {static: {name: s, speed: 7500 rpm}}, {equilibrium_branch: {name: b, parameter: speed, "
               "range: {from: 7400 rpm, to: 7500 rpm}}}]")
    for cross, grows in (("0.5e6", False), ("2e6", True)):
        s = h.run(deck(h, "steam_turbine"), f"cross {cross}", [Q % cross, studies], launcher=[])
        fast = [m for m in s["m"]["modes"] if m["imag"] > 1e5]
        h.true(f"{cross} N/m: those at 26.6 kHz are not resolved", len(fast) == 2 and all(m["stability"] == "not resolved" for m in fast), str(fast))
        h.close("and counted", value(s["m"], "at.7500.not_resolved"), 2, 0)
        h.true("the sentence passes over them", "not known" not in " ".join(s["m"]["brief"]["sentences"]), str(s["m"]["brief"]["sentences"]))
        h.true("the modes, the place at rest and the branch agree", (s["m"]["values"]["at.7500.unstable"]["value"] > 0) == grows
               and any("unstable" in w for w in s["s"].get("warnings", [])) == grows and s["b"]["stability"] == ("unstable throughout" if grows else "stable throughout"),
               f"{s['s'].get('warnings')} {s['b']['stability']}")


def of_sections(h):
    """Dampers at the ends of a shaft hardly move where its cross-sections only shear (above 3e5 rad/s): damping less than its rounding,
    which makes no machine an undamped one. Without dampers it is one."""
    transfer = ("studies=[{frequency_response: {name: t, speed: 0 rad/s, inputs: [{node: 2, direction: x}], range: {from: 10 rad/s, to: 500 rad/s}, points: 2}}]")
    for n in (20, 40, 60):
        for damped in (True, False)[:1 if n == 60 else 2]:
            more = [f"rotor.segments=[{', '.join(n * ['{length: %g mm, outer_mass_diameter: 40 mm}' % (1000 / n)])}]", f"bearings.right.node={n + 1}",
                    "rotor.internal_damping=0 s", transfer, *([] if damped else ["bearings.*.film.damping=0 N s/m"])]
            s = h.run(deck(h, "shaft_mesh"), f"{n} {damped}", more, launcher=[])["t"]
            h.true(f"{n} elements, dampers: {damped}", s["stability"] == ("stable" if damped else "undamped"), s["stability"])


CASES = {"of_elements": of_elements, "of_sections": of_sections, "pump": pump, "level_1": level_1, "node": node, "vertical": vertical}

if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    for case in CASES.values() if sys.argv[3] == "all" else [CASES[sys.argv[3]]]:
        case(harness)
    harness.finish()
