#!/usr/bin/env python3
"""Bars that once did not cover, and waves of a film's mesh that once passed for whirl.

cases_bars.py PROGRAM SOURCE
"""
import math
import subprocess
import sys

import h5py
import numpy as np
from harness import Harness, value

h = Harness(sys.argv[1], sys.argv[2], [])
CASES = h.source / "tests/cases"


def run(deck, name, *overrides, code=0):
    return h.run(str(CASES / deck), name, overrides, code=code)


def covers(what, found, bar, truth, longest):
    h.true(f"{what}: {found:.8g} +- {bar:.2g} covers {truth:.8g}", abs(found - truth) <= bar, f"error {abs(found - truth):.2g}")
    h.true(f"{what}: its bar is no longer than {longest:g}", bar <= longest)


def flips(studies):
    return [b for b in studies["coarse"]["bifurcations"] if b["type"] == "flip"]


# The second flip on 30 Radau intervals of degree two: the branch born there says supercritical on this mesh (-8.7 +- 0.7 rad/s per
# clearance^2) and subcritical on finer ones (71.9 +- 6.4 on 60 and 160 Gauss intervals of degree four).
b = flips(run("time_mesh.yaml", "criticality"))[-1]
covers("criticality of the second flip", b["criticality_coefficient"], b["criticality_uncertainty"], 71.94, 400)
h.true("which is undetermined on this mesh", b["criticality"] == "undetermined", b["criticality_by"])
fine = flips(run("time_mesh.yaml", "criticality_fine", "studies.1.cycle_branch.intervals=60", "studies.1.cycle_branch.points=gauss"))[-1]
h.true("subcritical on 60 Gauss intervals", fine["criticality"] == "subcritical", fine["criticality_by"])

# A multiplier on 10 Gauss intervals, which the doubled mesh repeats to 5e-6 by chance: 0.971677 +- 1.8e-5.
q = run("time_mesh.yaml", "multiplier", "unbalance.a.planes.1.eccentricity=5 um", "studies.1.cycle_branch.range={from: 395 rad/s, to: 405 rad/s}",
        "studies.1.cycle_branch.intervals=10", "studies.1.cycle_branch.points=gauss",
        "studies.1.cycle_branch.at=[400 rad/s]")["coarse"]["values"]["at.400.multiplier.modulus"]
covers("multiplier at 400 rad/s", q["value"], q["uncertainty"], 0.972015, 5e-3)

# The shaft's own mesh: 629.667 rad/s on 40 elements, where two say 633.075 +- 1e-7.
b = run("shaft_mesh.yaml", "shaft")["whirl"]["bifurcations"][0]
covers("Hopf point of a shaft of two elements", b["value"], b["uncertainty"], 629.66693, 20)
h.true("its bar is that of the shaft", b["uncertainty_shaft_mesh"] > 0.9 * b["uncertainty"])
covers("whirl frequency", b["whirl_frequency_rad_s"], b["uncertainty_whirl_frequency_rad_s"], 497.19625, 20)

# So do the peaks of a response, of shaft nodes and of journals: 497.0793 rad/s, 1148.08 um, 45.5430 um and an amplification of 578.6 on 40
# elements. Bars of cycles leave it out and say so: on 40 elements a second whirl sets in at 679.50 rad/s.
s = run("shaft_mesh.yaml", "response", "unbalance={u: {planes: [{node: 2, amount: 1e-5 kg m}]}, couple: {planes: [{node: 1, amount: 1e-5 kg m}, "
        "{node: 3, amount: 1e-5 kg m, phase: 180 deg}]}}", "rotor.stiffness_damping=1e-6 s",
        "studies=[{unbalance_response: {name: r, unbalance: [u], range: {from: 100 rad/s, to: 640 rad/s}, points: 20, nodes: [2], operating_speed: 490 rad/s}}, "
        "{unbalance_response: {name: still, unbalance: [couple], range: {from: 100 rad/s, to: 640 rad/s}, points: 2, nodes: [2], operating_speed: 490 rad/s}}, "
        "{cycle_branch: {name: c, unbalance: [u], parameter: speed, range: {from: 720 rad/s, to: 640 rad/s}, intervals: 8, degree: 3, points: gauss}}, "
        "{frequency_response: {name: t, speed: 100 rad/s, inputs: [{node: 2, direction: x}], range: {from: 100 rad/s, to: 400 rad/s}, points: 7}}, "
        "{frequency_response: {name: near, speed: 0 rad/s, inputs: [{node: 2, direction: x}], outputs: [{node: 2, direction: x}, {node: 2, direction: slope_x}], "
        "range: {from: 450 rad/s, to: 550 rad/s}, points: 11}}]")
