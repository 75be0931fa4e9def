#!/usr/bin/env python3
"""Linear responses of small machines: false peaks, unstable equilibria, amplification, sense, the service speed.

cases_response.py PROGRAM SOURCE MPIRUN...
"""
import json
import subprocess
import sys

import h5py
import numpy as np
from harness import Harness, kill, value


def whole(h, name):
    return json.loads((h.work / name / "summary.json").read_text())


def peaks(study, place):
    return [p for p in study.get("peaks", []) if p["place"] == place]


def warned(study, *words):
    return any(all(w in line for w in words) for line in study.get("warnings", []))


def false_peaks(h):
    """A thd film whose equilibria are known to their tolerance: node 4 rises at 2044 rpm, node 20 has one peak."""
    s = h.run(h.source / "tests/cases/false_peaks.yaml", "false_peaks")["r"]
    h.true("node 4 has no peak where it rises", not any(2030 < p["speed"]["value"] < 2060 for p in peaks(s, "node 4")), str(peaks(s, "node 4")))
    near = [p for p in peaks(s, "node 20") if 2030 < p["speed"]["value"] < 2060]
    h.true("node 20 has one peak there", len(near) == 1, str(near))
    h.close("its speed [rpm]", near[0]["speed"]["value"], 2044.2, 0.5)
    h.close("its height [um]", near[0]["semi_major"]["value"] * 1e6, 22.304, 0.005)
    h.true("why it has no amplification factor", "before the range ends" in near[0]["notes"][0], str(near[0]))
    h.true("few speeds are added to the 40", s["points"] < 120, str(s["points"]))
    # The values of this node at two speeds, without any refinement.
    for speed, height in ((2042.0, 26.531), (2057.1, 26.845)):
        at = h.run(h.source / "tests/cases/false_peaks.yaml", f"at {speed}", [f"studies.1.unbalance_response={{name: r, unbalance: [three_planes], range: {{from: {speed} rpm, to: {speed + 1} rpm}}, points: 2, nodes: [4], operating_speed: {speed} rpm, refine: false}}"])["r"]
        h.close(f"node 4 at {speed} rpm [um]", value(at, "operating.node.4.semi_major") * 1e6, height, 0.002)


def always_unstable(h):
    s = h.run(h.source / "tests/cases/always_unstable.yaml", "always_unstable")["r"]
    h.true("unstable wherever it is counted", s["stability"].startswith("unstable at the ") and s["stability"].endswith(" speeds counted"), s["stability"])
    h.true("a warning", warned(s, "unstable from 400 to 4000 rpm", "no vibration settles"), str(s.get("warnings")))
    h.true("every peak is marked", s["peaks"] and all(p["stability"] == "unstable" for p in s["peaks"]), str(s["peaks"]))
    h.true("the largest peaks are there", len(peaks(s, "node 3")) == 2, str(peaks(s, "node 3")))
    h.true("what speeds on flanks show is settled", not any("not settled" in note for p in s["peaks"] for note in p.get("notes", [])), str(s["peaks"]))
    transfer = "studies=[{frequency_response: {name: t, speed: 4000 rpm, inputs: [{node: 3, direction: x}], range: {from: 10 rad/s, to: 500 rad/s}, points: 20}}]"
    s = h.run(h.source / "tests/cases/always_unstable.yaml", "transfer", [transfer])["t"]
    h.true("transfer functions know it", s["stability"] == "unstable" and warned(s, "at 4000 rpm the equilibrium is unstable", "No vibration settles"), str(s.get("warnings")))
    s = h.run(h.source / "tests/cases/always_unstable.yaml", "linearity", ["studies=[{linearity: {name: l, speed: 400 rpm, node: 3, levels: [1 N], cutoff: 300 Hz, "
              "highest: 100 Hz, duration: 0.5 s, segments: 4, settle: 0.02 s}}]"])["l"]
    h.true("so does linearity", s["stability"] == "unstable" and warned(s, "at 400 rpm the equilibrium is unstable", "that the motion is compared with"), str(s.get("warnings")))
    # Damped evenly the springs that are coupled across bring no instability.
    s = h.run(h.source / "tests/cases/always_unstable.yaml", "damped", [transfer, "bearings.*.film.damping=2e4 N s/m"])["t"]
    h.true("damped, it is stable", s["stability"] == "stable" and not warned(s, "unstable"), f"{s['stability']} {s.get('warnings')}")


