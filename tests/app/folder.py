#!/usr/bin/env python3
"""The folder of results: held by one run, replaced only where a manifest names files, not blocked by runs that came to nothing.

folder.py PROGRAM SOURCE
"""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
work = pathlib.Path(tempfile.mkdtemp(prefix="whirl_folder_"))
failures = []
SHORT = [source / "inputs" / "rigid_rotor" / "short_f1.yaml"]
# Minutes of work, of which the first seconds are enough here.
LONG = [*SHORT, "--set", "studies.1.equilibrium_branch.step={initial: 1 mm/s, min: 1 mm/s, max: 1 mm/s}".replace("mm/s", "mrad/s"),
        "--set", "studies.1.equilibrium_branch.max_points=1000000"]


def command(words):
    return [program, "run", *map(str, words)]


def whirl(*words, code=0, err=None, env=None):
    done = subprocess.run(command(words), cwd=work, capture_output=True, text=True, timeout=300, env=env)
    where = "whirl run " + " ".join(map(str, words))
    if done.returncode != code:
        failures.append(f"{where}: exit {done.returncode} instead of {code}\n{done.stdout}{done.stderr}")
    if err is not None and err not in done.stderr:
        failures.append(f"{where}: '{err}' not on stderr\n{done.stdout}{done.stderr}")
    return done


def true(what, fact, more=""):
    if not fact:
        failures.append(f"{what} {more}")


def left(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())


def started(words, folder):
    process = subprocess.Popen(command(words), cwd=work, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    limit = time.monotonic() + 60
    while not (folder / "resolved.yaml").exists() and time.monotonic() < limit and process.poll() is None:
        time.sleep(1e-3)
    return process


# Two runs in one folder: the second one is refused and changes nothing; the lock goes with the process.
held = work / "held"
first = started([*LONG, "-o", held], held)
before = left(held)
for flags in [], ["--force"], ["--resume"]:
    whirl(*SHORT, "-o", held, *flags, code=2, err="another run is at work in")
true("the first run was still at work when others were refused", first.poll() is None)
true("a refused run changes nothing", set(before) <= set(left(held)))
first.send_signal(signal.SIGKILL)
first.wait()
whirl(*SHORT, "-o", held, "--force")
named = (held / "manifest.txt").read_text().split("\n")[:-1]
true("the manifest names all that a run leaves", set(left(held)) - {"manifest.txt"} <= set(named), f"{named} {left(held)}")

# A run that is killed before it has anything: what it left does not stand in the way.
early = work / "early"
process = started([*LONG, "-o", early], early)
process.send_signal(signal.SIGKILL)
process.wait()
true("nothing but the deck is left", set(left(early)) <= {"manifest.txt", "resolved.yaml"}, str(left(early)))
whirl(*SHORT, "-o", early)

# An input that only shows itself as wrong while it runs leaves nothing: neither a folder of its own nor a deck in one that was there.
MOTION = [*SHORT, "--set", "studies=[{motion: {speed: 200 rad/s, revolutions: 2, discard: 0}}]"]
for there in False, True:
    wrong = work / f"wrong {there}"
    if there:
        wrong.mkdir()
    whirl(*MOTION, "-o", wrong, "--", "-motion_ts_type", "bdf", code=2, err="Lyapunov exponents need the scheme sdirk4")
    true("a wrong run leaves nothing", wrong.exists() == there and (not there or not left(wrong)), str(list(work.iterdir())))
    whirl(*MOTION, "-o", wrong)

# --force replaces what the manifest names: pictures beside it too, the user's own files never.
mine = ["notes.txt", "mine.png", "mine.xdmf", "mine.part", "mine.checkpoint.h5", "csv/mine.csv"]
(held / "csv").mkdir(exist_ok=True)
for name in mine:
    (held / name).write_text("mine\n")
(held / "old.png").write_text("of the run before\n")
with open(held / "manifest.txt", "a") as f:
    f.write("old.png\n../outside\n")
(work / "outside").write_text("mine\n")
whirl(*SHORT, "-o", held, code=2, err="holds results already")
whirl(*SHORT, "-o", held, "--force")
true("--force leaves the user's files", all((held / n).read_text() == "mine\n" for n in mine) and (work / "outside").exists())
true("--force removes what the manifest names", not (held / "old.png").exists())

# A kill while --force removes what is there, at whatever file: the next run goes on with it, without --force.
many = work / "many"
whirl(*SHORT, "-o", many)
with open(many / "manifest.txt", "a") as f:
    for k in range(20000):
        (many / f"old{k}.png").write_text("")
        f.write(f"old{k}.png\n")
process = subprocess.Popen(command([*SHORT, "-o", many, "--force"]), cwd=work, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
limit = time.monotonic() + 60
while (many / "old0.png").exists() and time.monotonic() < limit:
    time.sleep(1e-4)
process.send_signal(signal.SIGKILL)
process.wait()
true("the kill came while files were removed", (many / "old19999.png").exists())
whirl(*SHORT, "-o", many)
true("the rest of the old results is gone", not list(many.glob("old*.png")))

# Without a manifest, as older versions left it: the two files of every run are replaced, the rest stays.
(held / "manifest.txt").unlink()
(held / "summary.json").write_text("{}")
whirl(*SHORT, "-o", held, "--force")
true("an older folder is replaced", json.loads((held / "summary.json").read_text())["studies"])
true("and nothing else of it", all((held / n).exists() for n in mine))

if not failures:
    shutil.rmtree(work)
print("\n".join(failures) or "folders of results are safe")
sys.exit(1 if failures else 0)
