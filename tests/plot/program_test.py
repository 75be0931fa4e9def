#!/usr/bin/env python3
"""What the program stores for pictures, and the pictures and the report of real results:  program_test.py PROGRAM"""
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(pathlib.Path(__file__).parent), str(ROOT / "scripts")]
import command  # noqa: E402

os.environ["WHIRL_PROGRAM"] = str(pathlib.Path(sys.argv[1]).resolve())
import whirl  # noqa: E402
from whirl_plot import curves  # noqa: E402


def doubled_branch(work):
    """Short bearings, F0* = 1, a* = 0.2: flips at 2.8743 and 5.7606 Omega_0 (independent values, see the gallery). The branch born at
    the first runs back into the simple cycle at the second, over a fold at 19.769."""
    options = ("unbalance: [a2], parameter: speed, range: {from: 400 rad/s, to: 3360 rad/s}, step: {initial: 4 rad/s, min: 0.0001 rad/s, "
               "max: 64 rad/s}, intervals: 30, degree: 4, points: gauss, detect: [flip, cyclic_fold], follow_flips: true, flips: [1]")
    results = whirl.run(ROOT / "inputs/rigid_rotor/figure_5_2.yaml", set={"studies": f"[{{cycle_branch: {{name: a2, {options}}}}}]"},
                        output=work / "doubled")
    born = results["a2 flip 1"]
    parameter, high, low = born.get("branch/parameter"), born.get("branch/x_max")[:, 0], born.get("branch/x_min")[:, 0]
    birth, closing = born.get("birth/parameter")[0], born.get("closing/parameter")[0]
    assert abs(birth / 160 - 2.8743) < 1e-3 and abs(closing / 160 - 5.7606) < 1e-3, (birth / 160, closing / 160)
    # The size of the simple cycle where the doubled one ends: the step that landed on it is no point of the branch.
    simple = results["a2"]
    order = np.argsort(simple.get("branch/parameter"))
    size = np.interp(parameter, simple.get("branch/parameter")[order], (simple.get("branch/x_max") - simple.get("branch/x_min"))[order, 0])
    assert np.all((high - low) / size > 1.001), "a point of the simple cycle on the doubled branch"
    assert born.summary["points"] == len(parameter) and born.values["returned"].value != parameter[-1]
    assert born.attribute("end") and not any(s["to"] == born.values["returned"].value for s in born.summary.get("suspected", []))
    orbits = born.orbits
    assert all(abs(o.parameter - parameter[o.point]) == 0 and o.stable == (born.get("branch/stable")[o.point] > 0.5) for o in orbits)
    return results


def nodes_of_a_branch(work):
    """At a hundredth of a balance grade G1 the forced cycle is the linear response of the shaft, at any node."""
    unbalance = {"unbalance.gen_pair.grade": "G0.01"}
    reduction = {"rotor.reduction": "{type: guyan, masters: [6, 25, 43, 49, 67, 93, 100, 120, 130, 140, 160, 177, 181]}"}
    ends = "range: {from: 2600 rpm, to: 2700 rpm}"
    branch = f"cycle_branch: {{name: b, unbalance: [gen_pair], parameter: speed, {ends}, step: {{initial: 100 rpm, min: 1 rpm, max: 100 rpm}}, " \
             "intervals: 60, degree: 3, nodes: [120, 130, 67], detect: []}"
    linear = f"unbalance_response: {{name: r, unbalance: [gen_pair], {ends}, points: 2, nodes: [120, 130, 67]}}"
    results = whirl.run(ROOT / "inputs/turbine_train/train.yaml", output=work / "nodes",
                        set={**unbalance, **reduction, "studies": f"[{{{branch}}}, {{{linear}}}]"})
    table, response = results.table("b", "nodes"), results.table("r")
    assert table.places["amplitude"] == ["node 120", "node 130", "node 67"]
    for column, other in (("amplitude", "semi_major"), ("x", "x_amplitude"), ("y", "y_amplitude")):
        ratio = table[column][[0, -1]] / response[other][[0, -1]]
        # 128 samples miss a peak by 1 - cos(pi/128) = 3e-4.
        assert np.all(np.abs(ratio - 1) < 2e-3), (column, ratio)
    return results