def past_threshold(h):
    """The threshold is 9572.6 +- 5.7 rpm."""
    s = h.run(h.source / "tests/cases/past_threshold.yaml", "past_threshold", ["studies.3.unbalance_response.points=23"])["unbalance_response"]
    unstable, = [w for w in s["warnings"] if "equilibrium is unstable" in w]
    h.true("the gravest warning stands first", s["warnings"][0] == unstable and len(s["warnings"]) > 1, str(s["warnings"]))
    low, high = float(unstable.split("stable at ")[1].split(")")[0]), float(unstable.split("unstable from ")[1].split(" to ")[0])
    h.true("unstable from the threshold on", low < 9572.6 + 5.7 and high > 9572.6 - 5.7 and high - low <= 501, unstable)
    h.true("to the end", "to 12000 rpm" in unstable, unstable)


def turbine(h):
    """Amplification factors of 72; the service speed opens the results."""
    out = h.run(h.source / "tests/cases/steam_turbine.yaml", "turbine", ["service_speed=7500 rpm", "studies.1.modes.points=13", "studies.2.unbalance_response.points=60"])
    s = out["G2.5"]
    high = [p for p in s["peaks"] if (p["amplification_factor"]["value"] or 0) > 60]
    h.true("a peak with an amplification of 72", any(abs(p["amplification_factor"]["value"] - 72.5) < 0.3 for p in high), str(high))
    h.true("is warned of with its number", warned(s, "amplification factors above 30: 72.5 at 5141 rpm"), str(s.get("warnings")))
    h.true("the modes warn as well", warned(out["Campbell"], "amplification factors above 30"), str(out["Campbell"].get("warnings")))
    h.close("operating speed [rpm]", value(s, "operating_speed"), 7500, 1e-9)
    service = whole(h, "turbine")["service_speed"]
    facts = {f["what"]: f for f in service["facts"]}
    h.close("service speed", service["value"], 7500, 1e-9)
    h.true("stable there", facts["stability"]["mark"] == "stable", str(facts["stability"]))
    h.true("critical speeds on either side or one", "critical speed below" in facts, str(facts))
    h.close("largest vibration [m]", facts["largest vibration"]["value"], max(v["value"] for k, v in s["values"].items() if k.startswith("operating.node.")), 1e-9)
    h.true("springs have no film", "thinnest film" not in facts, str(facts))
    h.true("far enough from it", "TOO NEAR" not in facts["critical speed below"]["mark"], str(facts))
    # API 684: below the operating speed 17 % (1 - 1/(AF - 1.5)), with an AF of 73.
    h.run(h.source / "tests/cases/steam_turbine.yaml", "near", ["service_speed=5300 rpm", "studies=[{modes: {range: {from: 4000 rpm, to: 6000 rpm}, points: 5, count: 4}}]"])
    near = next(f for f in whole(h, "near")["service_speed"]["facts"] if f["what"] == "critical speed below")
    h.true("3 % above a critical speed", near["mark"].startswith("3.0 %") and near["mark"].endswith("TOO NEAR: 17 % required"), str(near))


