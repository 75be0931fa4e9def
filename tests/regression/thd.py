#!/usr/bin/env python3
"""Runs bearings with heat against an independent computation.

thd.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import sys

import h5py
import numpy
from harness import Harness, value

SUPPLY, BUSH = "cool gas", "preheated gas"


def walls(h):
    """Walls of 300 K: temperatures, heat, power over the speed."""
    reference = json.loads((h.source / "tests/reference/thd/bearing_a.json").read_text())
    found = h.run("../thd/bearing_a.yaml", "walls")["bearing A"]
    fast = reference["walls_300K"][0]
    h.close("mean temperature [K]", value(found, "temperature.mean"), fast["T_mean"], 0.03)
    h.close("1st percentile [K]", value(found, "temperature.percentile_1"), fast["T_p01"], 0.1)
    h.close("99th percentile [K]", value(found, "temperature.percentile_99"), fast["T_p99"], 0.1)
    h.close("heat to the bush [W]", value(found, "heat.bush"), fast["Q_bush"], 0.1)
    h.close("heat to the journal [W]", value(found, "heat.journal"), fast["Q_journal"], 0.1)
    h.close("power loss [W]", value(found, "power_loss"), fast["Ploss"], 0.05)
    h.close("consumption [kg/s]", value(found, "mass_flow"), fast["mdot"], 0.001 * fast["mdot"])
    h.close("load [N]", numpy.hypot(value(found, "load.x"), value(found, "load.y")), fast["W"], 0.002 * fast["W"])
    # The reference's is 0.413 %, this one 0.368 % (0.435 and 0.391 % on 288 x 96 x 8 cells): it lies beside an orifice, where
    # temperatures do not converge with the mesh.
    h.close("change of the pressure against isothermal", value(found, "pressure_change"), fast["dp_max_rel"], 0.0006)
    h.close("what heats the film is what the shaft loses [W]", value(found, "heat.film"), value(found, "power_loss"), 1e-9 * fast["Ploss"])
    h.close("balance of the energy [W]", value(found, "energy_residual"), 0, 1e-8 * fast["Ploss"])
    with h5py.File(h.work / "walls/results.h5") as f:
        budget = f["studies/bearing A/budget"]
        for k, row in enumerate(reference["speed_sweep"]):
            at = f"{row['omega']:.0f} rad/s: "
            h.close(at + "power loss [W]", budget["power_loss"][k], row["Ploss"], 0.001 * row["Ploss"])
            h.close(at + "heat to the walls [W]", budget["heat_bush"][k] + budget["heat_journal"][k], row["Q_bush"] + row["Q_journal"], 0.1)
            h.close(at + "mean temperature [K]", budget["mean_temperature"][k], row["T_mean"], 0.03)
        h.close("at rest nothing is heated [W]", budget["heat"][0], 0, 1e-9)
        shape = f["studies/bearing A/film/temperature"].shape
        h.true("field of temperature", shape == (33, 96, 8), f"{shape}")


def solids(h):
    """Shaft and bush that carry the heat away."""
    rows = json.loads((h.source / "tests/reference/thd/bearing_a.json").read_text())["solids"]
    found = h.run("../thd/solids.yaml", "solids")
    cases = {BUSH: ("base", "bush"), SUPPLY: ("base", "ambient"), "adiabatic bore": ("no convection in bore", "bush"), "standstill": ("standstill", "bush")}
    for name, (case, inlet) in cases.items():
        row = next(r for r in rows if r["case"] == case and r["inlet"] == inlet)
        rise = row["dT_film_mean"]
        h.close(f"{name}: mean rise [K]", value(found[name], "temperature.mean") - 300, rise, max(0.01 * abs(rise), 0.1))
        h.close(f"{name}: power loss [W]", value(found[name], "power_loss"), row["Ploss"], 0.005 * row["Ploss"])
        if name != "standstill":
            for side in ("bush", "journal"):
                h.close(f"{name}: heat to the {side} [W]", value(found[name], f"heat.{side}"), row[f"Q_{side}"], 0.02 * row["Ploss"])
        h.close(f"{name}: balance of the energy [W]", value(found[name], "energy_residual"), 0, 1e-8 * max(row["Ploss"], 1))


def oil(h):
    """An oil bearing with a groove: bush of bronze, cold, and without heat."""
    few = ["studies.*.thd.cells=[72, 16, 10]"]
    found = h.run("../thd/oil_groove.yaml", "oil", few)
    bronze, cold, none = (found[name] for name in ("bronze bush", "cold bush", "bush without heat"))
    peak = [value(s, "temperature.maximum") for s in (cold, bronze, none)]
    h.true("the film is warmest where the bush takes no heat", peak[0] < peak[2] and peak[1] < peak[2], f"{peak} K")
    at_bush = [value(s, "temperature.bush.maximum") for s in (cold, bronze, none)]
    h.true("peak of the bush between cold and without heat", at_bush[0] < at_bush[1] < at_bush[2], f"{at_bush} K")
    with h5py.File(h.work / "oil/results.h5") as f:
        peaks = f["studies/bronze bush/budget/peak_bush_temperature"][:]
        budget = {k: f[f"studies/bronze bush/budget/{k}"][:] for k in ("heat", "heat_bush", "heat_journal", "enthalpy")}
    h.true("it rises with the speed", all(numpy.diff(peaks) > 0), f"{peaks} K")
    for k, heat in enumerate(budget["heat"]):
        h.close(f"point {k + 1}: heat that leaves [W]", budget["heat_bush"][k] + budget["heat_journal"][k] + budget["enthalpy"][k], heat, 1e-8 * heat)
    fine = h.run("../thd/oil_groove.yaml", "fine", ["studies.*.thd.cells=[108, 24, 15]", "studies.*.thd.speeds=[4000 rpm]"])
    h.close("peak of the bush on a finer mesh [K]", value(fine["bronze bush"], "temperature.bush.maximum"), at_bush[1], 1)


def ranks(h):
    """The same on 1, 2 and 3 ranks."""
    few = ["studies.*.thd.cells=[24, 12, 4]"]
    for n in (1, 2, 3):
        h.run("../thd/solids.yaml", f"ranks_{n}", few, launcher=[*h.launcher, "-n", str(n)])
        if n == 1:
            continue
        alone, shared = ({s: v["values"] for s, v in h.studies(f"ranks_{k}").items()} for k in (1, n))
        for study, values in alone.items():
            for key, entry in values.items():
                # What the balance leaves is rounding; small heats at standstill are those of ends of 0.1 mg/s.
                size = 1e-3 if key.startswith(("heat", "energy")) else 0
                if key.startswith(("iterations", "energy_residual")):
                    continue
                h.close(f"{n} ranks, {study}: {key}", shared[study][key]["value"], entry["value"], 1e-7 * max(abs(entry["value"]), size))
        with h5py.File(h.work / "ranks_1/results.h5") as one, h5py.File(h.work / f"ranks_{n}/results.h5") as other:
            for path in ("film/temperature", "film/pressure", "bush/temperature", "journal/temperature"):
                a, b = (f[f"studies/preheated gas/{path}"][:] for f in (one, other))
                h.close(f"{n} ranks: {path}", numpy.abs(a - b).max() / numpy.abs(a).max(), 0, 1e-7)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"walls": walls, "solids": solids, "oil": oil, "ranks": ranks}[sys.argv[3]](harness)
    harness.finish()
