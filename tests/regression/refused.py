#!/usr/bin/env python3
"""Runs that cannot deliver say why, with the right exit code, and leave nothing half-written.

refused.py PROGRAM SOURCE [LAUNCHER WORDS...]
"""
import subprocess
import sys

from harness import GUYAN, Harness, every_bearing

h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])


def run(what, deck, out, code, said="", overrides=(), flags=()):
    done = subprocess.run(h.command(deck, out, overrides, flags), capture_output=True, text=True, timeout=200)
    h.true(f"{what}: exit {code}", done.returncode == code, f"got {done.returncode}")
    told = done.stderr if code == 2 else done.stdout
    h.true(f"{what}: says '{said}' once", not said or told.count(said) == 1, told.strip()[:300])
    return done


def files(name):
    path = h.work / name
    return sorted(str(p.relative_to(path)) for p in path.rglob("*") if p.is_file()) if path.is_dir() else None


# Where results cannot go.
(h.work / "file").write_text("mine\n")
run("a directory below a file", "static.yaml", h.work / "file" / "out", 2, "for results: ")
run("a directory that nobody may make", "static.yaml", "/proc/whirl", 2, "cannot use '/proc/whirl' for results: ")
run("a directory as deck", ".", h.work / "out", 2, "is a directory")
h.true("nothing was written", files("out") is None and (h.work / "file").read_text() == "mine\n")

# A machine without an equilibrium: the films close under the weight before they carry it.
CASES = {"static.yaml": "at service speed", "balanced.yaml": "balanced", "response.yaml": "generator pair G2.5",
         "unbalance.yaml": "G2.5"}
for deck, study in CASES.items():
    name = deck.removesuffix(".yaml")
    # Shafts of few freedoms: each study tries for long.
    impossible = ["gravity=1e7 m/s^2", *every_bearing("film.cells", "[16, 8]"), *GUYAN]
    run(f"{deck} without equilibrium", deck, h.work / name, 3, f"{study}: no equilibrium near", overrides=impossible)
    s = h.studies(name)[study]
    h.true(f"{deck}: the reason is in the status", "completed" not in s["status"] and len(s["status"]) > 20, s["status"])
    h.true(f"{deck}: no values, no bifurcations", not [k for k in s["values"] if not k.startswith("unbalance.")] and not s["bifurcations"] and s["points"] == 0)
    h.true(f"{deck}: only finished files", all(n.endswith((".json", ".h5", ".yaml", ".xdmf", ".csv", "manifest.txt")) and "checkpoint" not in n
                                               for n in files(name)), str(files(name)))
    if deck == "static.yaml":
        h.true("the other study goes on", h.studies(name)["alignment"]["status"] == "completed")
        run("what failed is tried again", deck, h.work / name, 3, f"{study}: no equilibrium near", overrides=impossible, flags=["--resume"])

# A mass as large as a deck may have one, on every segment of the shaft: each kind of study ends, with the reason.
for deck, study in {**CASES, "modes.yaml": "in films", "run_up.yaml": "in 10 s", "self_excited.yaml": "whirl"}.items():
    name = "heavy " + deck
    run(f"{deck} of 1e10 kg a segment", deck, h.work / name, 3, f"{study}: no equilibrium near", overrides=["rotor.segments.*.added_mass=1e10 kg"])
    h.true(f"{deck}: the film and its bearing are named", "bearing B" in h.studies(name)[study]["status"], h.studies(name)[study]["status"])

# Bearings without stiffness: the matrix of the static equilibrium is singular, to the last digit or but for rounding.
(h.work / "loose.yaml").write_text("""title: A rotor that nothing holds
rotor: {element: rayleigh, segments: [&s {length: 100 mm, diameter: 40 mm}, *s, *s, *s, *s, *s, *s, *s], material: {density: 1 kg/m^3, modulus: 200 GPa},
  discs: [{node: 5, mass: 50 kg, polar_inertia: 0.6 kg m^2, diametral_inertia: 0.3 kg m^2}]}
bearings: {A: {node: 1, film: &f {type: linear, stiffness: 0 N/m, damping: 5e3 N s/m}}, B: {node: 9, film: *f}}
studies: [{static: {speed: 100 rad/s}}]
""")
for deck in (h.work / "loose.yaml", h.source / "tests/cases/missing_unstable.yaml"):
    run(f"{deck.stem} without stiffness", deck, h.work / f"out {deck.stem}", 3, "static: no",
        overrides=["bearings.*.film.stiffness=0 N/m", "studies=[{static: {speed: 100 rad/s}}]"])

# Results and checkpoints that are damaged are named, not used.
work = h.work / "damaged"
run("a study", "static.yaml", work, 0)
(work / "results.h5").write_bytes(b"not HDF5")
done = subprocess.run(h.command("static.yaml", work, flags=["--resume"]), capture_output=True, text=True)
h.true("damaged results: exit 1", done.returncode == 1 and "results.h5" in done.stderr, done.stderr.strip())
run("damaged results, replaced", "static.yaml", work, 0, flags=["--force"])
(work / "results.h5").unlink()
(work / "summary.json").unlink()
(work / "at_service_speed.checkpoint.h5").write_bytes(b"not HDF5")
run("a checkpoint that the study does not use", "static.yaml", work, 0, flags=["--resume"])

short = ["studies.1.cycle_branch.range={from: 4000 rpm, to: 4100 rpm}", "studies.1.cycle_branch.at=[]", "studies.1.cycle_branch.follow_flips=false", "studies.1.cycle_branch.flips=[]",
         "studies.2.cycle_branch.max_points=1", "studies.2.cycle_branch.follow_flips=false", "studies.2.cycle_branch.flips=[]"]
work = h.work / "checkpoint"
work.mkdir()
run("a short branch", "unbalance.yaml", work, 0, overrides=short)
for name in ("results.h5", "summary.json"):
    (work / name).unlink()
(work / "G2.5.checkpoint.h5").write_bytes(b"not HDF5")
done = subprocess.run(h.command("unbalance.yaml", work, short, ["--resume"]), capture_output=True, text=True)
h.true("a damaged checkpoint: exit 1", done.returncode == 1 and "no usable checkpoint" in done.stderr, done.stderr.strip())
h.finish()
