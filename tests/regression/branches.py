#!/usr/bin/env python3
"""Branches of forced cycles: reference values, doubled time mesh, rank counts.

branches.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import sys

from compare import same_results
from harness import BARS, RANKS, Harness, value

NAMES = ["B1", "B2", "B3", "B4", "B5"]
G25, G63 = "studies.1.cycle_branch.", "studies.2.cycle_branch."
# A stretch of each branch with bifurcations in it: a flip of G2.5, both Neimark-Sacker bifurcations of G6.3.
SHORT = [G25 + "range={from: 4000 rpm, to: 4200 rpm}", G25 + "step={initial: 20 rpm, min: 0.01 rpm, max: 60 rpm}",
         G25 + "at=[4100 rpm]", G63 + "range={from: 2500 rpm, to: 2800 rpm}",
         G63 + "step={initial: 20 rpm, min: 0.01 rpm, max: 60 rpm}", G63 + "at=[2700 rpm]",
         *[grade + option for grade in (G25, G63) for option in ("follow_flips=false", "flips=[]")]]


def nearest(study, speed, kinds=("cyclic_fold", "flip", "neimark_sacker", "branch_point")):
    found = [b for b in study["bifurcations"] if b["type"] in kinds]
    return min(found, key=lambda b: abs(b["value"] - speed), default={"value": None})


def reference(h):
    """The main job: cycles and bifurcations of both unbalances."""
    # Branches born at flips: period_doubling().
    run = h.run("unbalance.yaml", "main", [grade + option for grade in (G25, G63) for option in ("follow_flips=false", "flips=[]")])
    for grade, speed, records in (("G2.5", 2700, (84, 85, 86)), ("G2.5", 3600, (80, 81, 82)),
                                  ("G6.3", 2700, (90, 91, 92)), ("G6.3", 3600, (87, 88, 89))):
        s = run[grade]
        for axis, record in zip("xy", records):
            for name, (r, within) in zip(NAMES, h.reference(record)):
                h.close(f"{grade}, {speed} rpm: peak to peak {axis} {name} [m]",
                        value(s, f"at.{speed}.peak_to_peak.{name}.{axis}"), r, within)
        h.close(f"{grade}, {speed} rpm: largest multiplier", value(s, f"at.{speed}.multiplier.modulus"),
                *h.reference(records[2])[0])
    # Record 95 is a period doubling there and a Neimark-Sacker bifurcation at an angle of 170 degrees here.
    lost, back = "stability lost", "stability regained"
    for grade, record, kinds, what in (
            ("G2.5", 98, ("flip",), lost), ("G2.5", 99, ("flip",), back), ("G2.5", 100, ("neimark_sacker",), lost),
            ("G6.3", 93, ("neimark_sacker",), lost), ("G6.3", 94, ("neimark_sacker",), back),
            ("G6.3", 95, ("flip", "neimark_sacker"), lost), ("G6.3", 96, ("flip",), back),
            ("G6.3", 97, ("neimark_sacker",), lost)):
        r, within = h.reference(record)[0]
        b = nearest(run[grade], r, kinds)
        h.close(f"{grade}: {what}, {'/'.join(kinds)} [rpm]", b["value"], r, within)
        if record != 95:
            h.close(f"{grade}: {what}, angle of the multiplier [rad]", b.get("angle_rad"),
                    h.records[record]["parameters"]["multiplier_angle_rad"], 0.03)
    # Nothing happens to G2.5 below service speed, and no cycle folds.
    h.true("G2.5 is stable up to the first flip", min(b["value"] for b in run["G2.5"]["bifurcations"]) > 4085)
    for grade in ("G2.5", "G6.3"):
        h.true(f"{grade} reaches its end", run[grade]["status"] == "completed", run[grade]["status"])


def self_excited(h):
    """Whirl of the balanced train beyond its Hopf point: speed over the amplitude of the first harmonic, bearing 4."""
    import h5py
    import numpy
    s = h.run("self_excited.yaml", "whirl", [G25 + "orbits=500", G25 + "max_points=20", G25 + "intervals=40"])["whirl"]
    with h5py.File(h.work / "whirl" / "results.h5") as f:
        orbits, branch = f["studies/whirl/orbits"], f["studies/whirl/branch"]
        speed, period = branch["parameter"][()], branch["period"][()]
        amplitude = 2 * numpy.abs(numpy.fft.rfft(orbits["x"][()][:, :, 3], axis=1)[:, 1]) / orbits["x"].shape[1] / 300e-6
    h.true("every cycle has its orbit", len(amplitude) == len(speed), f"{len(speed)} points, {s['status']}")
    hopf = value(s, "hopf")
    # 5009 rpm on this film mesh, stated with the conventions of the reference.
    h.close("Hopf point on 60 x 16 cells [rpm]", hopf, 5009 + 1.1, 5)
    for a, record in ((0.1, 108), (0.2, 110), (0.25, 112)):
        k = int(numpy.argmax(amplitude > a))
        w = (a - amplitude[k - 1]) / (amplitude[k] - amplitude[k - 1])
        at = lambda column: column[k - 1] + w * (column[k] - column[k - 1])
        h.close(f"amplitude {a} c_b: speed above the Hopf point [rpm]", at(speed) - hopf, *h.reference(record)[0])
        h.close(f"amplitude {a} c_b: whirl [rpm]", 60 / at(period), *h.reference(record + 1)[0])
    # The normal form of this film is that of its mesh; cycles of amplitudes 0.05, 0.1, 0.2 found by harmonic balance
    # decide. The branch found by collocation shows the same curvature over the larger half-axis of the first harmonic.
    b = next(b for b in s["bifurcations"] if b["type"] == "hopf")
    h.true("supercritical", b["criticality"] == "supercritical" and b["criticality_by"].startswith("cycles at"),
           f"{b['criticality']}, {b['criticality_by']}")
    with h5py.File(h.work / "whirl" / "results.h5") as f:
        z = [f["studies/whirl/orbits"][c][()][:, :, 3] for c in "xy"]
    spectrum = numpy.fft.fft(z[0] + 1j * z[1], axis=1) / z[0].shape[1] / 300e-6
    axis = numpy.abs(spectrum[:, 1]) + numpy.abs(spectrum[:, -1])
    born = numpy.interp([0.1, 0.2], axis, speed)
    # The branch starts upwards and ends upwards: what folds beside the birth folds back there as well.
    beside = [f for f in s["bifurcations"] if f["type"] == "cyclic_fold" and abs(f["value"] - hopf) < f["uncertainty"]]
    h.true("folds that cannot be told from the birth come in pairs and say so", len(beside) == 2 and sum("where the branch is born" in w for w in s["warnings"]) == 2
           and all(f["criticality"] == "undetermined" and f["distance_from_birth"] < 1 for f in beside), f"{beside}, {s.get('warnings')}")
    h.close("curvature of the branch [rpm per clearance^2]", -b["criticality_coefficient"], (born[1] - born[0]) / 0.03,
            b["criticality_uncertainty"])


def bubble(h):
    """Whirl that lives between two Hopf points, over the viscosity: the branch from one ends at the other, for the equilibrium is no
    whirl."""
    import h5py
    over = "parameter: lubricants.water.viscosity, speed: 410 rad/s, range: {from: 0.4 mPa s, to: 0.05 mPa s}"
    run = h.run((h.source / "inputs/rigid_rotor/short_f1.yaml").resolve(), "bubble", [
        f"studies=[{{equilibrium_branch: {{name: balanced, {over}}}}}, "
        f"{{cycle_branch: {{name: whirl, origin: hopf, intervals: 30, degree: 3, {over}}}}}]"])
    ends, whirl = [b["value"] for b in run["balanced"]["bifurcations"]], run["whirl"]
    h.true("two Hopf points, whirl is born at the first one", len(ends) == 2 and [b["type"] for b in whirl["bifurcations"]] == ["hopf"],
           f"{ends}, {whirl['bifurcations']}")
    h.true("it ends as a branch that has arrived", whirl["status"] == "completed" and value(whirl, "returned") is not None, whirl["status"])
    with h5py.File(h.work / "bubble" / "results.h5") as f:
        group = f["studies/whirl"]
        place = group["branch/parameter"][()]
        swing = (group["branch/y_max"][()] - group["branch/y_min"][()])[:, 0]
        h.true("why it ends", group.attrs["end"] == "an equilibrium, at a Hopf point")
    h.true("every cycle lies between the Hopf points and moves", len(place) == whirl["points"] > 10 and ends[1] < place.min() < place.max() < ends[0]
           and swing.min() > 1e-7, f"{place.min()} to {place.max()}, {swing.min()} m")
    # Near its end the square of the swing falls on a straight line to nothing.
    square = swing[-2:]**2
    h.close("the line through the last two points meets the other Hopf point [mPa s]", place[-1] - square[1] * (place[-1] - place[-2]) / (square[1] - square[0]),
            ends[1], 0.01 * ends[1])


def period_doubling(h):
    """Both flips of G2.5 give birth to one and the same branch of twice the period."""
    import h5py
    import numpy
    run = h.run("period_doubling.yaml", "doubling")
    flips = [b["value"] for b in run["G2.5"]["bifurcations"] if b["type"] == "flip"]
    h.true("two flips", len(flips) == 2, f"{flips}")
    curves = []
    with h5py.File(h.work / "doubling" / "results.h5") as f:
        for k, flip in enumerate(flips):
            name = f"G2.5 flip {k + 1}"
            h.close(f"{name}: born at [rpm]", value(run[name], "flip"), flip, 1e-6)
            h.true(f"{name} runs back into the simple cycle", run[name]["status"] == "completed"
                   and value(run[name], "returned") is not None, run[name]["status"])
            b = f[f"studies/{name}/branch"]
            speed, size = b["parameter"][()], (b["x_max"][()] - b["x_min"][()])[:, 0]
            ends = sorted(f[f"studies/{name}/{end}/parameter"][0] for end in ("birth", "closing"))
            h.true(f"{name} lies between the flips, which are its ends", numpy.allclose(ends, flips, rtol=1e-9, atol=0)
                   and flips[0] < speed.min() and speed.max() < flips[1], f"{speed.min()} to {speed.max()}, {ends}")
            inside = (speed > flips[0] + 1) & (speed < flips[1] - 1)
            turns = b["period"][()] * speed / 60
            h.close(f"{name}: turns per period", float(numpy.ptp(turns)) + float(turns[0]), 2, 1e-9)
            h.true(f"{name} is stable between the flips", bool((b["stable"][()][inside] == 1).all()))
            order = numpy.argsort(speed[inside])
            curves.append((speed[inside][order], size[inside][order]))
    for speed in (4200, 4300, 4400):
        a, b = (float(numpy.interp(speed, *c)) for c in curves)
        # Chords between points 60 rpm apart on an arch of 165 um.
        h.close(f"both branches at {speed} rpm: peak to peak x B1 [m]", a, b, 4e-6)


# Closely about the flip of G2.5 and the first Neimark-Sacker bifurcation of G6.3.
CLOSE = [*SHORT, G25 + "range={from: 4050 rpm, to: 4130 rpm}", G25 + "at=[]", G63 + "range={from: 2540 rpm, to: 2600 rpm}", G63 + "at=[]"]


def doubled(h, overrides=CLOSE):
    """A located bifurcation moves by less than its reported uncertainty on a doubled time mesh and at a higher degree."""
    base = h.run("unbalance.yaml", "base", overrides)
    for grade, kind in (("G2.5", "flip"), ("G6.3", "neimark_sacker")):
        h.true(f"{grade}: {kind}", kind in [b["type"] for b in base[grade]["bifurcations"]], str(base[grade]["bifurcations"]))
    finer = {"120 intervals": [G25 + "intervals=120", G63 + "intervals=120"],
             "degree 3": [G25 + "degree=3", G63 + "degree=3"]}
    for what, more in finer.items():
        run = h.run("unbalance.yaml", what, overrides + more, bars=False)
        for grade in ("G2.5", "G6.3"):
            a, b = base[grade]["bifurcations"], run[grade]["bifurcations"]
            h.true(f"{grade}, {what}: the same bifurcations", [x["type"] for x in a] == [x["type"] for x in b])
            for x, y in zip(a, b):
                h.close(f"{grade}, {what}: {x['type']} [rpm]", y["value"], x["value"], x["uncertainty"])
                h.close("  against the uncertainty of the time mesh alone", y["value"], x["value"],
                        x["uncertainty_time_mesh"])


def ranks(h):
    """The same branches to 1e-8 on 1, 2 and at night 3 ranks, and to Newton's tolerance where they share the states of the machine."""
    decks = {"unbalance.yaml": SHORT if 3 in RANKS else CLOSE,
             "balanced.yaml": ["studies.1.equilibrium_branch.range={from: 4990 rpm, to: 5050 rpm}"],
             "modes.yaml": ["studies.3.modes.points=2", "studies.3.modes.range={from: 3000 rpm, to: 3100 rpm}", "studies.3.modes.shapes_at=[]"],
             "response.yaml": ["layout.machine=all_ranks", "studies.1.unbalance_response.points=3",
                               "studies.1.unbalance_response.nodes=[6]",
                               "studies.1.unbalance_response.range={from: 720 rpm, to: 760 rpm}", *(
                                  f"bearings.B{b}.film.cells=[60, 16]" for b in range(1, 6))]}
    for deck, overrides in decks.items():
        for n in RANKS:
            h.run(deck, f"{deck}.{n}", overrides, launcher=[*h.launcher, "-n", str(n)], bars=BARS or deck == "response.yaml")
            if n > 1:
                for what, difference, within in same_results(h.work / f"{deck}.1", h.work / f"{deck}.{n}",
                                                             1e-7 if "layout.machine=all_ranks" in overrides else 1e-8):
                    h.close(f"{deck}, {n} ranks: {what}", difference, 0, within)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    cases = {"reference": reference, "doubled": doubled, "doubled_whole": lambda h: doubled(h, []), "ranks": ranks,
             "self_excited": self_excited, "bubble": bubble, "period_doubling": period_doubling}
    cases[sys.argv[3]](harness)
    harness.finish()