def pump(h):
    """Water in plain bearings: the Reynolds number is 2680."""
    s = h.run(h.source / "tests/cases/vertical_pump.yaml", "pump", ["studies=[{static: {name: s, speed: 3000 rpm}}]"])["s"]
    h.close("Reynolds number", value(s, "bearing.B1.reynolds_number"), 995 * 314.159265 * 0.04 * 150e-6 / 0.7e-3, 0.01)
    h.true("is above the laminar limit", warned(s, "B1 (2679)", "B4 (2679)", "laminar"), str(s.get("warnings")))
    every = ["modes: {name: m, speeds: [3000 rpm], count: 3}", "equilibrium_branch: {name: b, range: {from: 2950 rpm, to: 3000 rpm}}",
             "unbalance_response: {name: r, unbalance: [u], range: {from: 2950 rpm, to: 3000 rpm}, points: 2}",
             "dynamic_coefficients: {name: d, bearing: B1, speeds: [3000 rpm], eccentricity: 0.5}",
             "bearing_map: {name: bm, bearing: B1, speed: 3000 rpm, points: 2, grid: 3}", "critical_speed_map: {name: c, count: 1, stiffness: {from: 1 MN/m, to: 10 MN/m}, points: 2}"]
    s = h.run(h.source / "tests/cases/vertical_pump.yaml", "studies", ["unbalance={u: {planes: [{node: 3, amount: 1e-5 kg m}]}}", f"studies=[{', '.join('{' + e + '}' for e in every)}]"], bars=False)
    h.true("every study of these films says so", [n for n in s if warned(s[n], "B1 (2679)", "laminar", "3000 rpm")] == ["m", "b", "r", "d", "bm"], str({n: s[n].get("warnings") for n in s}))
    h.true("of one bearing where it is about one", not warned(s["bm"], "B4 (2679)") and warned(s["m"], "B4 (2679)"))
    # A study with a film of its own: rho Omega R c/mu at its temperature, which hardly rises.
    film = ("{name: t, speeds: [400 rpm, 4000 rpm], eccentricity: 0.5, cells: [24, 8, 4], cavitation: reynolds, ambient: {temperature: 40 degC}, bush: {type: adiabatic}, journal: {type: adiabatic},"
            " fluid: {type: liquid, viscosity: {type: constant, value: 0.7 mPa s}, density: 995 kg/m^3, heat_capacity: 4180 J/(kg K), conductivity: 0.6 W/(m K)},"
            " grooves: [{angle: 135 deg, width: 18 deg, length: 70 mm, pressure: 70 kPa, temperature: 40 degC, mixing: true}]}")
    s = h.run(h.source / "inputs/thd/oil_groove.yaml", "heat", [f"studies=[{{thd: {film}}}]"], bars=False)["t"]
    h.true("with heat, at the highest speed", warned(s, "(4317)", "418.879 rad/s (4000 rpm)", "begin at 763"), str(s.get("warnings")))
    s = h.run(h.source / "tests/cases/vertical_pump.yaml", "turbulent", ["studies=[{static: {name: s, speed: 3000 rpm}}]", "bearings.{B1,B2,B3,B4}.film.turbulence=constantinescu",
                                                                         "lubricants.water.viscosity=700 mPa s"])
    top = whole(h, "turbulent").get("warnings", [])
    h.true("no word of laminar films", not warned(s["s"], "laminar"), str(s["s"].get("warnings")))
    h.true("700 mPa s is an oil", not any("viscosity" in w for w in top), str(top))
    h.run(h.source / "tests/cases/vertical_pump.yaml", "thick", ["studies=[{static: {name: s, speed: 3000 rpm}}]", "lubricants.water={viscosity: 12 Pa s, density: 0.995 kg/m^3}"], code=None)
    top = whole(h, "thick").get("warnings", [])
    h.true("12 Pa s and 0.995 kg/m^3 are not", any("viscosity of 1.2e+04 mPa s" in w for w in top) and any("density of 0.995 kg/m^3" in w for w in top), str(top))


