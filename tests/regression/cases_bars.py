#!/usr/bin/env python3
"""Bars that once did not cover, and waves of a film's mesh that once passed for whirl.

cases_bars.py PROGRAM SOURCE
"""
import subprocess
import sys

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
# Without the word the film has no such waves.
plain = run("mesh_wave.yaml", "default", "bearings.half.film={type: compliant_short, compliance: 0.1, reference_speed: 160 rad/s, cells: [40, 4]}")
for name, s in plain.items():
    h.true(f"the default has no waves: {name}", not any("mesh" in w for w in s.get("warnings", [])), str(s.get("warnings")))
for name in ("load", "cycles"):
    h.true(f"the default is stable: {name}", not plain[name]["bifurcations"] and plain[name]["stability"] == "stable throughout", plain[name]["stability"])

# A contact that the mesh makes: 182 N on 30 cells, 1363 N on 120, 3476 N on 240. It has no limit and no bar, and says so.
touch = run("contact.yaml", "contact")["load"]
q = touch["values"]["contact"]
h.close("contact on 60 cells [N]", q["value"], 520.57, 1e-3)
h.true(f"it has no bar: {q['uncertainty']}", q["uncertainty"] is None)
said = " ".join(w for w in touch["warnings"] if "says nothing about the machine" in w)
h.true("and says why, with the places on other meshes", "has no limit" in said and "182" in said and "136" in said, str(touch["warnings"]))

# Tolerances looser than those that bars stand on are refused: a Hopf point 9.8 rad/s off with a bar of 4e-5.
for option in (["-newton_snes_atol", "1e10"], ["-newton_snes_rtol", "1e-3"], ["-newton_snes_convergence_test", "skip"]):
    done = subprocess.run([h.program, "run", str(CASES / "time_mesh.yaml"), "-o", str(h.work / "loose"), "--", *option], capture_output=True, text=True)
    h.true(f"{' '.join(option)} is refused by name", done.returncode == 2 and option[0] in done.stderr, f"exit {done.returncode} {done.stderr}")

h.finish()
