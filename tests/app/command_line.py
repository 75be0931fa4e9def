#!/usr/bin/env python3
"""Runs the program as users do and checks exit codes, what is said where, and what is left on disk.

command_line.py PROGRAM SOURCE RANKS [LAUNCHER WORDS...]
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

program, source, ranks = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
launcher = sys.argv[4:]
train = source / "inputs" / "turbine_train"
work = pathlib.Path(tempfile.mkdtemp(prefix="whirl_app_"))
failures = []


def whirl(*words, code, out=None, err=None, times=1):
    done = subprocess.run([*launcher, program, *map(str, words)], cwd=work, capture_output=True, text=True, timeout=120)
    where = "whirl " + " ".join(map(str, words))
    if done.returncode != code:
        failures.append(f"{where}: exit {done.returncode} instead of {code}\n{done.stdout}{done.stderr}")
    if out is not None and done.stdout.count(out) != times:
        failures.append(f"{where}: '{out}' {done.stdout.count(out)} times on stdout\n{done.stdout}")
    if err is not None and done.stderr.count(err) != times:
        failures.append(f"{where}: '{err}' {done.stderr.count(err)} times on stderr\n{done.stderr}")
    return done


few = ranks > 1  # starting under mpirun takes a second; what one rank shows is not repeated
whirl("check", train / "unbalance.yaml", code=0, out="184 segments, 5 bearings, 2 studies")
whirl("list", code=0, out="cycle_branch")
whirl("describe", "clearence", code=2, err="did you mean 'clearance'?")
if not few:
    whirl("describe", "bearings.geometry.clearance", code=0, out="bearings.NAME.geometry.clearance")
    whirl("describe", "cycle_branch", code=0, out="studies.1.cycle_branch.intervals")
    whirl("describe", "cycle_branch.step", code=0, out="studies.1.cycle_branch.step.initial")
    whirl("check", train / "static.yaml", "--set", "studies=[{modes: {speed: 3000 rpm}}, {static: {speeds: 3000 rpm}}, {modes: {name: b, speeds: [3000 rpm]}}]", code=0, out="3 studies")
    whirl("describe", "impeller", code=0, out="elements.NAME.role")
    whirl("describe", "windage", code=2, err="there is no option 'windage'")
    whirl("describe", "half_sommerfeld", code=0, out="negative pressure is cut off after the solution")
    whirl("describe", "bearings.geometry.clearance", code=0, out="[004] I. Gavalas (2022)")
    whirl("help", "disks", code=0, out="may be written 'disks'")
    whirl("schema", code=0, out='"$schema"')
    whirl("--version", code=0, out="whirl ")
    whirl(code=2, err="commands are help, run, check, list, describe, schema")
    whirl("rum", train / "static.yaml", code=2, err="there is no command 'rum' (did you mean 'run'?)")
    whirl("run", train / "static.yaml", "--resum", code=2, err="run: there is no option '--resum' (did you mean '--resume'?)")
    whirl("check", code=2, err="whirl: check: DECK is required; see whirl help check")
    whirl("help", code=0, out="Subcommands:")
    whirl("help", "run", code=0, out="--resume")
    whirl("help", "clearance", code=0, out="bearings.NAME.geometry.clearance")
    whirl("help", "clearence", code=2, err="did you mean 'clearance'?")
whirl("check", work / "none.yaml", code=2, err="No such file or directory")

# A wrong deck is refused with its place, said once, and leaves nothing behind.
deck = source / "tests" / "failure" / "unknown_nested_key.yaml"
whirl("run", deck, "-o", work / "out", code=2, err=f"{deck}:6:16: unknown key 'clearence' (did you mean 'clearance'?)")
whirl("run", train / "static.yaml", "--set", "gravity=9.81", "-o", work / "out", code=2, err="--set gravity=9.81: ")
if not few:
    # Several values after one --set, with the deck behind them; each change is told.
    wild = ["bearings.{B2,B3,B4}.geometry.clearance=x1.2", "bearings.B5.elevation=by +500 um", "studies+={modes: {speeds: [3600 rpm]}}"]
    whirl("check", "--set", *wild, train / "static.yaml", code=0, out="  modes (modes)")
    whirl("check", train / "static.yaml", "--set", *wild, code=0, out="set bearings.B4.geometry.clearance: 360 um, was 300 um")
    whirl("check", train / "static.yaml", "--set", "gravity=x2", "--set", "title=a", code=0,
          out="set gravity: 19.62 m/s^2, was 9.81 m/s^2")
    whirl("run", train / "train.yaml", "-o", work / "out", code=2, err="asks for no study")
if (work / "out").exists() or (work / "results").exists():
    failures.append("a wrong deck left files")

# Directories that hold something are not touched.
strange = work / "strange"
strange.mkdir()
(strange / "thesis.txt").write_text("mine\n")
for flag in ([["--force"]] if few else [[], ["--force"], ["--resume"]]):
    whirl("run", train / "static.yaml", "-o", strange, *flag, code=2, err="not results of whirl")
earlier = work / "earlier"
earlier.mkdir()
(earlier / "resolved.yaml").write_text("title: another deck\n")
whirl("run", train / "static.yaml", "-o", earlier, code=2, err="holds results already")
whirl("run", train / "static.yaml", "-o", earlier, "--resume", code=2, err="results of another deck")
if not few:
    whirl("run", train / "static.yaml", "-o", strange / "thesis.txt", code=2, err="is a file")
if (earlier / "resolved.yaml").read_text() != "title: another deck\n" or not (strange / "thesis.txt").exists():
    failures.append("a refused run changed files")

# What a run says at its end; what it leaves alone.
if not few:
    short = source / "inputs" / "rigid_rotor" / "short_f1.yaml"
    done = whirl("run", short, "-o", work / "short", "--", "-no_such_option", "3", code=0,
                 out="nothing has asked for the PETSc option -no_such_option")
    said = re.search(r"^balanced: completed \(equilibrium_branch, \d+ points, [\d.e-]+ s\)\n  The equilibrium loses stability at the threshold (\d+\.\d+) rad/s ",
                     done.stdout, re.M)
    located = json.loads((work / "short" / "summary.json").read_text())["studies"][0]["bifurcations"][0]["value"]
    if not said or abs(float(said[1]) - located) > 1e-4 * located:
        failures.append(f"the Hopf point at {located} is not among what was said:\n{done.stdout}")
    (work / "short" / "notes.txt").write_text("mine\n")
    whirl("run", short, "-o", work / "short", "--force", code=0)
    if not (work / "short" / "notes.txt").exists():
        failures.append("--force removes a user's files")

# A machine of another kind: published frequencies (rad/s) and senses of whirl, and no threshold where nothing damps or drives.
if not few:
    whirl("run", source / "tests" / "app" / "friswell_591.yaml", "-o", work / "friswell", code=0)
    modes, branch = json.loads((work / "friswell" / "summary.json").read_text())["studies"]
    published = [(85.39, "backward"), (87.80, "forward"), (251.78, "backward"), (294.71, "forward"), (600.18, "backward")]
    for mode, (frequency, sense) in zip(modes["modes"], published, strict=True):
        if abs(mode["imag"] - frequency) > 0.01 or mode["whirl"] != sense:
            failures.append(f"Friswell 5.9.1: {mode} instead of {frequency} {sense}")
    if branch["bifurcations"] or branch["status"] != "completed":
        failures.append(f"an undamped rotor on linear bearings has {branch['bifurcations']}, {branch['status']}")

shutil.rmtree(work)
print("\n".join(failures) or f"the command line is right on {ranks} ranks")
sys.exit(1 if failures else 0)