def wide(h):
    """Ranges far too wide for their points: two and three speeds up to 1e5 rad/s show the resonance at 498.2 rad/s that 20 speeds about it do."""
    range_of = "range: {from: %s rad/s, to: %s rad/s}, points: %d, nodes: [2]"
    response = "{unbalance_response: {name: %s, unbalance: [%s], " + range_of + "%s}}"
    s = h.run(h.source / "tests/cases/shaft_mesh.yaml", "wide", [
        "unbalance={u: {planes: [{node: 2, amount: 1e-5 kg m}]}, couple: {planes: [{node: 1, amount: 1e-5 kg m}, {node: 3, amount: 1e-5 kg m, phase: 180 deg}]}}",
        "rotor.stiffness_damping=1e-5 s", "rotor.internal_damping=0 s",
        "studies=[" + ", ".join([response % ("near", "u", 100, 640, 20, ""), response % ("two", "u", 100, 1e5, 2, ""), response % ("three", "u", 1, 1e5, 3, ""),
                                 response % ("off", "u", 100, 1000, 9, ", refine: false"), response % ("couple", "couple", 100, 4000, 50, ""), response % ("short", "u", 100, 4e5, 2, ", refine: false"),
                                 "{frequency_response: {name: t, speed: 0 rad/s, inputs: [{node: 2, direction: x}], range: {from: 100 rad/s, to: 1000 rad/s}, points: 9}}"]) + "]"])
    near, = peaks(s["near"], "node 2")
    for name in ("two", "three"):
        found = [p for p in peaks(s[name], "node 2") if abs(p["speed"]["value"] - near["speed"]["value"]) < 0.01]
        h.true(f"{name} speeds find the resonance", len(found) == 1, str(peaks(s[name], "node 2")))
        h.close("    its height", found[0]["semi_major"]["value"] / near["semi_major"]["value"], 1, 1e-4)
        h.close("    its amplification factor", found[0]["amplification_factor"]["value"] / near["amplification_factor"]["value"], 1, 5e-3)
        h.true("    what the mesh resolves", warned(s[name], "above 2041.9 rad/s the mesh of the shaft is too coarse", "cut the segments shorter") and not warned(s[name], "beam theory"), str(s[name]["warnings"]))
    h.true("without refinement a warning has it", warned(s["off"], "the speeds computed miss resonances", "498.209 rad/s", "um at least, node 2", "'refine: true'"), str(s["off"].get("warnings")))
    h.true("and peaks are no peaks", peaks(s["off"], "node 2") and all(p.get("verdict") == "undetermined" and "not settled" in p["notes"][-1] for p in peaks(s["off"], "node 2")), str(s["off"]["peaks"]))
    h.true("above the cut-off no mesh helps", warned(s["short"], "rad/s the response is not that of the shaft", "beam theory ends"), str(s["short"]["warnings"]))
    h.true("refined ones are", not near.get("verdict") and not near.get("notes"), str(near))
    h.true("rounding has no peaks", not peaks(s["couple"], "node 2") and peaks(s["couple"], "left, journal"), str(s["couple"].get("peaks")))
    h.true("frequencies pass over it", warned(s["t"], "step over narrow resonances", "498.65 rad/s", "(node 2 x from node 2 x reaches ", " um/N there, ", "m/N at the frequencies beside it)"), str(s["t"].get("warnings")))


def near(h):
    """A backward critical speed 5 % above the service speed: unbalance excites it where the supports differ, and not where they are alike."""
    deck = h.source / "tests/cases/overhung_grade.yaml"
    modes = "studies=[{modes: {name: m, range: {from: 400 rpm, to: 1000 rpm}, points: 5, count: 2}}, {unbalance_response: {name: r, unbalance: [amount], range: {from: 100 rpm, to: 600 rpm}, points: 9, nodes: [6]}}]"
    for name, more in (("alike", []), ("other", ["bearings.*.film.stiffness=[1e8 N/m, 0 N/m, 0 N/m, 9e7 N/m]"])):
        out = h.run(deck, name, [modes, "service_speed=700 rpm", *more])
        with h5py.File(h.work / name / "results.h5") as f:
            table = f["studies/m/critical"]
            first = {k: table[k][0].decode() for k in ("whirl", "verdict")}
        fact = next(f for f in whole(h, name)["service_speed"]["facts"] if f["what"] == "critical speed above")
        h.true(f"{name}: backward", first["whirl"] == "backward", str(first))
        h.true("    its verdict", first["verdict"] == ("not excited" if name == "alike" else "too near"), str(first))
        h.true("    at the service speed", ("unbalance does not excite" in fact["mark"]) == (name == "alike") != ("TOO NEAR" in fact["mark"]), str(fact))
        h.true("    it is the only one with that value", (value(out["m"], "critical.1.excited") == 0) == (name == "alike"), str(out["m"]["values"]))
        h.true("    margins beyond the range are not judged", warned(out["r"], "the range ends at 600 rpm, below the operating speed (700 rpm)", "above 600 rpm are not judged"), str(out["r"].get("warnings")))
        h.true("    those within are", not warned(out["m"], "not judged"), str(out["m"].get("warnings")))


