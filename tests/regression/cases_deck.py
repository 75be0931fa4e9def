#!/usr/bin/env python3
"""Small decks with known answers: balance grades, values with a sign, the default film, labels of tables, run-ups under whirl,
names of coefficients, tables over the speed, inertias that no body has, paths that leave a step out.

cases_deck.py PROGRAM SOURCE [LAUNCHER WORDS...]
"""
import csv
import json
import math
import subprocess
import sys

import h5py

from harness import Harness, value

PROGRAM, SOURCE, LAUNCHER = sys.argv[1], sys.argv[2], sys.argv[3:]


def say(h, *words, code=0):
    """What the program prints, screen and errors together."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=200)
    h.true(f"{' '.join(map(str, words))[-80:]}: exit {code}", done.returncode == code, "" if done.returncode == code else f"{done.stdout}{done.stderr}"[:500])
    return done.stdout + done.stderr


def head(h, run, study, table):
    with open(h.work / run / "csv" / study / f"{table}.csv", newline="") as f:
        return next(csv.reader(f))


def grades(h):
    """ISO 21940-11: U = e M of the rotor, M its segments and the discs on their nodes, in bearings or beyond them."""
    deck = CASES / "overhung_grade.yaml"
    unit = 6.3e-3 / (1500 * math.pi / 30)
    mass = 200 + 7850 * math.pi / 4 * 0.06**2 * 1.25
    found = h.run(deck, "grade")
    h.close("overhung fan: mass of the rotor [kg]", value(found["g"], "unbalance.grade.mass"), mass, 1e-9 * mass)
    h.close("overhung fan: U [kg m]", value(found["g"], "unbalance.grade.plane.1"), 9.134e-3, 0.0005e-3)
    h.close("overhung fan: U per e M", value(found["g"], "unbalance.grade.plane.1") / (unit * mass), 1, 1e-12)
    with h5py.File(h.work / "grade/results.h5") as f:
        g, u = (f[f"studies/{s}/response/semi_major"][0, 0] for s in "gu")
        table = f["studies/g/unbalance"]
        h.close("overhung fan: the response is that of U", g / u * 1e-3, unit * mass, 1e-8 * unit * mass)
        h.true("U of the plane in the tables", table["node"][0] == 6 and table["amount"].attrs["unit"] == "kg m" and
               math.isclose(table["amount"][0], unit * mass))
    span = value(h.run(deck, "span", ["unbalance.grade.mass=span"])["g"], "unbalance.grade.plane.1")
    h.close("mass: span, between the bearings about the middle [kg m]", span, 0.890e-3, 0.0005e-3)
    given = value(h.run(deck, "given", ["unbalance.grade.mass=1200 kg"])["g"], "unbalance.grade.plane.1")
    h.close("mass: 1200 kg [kg m]", given, 1200 * unit, 1e-9)
    own = value(h.run(deck, "own", ["unbalance.grade={grade: G6.3, rotor: FAN, planes: [{node: 6, fraction: 1}]}", "service_speed=3000 rpm"])["g"], "unbalance.grade.plane.1")
    h.close("a grade without a speed has that of the machine [kg m]", own, unit * mass / 2, 1e-12)
    pump = h.run(CASES / "grade_between_seals.yaml", "seals")["g"]
    whole = sum(value(pump, f"unbalance.g63.plane.{k}") for k in (1, 2, 3))
    h.close("pump with seals among its bearings [kg m]", whole, 2.366e-3, 0.0005e-3)
    h.close("pump: mass of the rotor [kg]", value(pump, "unbalance.g63.mass"), 196.66, 0.005)
    told = say(h, "check", deck, "--set", "unbalance.grade.planes.1.fraction=0.8")
    h.true("fractions that do not sum to one are said", "unbalance 'grade': the fractions of its planes sum to 0.8, not to 1" in told, told)
    h.true("those that do are not", "sum to" not in say(h, "check", deck))
    two = "rotor.segments.{1,2}.rotor=SHAFT"
    told = say(h, "check", deck, "--set", two, "rotor.discs+={node: 3, mass: 10 kg}", code=2)
    h.true("a disc where two rotors meet names its own", "two rotors meet at node 3: give the disc 'rotor'" in told, told)
    for name, more in (("FAN", 10), ("SHAFT", 0)):
        border = h.run(deck, f"border {name}", [two, f"rotor.discs+={{node: 3, mass: 10 kg, rotor: {name}}}"])["g"]
        h.close(f"a disc at the border that names {name} [kg]", value(border, "unbalance.grade.mass"),
                200 + more + (mass - 200) * 3 / 5, 1e-9)


def signs(h):
    """A sign is part of a value; changes are written otherwise."""
    deck = CASES / "elevations.yaml"
    sweep = h.run(deck, "signs")["sw"]
    rows = [(v["name"], v["changes"]["bearings.left.elevation"]) for v in sweep["variants"]]
    h.true("the grid runs the values that it names", rows == [(f"elevation {x} um", f"{x} um") for x in (-20, 0, 20)], rows)
    with h5py.File(h.work / "signs/results.h5") as f:
        column = f["studies/sw/table/bearings.left.elevation"]
        h.true("the row of the table says the value", list(column[:]) == [-20, 0, 20] and column.attrs["unit"] == "um", list(column[:]))
    told = say(h, "check", deck, "--set", "gravity=-9.81 m/s^2")
    h.true("gravity with a sign is that value", "set gravity: -9.81 m/s^2, was 9.81 m/s^2" in told and "points upwards" in told, told)
    # Proportions that no usual bearing has: a wrong unit is likely.
    own = h.source / "inputs/tutorial/6_own_machine.yaml"
    for key, text, words in (("clearance", "800 um", "20 per mille"), ("clearance", "8 nm", "0.0002 per mille"), ("length", "500 mm", "6.25 diameters"),
                             ("diameter", "400 mm", "a shaft of 80 mm at its node in a bore of 400 mm"), ("clearance", "80 um", None)):
        told = say(h, "check", own, "--set", f"bearings.*.geometry.{key}={text}")
        h.true(f"a bearing with a {key} of {text}", words in told if words else "unit wrong" not in told, told)
    # Discs, beside a shaft of 7850 kg/m^3 pi/4 (80 mm)^2 0.96 m = 37.88 kg: R = sqrt(2 I_p/m), t = m/(rho pi R^2).
    for key, text, words in (("mass", "40 t", "is 1.06e+03 times that of the whole shaft in steel, 37.88 kg"),
                             ("mass", "40 g", "a cylinder of steel of 12.25 m radius and 1.081e-08 m length"),
                             ("polar_inertia", "3 g mm^2", "a cylinder of steel of 1e-05 m radius and 2.433e+07 m length"),
                             ("diametral_inertia", "16e3 kg m^2", "it would be 56.57 m long, and the shaft is 0.96 m"),
                             ("mass", "300 kg", None), ("mass", "20 kg", None)):
        told = say(h, "check", own, "--set", f"rotor.discs.1.{key}={text}")
        lines = [line for line in told.splitlines() if "unit wrong" in line and "twice the diametral" not in line]
        h.true(f"a disc with a {key} of {text}", len(lines) == 1 and words in lines[0] if words else not lines, told)
    told = say(h, "check", own, "--set", "rotor.discs.2={node: 17, mass: 1 g}")
    h.true("a disc that its shaft would not feel", "0.000317 of that of the shaft at its node over one diameter, 3.157 kg" in told, told)
    # Moments about the left bearing: shaft 37.88 kg at 0.48 m, wheel 200 kg at 0 m, coupling 12 kg at 0.96 m; bearings at 0.24 and 0.84 m.
    told = say(h, "check", own, "--set", "rotor.discs.1.mass=200 kg")
    h.true("a journal that the shaft lifts", "bearing drive: its load is -494.9 N by the weight of the shaft, 2451 N" in told, told)
    here = "bearings.left.elevation"
    for text, after in (("by -20 um", "30 um"), ("by +20 um", "70 um"), ("x1.2", "60 um"), ("+20 %", "60 um"), ("-20 %", "40 um"),
                        ("=-20 um", "-20 um"), ("=+20 um", "20 um")):
        told = say(h, "check", deck, "--set", f"{here}={text}")
        h.true(f"{text} makes 50 um {after}", f"set {here}: {after}, was 50 um" in told, told)
    for text in ("-20 um", "+20 um"):
        told = say(h, "check", deck, "--set", f"{here}={text}", code=2)
        h.true(f"{text} alone is refused, both ways named", f"write 'by {text}' to change it, '={text}' for the value itself" in told, told)
        told = say(h, "check", deck, "--set", f"studies.2.sweep.grid={{{here}: [{text}]}}", code=2)
        h.true(f"{text} alone in a grid as well", f"write 'by {text}'" in told, told)
        told = say(h, "check", deck, "--set", f"{here}=0 um", f"{here}={text}")
        h.true(f"{text} where the value is zero", f"set {here}: {text.removeprefix('+')}, was 0 um" in told, told)
    ends = h.run(deck, "ends", [f"studies.2.sweep.grid={{{here}: {{from: by -20 um, to: by 20 um, points: 2}}}}"])["sw"]
    h.true("ends of a range may be changes", [v["changes"][here] for v in ends["variants"]] == ["30 um", "70 um"], str(ends["variants"])[:300])


def films(h):
    """The default film ruptures where pressure and its slope vanish; half_sommerfeld is asked for."""
    branch = "studies=[{equilibrium_branch: {name: t, range: {from: 8000 rpm, to: 11000 rpm}, detect: [hopf]}}]"
    for words, speed, bar in (([], 9572.6, 5.7), (["bearings.*.film.cavitation=reynolds"], 9572.6, 5.7),
                              (["bearings.*.film.cavitation=half_sommerfeld"], 9470.0, 3.9)):
        b = h.run(CASES / "past_threshold.yaml", f"threshold {len(h.rows)}", [branch, *words])["t"]["bifurcations"][0]
        h.close(f"threshold, {words or 'default'} [rpm]", b["value"], speed, 0.05)
        h.true("a bar of that size", bar <= b["uncertainty"] < 2 * bar, b["uncertainty"])
    for cavitation, speed, bar in (("half_sommerfeld", 2813, 29), ("reynolds", 5003, 44)):
        b = h.run(CASES / "generator_threshold.yaml", cavitation, [f"bearings.*.film.cavitation={cavitation}"])["threshold"]["bifurcations"][0]
        h.close(f"generator, {cavitation} [rpm]", b["value"], speed, 0.6)
        h.close("its bar", b["uncertainty"], bar, 1)


def labels(h):
    """Columns have the names of their own places, in CSV, HDF5 and Python."""
    h.run(CASES / "labels.yaml", "labels", ["studies.1.run_up.orders={track: [1], revolutions: 2, advance: 1}",
                                           "studies.1.run_up.waterfall={highest: 2, revolutions: 2, advance: 1}"])
    sys.path.insert(0, str(h.source / "scripts"))
    import whirl
    results = whirl.read(h.work / "labels")
    with results:
        for study, table, column, wanted in (
                ("up2", "run_up", "node_amplitude", ["node 3", "node 5"]), ("up3", "run_up", "node_amplitude", ["node 3", "node 5", "node 1"]),
                ("up2", "run_up", "amplitude", ["a", "b"]), ("cyc", "nodes", "amplitude", ["node 3", "node 5"]),
                ("cyc", "branch", "x_max", ["a", "b"]), ("mot", "orbit", "x", ["a", "b"]), ("mot", "spectrum", "y", ["a", "b"])):
            data = results[study].group[f"{table}/{column}"]
            h.true(f"{study}: {column} in HDF5", list(data.attrs["labels"]) == wanted, list(data.attrs.get("labels", [])))
            heads = [name.split(" [")[0] for name in head(h, "labels", study, table)]
            h.true(f"{study}: {column} in CSV", all(f"{column}.{w}" in heads for w in wanted), heads)
            h.true(f"{study}: {column} in Python", results.table(study, table).places[column] == wanted, results.table(study, table).places)
    heads = head(h, "labels", "up2", "orders")
    h.true("orders reach CSV", any(c.startswith("x_amplitude.order 1.a") for c in heads) and any(c.startswith("y_phase.order 1.node 5") for c in heads), heads)
    heads = head(h, "labels", "up2", "waterfall")
    h.true("waterfalls reach CSV", any(c.startswith("x.order 0.5.b") for c in heads), heads)


def whirl_amplitude(h):
    """A journal that whirls at half the speed goes half around in a revolution: its amplitude is counted from the mean of its orbit."""
    run = ("studies=[{run_up: {name: up, unbalance: [wheels], range: {from: 60000 rpm, to: 61000 rpm}, duration: 50 ms, nodes: [12], "
           "samples: 32, tolerance: 1e-5}}]")
    s = h.run(CASES / "turbocharger.yaml", "turbocharger", [run])["up"]
    with h5py.File(h.work / "turbocharger/results.h5") as f:
        table = f["studies/up/run_up"]
        amplitude, eccentricity = table["amplitude"][:], table["eccentricity_max"][:]
        h.true("the journal whirls", eccentricity[-20:].max() > 0.7, eccentricity[-5:])
        # About the mean of one revolution it was up to 1.15 times the bore.
        ratio = amplitude[20:] / (eccentricity[20:] * 14e-6)
        h.true("amplitudes stay within the bore", amplitude.max() < 14e-6, amplitude.max())
        h.true("and are about those of the orbit", ratio.max() < 1.2, ratio.max())
    h.true("peaks", value(s, "bearing.compressor.peak.amplitude") < 14e-6)


def names(h):
    """c_xx is damping, b_xx another word for it; no hint names another quantity."""
    deck = CASES / "overhung_grade.yaml"
    study = "studies=[{static: {speed: 100 rad/s}}]"
    row = "bearings.a.film.table=[{speed: 0 rad/s, k_xx: 1e6 N/m, k_yy: 1e6 N/m, %s}]"
    for word in ("c_xx", "b_xx"):
        s = h.run(deck, word, [study, row % f"{word}: 500 N s/m"])["static"]
        h.close(f"{word} is damping [N s/m]", value(s, "bearing.a.C.xx"), 1e4 + 500, 1e-9)
    told = say(h, "describe", "b_xx")
    h.true("b_xx is said to be another word", "c_xx" in told and "may be written 'b_xx'" in told, told)
    told = say(h, "check", deck, "--set", study, row % "m_xx: 3 kg", code=2)
    h.true("a mass is no stiffness", "unknown key 'm_xx'" in told and "did you mean" not in told, told)
    told = say(h, "check", deck, "--set", study, row % "cxx: 3 N s/m", code=2)
    h.true("a slip of the pen is one", "did you mean 'c_xx'?" in told, told)


def beyond(h):
    """Speeds beyond the table of a bearing: `check` says so, `extrapolate: hold` keeps the nearest end."""
    deck = CASES / "overhung_grade.yaml"
    table = ("bearings.a.film.table=[{speed: 0 rad/s, k_xx: 1e6 N/m, k_yy: 1e6 N/m}, {speed: 100 rad/s, k_xx: 3e6 N/m, k_yy: 3e6 N/m}]")
    study = "studies=[{static: {name: in, speed: 100 rad/s}}, {static: {name: out, speed: 150 rad/s}}]"
    told = say(h, "check", deck, "--set", table, study)
    words = "'out' asks for the speed 150 rad/s (1432.39 rpm), and the table of bearing a goes from 0 rad/s (0 rpm) to 100 rad/s (954.93 rpm): beyond it "
    h.true("check says it", words + "there is no answer" in told and "'in' asks" not in told, told)
    found = h.run(deck, "unknown", [table, study], code=3)
    h.true("without an option there is no answer", "extrapolate: hold" in found["out"]["status"], found["out"]["status"])
    held = h.run(deck, "hold", [table, study, "bearings.a.film.extrapolate=hold"])
    h.close("with hold it is that of the end", value(held["out"], "bearing.a.K.xx"), value(held["in"], "bearing.a.K.xx"), 1e-6)
    h.true("and the result says so", any(words + "the coefficients of its nearest end are kept" in w for w in held["out"].get("warnings", [])),
           held["out"].get("warnings"))


def discs(h):
    """A polar inertia above twice the diametral one is no body's: said, and computed all the same. Negative ones are refused."""
    deck = CASES / "overhung_grade.yaml"
    disc = "rotor.discs=[{node: 1, mass: 10 kg, polar_inertia: %g kg m^2, diametral_inertia: %g kg m^2%s}]"
    study = "studies=[{static: {name: s, speed: 100 rad/s}}]"
    words = "rotor.discs.1: a polar inertia of 0.25 kg m^2 is more than twice the diametral one of 0.1 kg m^2"
    told = say(h, "check", deck, "--set", study, disc % (0.25, 0.1, ""))
    h.true("check says it", words in told, told)
    told = say(h, "run", deck, "-o", h.work / "discs", "--set", study, disc % (0.25, 0.1, ""))
    h.true("run says it", words in told, told)
    summary = json.loads((h.work / "discs" / "summary.json").read_text())
    h.true("and the summary", any(words in w for w in summary["warnings"]), str(summary["warnings"]))
    told = say(h, "check", deck, "--set", study, disc % (0.25, 0, ""))
    h.true("a missing one, too", "0.25 kg m^2 is more than twice the diametral one of 0 kg m^2" in told, told)
    for polar, diametral, more in ((0.2, 0.1, ""), (0.157, 0.0781, ""), (0, 0.1, ""), (0, 0, ""), (0.05, 0, ", diameter: 0.4 m, thickness: 0.1 m")):
        told = say(h, "check", deck, "--set", study, disc % (polar, diametral, more))
        h.true(f"a body, {polar} and {diametral}{more}", "polar inertia" not in told, told)
    for pair in ((-0.2, 0.1), (0.2, -0.1)):
        told = say(h, "check", deck, "--set", study, disc % (*pair, ""), code=2)
        h.true("a negative one has its place", "inertia' must be" in told, told)


