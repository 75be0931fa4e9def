#!/usr/bin/env python3
"""Runs decks of inputs/aerostatic and compares loads and flows with those computed independently.

aerostatic.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
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


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"loads": loads}[sys.argv[3]](harness)
    harness.finish()