UNDAMPED = """
rotor: {type: rigid, mass: 10 kg}
gravity: 0 m/s^2
bearings: {A: {node: 1, film: {type: linear, stiffness: 3947841.7604357433 N/m}}}
unbalance: {U: {planes: [{node: 1, amount: 300 g mm}]}}
studies:
  - frequency_response: {name: hit, speed: 1000 rpm, range: {from: 90 Hz, to: 110 Hz}, points: 21, inputs: [{node: 1, direction: x}]}
  - frequency_response: {name: last, speed: 1000 rpm, range: {from: 5400 rpm, to: 6000 rpm}, points: 21, inputs: [{node: 1, direction: x}], coefficients: true}
  - frequency_response: {name: none, speed: 1000 rpm, range: {from: 100 Hz, to: 6000.0000000001 rpm}, points: 2, inputs: [{node: 1, direction: x}]}
  - unbalance_response: {name: u_last, unbalance: [U], range: {from: 5400 rpm, to: 6000 rpm}, points: 21, refine: false}
  - unbalance_response: {name: u_first, unbalance: [U], range: {from: 6000 rpm, to: 6600 rpm}, points: 21, refine: false, operating_speed: 6000 rpm}
"""


def undamped(h, mpirun):
    """sqrt(k/m) is 6000 rpm = 100 Hz: at it there is no answer, beside it there is, 1/(k - m w^2), on any number of ranks."""
    deck = h.work / "undamped.yaml"
    deck.write_text(UNDAMPED)
    k, m = 3947841.7604357433, 10
    for ranks in (1, 2):
        out = h.run(deck, f"undamped {ranks}", launcher=[] if ranks == 1 else [*mpirun, "-n", "2"], code=3)
        with h5py.File(h.work / f"undamped {ranks}" / "results.h5") as f:
            rows = {name: f[f"studies/{name}/response/frequency"][()] for name in ("hit", "last")}
            reals = {name: f[f"studies/{name}/response/machine/node.1.x.from.node.1.x/real"][()] for name in rows}
            speeds, answers, major, growing = (f[f"studies/u_last/response/{c}"][()] for c in ("speed", "answer", "semi_major", "unstable_count"))
        for name, lost, where in (("hit", 10, "100 Hz"), ("last", 20, "6000 rpm")):
            s = out[name]
            h.true(f"{name}: one row without an answer, {ranks} ranks", s["status"] == "1 of 21 frequencies have no answer" and list(np.flatnonzero(np.isnan(reals[name]))) == [lost], s["status"])
            h.true("    said where and why", warned(s, f"no answer at {where}: the equations are singular there, as at an undamped resonance"), str(s.get("warnings")))
            others = np.isfinite(reals[name])
            h.close("    the others", np.abs(reals[name][others] * (k - m * rows[name][others] ** 2) - 1).max(), 0, 1e-9)
            h.close("    grows without limit at", value(s, "node.1.x.from.node.1.x.largest_at"), float(where.split()[0]), 1e-6)
        h.true("a study of such rows alone has no answer", "undamped resonance" in out["none"]["status"] and out["none"]["points"] == 0, out["none"]["status"])
        for name, op in (("u_last", 0), ("u_first", 1)):
            s = out[name]
            h.true(f"{name}: one speed without a response", s["status"] == "1 of 21 speeds have no response", s["status"])
            h.true("    said where and why", warned(s, "no response at 6000 rpm: the equations are singular there"), str(s.get("warnings")))
            h.true("    at the operating speed too", warned(s, "no response at the operating_speed of 6000 rpm") == bool(op), str(s.get("warnings")))
        h.true("its row has no numbers", answers[-1] == 0 and np.isnan(major[-1]).all() and np.isfinite(major[:-1]).all() and answers[:-1].all(), str(major[-3:]))
        h.true("its equilibrium is known", not growing.any() and len(speeds) == 21, str(growing))
        w = 2 * np.pi / 60 * 5400
        h.close("beside it U w^2/(k - m w^2) [m]", major[0, 0], 3e-4 * w**2 / (k - m * w**2), 1e-12)


def flushed(h):
    """What a study found stands on a file's screen while the next one still runs."""
    studies = ("studies=[{static: {name: quick, speed: 4000 rpm}}, {unbalance_response: {name: long, unbalance: [u], nodes: [3], points: 20000, "
               "range: {from: 400 rpm, to: 4000 rpm}}}]")
    process = subprocess.Popen(h.command(h.source / "tests/cases/always_unstable.yaml", h.work / "flushed", [studies]), stdout=subprocess.PIPE, text=True)
    lines = [process.stdout.readline() for _ in range(3)]
    h.true("the first study is told before the second one ends", any(l.startswith("quick: completed") for l in lines) and process.poll() is None, str(lines))
    kill(process)


