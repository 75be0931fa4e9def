#!/usr/bin/env python3
"""Linear analyses: condition numbers, whirl of every node, frequency responses, convergence over elements.

linear.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import sys

import h5py
import numpy as np
from harness import Harness, value


def condition(h):
    """The free shaft: zero is six eigenvalues with four vectors. On its springs all is well."""
    deck = h.source / "inputs/merot/free_rotor.yaml"
    s = h.run(deck, "free", launcher=[])["modes"]
    h.close("multiplicity of zero", value(s, "rest.multiplicity"), 6, 0)
    h.close("its vectors", value(s, "rest.vectors"), 4, 0)
    h.true("a warning says so", any("6 but 4 eigenvectors" in w for w in s.get("warnings", [])))
    h.close("precession [rad/s]", s["modes"][0]["imag"], 37.43, 0.005)
    for m in s["modes"]:
        h.true(f"mode at {m['imag']:.6g} rad/s", 1 <= m["condition"] < 1e4 and m["multiplicity"] == m["vectors"], f"condition {m['condition']:.4g}")
    held = "bearings.*.film.stiffness=1e7 N/m"
    one = h.run(deck, "held", [held], launcher=[])["modes"]
    h.true("on springs nothing is defective", value(one, "rest.multiplicity") is None and not one.get("warnings"))
    two = h.run(deck, "ranks", [held], launcher=[*h.launcher, "-n", "2"])["modes"]
    for a, b in zip(one["modes"], two["modes"]):
        h.close(f"condition at {a['imag']:.6g} rad/s, two ranks", b["condition"], a["condition"], 1e-6 * a["condition"])
        h.true("    whirl by the nodes", a["whirl_rule"] == b["whirl_rule"] == a["whirl"], a["whirl_rule"])


def whirl_map(h):
    """Of an isotropic rotor every node moves on circles; springs that differ make ellipses, lines at rest and mixed modes."""
    deck = h.source / "inputs/merot/disc_rotor.yaml"
    study = "studies=[{modes: {name: map, speeds: [0 rad/s, 2500 rad/s, 5000 rad/s, 7500 rad/s, 10000 rad/s], count: 6}}]"
    h.run(deck, "isotropic", [study], launcher=[])
    with h5py.File(h.work / "isotropic" / "results.h5") as f:
        speed, turning = f["studies/map/spectrum/speed"][()], f["studies/map/whirl_map/turning"][()]
        moving = turning[speed > 0]
        h.close("circles", np.abs(np.abs(moving[np.abs(moving) > 0]) - 1).max(), 0, 1e-3)
    springs = "bearings.*.film.stiffness=[1e7 N/m, 0 N/m, 0 N/m, 2e7 N/m]"
    s = h.run(deck, "springs", [study, springs], launcher=[])["map"]
    h.true("at rest every mode is planar by both rules", all(m["whirl"] == m["whirl_rule"] == "planar" for m in s["modes"] if m["speed"] == 0))
    with h5py.File(h.work / "springs" / "results.h5") as f:
        speed, turning = f["studies/map/spectrum/speed"][()], f["studies/map/whirl_map/turning"][()]
        rule = f["studies/map/spectrum/whirl_rule"].asstr()[()]
        forward, backward = f["studies/map/spectrum/forward_nodes"][()], f["studies/map/spectrum/backward_nodes"][()]
    h.true("nodes are counted", np.all(forward == (turning > 1e-6).sum(axis=1)) and np.all(backward == (turning < -1e-6).sum(axis=1)))
    wanted = np.where((forward > 0) & (backward > 0), "mixed", np.where(forward > 0, "forward", np.where(backward > 0, "backward", "planar")))
    h.true("the rule follows from the nodes", np.all(rule == wanted))
    h.true("both rules differ somewhere", any(m["whirl"] != m["whirl_rule"] for m in s["modes"]))


def convergence(h):
    """Frequencies against the independent computation, orders, and the condition number that grows with the elements."""
    cases = {c["name"]: c for c in json.loads((h.source / "tests/reference/rotor/trial_rotor.json").read_text())["cases"]}
    deck = h.source / "inputs/merot/convergence.yaml"
    s = h.run(deck, "plain", ["studies.1.element_convergence.parts=[7, 14, 28]"], launcher=[])["elements"]
    for element, name, order, part in (("rayleigh", "rayleigh", 4, 6e-5), ("timoshenko_linear", "timoshenko", 4, 6e-5), ("timoshenko", "timoshenko", 2, 1.1e-3)):
        case = cases[f"{name}|plain|omega0=10000"]
        for k, wanted in enumerate(case["frequency"], 1):
            h.close(f"{element}, {k} [rad/s]", value(s, f"{element}.frequency.{k}"), abs(wanted), part * abs(wanted) + case["uncertainty"][k - 1])
        for k in (1, 3, 5) if order == 4 else ():
            h.close(f"    order, {k}", value(s, f"{element}.order.{k}"), order, 0.15 * order)
    # One shear angle an element costs h^2, which on coarse meshes hides behind the h^4 of all.
    fine = ["studies.1.element_convergence={name: elements, speed: 10000 rad/s, parts: [20, 40, 80], elements: [timoshenko], count: 6, condition: false}"]
    orders = h.run(deck, "fine", fine, launcher=[])["elements"]
    for k in (1, 3, 5):
        h.close(f"timoshenko: order, {k}", value(orders, f"timoshenko.order.{k}"), 2, 0.2)
    # Bars of meshes that are nearly alike hold the fine one.
    near = h.run(deck, "near", [fine[0].replace("[20, 40, 80]", "[18, 20]")], launcher=[])["elements"]
    for k in (1, 3, 5):
        bar = near["values"][f"timoshenko.frequency.{k}"]["uncertainty"]
        h.close(f"timoshenko on 20 elements, {k}", value(near, f"timoshenko.frequency.{k}"), value(orders, f"timoshenko.frequency.{k}"), bar)
    shift = abs(cases["timoshenko|plain|omega0=10000"]["frequency"][9] / cases["rayleigh|plain|omega0=10000"]["frequency"][9]) - 1
    h.close("shift by shear, 10", value(s, "timoshenko_linear.shift.10"), shift, 1e-4)
    with h5py.File(h.work / "plain" / "results.h5") as f:
        for element in ("rayleigh", "timoshenko_linear"):
            table = f[f"studies/elements/convergence/{element}"]
            h.true(f"{element}: vectors worse conditioned with more elements", np.all(np.diff(table["condition_vectors"][()]) > 0))
            growth = np.diff(np.log2(table["condition_stiffness"][()]))
            h.true("    stiffness by the fourth power", element != "rayleigh" or np.all(np.abs(growth - 4) < 1), np.array2string(growth, precision=2))
    one, two = (h.run(deck, f"ranks {n}", ["studies.1.element_convergence.parts=[2, 4]"], launcher=[*h.launcher, "-n", str(n)] if n > 1 else [])["elements"] for n in (1, 2))
    for k in (1, 5):
        wanted = value(one, f"timoshenko.frequency.{k}")
        h.close("two ranks", value(two, f"timoshenko.frequency.{k}"), wanted, 1e-8 * wanted)


def response(h):
    deck = h.source / "inputs/merot/frequency_response.yaml"

    def matrix(name, entries=("node.7.x", "node.7.y", "node.7.slope_x")):
        with h5py.File(h.work / name / "results.h5") as f:
            g = f["studies/disc/response/machine"]
            return np.array([[g[f"{o}.from.{i}/real"][()] + 1j * g[f"{o}.from.{i}/imaginary"][()] for i in entries] for o in entries])

    h.run(deck, "whole", launcher=[])
    with h5py.File(h.work / "whole" / "results.h5") as f:
        units = [f[f"studies/disc/response/machine/{p}/amplitude"].attrs["unit"] for p in ("node.7.x.from.node.7.x", "node.7.slope_x.from.node.7.x", "node.7.slope_x.from.node.7.slope_x", "bearing.left.x.from.node.7.slope_x")]
    h.true("units", [u.decode() if isinstance(u, bytes) else u for u in units] == ["m/N", "1/N", "1/(N m)", "m/(N m)"], str(units))
    whole = matrix("whole")
    few = "studies.1.frequency_response.points=40"
    h.run(deck, "ranks", [few], launcher=[*h.launcher, "-n", "2"])
    h.run(deck, "few", [few], launcher=[])
    h.close("two ranks", np.abs(matrix("ranks") / matrix("few") - 1).max(), 0, 1e-7)
    h.run(deck, "rest", [few, "studies.1.frequency_response.speed=0 rad/s"], launcher=[])
    rest = matrix("rest")
    scale = np.sqrt(np.abs(np.einsum("iik,jjk->ijk", rest, rest)))
    h.close("at rest it is symmetric", (np.abs(rest - rest.transpose(1, 0, 2)) / scale).max(), 0, 1e-9)
    # An isotropic rotor: what a force along x does along y, a force along y does against x.
    h.close("isotropic: G_yx = -G_xy", np.abs(whole[1, 0] / whole[0, 1] + 1).max(), 0, 1e-6)
    # Coefficients given over the frequency: those of the deck say the same, others what they say.
    row = "{frequency: %g rad/s, k_xx: %g N/m, k_yy: %g N/m, c_xx: 100 N s/m, c_yy: 100 N s/m}"
    study = "studies.1.frequency_response+={given: {left: {table: [%s, %s]}}}"
    same = h.run(deck, "given", [few, study % (row % (1, 1e7, 1e7), row % (3e4, 1e7, 1e7))], launcher=[])["disc"]
    h.close("given: those of the deck", value(same, "given.difference"), 0, 1e-9)
    one = "studies=[{frequency_response: {name: disc, speed: 0 rad/s, range: {from: 2 rad/s, to: 3 rad/s}, points: 2, inputs: [{bearing: left, direction: x}], given: {left: {table: [%s, %s]}}}}]"
    rows = [row % (1, 1e3, 1e7), row % (4, 4e3, 1e7)]
    h.run(deck, "rising", [one % tuple(r.replace("c_xx: 100", "c_xx: 0") for r in rows), "rotor.discs=[]", "rotor.material.density=1 kg/m^3"], launcher=[])
    with h5py.File(h.work / "rising" / "results.h5") as f:
        found = f["studies/disc/response/given/bearing.left.x.from.bearing.left.x/real"][()]
    for w, g in zip((2, 3), found):
        h.close(f"given: a spring of {w} kN/m [m/N]", g, 1e-3 / w, 1e-5 / w)
    # A linear film over the speed is at 5000 rad/s the one half-way between its two rows, for every study.
    modes = "studies+={modes: {name: modes, supports: films, speeds: [5000 rad/s], count: 6}}"
    over = "bearings.left.film={type: linear, stiffness: 0 N/m, damping: 100 N s/m, table: [{speed: 0 rad/s, k_xx: 1e7 N/m, k_yy: 1e7 N/m}, {speed: 10000 rad/s, k_xx: 3e7 N/m, k_yy: 2e7 N/m, c_yy: 50 N s/m}]}"
    there = "bearings.left.film={type: linear, damping: [100 N s/m, 0 N s/m, 0 N s/m, 125 N s/m], stiffness: [2e7 N/m, 0 N/m, 0 N/m, 1.5e7 N/m]}"
    a, b = (h.run(deck, name, [few, modes, film], launcher=[])["modes"]["modes"] for name, film in (("over speed", over), ("at speed", there)))
    h.close("a film over the speed", np.abs(matrix("over speed") / matrix("at speed") - 1).max(), 0, 1e-9)
    h.true("    is another one", np.abs(matrix("over speed") / matrix("few") - 1).max() > 0.1)
    h.close("    its modes [rad/s]", max(abs(p["imag"] - q["imag"]) for p, q in zip(a, b)), 0, 1e-6 * b[-1]["imag"])
    # Far below all resonances: the springs, and the shaft's own compliance.
    stiff = ["studies.1.frequency_response={name: disc, speed: 0 rad/s, range: {from: 0.1 rad/s, to: 0.2 rad/s}, points: 2, inputs: [{bearing: left, direction: x}], "
             "outputs: [{bearing: left, direction: x}, {bearing: left, direction: y}]}",
             "bearings.*.film.stiffness=1e3 N/m"]
    s = h.run(deck, "soft", stiff, launcher=[], bars=True)["disc"]
    across = [name for name in s["values"] if name.startswith("bearing.left.y") and name.endswith("relative_error")]
    h.true("what does not answer at all has no relative error", value(s, "bearing.left.x.from.bearing.left.x.relative_error") < 1e-6 and not across, str(across))
    bar = s["values"]["bearing.left.x.from.bearing.left.x.largest"]["uncertainty"]
    h.true("the mesh of the shaft hardly matters to it", 0 < bar < 1e-9, str(bar))
    h.close("a soft spring at rest [m/N]", value(s, "bearing.left.x.from.bearing.left.x.largest"), 1e-3, 1e-6)


def coefficients(h):
    """The response by K(w), C(w) is that of the machine with its films' states; constant ones are not."""
    deck = h.source / "inputs/aerostatic/response.yaml"
    few = ["studies.1.frequency_response.points=8", "bearings.A.film.cells=[48, 16]"]
    s = h.run(deck, "few", few, launcher=[], bars=True)["journal"]
    h.close("by coefficients at each frequency", value(s, "coefficients.difference"), 0, 1e-8)
    h.true("by those of synchronous whirl", value(s, "constant.1.difference") > 0.05, f"{value(s, 'constant.1.difference'):.3g}")
    # Bars of the coarse film against one with half the spacing, real and imaginary part together.
    h.run(deck, "fine", ["studies.1.frequency_response.points=8", "studies.1.frequency_response.coefficients=false",
                         "studies.1.frequency_response.constant_at=[]", "bearings.A.film.cells=[96, 32]", "layout={refined_states: 1}"], launcher=[])
    with h5py.File(h.work / "few/results.h5") as f, h5py.File(h.work / "fine/results.h5") as g:
        bars, tables = f["studies/journal/bars"], [x["studies/journal/response/machine"] for x in (f, g)]
        frequency = f["studies/journal/response/frequency"][()]
        at = np.searchsorted(frequency, bars["frequency"][()])
        h.true("bars: at five frequencies or more", len(at) >= 5 and np.array_equal(frequency[at], bars["frequency"][()]))
        covered = []
        for name in tables[0]:
            coarse, fine = (t[name]["real"][()] + 1j * t[name]["imaginary"][()] for t in tables)
            bar = bars[name][()]
            h.true(f"bars: {name} are known and small", np.all(bar > 0) and np.median(bar / np.abs(coarse[at])) < 0.5, np.array2string(bar / np.abs(coarse[at]), precision=2))
            covered += list(np.abs(fine - coarse)[at] <= bar)
            entry = s["values"][f"{name}.largest"]
            h.close("    that of the largest", entry["uncertainty"], bar[list(at).index(int(np.abs(coarse).argmax()))], 1e-12 * entry["value"])
            h.close("    largest part", value(s, f"{name}.relative_error"), (bar / np.abs(coarse[at])).max(), 1e-9)
        h.true("bars cover", np.mean(covered) >= 0.8, f"{np.mean(covered):.2f}")
    two = h.run(deck, "ranks", few, launcher=[*h.launcher, "-n", "2"])["journal"]
    for name in ("bearing.A.x.from.bearing.A.x.largest", "constant.1.difference"):
        h.close(f"{name}, two ranks", value(two, name), value(s, name), 1e-5 * value(s, name))
    # At the frequency of the constant ones they are the same.
    at = ["studies.1.frequency_response.range={from: 2500 rad/s, to: 2501 rad/s}", "studies.1.frequency_response.points=2", "bearings.A.film.cells=[48, 16]"]
    near = h.run(deck, "near", at, launcher=[])["journal"]
    h.close("constant ones at their own frequency", value(near, "constant.1.difference"), 0, 1e-3)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"coefficients": coefficients, "condition": condition, "convergence": convergence, "response": response, "whirl_map": whirl_map}[sys.argv[3]](harness)
    harness.finish()