def undamped_friends(work):
    """Two rotors in undamped bearings, once drawn unstable because of a log. decrement of -5e-15. Their frequencies are published:
    Friswell et al. (2010), example 5.9.2, as reproduced by ROSS in rad/s; critical speeds of Nelson and McVaugh (1976) in rpm, whose
    beams have no shear."""
    friswell = whirl.run(ROOT / "tests/app/friswell_592.yaml", output=work / "friswell")
    for name, published in (("at rest", (82.65303734, 86.65811435, 254.52047828, 274.31285391, 679.48903239, 716.78631221)),
                            ("running", (82.32547398, 86.86369902, 239.64228361, 287.24958074, 583.48782916, 806.8872843))):
        found = [m["imag"] for m in friswell[name].modes]
        assert np.allclose(found, published, rtol=1e-8), (name, found)
    nelson = whirl.run(ROOT / "tests/app/nelson.yaml", output=work / "nelson", set={"rotor.material.shear_modulus": "1e13 Pa"})
    for k, published in enumerate((15470, 17159), 1):
        assert abs(nelson["over speed"].values[f"critical.{k}.speed"].value / published - 1) < 1e-3
    for results in (friswell, nelson):
        for study in results.studies:
            assert all(m["stability"] == "undamped" and m["real"] == 0 and m["log_decrement"] == 0 for m in study.modes), study.name
        assert all(v.value == 0 and not np.signbit(v.value) for k, v in results["over speed"].values.items() if k.endswith("log_decrement"))
        assert results["branch"].summary["stability"] == "undamped throughout" and not results["branch"].bifurcations
        assert not results["branch"].get("branch/leading_real").any() and results["branch"].get("branch/undamped_count").all()
        made(results, {"over_speed.campbell", "branch.equilibria"}, "undamped throughout")
        for picture, words, not_words in (("over_speed.campbell.svg", ("undamped",), ()), ("branch.equilibria.svg", ("undamped",), (">stable<",))):
            text = (results.directory / picture).read_text()
            assert all(w in text for w in words) and not any(w in text for w in not_words), picture


def of_python(work):
    """A deck of dicts and arrays gives what its text gives; a sweep changes what it is told; time and texts are limited."""
    support = {"type": "linear", "stiffness": ["10 MN/m", "0 N/m", "0 N/m", "20 MN/m"]}
    deck = whirl.Deck(title="Shaft with a disc", rotor={
        "segments": whirl.shaft(np.full(6, 250.0), np.float64(50)), "material": {"density": "7810 kg/m^3", "poisson": 0.3, "modulus": whirl.quantity(211, "GPa")},
        "discs": [{"node": np.int64(3), "outer_diameter": "280 mm", "inner_diameter": "50 mm", "thickness": "70 mm"}]},
        bearings={"A": {"node": 1, "film": support}, "B": {"node": 7, "film": support}}, studies=[{"modes": {"name": "m", "speeds": ["3000 rpm"], "count": 2}}])
    lines = []
    results = deck.run(work / "python", progress=lines.append)
    text = SHAFT.format(segments=", ".join(["{length: 250 mm, diameter: 50 mm}"] * 6), middle=3, last=7)
    (work / "text.yaml").write_text(text)
    same = whirl.run(work / "text.yaml", output=work / "text")["m"].modes
    assert [m["imag"] for m in results["m"].modes] == [m["imag"] for m in same] and any("completed" in line for line in lines), lines
    study = whirl.sweep(work / "python.deck.yaml", {"rotor.material.modulus": ["211 GPa", "422 GPa"]}, of=["m"], output=work / "sweep")
    assert study.kind == "sweep" and [v["changes"] for v in study.summary["variants"]][1] == {"rotor.material.modulus": "422 GPa"}, study.summary["variants"]
    assert "Shaft with a disc" in results._repr_html_() and results["m"].multipliers is None
    for wrong, words in (({"a": float("nan")}, "a: nan"), ({"a": [{"b": object()}]}, "a.1.b: a deck has no values of type object")):
        try:
            whirl.Deck(wrong).write(work / "wrong.yaml")
        except whirl.Error as error:
            assert words in str(error), error
        else:
            raise AssertionError(wrong)
    try:
        whirl.run(ROOT / "inputs/turbine_train/unbalance.yaml", output=work / "late", timeout=0.5)
    except whirl.RunError as error:
        assert "resume=True" in str(error), error
    else:
        raise AssertionError("no limit of time")