def without_equilibrium(h, mpirun):
    """A liner that touches at low speeds: these have no response, the others keep theirs, on one and on two ranks."""
    deck, words = h.source / "inputs/compliant_rotor/short.yaml", ["bearings.half.film.compliance=0.05", "bearings.half.film.differences=upwind", "rotor.load=30 N"]
    response = "studies=[{{unbalance_response: {{name: r, unbalance: [a], range: {{from: {}, to: 1000 rad/s}}, points: {}, refine: false}}}}]"
    columns = {}
    for name, start, points, launcher in (("lost", "20 rad/s", 3, []), ("lost_2", "20 rad/s", 3, [*mpirun, "-n", "2"]), ("kept", "510 rad/s", 2, [])):
        s = h.run(deck, name, [*words, response.format(start, points)], launcher=launcher)["r"]
        with h5py.File(h.work / name / "results.h5") as f:
            columns[name] = [f[f"studies/r/response/{k}"][:].reshape(-1) for k in ("speed", "semi_major")]
        if name == "kept":
            continue
        speed, size = columns[name]
        gone = np.isnan(size)
        h.true(f"{name}: the lowest speed has no response", gone[0] and not gone[speed > 210].any(), str(speed[gone]))
        h.true(f"{name}: with the reason", warned(s, "no response at 20 rad/s", "equilibrium"), str(s.get("warnings")))
        h.true(f"{name}: counted in the status", s["status"] == f"{gone.sum()} of 3 speeds have no response", s["status"])
    at = lambda name: columns[name][1][np.isclose(columns[name][0], 510)][0]
    h.close("the same at 510 rad/s [m]", at("lost"), at("kept"), 1e-8 * at("kept"))
    h.true("and on two ranks", np.allclose(columns["lost"][1], columns["lost_2"][1], rtol=1e-6, equal_nan=True))


def shaft_of_cycles(h):
    """The whole shaft over a cycle asked for, on linear bearings alike in both directions: forward circles of the linear response about
    the sag line."""
    h.run(h.source / "tests/cases/shaft_mesh.yaml", "cycles", [
        "unbalance={u: {planes: [{node: 2, amount: 1e-5 kg m}, {node: 1, amount: 2e-5 kg m, phase: 70 deg}]}}",
        "studies=[{static: {name: s, speed: 410 rad/s}}, "
        "{unbalance_response: {name: r, unbalance: [u], range: {from: 410 rad/s, to: 411 rad/s}, points: 2, nodes: [1, 2, 3], refine: false}}, "
        "{cycle_branch: {name: c, unbalance: [u], parameter: speed, range: {from: 400 rad/s, to: 420 rad/s}, at: [410 rad/s], intervals: 12, degree: 4, "
        "points: gauss}}]"], bars=False)
    with h5py.File(h.work / "cycles/results.h5") as f:
        shaft, sag, linear = (f[f"studies/{path}"] for path in ("c/shaft", "s/nodes", "r/response/semi_major"))
        h.true("the cycle that was asked for", list(shaft["what"].asstr()) == ["at"] and np.allclose(shaft["parameter"], 410)
               and np.allclose(shaft["period"], 2 * np.pi / 410) and np.array_equal(shaft["z"], sag["z"]))
        parts = np.fft.fft(shaft["x"][0] + 1j * shaft["y"][0], axis=0) / shaft["x"].shape[1]
        for k, wanted in enumerate(linear[0]):
            h.close(f"node {k + 1}: forward circle [m]", abs(parts[1, k]), wanted, 1e-6 * wanted)
            h.close("    and nothing else [m]", np.abs(parts[2:, k]).max(), 0, 1e-6 * wanted)
            h.close("    about the sag line [m]", abs(parts[0, k] - sag["x"][k] - 1j * sag["y"][k]), 0, 1e-6 * abs(sag["y"][k]))


if __name__ == "__main__":
    program, source, *mpirun = sys.argv[1:]
    harness = Harness(program, source, [])
    for case in (false_peaks, always_unstable, past_threshold, turbine, pump, wide, near, flushed, shaft_of_cycles):
        case(harness)
    undamped(harness, mpirun)
    without_equilibrium(harness, mpirun)
    harness.finish()
