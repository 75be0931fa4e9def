#!/usr/bin/env python3
"""Counts the instructions of three decks and holds the counts against the kept ones: a change of speed that no other work on the machine hides.

instructions.py PACKAGE SOURCE [--keep]

PACKAGE is the Debian package, or the folder that holds it: its program is made for any processor, so that valgrind can run it.
Fails if a deck takes 5 % more than kept. With --keep the counts become the kept ones, in instructions.json; do this for each version.
Exit code 77, which CTest counts as skipped, without valgrind, or where compiler, valgrind or libraries are others than kept.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

DECKS = ("2_unbalance", "3_oil_films", "4_limit_cycle")  # responses, an equilibrium branch with films, a branch of cycles
LIMIT = 0.05
package, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
kept_file = pathlib.Path(__file__).with_suffix(".json")


def skip(why):
    print("skipped:", why)
    sys.exit(77)


def first_line(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()[0].strip()


for tool in ("valgrind", "dpkg-deb", "g++", "dpkg-query"):
    if not shutil.which(tool):
        skip(f"there is no {tool}")
with tempfile.TemporaryDirectory() as folder:
    work = pathlib.Path(folder)
    packages = sorted(package.glob("whirl_*.deb"), key=os.path.getmtime) if package.is_dir() else [package]
    subprocess.run(["dpkg-deb", "-x", packages[-1], work / "tree"], check=True)
    program = work / "tree/usr/bin/whirl"
    # OpenBLAS takes the kernels of the processor at hand, unless it is told which.
    environment = {**os.environ, "OMPI_MCA_pml": "ob1", "OMPI_MCA_ess_singleton_isolated": "1", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
                   "OPENBLAS_CORETYPE": "Haswell"}
    counts = {"version": first_line(program, "--version").split()[-1], "compiler": first_line("g++", "--version"),
              "valgrind": first_line("valgrind", "--version"),
              "libraries": {name: first_line("dpkg-query", "-W", "-f=${Version}", name)
                            for name in ("libpetsc-real3.18", "libopenblas0-pthread", "libc6", "libopenmpi3")}}
    keep = "--keep" in sys.argv
    kept = {} if keep else json.loads(kept_file.read_text(encoding="utf-8"))
    for what in () if keep else ("compiler", "valgrind", "libraries"):
        if counts[what] != kept[what]:
            skip(f"{what}: {counts[what]}; the kept counts are of {kept[what]}")
    counts["instructions"] = {}
    for deck in DECKS:
        done = subprocess.run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null", program, "run",
                               source / f"inputs/tutorial/{deck}.yaml", "-o", work / deck], env=environment, capture_output=True, text=True)
        found = re.search(r"I\s+refs:\s+([\d,]+)", done.stderr)
        assert done.returncode == 0 and found, done.stdout + done.stderr
        counts["instructions"][deck] = int(found[1].replace(",", ""))

if keep:
    kept_file.write_text(json.dumps(counts, indent=2) + "\n", encoding="utf-8")
slower = []
for deck, count in counts["instructions"].items():
    before = kept.get("instructions", {}).get(deck, count)
    print(f"{deck:14} {count:15,d} instructions, {100 * (count / before - 1):+6.2f} % of version {kept.get('version', 'kept now')}")
    if count > (1 + LIMIT) * before:
        slower.append(deck)
print("slower: " + ", ".join(slower) if slower else "none takes more than 5 % beyond the kept counts")
sys.exit(1 if slower else 0)