SHAFT = """
title: Shaft with a disc
rotor:
  segments: [{segments}]
  material: {{density: 7810 kg/m^3, poisson: 0.3, modulus: 211 GPa}}
  discs: [{{node: {middle}, outer_diameter: 280 mm, inner_diameter: 50 mm, thickness: 70 mm}}]
gravity: 9.81 m/s^2
bearings:
  A: {{node: 1, film: {{type: linear, stiffness: [10 MN/m, 0 N/m, 0 N/m, 20 MN/m]}}}}
  B: {{node: {last}, film: {{type: linear, stiffness: [10 MN/m, 0 N/m, 0 N/m, 20 MN/m]}}}}
studies:
  - static: {{name: rest, speed: 3000 rpm}}
  - modes: {{name: m, speeds: [3000 rpm], count: 2}}
"""


def slopes_along_the_shaft(work):
    """Curves through displacements and slopes of four elements meet the nodes of eight."""
    runs = []
    for count in (4, 8):
        deck = work / f"shaft_{count}.yaml"
        one = f"{{length: {800 // count} mm, diameter: 50 mm}}"
        deck.write_text(SHAFT.format(segments=", ".join([one] * count), middle=count // 2 + 1, last=count + 1))
        runs.append(whirl.run(deck, output=work / f"shaft_{count}"))
    coarse, fine = (r["rest"] for r in runs)
    z, y = curves.along_shaft(coarse.get("nodes/z"), coarse.get("nodes/y"), coarse.get("nodes/slope_y"))
    found = fine.get("nodes/y")
    # A polygon misses by h^2 y''/8, 3 um here; the weight between the nodes bends by 0.02 um.
    assert np.abs(np.interp(fine.get("nodes/z"), z, y) - found).max() < 1e-3 * np.ptp(found)
    assert np.abs(np.interp(fine.get("nodes/z"), coarse.get("nodes/z"), coarse.get("nodes/y")) - found).max() > 0.03 * np.ptp(found)
    for mode in (0, 1):
        shapes = []
        for study in (r["m"] for r in runs):
            values = {k: study.get(f"shapes/{k}_real")[mode] + 1j * study.get(f"shapes/{k}_imag")[mode] for k in ("x", "y", "slope_x", "slope_y")}
            # The largest displacement is one, at the disc.
            shapes.append([curves.along_shaft(study.get("shapes/z"), values[d], values[f"slope_{d}"]) for d in "xy"])
        for (s, values), (other, finer) in zip(*shapes):
            assert np.abs(np.interp(other, s, values) - finer).max() < 3e-3, mode
    return runs[0]


def made(results, draw, *words, run=command.call):
    """Pictures and report of a run: all figures are made, those in `draw` are drawn; all are drawn by the commands themselves."""
    for done in (run("plot", results.directory, "--formats", "png,svg", draw=draw), run("report", results.directory)):
        assert done.returncode == 0 and not done.stderr, done.stderr
    page = (results.directory / "report.html").read_text()
    for w in words:
        assert w in page, f"the report does not say {w}"
    assert (results.directory / "machine.png").is_file() and (results.directory / "machine.svg").is_file()


def by_the_commands(script, directory, *words, draw=None):
    return subprocess.run([str(ROOT / "scripts" / script), str(directory), *words], capture_output=True, text=True)


with tempfile.TemporaryDirectory() as name:
    made(doubled_branch(pathlib.Path(name)), None, "Largest vibration of the stable cycles", "flip (period doubling)", "cylindrical", "25 \u00b5m", run=by_the_commands)
    undamped_friends(pathlib.Path(name))
    of_python(pathlib.Path(name))
    made(slopes_along_the_shaft(pathlib.Path(name)), {"machine"}, "Shaft with a disc")
    made(nodes_of_a_branch(pathlib.Path(name)), {"machine", "b.nodes"}, "node 130", "lemon bore", "gen_pair")
print("results are as the pictures need them")