q = s["t"]["values"]["node.2.x.from.node.2.x.largest"]
covers("transfer function at 400 rad/s", q["value"] * 1e6, q["uncertainty"] * 1e6, 2.299986, 0.2)
# Beside a resonance two elements leave more than the answer; in its middle the shaft has no slope (relative error 656 of 2e-20 1/N once).
said = {name: [w for w in s[name]["warnings"] if "the mesh of the shaft (2 elements, rotor.element timoshenko) leaves up to" in w] for name in ("near", "r")}
h.true("a response far off says why", "209 % in these transfer functions: cut the segments shorter" in said["near"][0], str(s["near"]["warnings"]))
h.true("and so do peaks", "1.5 % in the speeds of these peaks and up to " in said["r"][0] and "% in the heights of these peaks and up to " in said["r"][0] and
       said["r"][0].endswith("% in the amplitudes at operating speed: cut the segments shorter"), str(s["r"]["warnings"]))
still = s["still"]["values"]["operating.node.2.semi_major"]
h.true("a node that stands still has no error", still["uncertainty_shaft_mesh"] > 0.1 * still["value"] and still["value"] < 1e-15 and
       not any("the mesh of the shaft" in w for w in s["still"].get("warnings", [])), f"{still} {s['still'].get('warnings')}")
h.true("rounding is no answer and has no relative error", "node.2.slope_x.from.node.2.x.relative_error" not in s["near"]["values"] and
       any("no answer but rounding" in w and "node.2.slope_x.from.node.2.x." in w for w in s["near"]["warnings"]), str(s["near"]))
h.close("what answers has one", s["near"]["values"]["node.2.x.from.node.2.x.relative_error"]["value"], 2.092, 0.005)
peaks = {p["place"]: p for p in s["r"]["peaks"]}
h.true("a peak of the node and of both journals", list(peaks) == ["node 2", "left, journal", "right, journal"], str(list(peaks)))
for place, height in (("node 2", 1148.08e-6), ("left, journal", 45.5430e-6)):
    for what, truth, longest in (("speed", 497.0793, 10), ("semi_major", height, 0.5 * height), ("amplification_factor", 578.6, 250)):
        covers(f"{place}: {what}", peaks[place][what]["value"], peaks[place][what]["uncertainty"], truth, longest)
h.true("bars of cycles say what they leave out", s["c"]["bifurcations"] and any("2 elements of the shaft (rotor.element timoshenko)" in w for w in s["c"]["warnings"]),
       f"{s['c']['bifurcations']} {s['c'].get('warnings')}")

# Modes of the shaft alone, and its critical speeds on springs, on four elements of 0.25 m: torsion k pi c/L, along the shaft held at one
# end (k - 1/2) pi c/L, its fourth mode 10.3 % too high; on pins Timoshenko's beam; free and on springs 80 elements.
alone = ["rotor.segments=[" + ", ".join(["{length: 0.25 m, outer_mass_diameter: 50 mm}"] * 4) + "]", "bearings.right.node=5", "rotor.internal_damping=",
         "studies=[{modes: {name: torsion, motion: torsion, count: 4}}, {modes: {name: axial, motion: axial, held: [1], count: 3}}, {modes: {name: pinned, supports: pinned, count: 4}}, "
         "{modes: {name: free, supports: free, count: 3}}, {critical_speed_map: {name: map, stiffness: {from: 1e7 N/m, to: 1e9 N/m}, points: 7, count: 3}}]"]
