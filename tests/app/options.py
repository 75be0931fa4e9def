#!/usr/bin/env python3
"""Options of PETSc: wrong words are refused, those in force are told with their source.

options.py PROGRAM SOURCE
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
work = pathlib.Path(tempfile.mkdtemp(prefix="whirl_options_"))
failures = []
DECK = [str(source / "inputs" / "rigid_rotor" / "short_f1.yaml"), "--set", "studies.2.cycle_branch.max_points=2"]


def run(out, petsc, code=0, env=None, home=None):
    done = subprocess.run([program, "run", *DECK, "-o", str(work / out), "--", *petsc], cwd=work, capture_output=True, text=True,
                          timeout=120, env={**os.environ, "HOME": str(home or work / "nobody"), **(env or {})})
    if done.returncode != code:
        failures.append(f"-- {petsc}: exit {done.returncode} instead of {code}\n{done.stdout}{done.stderr}")
    return done


def told(out):
    given = json.loads((work / out / "summary.json").read_text())["options"]
    return {(o["name"], o["value"], o["source"]) for o in given}


def equal(what, found, expected):
    if found != expected:
        failures.append(f"{what}: {found} instead of {expected}")


# A dash forgotten is a wrong input and leaves nothing.
done = run("dash", ["newton_snes_rtol", "1e-3"], code=2)
if "'newton_snes_rtol' behind '--'" not in done.stderr or "did you mean '-newton_snes_rtol'?" not in done.stderr:
    failures.append("a forgotten dash: " + done.stderr)
if (work / "dash").exists():
    failures.append("a wrong option left files")

# The example of the help does what it says.
usage = subprocess.run([program, "--help"], capture_output=True, text=True).stdout
example = usage[usage.index(" -- -") + 4:].split()[0]
done = run("example", [example])
if "SNES Function norm" not in done.stdout:
    failures.append(f"{example} shows nothing:\n{done.stdout[:2000]}")
equal("nothing else is in force", told("example"), {(example, "", "command line")})

# Files and environment count as well, the later source over the earlier one.
home = work / "home"
home.mkdir()
(home / ".petscrc").write_text("-newton_snes_rtol 1e-20\n-newton_snes_max_it 11\n")
(work / ".petscrc").write_text("-newton_snes_max_it 12\n-newton_snes_stol 1e-11\n")
done = run("sources", ["-newton_snes_stol", "1e-12"], env={"PETSC_OPTIONS": "-newton_snes_max_fail 3"}, home=home)
equal("options in force", told("sources"), {("-newton_snes_rtol", "1e-20", "~/.petscrc"), ("-newton_snes_max_it", "12", ".petscrc"),
                                            ("-newton_snes_max_fail", "3", "PETSC_OPTIONS"), ("-newton_snes_stol", "1e-12", "command line")})
for line in "-newton_snes_rtol 1e-20 from ~/.petscrc was in force", "-newton_snes_max_fail 3 from PETSC_OPTIONS was in force":
    if line not in done.stdout:
        failures.append(f"'{line}' is not said:\n{done.stdout}")

if not failures:
    shutil.rmtree(work)
print("\n".join(failures) or "options of PETSc are told")
sys.exit(1 if failures else 0)
