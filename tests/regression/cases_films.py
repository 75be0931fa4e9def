#!/usr/bin/env python3
"""Films, results folders and options that once crashed the program, hung it or lost what it had computed.

cases_films.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import json
import math
import os
import resource
import subprocess
import sys
import time

import h5py
import numpy
from harness import Harness, value

GAS = "../aerostatic/gas_bearing.yaml"
THD = ["studies.1.thd.cells=[24, 8, 4]", "studies.1.thd.meshes=1"]


class Cases(Harness):
    def whirl(self, deck, out, overrides=(), flags=(), launcher=(), seconds=120, **more):
        """(exit code, None for no end; what it said; studies by name)"""
        try:
            done = subprocess.run(self.command(deck, self.work / out, overrides, flags, list(launcher)), capture_output=True, text=True,
                                  timeout=seconds, **more)
        except subprocess.TimeoutExpired:
            return None, "", {}
        try:
            studies = self.studies(out)
        except (OSError, ValueError):  # none, or not whole
            studies = {}
        return done.returncode, done.stdout + done.stderr, studies

    def exits(self, what, found, code, *words):
        self.true(f"{what}: exit {code}" + "".join(f", '{w}'" for w in words),
                  found[0] == code and all(w in found[1] for w in words), "" if found[0] == code else f"exit {found[0]}: {found[1][-400:]}")


def rest(h):
    """A film whose content settles has a line search of another type where whole steps are tried: a reason, no crash."""
    deck = "../rigid_rotor/mass_conserving.yaml"
    alone = h.whirl(deck, "slow", ["studies=[{static: {speed: 1 rad/s}}]", "bearings.*.film.cells=[24, 4]"])
    h.exits("statics at 1 rad/s", alone, 3, "could not be followed")
    sweep = ("studies=[{static: {name: s, speed: 120 rad/s}}, "
             "{sweep: {as_given: false, variants: {slow: {studies.1.static.speed: 1 rad/s}, fast: {studies.1.static.speed: 200 rad/s}}}}]")
    both = h.whirl(deck, "sweep", [sweep, "bearings.*.film.cells=[24, 4]"])
    h.exits("a sweep with it", both, 0, "1 of 2 studies delivered nothing")
    with h5py.File(h.work / "sweep/results.h5") as f:
        h.true("the other variant is there", f["studies/sweep/variants/fast/s"].attrs["delivered"] == 1)


def heat(h):
    """Speeds of a film with heat that has none: rows with reasons, exit 3, the same on all ranks."""
    rows = {}
    for ranks in [1, 2, 3] if h.launcher else [1]:
        launcher = [*h.launcher, "-n", str(ranks)] if ranks > 1 else []
        found = h.whirl("../thd/bearing_a.yaml", f"fast_{ranks}", [*THD, "studies.1.thd.speeds=[5000 rad/s, 1e9 rad/s, 6000 rad/s]"],
                        launcher=launcher)
        h.exits(f"{ranks} ranks", found, 3, "no film at 1e+09 rad/s")
        with h5py.File(h.work / f"fast_{ranks}/results.h5") as f:
            table = f["studies/bearing A/budget"]
            rows[ranks] = table["power_loss"][:]
            h.true(f"{ranks} ranks: the row has its reason", [bool(r) for r in table["reason"][:]] == [False, True, False])
        h.true(f"{ranks} ranks: the others are there", numpy.isfinite(rows[ranks][[0, 2]]).all() and numpy.isnan(rows[ranks][1]))
        h.close(f"{ranks} ranks: loss at 5000 rad/s [W]", rows[ranks][0], rows[1][0], 1e-6 * rows[1][0])
        h.true(f"{ranks} ranks: values of the last speed", value(found[2]["bearing A"], "power_loss") == rows[ranks][2])
    # Values, bars and fields are those of the last film that there is.
    words = "studies.1.thd.speeds=[5000 rad/s, 1e9 rad/s]"
    h.exits("the last speed is lost", h.whirl("../thd/bearing_a.yaml", "lost", [*THD, words]), 3, "no film at 1e+09 rad/s", "5000 rad/s, the last speed with a film")
    last = h.studies("lost")["bearing A"]
    h.close("    its values are kept", value(last, "power_loss"), rows[1][0], 1e-6 * rows[1][0])
    self_acting = [*THD, "studies.1.thd.orifices=[]", "studies.1.thd.bush={type: adiabatic}", "studies.1.thd.journal={type: adiabatic}"]
    for speed in "3e5", "1e6", "1e8":
        h.exits(f"walls without heat at {speed} rad/s", h.whirl("../thd/bearing_a.yaml", speed, [*self_acting, f"studies.1.thd.speeds=[{speed} rad/s]"]), 3)
    # What stands at orifices, which are points, has no limit over the mesh and no bar.
    fine = h.whirl("../thd/bearing_a.yaml", "bars", ["studies.1.thd.cells=[48, 16, 4]", "studies.1.thd.speeds=[10000 rad/s]"])
    values = fine[2]["bearing A"]["values"]
    h.true("no bar of what has no limit", all("uncertainty" not in values[k] for k in ("heat.expansion", "heat.dissipation", "temperature.minimum")))
    h.true("bars of the others", all("uncertainty" in values[k] for k in ("heat.bush", "power_loss", "temperature.mean")))
    h.true("it is said", any("no limit" in w and "heat.expansion" in w for w in fine[2]["bearing A"]["warnings"]))
    # Too few rounds to settle at once: they go on while they converge.
    more = h.whirl("../thd/bearing_a.yaml", "rounds", [*THD, "studies.1.thd.speeds=[10000 rad/s]", "studies.1.thd.most_iterations=2"])
    h.exits("rounds that converge go on", more, 0)


def orifices(h):
    """Two orifices at one node of the mesh are refused where the deck says so."""
    for deck, cells in ("../thd/bearing_a.yaml", "studies.1.thd.cells=[6, 4, 2]"), (GAS, "bearings.*.film.cells=[4, 4]"):
        words = [str(h.program), "check", str(h.train / deck), "--set", cells]
        done = subprocess.run(words, capture_output=True, text=True)
        h.true(f"{cells}: refused by check", done.returncode == 2 and "two orifices" in done.stderr and ".yaml:" in done.stderr, done.stderr[-300:])


def points(h):
    """Points of a film of gas without an answer are rows with reasons; rows are kept by a kill."""
    map_ = "studies.1.gas_bearing.map={clearances: [10 um, 20 um], diameters: [0.2 mm, 40 mm], eccentricity: 0.5}"  # 40 mm: wider than the bearing
    few = ["studies.1.gas_bearing.speeds=[0 rad/s]", "studies.1.gas_bearing.eccentricities=[0.2, 0.5]", "studies.1.gas_bearing.load=[]",
           "studies.1.gas_bearing.meshes=0", "bearings.*.film.cells=[32, 12]"]
    found = h.whirl(GAS, "map", [*few, map_])
    study = next(iter(found[2].values()))
    with h5py.File(h.work / "map/results.h5") as f:
        table = f["studies"][study["name"]]["map"]
        loads = table["load"][:]
        reasons = table["reason"][:].reshape(loads.shape) if "reason" in table else numpy.zeros(loads.shape, bytes)
        h.true("a reason for each entry without a film", ((reasons != b"") == numpy.isnan(loads)).all(), f"{loads} {reasons}")
    lost = int(numpy.isnan(loads).sum())
    h.true("half of the map has none", lost == 2)
    h.true("the status counts them", study["status"] == ("completed" if lost == 0 else f"{lost} of 6 points have no film"), study["status"])
    h.true("no value is no number", all(q["value"] is not None for q in study["values"].values()))

    # Motions that a film does not bear: reasons motion by motion, no values, and nothing delivered where none is left.
    enforced = "{dynamic_coefficients: {name: %s, eccentricity: 0.6, speeds: [2000 rad/s], method: enforced, amplitudes: [%s]}}"
    ran = h.whirl("../aerostatic/bearing_b.yaml", "enforced",
                  ["bearings.*.film.cells=[16, 6]", f"studies=[{enforced % ('some', '0.05, 0.9')}, {enforced % ('none', '0.9')}]"])
    h.exits("enforced motions", ran, 3, "none: 2 of 2 enforced motions have no values")
    found = ran[2]
    with h5py.File(h.work / "enforced/results.h5") as f:
        table = f["studies/some/enforced"]
        for way, entries in (("x", ("xx", "yx")), ("y", ("xy", "yy"))):
            reasons = [bool(r) for r in table[f"reason_{way}"][0, 0, :]]
            h.true(f"enforced along {way}: the second motion has a reason", reasons == [False, True], str(reasons))
            for e in entries:
                values = numpy.isnan(table[f"k_{e}"][0, 0, :]).tolist()
                h.true(f"enforced k_{e}: values where there is no reason", values == reasons, str(values))
    h.true("the status counts motions", found["some"]["status"] == "2 of 4 enforced motions have no values", found["some"]["status"])
    h.true("a warning names motion and reason", any("along x with amplitude 0.9" in w for w in found["some"]["warnings"]), str(found["some"]["warnings"]))
    h.true("no value is no number", all(q["value"] is not None for q in found["some"]["values"].values()))


def folders(h):
    """Folders and pipes in the place of results, damaged results, options of a folder: one sentence and no waiting."""
    deck, few = "../rigid_rotor/short_f1.yaml", ["studies=[{static: {speed: 120 rad/s}}]"]
    good = h.whirl(deck, "good", few)
    h.exits("undisturbed", good, 0)
    for k, name in enumerate(("summary.json", "results.h5", "resolved.yaml", "manifest.txt", "static.checkpoint.h5", "resolved.yaml.new")):
        out, flags = f"in_place_of_{name}", [[], ["--resume"], ["--force"]][k % 3]
        (h.work / out).mkdir()
        if name != "manifest.txt":
            (h.work / out / "manifest.txt").write_text("resolved.yaml\n")
        path = h.work / out / name
        path.mkdir() if k % 2 == 0 else os.mkfifo(path)
        h.exits(f"{'folder' if k % 2 == 0 else 'pipe'} {name} {flags}", h.whirl(deck, out, few, flags, seconds=60), 2, name)
    (h.work / "parts").mkdir()
    for name in "results.h5.part", "summary.json.part":
        os.mkfifo(h.work / "parts" / name)
    (h.work / "parts/manifest.txt").write_text("resolved.yaml\n")
    h.exits("pipes under names of what is written", h.whirl(deck, "parts", few, seconds=30), 0)
    for name in "summary.json", "results.h5":
        out = f"cut_{name}"
        h.whirl(deck, out, few)
        path = h.work / out / name
        path.write_bytes(path.read_bytes()[:path.stat().st_size // 2])
        h.exits(f"half of {name}", h.whirl(deck, out, few, ["--resume"], seconds=30), 1, name)
    # Aliases of aliases: 2^60 words.
    bomb = "a0: &a0 [x, x]\n" + "".join(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]\n" for k in range(1, 60))
    (h.work / "good/resolved.yaml").write_text(bomb)
    h.exits("a bomb as resolved.yaml", h.whirl(deck, "good", few, ["--resume"], seconds=30), 2, "another deck")
    sys.path.insert(0, str(h.source / "scripts"))
    import whirl as reader
    begin = time.monotonic()
    try:
        said = str(reader.read(h.work / "good").deck)
    except reader.Error as error:
        said = str(error)
    h.true("the reader refuses it at once", "aliases" in said and time.monotonic() - begin < 5, said[:200])


def memory(h):
    """A limit of memory ends the run with a sentence."""
    for megabytes in 250, 500:
        limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
        code, said, _ = h.whirl("../turbine_train/static.yaml", f"limit_{megabytes}", (), ["--force"], seconds=100, preexec_fn=limit)
        h.true(f"{megabytes} MB: an end", code == 0 or (code == 1 and "out of memory" in said), f"exit {code}: {said[-200:]}")


def pieces(path):
    """How many pieces of work a checkpoint holds."""
    found = []
    with h5py.File(path) as f:
        f.visititems(lambda name, item: found.extend(item) if name.split("/")[-1] == "pieces" else None)
    return len(found)


def resume(h):
    """Rows of one bearing's studies survive a kill: a resumed study goes on from them and finds the same numbers."""
    coefficients = ("studies=[{dynamic_coefficients: {speeds: [100 rad/s, 120 rad/s, 140 rad/s, 160 rad/s], eccentricity: 0.4}}]")
    map_ = "studies=[{bearing_map: {speed: 120 rad/s, points: 30, grid: 9}}]"
    film = "bearings.*.film={type: reynolds, cavitation: reynolds, cells: [96, 24]}"
    for name, deck, words in (("gas", GAS, ["bearings.*.film.cells=[64, 24]"]), ("coefficients", "../rigid_rotor/short_f1.yaml", [film, coefficients]),
                              ("map", "../rigid_rotor/short_f1.yaml", [film, map_])):
        whole = h.whirl(deck, name, words, seconds=300)
        h.true(f"{name}: undisturbed", whole[0] == 0, whole[1][-300:])
        out = h.work / f"{name}_killed"
        h.kill_at_checkpoint(deck, out, words)
        kept = [pieces(path) for path in out.glob("*.checkpoint.h5")]
        h.true(f"{name}: the checkpoint holds two rows at least", kept and min(kept) >= 2, str(kept))
        again = h.whirl(deck, f"{name}_killed", words, ["--resume"], seconds=300)
        for study in whole[2].values():
            other = again[2].get(study["name"], {"values": {}})["values"]
            # The next row starts from where the last one left its solver: rounding differs.
            same = all(k in other and math.isclose(other[k]["value"], q["value"], rel_tol=1e-9) for k, q in study["values"].items())
            h.true(f"{name}: the same values after a kill", same and len(other) == len(study["values"]))


def centre(h):
    """At eccentricity 0 the coefficients are the limit of a small load, and those of the full film are named."""
    film = "bearings.*.film={type: reynolds, cavitation: half_sommerfeld, cells: [96, 16]}"
    study = lambda e: f"studies=[{{dynamic_coefficients: {{speeds: [120 rad/s], eccentricity: {e}}}}}]"
    found = {e: h.whirl("../rigid_rotor/short_f1.yaml", f"at_{e}", [film, study(e)])[2]["dynamic_coefficients"] for e in ("0", "1e-4")}
    key = next(k for k in found["0"]["values"] if k.endswith("K.xy"))
    small = value(found["1e-4"], key)
    h.close("K_xy at the centre is that of a small load [N/m]", value(found["0"], key), small, 1e-3 * abs(small))
    h.true("both are named", any("at the centre" in w for w in found["0"]["warnings"]))
    h.true("not beside the centre", not any("at the centre" in w for w in found["1e-4"].get("warnings", [])))


CASES = {f.__name__: f for f in (rest, heat, orifices, points, folders, memory, resume, centre)}
h = Cases(sys.argv[1], sys.argv[2], sys.argv[4:])
CASES[sys.argv[3]](h)
h.finish()