s = run("shaft_mesh.yaml", "alone", *alone)
fine = run("shaft_mesh.yaml", "alone_fine", *alone, "rotor.segments=[" + ", ".join(["{length: 12.5 mm, outer_mass_diameter: 50 mm}"] * 80) + "]", "bearings.right.node=81")
e, density, nu, d = 210e9, 7850, 0.3, 0.05
right = {"torsion": [k * math.pi * math.sqrt(e / 2.6 / density) for k in (1, 2, 3, 4)], "axial": [(k - 0.5) * math.pi * math.sqrt(e / density) for k in (1, 2, 3)], "pinned": []}
for k in (1, 2, 3, 4):
    b, shear = (k * math.pi) ** 2, 6 * (1 + nu) / (7 + 6 * nu) * e / 2.6
    first, second, stiff = density * (1 + d**2 / 16 * (1 + e / shear) * b), density**2 * d**2 / 16 / shear, e * d**2 / 16 * b**2
    right["pinned"].append(math.sqrt((first - math.sqrt(first**2 - 4 * second * stiff)) / (2 * second)))
right["free"] = [fine["free"]["values"][f"frequency.{k}"]["value"] for k in (1, 2, 3)]
for name, wanted in right.items():
    for k, truth in enumerate(wanted):
        q, m = s[name]["values"][f"frequency.{k + 1}"], s[name]["modes"][k]
        covers(f"{name} {k + 1} [rad/s]", q["value"], q["uncertainty"], truth, 0.5 * truth)
        h.true("    in its list as well", (m["imag"], m["imag_uncertainty"]) == (q["value"], q["uncertainty"]), str(m))
for name, q in s["map"]["values"].items():
    if name.startswith("s") and "mesh" not in name:
        covers(f"{name} [rad/s]", q["value"], q["uncertainty"], fine["map"]["values"][name]["value"], 0.5 * q["value"])
for name, element in (("torsion", "linear bar elements"), ("free", "rotor.element timoshenko"), ("map", "rotor.element timoshenko")):
    h.true(f"{name}: four elements are few", any(f"(4 elements, {element}) leaves up to" in w for w in s[name]["warnings"]) and not fine[name].get("warnings"),
           f"{s[name].get('warnings')} {fine[name].get('warnings')}")

# A wave of the mesh is said to be one by every study, and is no bifurcation, no threshold and no mode.
waves = run("mesh_wave.yaml", "central")
for name, s in waves.items():
    h.true(f"{name}: the wave of the mesh is said", sum("of the film's mesh" in w for w in s.get("warnings", [])) == 1, str(s.get("warnings")))
for name in ("load", "cycles"):
    s = waves[name]
    h.true(f"{name}: it is no bifurcation and no verdict", not s["bifurcations"] and s["stability"] == "undetermined", f"{s['stability']} {s['bifurcations']}")
    h.true(f"{name}: and no threshold", not any(v.startswith(("threshold", "stable_")) for v in s["values"]), str(s["values"]))
h.true("modes: it is none", waves["modes"]["modes"] and all(m["real"] < 0 for m in waves["modes"]["modes"]), str(waves["modes"]["modes"]))
h.true("static: nothing of the machine grows", not any("unstable" in w for w in waves["at rest"]["warnings"]), str(waves["at rest"]["warnings"]))
# Between the bifurcations of a branch of cycles every point is asked: the multipliers that count are those of the machine.
h.true("cycles: stable up to the wave, not known beyond", [r["stability"] for r in waves["cycles"]["ranges"]] == ["stable", "undetermined"] and
       2.28 < waves["cycles"]["ranges"][0]["to"] < 2.2918 < waves["cycles"]["ranges"][1]["from"] < 2.30, str(waves["cycles"]["ranges"]))
with h5py.File(h.work / "central/results.h5") as f:
    b = f["studies/cycles/branch"]
    h.true("    the points say so", ((b["mesh_waves"][()] > 0) == (b["parameter"][()] > 2.29)).all() and not b["unstable_count"][()].any(), str(b["mesh_waves"][()]))
