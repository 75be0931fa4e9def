#!/usr/bin/env python3
"""Options of PETSc: wrong words and types are refused, those in force are told with their source, the folder brings none.

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
    if code is not None and done.returncode != code or done.returncode in (70, -11):
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
# The working folder comes with a deck from elsewhere: its files count for nothing.
for name in ".petscrc", "petscrc":
    (work / name).write_text("-newton_snes_max_it 12\n-newton_snes_stol 1e-11\n-dll_prepend /nowhere/of_another.so\n")
done = run("sources", ["-newton_snes_stol", "1e-12"], env={"PETSC_OPTIONS": "-newton_snes_max_fail 3"}, home=home)
equal("options in force", told("sources"), {("-newton_snes_rtol", "1e-20", "~/.petscrc"), ("-newton_snes_max_it", "11", "~/.petscrc"),
                                            ("-newton_snes_max_fail", "3", "PETSC_OPTIONS"), ("-newton_snes_stol", "1e-12", "command line")})
for line in "-newton_snes_rtol 1e-20 from ~/.petscrc was in force", "-newton_snes_max_fail 3 from PETSC_OPTIONS was in force":
    if line not in done.stdout:
        failures.append(f"'{line}' is not said:\n{done.stdout}")

checked = subprocess.run([program, "check", DECK[0]], cwd=work, capture_output=True, text=True, timeout=60)
if checked.returncode != 0 or "of_another" in checked.stdout + checked.stderr:
    failures.append(f"check reads the folder's .petscrc: exit {checked.returncode}\n{checked.stderr}")

# Types that there are not, and types that cannot work here, are wrong input and leave nothing.
for k, (petsc, said) in enumerate(((["-newton_snes_type", "nrichardson"], "newtonls, newtontr"), (["-newton_snes_type", "nonsense"], "newtonls"),
                                   (["-newton_pc_type", "nonsense"], "nonsense"), (["-newton_ksp_type", "nonsense"], "nonsense"),
                                   (["-newton_snes_linesearch_type", "nonsense"], "nonsense"),
                                   (["-newton_snes_max_it", "many"], "many"))):
    done = run(f"type_{k}", petsc, code=2)
    if said not in done.stderr:
        failures.append(f"-- {petsc}: '{said}' is not said:\n{done.stderr}")
    if (work / f"type_{k}").exists():
        failures.append(f"-- {petsc} left files")
# More iterations than are kept for the history.
run("many", ["-newton_snes_max_it", "200000", "-newton_snes_type", "newtontr"], code=None)

if not failures:
    shutil.rmtree(work)
print("\n".join(failures) or "options of PETSc are told")
sys.exit(1 if failures else 0)
