#!/usr/bin/env python3
"""Runs decks of inputs/aerostatic and compares loads and flows with those computed independently.

aerostatic.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import cmath
import json
import math
import subprocess
import sys

import h5py

from harness import Harness, value


def reference(h, name):
    return json.loads((h.source / "tests/reference/gas" / name).read_text())


def loads(h):
    deck = h.source / "inputs/aerostatic/gas_bearing.yaml"
    r = h.run(deck, "whole", launcher=[])
    wanted = reference(h, "loads.json")
    s = r["load over eccentricity"]
    for e in wanted["loads"]:
        head = f"speed.{e['omega']:g}.eccentricity.{e['eps']:g}."
        for name, key in (("load", "W"), ("mass_flow", "mdot"), ("power_loss", "Ploss")):
            h.close(head + name, value(s, head + name), e[key], 0.005 * e[key])
            h.true("    its bar covers what is left", abs(value(s, head + name) - e[key]) <= 1.5 * s["values"][head + name]["uncertainty"] + 1e-5 * e[key])
    with h5py.File(h.work / "whole" / "results.h5") as f:
        curves = f["studies/load over eccentricity/curves"]
        h.true("at most 12 factorisations from a cold start", curves["factorisations"][()].max() <= 12)
        map_ = f["studies/design/map"]
        for e in wanted["map"]:
            at = [[k for k, v in enumerate(map_[name][()]) if abs(v - e[key]) < 1e-9] for name, key in (("clearance", "c"), ("diameter", "d_o"))]
            if all(at):
                h.close(f"load at c = {e['c']:g} m, d = {e['d_o']:g} m", map_["load"][at[0][0], at[1][0]], e["W"], 0.005 * e["W"])
                h.close("    mass flow", map_["mass_flow"][at[0][0], at[1][0]], e["mdot"], 0.005 * e["mdot"])
    under = r["under its rotor"]
    h.close("order of the load", value(under, "meshes.order"), 2, 0.3)
    h.true("a node source does not converge", value(under, "meshes.order_of_node_source") < 0.3)
    # 0.3 MPa at rest: no equilibrium, and the most it carries; with rotation there is one.
    weak = ["bearings.A.film.orifices.1.supply=0.3 MPa", "studies=[{gas_bearing: {name: weak, speeds: [0 rad/s], eccentricities: [0.78], load: 49.05 N}}]"]
    none = h.run(deck, "weak", weak, launcher=[], code=None)["weak"]
    h.true("no equilibrium at 0.3 MPa at rest", "no equilibrium" in none["status"], none["status"])
    at_most = value(none, "capacity.load")
    h.close("the most is what it carries at that place", value(none, "speed.0.eccentricity.0.78.load"), at_most, 1e-3 * at_most)
    h.true("    which is below its load", at_most < 49.05)


def tables(h):
    """All loads, flows and losses of the independent computation, bearings A and B; sources over the mesh; other data."""
    wanted = reference(h, "tables.json")
    deck = h.source / "inputs/aerostatic/gas_bearing.yaml"
    numbers = lambda of, unit="": "[" + ", ".join(f"{x:.12g}{unit}" for x in of) + "]"

    def run(name, speeds, eccentricities, bearing="A", supply=5e5, changes=()):
        ring = "{count: 8, diameter: 0.2 mm, supply: %g Pa, %s}"
        rings = ", ".join(ring % (supply, f"z: {z} mm") for z in ([0] if bearing == "A" else [-7.5, 7.5]))
        study = f"{{name: s, speeds: {numbers(speeds, ' rad/s')}, eccentricities: {numbers(eccentricities)}}}"
        return h.run(deck, name, [f"bearings.A.film.orifices=[{rings}]", f"studies=[{{gas_bearing: {study}}}]", *changes], launcher=[])["s"]

    def same(study, what, wanted, speed, eccentricity, within=0.005):
        head = f"speed.{speed:.6g}.eccentricity.{eccentricity:g}."
        for name, key in (("load", "W"), ("mass_flow", "mdot"), ("power_loss", "Ploss")):
            if key in wanted:
                h.close(f"{what}: {name}", value(study, head + name), wanted[key], max(within * abs(wanted[key]), 1e-6 if key == "Ploss" else 0))

    for bearing, supply in sorted({(t["bearing"], t["ps"]) for t in wanted["tables"]}):
        rows = [t for t in wanted["tables"] if (t["bearing"], t["ps"]) == (bearing, supply)]
        s = run(f"{bearing} {supply / 1e6:g}", sorted({t["omega"] for t in rows}), sorted({t["eps"] for t in rows}), bearing, supply)
        for t in rows:
            same(s, f"{bearing}, {supply / 1e6:g} MPa, {t['omega']:g} rad/s, {t['eps']:g}", t, t["omega"], t["eps"])
    s = run("speeds", [t["omega"] for t in wanted["speeds"]], [0.5])
    for t in wanted["speeds"]:
        same(s, f"{t['omega']:g} rad/s", t, t["omega"], 0.5)
    for t in wanted["meshes"]:
        if t["N"] < 384:
            name = f"{t['bearing']} {t['source']} {t['N']}"
            s = run(name, [1000], [0.6], t["bearing"], changes=[f"bearings.A.film.cells=[{t['N']}, {t['M']}]", f"bearings.A.film.source={t['source']}"])
            same(s, name, t, 1000, 0.6, 2e-4)
    row = "bearings.A.film.orifices.1."
    for name, changes in (("base", []), ("between_orifices", [row + "angle=22.5 deg"]), ("pa_1e5", ["bearings.A.film.ambient=1e5 Pa"]),
                          ("mu_1.8e-5", ["lubricants.air.viscosity=18 uPa s"]), ("T_293", ["bearings.A.film.temperature=293 K", "lubricants.air.viscosity=18.1 uPa s"]),
                          ("ps_gauge", [row + "supply=601325 Pa"]), ("curtain_area_model", [row + "law=curtain"])):
        same(run(name, [1000], [0.6], changes=changes), name, wanted["changes"][name], 1000, 0.6)


def linear(number, slender):
    """Load over p_a L D eps and attitude of a small eccentricity, of a bearing number and L/D."""
    k = cmath.sqrt(1 + 1j * number)
    load = math.pi / 2 * 1j * number / (1 + 1j * number) * (1 - cmath.tanh(k * slender) / (k * slender))
    return abs(load), cmath.phase(load)


def pockets(h):
    deck, row = h.source / "inputs/aerostatic/pockets.yaml", "bearings.A.film.orifices.1"
    whole = h.run(deck, "whole", launcher=[])
    bare = h.run(deck, "bare", ["bearings.A.film.orifices=[{count: 8, diameter: 0.2 mm, supply: 0.6 MPa}]"], launcher=[])
    fine = h.run(deck, "fine", ["bearings.A.film.cells=[96, 32]", "studies=[{gas_bearing: {name: load, speeds: [1000 rad/s], eccentricities: [0.5]}}]"],
                 launcher=[])
    deep = h.run(deck, "deep", [f"{row}.pocket.depth=4 mm"], launcher=[])
    at = "speed.1000.eccentricity.0.5."
    for name in ("load", "mass_flow"):
        v = whole["load"]["values"][at + name]
        h.close(f"{name} within its bar of a finer mesh", v["value"], value(fine["load"], at + name), v["uncertainty"])
        h.true(f"{name}: pockets carry half as much again, for gas", 1.4 < v["value"] / value(bare["load"], at + name) < 1.6)
    b = [value(s["coefficients"], "speed.1000.ratio.0.1.C.xx") for s in (bare, whole, deep)]
    h.true("volumes of pockets take damping away, down to below zero", b[0] > b[1] > 0 > b[2], str(b))
    for changes, said in (([f"{row}.law=thickness"], "two_restrictors"), ([f"{row}.law=curtain"], "without pocket"),
                          ([f"{row}.pocket.diameter=0.1 mm"], "wider than its orifice"), ([f"{row}.z=14.5 mm"], "lie within the bearing"),
                          (["bearings.A.geometry={type: lemon_bore, radius: 15 mm, length: 30 mm, clearance: 20 um, arc: 150 deg}",
                            "bearings.A.film.lobes={count: 3}"], "a cylindrical bore")):
        done = subprocess.run(h.command(deck, h.work / "no", changes), capture_output=True, text=True, timeout=100)
        h.true(f"refused: {changes[-1]}", done.returncode == 2 and said in done.stderr, done.stderr.strip()[:300])


def self_acting(h):
    deck = h.source / "inputs/aerostatic/self_acting.yaml"
    s = h.run(deck, "whole", launcher=[])["load"]
    for e in ("0.2", "0.4", "0.6"):
        h.true(f"{e}: carries more with the speed, and more in line", value(s, f"speed.3000.eccentricity.{e}.load") > 1.5 * value(s, f"speed.1000.eccentricity.{e}.load")
               and value(s, f"speed.3000.eccentricity.{e}.attitude") < value(s, f"speed.1000.eccentricity.{e}.attitude"))
    # A circle at a small eccentricity: films_and_rotors.md sec. 6.1.
    number, slender = 1.0, 1.0
    speed = number * 101325 / (6 * 18.46e-6) * (10e-6 / 15e-3) ** 2
    study = f"studies=[{{gas_bearing: {{name: small, speeds: [{speed:.12g} rad/s], eccentricities: [0.01]}}}}]"
    c = h.run(deck, "circle", ["bearings.A.film.lobes=null", "bearings.A.film.cells=[96, 32]", study], launcher=[])["small"]
    load, attitude = linear(number, slender)
    head = f"speed.{speed:.6g}.eccentricity.0.01."
    h.close("load at a small eccentricity", value(c, head + "load") / (101325 * 0.03 * 0.03 * 0.01), load, 2.5e-3 * load)
    h.close("    attitude", value(c, head + "attitude"), attitude, 2e-3)


def slip(h):
    deck = h.source / "inputs/aerostatic/slip.yaml"
    number = 6 * 18.46e-6 * 40 / 101325 * (5e-3 / 1e-6) ** 2
    knudsen = 18.46e-6 / 101325 * math.sqrt(math.pi * 286.7 * 300 / 2) / 1e-6
    head = "speed.40.eccentricity.0.01."
    for name, factor in (("none", 1), ("first", 1 + 6 * knudsen), ("second", 1 + 6 * knudsen + 6 * knudsen**2)):
        s = h.run(deck, name, [f"bearings.A.film.slip={name}", "bearings.A.film.cells=[96, 32]"], launcher=[])["load"]
        load, attitude = linear(number / factor, 1)
        h.close(f"{name}: load", value(s, head + "load"), load * 101325 * 0.01 * 0.01 * 0.01, 2.5e-3 * value(s, head + "load"))
        h.close("    attitude", value(s, head + "attitude"), attitude, 2e-3)
        # 0.0669 over the thickness at the largest eccentricity, beyond 0.01 and within 0.1 and 1.
        h.true("    warned of beyond the law of slip", any("law of slip" in w for w in s.get("warnings", [])) == (name != "second" and knudsen / 0.6 > {"none": 0.01, "first": 0.1}[name]),
               str(s.get("warnings")))
    studies = "studies=[{bearing_map: {name: map, speed: 40 rad/s, points: 2, max_eccentricity: 0.4}}]"
    s = h.run(deck, "elsewhere", ["bearings.A.film.slip=none", "bearings.A.film.cells=[24, 8]", studies], launcher=[], bars=False)["map"]
    h.true("    a map as well", any(f"A ({knudsen / 0.6:.4g})" in w and "law of slip" in w for w in s.get("warnings", [])), str(s.get("warnings")))
    h.run(deck, "whole", launcher=[])


def supply(h):
    found = h.run(h.source / "inputs/aerostatic/supply.yaml", "whole", launcher=[])
    [at] = found["supply"]["bifurcations"]
    [by_speed] = found["speed"]["bifurcations"]
    h.true("both are Hopf points", at["type"] == by_speed["type"] == "hopf")
    h.close("the speed of the threshold [rad/s]", by_speed["value"], 2641, 1)
    h.close("the supply at which this is the threshold [MPa]", at["value"], 0.6, 5e-4)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"loads": loads, "tables": tables, "pockets": pockets, "self_acting": self_acting, "slip": slip, "supply": supply}[sys.argv[3]](harness)
    harness.finish()