# A curve of Hopf points over speed and load in such a film, through a Hopf point that a branch over the load finds. Central and upwind
# differences agree within their bars.
curve = {}
for differences in ("central", "upwind"):
    s = run("mesh_wave.yaml", f"curve {differences}", "rotor.load=0.32 N", "bearings.half.film.cells=[30, 4]", f"bearings.half.film.differences={differences}",
            "studies=[{equilibrium_branch: {name: rest, parameter: speed, range: {from: 420 rad/s, to: 450 rad/s}}}, {locus: {name: curve, of: rest, bifurcation: 1, "
            "parameter: rotor.load, range: {from: 0.3 N, to: 0.8 N}, first_range: {from: 400 rad/s, to: 640 rad/s}}}, "
            "{equilibrium_branch: {name: load, parameter: rotor.load, speed: 600 rad/s, range: {from: 0.5 N, to: 0.7 N}}}]")
    with h5py.File(h.work / f"curve {differences}/results.h5") as f:
        table = {k: f["studies/curve/locus"][k][()] for k in ("parameter", "second", "second_uncertainty")}
    order = table["parameter"].argsort()
    at = lambda column: np.interp(600, table["parameter"][order], table[column][order])  # noqa: E731
    hopf = s["load"]["bifurcations"][0]
    h.close(f"{differences}: the curve runs through the Hopf point at 600 rad/s [N]", at("second"), hopf["value"], 2e-4)
    h.true("    no wave of the mesh, nothing else unstable", hopf["type"] == "hopf" and not s["curve"].get("warnings"), str(s["curve"].get("warnings")))
    curve[differences] = at("second"), at("second_uncertainty")
(a, bar_a), (b, bar_b) = curve.values()
h.true(f"{a:.4f} +- {bar_a:.4f} N by central and {b:.4f} +- {bar_b:.4f} N by upwind differences", abs(a - b) <= bar_a + bar_b and max(bar_a, bar_b) < 0.1 * a)
# Without the word the film has no such waves.
plain = run("mesh_wave.yaml", "default", "bearings.half.film={type: compliant_short, compliance: 0.1, reference_speed: 160 rad/s, cells: [40, 4]}")
for name, s in plain.items():
    h.true(f"the default has no waves: {name}", not any("of the film's mesh" in w for w in s.get("warnings", [])), str(s.get("warnings")))
for name in ("load", "cycles"):
    h.true(f"the default is stable: {name}", not plain[name]["bifurcations"] and plain[name]["stability"] == "stable throughout", plain[name]["stability"])

# A contact that the mesh makes: 182 N on 30 cells, 1363 N on 120, 3476 N on 240. It has no limit and no bar, and says so.
touch = run("contact.yaml", "contact")["load"]
q = touch["values"]["contact"]
h.close("contact on 60 cells [N]", q["value"], 520.57, 1e-3)
h.true(f"it has no bar: {q['uncertainty']}", q["uncertainty"] is None)
said = " ".join(w for w in touch["warnings"] if "says nothing about the machine" in w)
h.true("and says why, with the places on other meshes", "has no limit" in said and "182" in said and "136" in said, str(touch["warnings"]))

# One eigenvalue, one bar: a mode at a speed just below its critical speed and the critical speed itself, the former at a speed with
# other meshes, the latter between two of these.
beside = 4023.184 * 0.9995
s = run("friswell_596.yaml", "one_bar", "studies=[{modes: {name: m, range: {from: 1000 rpm, to: 6000 rpm}, points: 4, count: 8}}]",
        f"service_speed={beside} rpm")["m"]
mode, here = value(s, "critical.3.mode"), s["values"]["critical.3.log_decrement"]["uncertainty"]
there = [m["log_decrement_uncertainty"] for m in s["modes"] if abs(m["speed"] - beside) < 1e-6 * beside and m["mode"] == mode]
h.true("the mode is listed there", len(there) == 1, str(there))
h.close("bar of the log decrement of mode and critical speed", here, there[0], 0.01 * there[0])

# Tolerances looser than those that bars stand on are refused: a Hopf point 9.8 rad/s off with a bar of 4e-5.
for option in (["-newton_snes_atol", "1e10"], ["-newton_snes_rtol", "1e-3"], ["-newton_snes_convergence_test", "skip"]):
    done = subprocess.run([h.program, "run", str(CASES / "time_mesh.yaml"), "-o", str(h.work / "loose"), "--", *option], capture_output=True, text=True)
    h.true(f"{' '.join(option)} is refused by name", done.returncode == 2 and option[0] in done.stderr, f"exit {done.returncode} {done.stderr}")