def paths(h):
    """A path that leaves a step out, the kind of a study above all, is answered with the whole one; so are sweeps and branches."""
    deck = CASES / "overhung_grade.yaml"
    base = "studies=[{frequency_response: {name: f, speed: 0 rad/s, range: {from: 10 rad/s, to: 100 rad/s}, inputs: [{node: 1, direction: x}], outputs: [{node: 1, direction: x}]}}]"
    for path, meant in (("studies.1.range={from: 1 rad/s, to: 2 rad/s}", "studies.1.frequency_response.range"), ("studies.1.rnge.from=1 rad/s", "studies.1.frequency_response.range.from"),
                        ("studies.*.points=3", "studies.1.frequency_response.points"), ("studies.points=3", "studies.1.frequency_response.points"),
                        ("bearings.a.stiffness=1 N/m", "bearings.a.film.stiffness"), ("modulus=200 GPa", "rotor.material.modulus")):
        told = say(h, "check", deck, "--set", base, path, code=2)
        h.true(f"{path}", f"(did you mean '{meant}'?)" in told, told)
    sweep = "studies=[{static: {name: s, speed: 100 rad/s}}, {sweep: {of: [s], %s}}]"
    for what in ("grid: {studies.1.speed: [100 rad/s, 200 rad/s]}", "variants: {b: {studies.1.speed: 200 rad/s}}"):
        told = say(h, "check", deck, "--set", sweep % what, code=2)
        h.true(what, "(did you mean 'studies.1.static.speed'?)" in told, told)
    branch = "studies=[{equilibrium_branch: {speed: 100 rad/s, parameter: bearings.a.stiffness, range: {from: 1 MN/m, to: 2 MN/m}}}]"
    told = say(h, "check", deck, "--set", branch, code=2)
    h.true("the parameter of a branch", "(did you mean 'bearings.a.film.stiffness'?)" in told, told)
    told = say(h, "describe", "rotor.modulus")
    h.true("describe finds it", told.startswith("rotor.material.modulus\n") and "bearings." not in told, told)
    told = say(h, "check", deck, "--set", base, "studies.1.frequency_response.pionts=3", code=2)
    h.true("a slip of the pen stays one", "did you mean 'points'?" in told, told)


if __name__ == "__main__":
    harness = Harness(PROGRAM, SOURCE, LAUNCHER)
    CASES = harness.source / "tests/cases"
    for case in (grades, signs, films, labels, whirl_amplitude, names, beyond, discs, paths):
        case(harness)
    harness.finish()