# Growth of a mode at 1380 rpm, alone and behind other speeds: once 0.03624 and 0.03626 1/s with bars of 3e-7, by where Newton's method ended.
for name, speeds in (("one speed", "1380 rpm"), ("behind others", "1345 rpm, 1380 rpm, 1600 rpm")):
    found = run("turbocharger.yaml", name, "studies=[{modes: {name: m, speeds: [%s], count: 2}}]" % speeds)["m"]["modes"]
    first = next(m for m in found if m["speed"] == 1380)
    covers(f"growth at 1380 rpm, {name} [1/s]", first["real"], first["real_uncertainty"], 0.03625077, 3e-6)

# Close to its threshold on a coarse mesh, 1283 +- 46 rpm, nobody knows on either side whether the first mode grows.
found = run("turbocharger.yaml", "close", "bearings.*.film={type: reynolds, cells: [24, 4]}",
            "studies=[{modes: {name: m, speeds: [1000 rpm, 1275 rpm, 1291 rpm], count: 1}}]")["m"]["modes"]
h.true("stable far from the threshold, undetermined close to it", [m["stability"] for m in found] == ["stable", "undetermined", "undetermined"]
       and found[1]["real"] < 0 < found[2]["real"], str(found))

# Elements with derivatives as freedoms, undamped on equal springs: near rest eigenvalues were once off by 1e-3, with damping that is none.
for name, speed in (("slow", "0.001"), ("slower than the first mode", "1")):
    s = run("../../inputs/merot/disc_rotor.yaml", name, "rotor.element=timoshenko_hermitian",
            "studies=[{modes: {name: m, supports: films, speeds: [%s rad/s], count: 4}}]" % speed)["m"]
    h.true(f"{speed} rad/s: no mode has damping", all(m["stability"] == "undamped" for m in s["modes"]), str(s["modes"]))
    for m in s["modes"][:2]:
        h.close("the first two frequencies [Hz]", m["imag"] / (2 * math.pi), 196.6453, 0.002)
first = value(s, "at.1.first_forward.frequency")
h.close("first mode of forward whirl [Hz]", None if first is None else first / (2 * math.pi), 196.646, 0.002)

# Without bars no study solves on other meshes: no number has a bar, and what rests on one is undetermined.
NONE = ("studies=[{static: {speed: 320 rad/s}}, {modes: {speeds: [320 rad/s], count: 4}}, {unbalance_response: {unbalance: [a], range: {from: 300 rad/s, "
        "to: 500 rad/s}, points: 9}}, {frequency_response: {speed: 320 rad/s, range: {from: 100 rad/s, to: 400 rad/s}, points: 4, inputs: [{bearing: half, "
        "direction: x}]}}, {equilibrium_branch: {name: rest, parameter: speed, range: {from: 400 rad/s, to: 460 rad/s}}}, {cycle_branch: {name: cycles, "
        "unbalance: [a], parameter: speed, range: {from: 320 rad/s, to: 330 rad/s}, intervals: 12, degree: 2, adapt_mesh: false, at: [322 rad/s]}}]")
done = subprocess.run(h.command(h.source / "inputs/compliant_rotor/short.yaml", h.work / "none", ["bearings.half.film.cells=[16, 4]", NONE], bars=False),
                      capture_output=True, text=True)
found = h.studies("none")
h.true("all studies end", done.returncode == 0 and len(found) == 6 and all(s["points"] > 0 for s in found.values()), done.stdout + done.stderr)
h.true("no bar on the screen, and why, once", "+-" not in done.stdout and done.stdout.count("the errors of the meshes are not estimated") == 1, done.stdout)
h.true("none in the results", not any(isinstance(x, float) for s in found.values() for e in [*s["values"].values(), *s["bifurcations"], *s.get("modes", [])]
                                      for k, x in e.items() if "uncertainty" in k and k != "uncertainty_location"), str(found)[:2000])
b = found["rest"]["bifurcations"][0]
h.true("what needs a bar is undetermined", b["type"] == "hopf" and b["criticality"] == "undetermined" and "has no error bar" in b["criticality_by"], str(b))
h.true("stability is that of the mesh", found["rest"]["stability"] == "loses stability" and found["cycles"]["stability"] == "stable throughout",
       f"{found['rest']['stability']}, {found['cycles']['stability']}")
said = (h.work / "none/summary.json").read_text()
h.true("the results say it once", said.count("the errors of the meshes are not estimated") == 1)

h.finish()
