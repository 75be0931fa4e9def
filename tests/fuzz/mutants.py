#!/usr/bin/env python3
"""Decks that were changed at random: none may crash the program, hang it, or lose what it has computed.

mutants.py PROGRAM SOURCE [--checks 2000] [--runs 20] [--kills 4] [--seed 1] [--jobs 1] [--keep FOLDER]

checks   decks with lines deleted, doubled, moved or taken from other decks, and with other numbers, units, words and bytes, go
         through `whirl check`, a hundred in a process. Right answers: the deck is right (exit 0) or wrong (exit 2)
runs     small decks with other numbers are computed. Right answers: exit 0, 2, 3, and 1 where memory runs out. What an
         exit of 0 or 3 leaves can be read, and `completed` stands beside no value that is not a number
kills    a run is killed at a random moment, twice, and resumed: its values are those of a run that nobody disturbed
What falls is kept in FOLDER (mutants_found here) with a line that says how; the seed repeats it.
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

NUMBERS = ["0", "-1", "1", "2", "1e9", "-1e9", "1e30", "1e-30", "1e308", "1e-308", ".nan", ".inf", "0.5", "3", "1000000", "2147483648",
           "9007199254740993", "-0", "0.999999999"]
WORDS = ["~", "[]", "{}", "true", "none", "''", "[1, 2]", "{a: 1}", "!!binary aGk=", "&a x", "*a", "2 kg", "3 rpm", "5 degC", "x1.2", "+20 um"]
BYTES = ["\t", "\0", "\x1b[31m", "\u202e", "é", "{", "}", "[", "]", ":", "- ", "#", "|", "\r", "\\", "\"", "'", "%", "@", "<<: *a"]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])")
# Decks whose studies take seconds, and what keeps them short.
SMALL = [
    ("inputs/rigid_rotor/short_f1.yaml", ["studies.2.cycle_branch.max_points=4", "studies.1.equilibrium_branch.max_points=10"]),
    ("inputs/rigid_rotor/mass_conserving.yaml", ["studies=[{static: {speed: 120 rad/s}}]", "bearings.*.film.cells=[24, 4]"]),
    ("inputs/aerostatic/gas_bearing.yaml", ["bearings.*.film.cells=[24, 8]", "studies.1.gas_bearing.eccentricities=[0.2, 0.6]"]),
    ("inputs/thd/bearing_a.yaml", ["studies.1.thd.cells=[24, 8, 4]", "studies.1.thd.speeds=[0 rad/s, 5000 rad/s]"]),
    ("inputs/thd/oil_groove.yaml", ["studies.1.thd.cells=[24, 8, 4]"]),
    ("inputs/merot/disc_rotor.yaml", []),
    ("inputs/turbine_train/static.yaml", []),
]
# What is killed and resumed, with studies that take long enough.
LONG = [
    ("inputs/aerostatic/gas_bearing.yaml", ["studies.1.gas_bearing.eccentricities=[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]"]),
    ("inputs/rigid_rotor/short_f1.yaml", ["studies.2.cycle_branch.max_points=12"]),
    ("inputs/thd/bearing_a.yaml", ["studies.1.thd.cells=[48, 16, 6]"]),
]


def environment():
    fixed = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return {**os.environ, **fixed}


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def changed_number(text, rng):
    places = [m for m in NUMBER.finditer(text) if not text[text.rfind("\n", 0, m.start()) + 1:m.start()].lstrip().startswith("#")]
    if not places:
        return text
    m = rng.choice(places)
    try:
        near = f"{float(m[0]) * rng.choice([0.1, 0.5, 0.9, 1.1, 2, 10, -1]):.6g}"
    except (ValueError, OverflowError):
        near = "1"
    return text[:m.start()] + rng.choice([near, near, rng.choice(NUMBERS)]) + text[m.end():]


def mutated(text, corpus, rng):
    """A deck with one to six changes."""
    for _ in range(rng.choice([1, 1, 1, 2, 3, 6])):
        lines = text.split("\n")
        k = rng.randrange(len(lines))
        way = rng.randrange(10)
        if way <= 2:
            text = changed_number(text, rng)
            continue
        if way == 3:
            del lines[k]
        elif way == 4:
            lines.insert(rng.randrange(len(lines) + 1), lines[k])
        elif way == 5:
            other = rng.choice(corpus).split("\n")
            j = rng.randrange(len(other))
            lines[k:k] = other[j:j + rng.choice([1, 1, 3, 10])]
        elif way == 6:  # the value of a key
            head, colon, _ = lines[k].partition(":")
            lines[k] = head + colon + " " + rng.choice(WORDS + NUMBERS) if colon else rng.choice(WORDS)
        elif way == 7:  # of the same key in another deck
            key = lines[k].partition(":")[0].strip(" -")
            same = [l for l in rng.choice(corpus).split("\n") if l.strip(" -").startswith(key + ":")]
            if same:
                lines[k] = lines[k][:len(lines[k]) - len(lines[k].lstrip(" "))] + rng.choice(same).strip()
        elif way == 8:
            at = rng.randrange(len(lines[k]) + 1)
            lines[k] = lines[k][:at] + rng.choice(BYTES) + lines[k][at + rng.randrange(2):]
        else:
            lines[k] = " " * rng.randrange(8) + lines[k].lstrip(" ")
        text = "\n".join(lines)
    return text


class Runner:
    def __init__(self, given):
        self.program, self.source = str(pathlib.Path(given.program).resolve()), pathlib.Path(given.source).resolve()
        self.given = given
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="whirl_mutants_"))
        self.keep = pathlib.Path(given.keep)
        self.found = []
        paths = sorted(p for folder in ("inputs", "tests/cases", "tests/failure") for p in (self.source / folder).rglob("*.yaml"))
        self.decks = [(p, p.read_text(encoding="utf-8", errors="replace")) for p in paths if p.stat().st_size < 20000]
        self.corpus = [text for _, text in self.decks]
        self.count = {"checked": 0, "right": 0, "run": 0, "completed": 0, "no end": 0, "killed": 0}

    def fall(self, what, deck, more=""):
        self.keep.mkdir(parents=True, exist_ok=True)
        name = f"{what.replace(' ', '_')}_{len(self.found) + 1}_seed_{self.given.seed}"
        kept = self.keep / (name + ".yaml")
        if deck is not None:
            shutil.copy(deck, kept)
        (self.keep / (name + ".txt")).write_text(more)
        self.found.append(f"{what}: {kept}\n    {more[-400:]}")

    def beside(self, deck, text, number):
        """The text as a file in the folder of the deck it came from, whose tables it names: a copy of that folder."""
        folder = self.work / "decks" / deck.parent.relative_to(self.source)
        if not folder.exists():
            shutil.copytree(deck.parent, folder)
        path = folder / f"mutant_{number}.yaml"
        path.write_bytes(text.encode("utf-8", "surrogateescape"))
        return path

    def whirl(self, words, timeout):
        """(exit code or None for no end, what it said)"""
        process = subprocess.Popen([self.program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment(),
                                   preexec_fn=limited, cwd=self.work)
        try:
            text, _ = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            text, _ = process.communicate()
            return None, text.decode("utf-8", "replace")
        return process.returncode, text.decode("utf-8", "replace")

    # -- check ---------------------------------------------------------------------------------------------------------
    def check(self, decks):
        code, text = self.whirl(["check", *decks], 60 + 2 * len(decks))
        if code in (0, 2):
            self.count["checked"] += len(decks)
            self.count["right"] += text.count(": no errors")
        elif len(decks) > 1:  # which of them
            for part in decks[:len(decks) // 2], decks[len(decks) // 2:]:
                self.check(part)
        else:
            self.count["checked"] += 1
            self.fall("check hangs" if code is None else f"check ends with {code}", decks[0], text)
        if len(decks) == 1 or code in (0, 2):
            for deck in decks:
                deck.unlink(missing_ok=True)

    def checks(self):
        rng = random.Random(self.given.seed)
        batches, batch = [], []
        for k in range(self.given.checks):
            deck, text = rng.choice(self.decks)
            batch.append(self.beside(deck, mutated(text, self.corpus, rng), k))
            if len(batch) == 100 or k + 1 == self.given.checks:
                batches.append(batch)
                batch = []
            if len(batches) == 10 or k + 1 == self.given.checks:
                with concurrent.futures.ThreadPoolExecutor(self.given.jobs) as pool:
                    list(pool.map(self.check, batches))
                batches = []
                print(f"{self.count['checked']} checked, {self.count['right']} right", flush=True)

    # -- run -----------------------------------------------------------------------------------------------------------
    def bad_results(self, out, code):
        summary = json.loads((out / "summary.json").read_text())
        for s in summary["studies"]:
            if s["status"] == "completed":
                for name, q in s["values"].items():
                    if q["value"] is None or not math.isfinite(q["value"]):
                        return f"'{s['name']}' completed, and {name} is no number"
        if code == 0 and not summary["studies"]:
            return "exit 0 without a study"
        return ""

    def run(self, job):
        number, name, words, seed = job
        rng = random.Random(seed)
        deck, text = self.source / name, (self.source / name).read_text()
        for _ in range(rng.choice([1, 1, 2, 4])):
            text = changed_number(text, rng)
        path, out = self.beside(deck, text, f"run_{number}"), self.work / f"out_{number}"
        code, said = self.whirl(["run", path, *[w for o in words for w in ("--set", o)], "-o", out], 120)
        self.count["run"] += 1
        self.count["completed"] += code == 0
        if code is None:  # more work than there is time, as far as one can tell
            self.count["no end"] += 1
        elif code not in (0, 2, 3) and not (code == 1 and "out of memory" in said):
            self.fall(f"run ends with {code}", path, said)
        elif code in (0, 3) and (bad := self.bad_results(out, code)):
            self.fall("bad results", path, bad)
        shutil.rmtree(out, ignore_errors=True)

    def runs(self):
        rng = random.Random(self.given.seed + 1)
        jobs = [(k, *rng.choice(SMALL), rng.random()) for k in range(self.given.runs)]
        with concurrent.futures.ThreadPoolExecutor(self.given.jobs) as pool:
            list(pool.map(self.run, jobs))
        print(f"{self.count['run']} run, {self.count['completed']} to their end, {self.count['no end']} stopped after two minutes", flush=True)

    # -- kill ----------------------------------------------------------------------------------------------------------
    def values(self, out):
        summary = json.loads((out / "summary.json").read_text())
        return {(s["name"], name): q["value"] for s in summary["studies"] for name, q in s["values"].items()}

    def kills(self):
        rng = random.Random(self.given.seed + 2)
        whole = {}
        for k in range(self.given.kills):
            name, words = LONG[k % len(LONG)]
            sets = [w for o in words for w in ("--set", o)]
            if name not in whole:
                begin, out = time.monotonic(), self.work / f"whole_{len(whole)}"
                code, said = self.whirl(["run", self.source / name, *sets, "-o", out], 900)
                if code != 0:
                    return self.fall(f"undisturbed run ends with {code}", self.source / name, said)
                whole[name] = self.values(out), time.monotonic() - begin
            expected, seconds = whole[name]
            out = self.work / f"killed_{k}"
            for _ in range(2):
                process = subprocess.Popen([self.program, "run", str(self.source / name), *sets, "-o", str(out), "--resume"],
                                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment())
                try:
                    process.wait(rng.uniform(0.02, 0.7) * seconds)
                except subprocess.TimeoutExpired:
                    process.send_signal(signal.SIGKILL)
                    process.wait()
            code, said = self.whirl(["run", self.source / name, *sets, "-o", out, "--resume"], 900)
            self.count["killed"] += 1
            if code != 0:
                self.fall(f"resumed run ends with {code}", self.source / name, said)
                continue
            found = self.values(out)
            far = [key for key, v in expected.items()
                   if (found.get(key) is None) != (v is None) or (v is not None and abs(found[key] - v) > 1e-7 * max(abs(v), 1e-12))]
            if far or found.keys() != expected.keys():
                self.fall("resumed run finds other values", self.source / name, f"{far[:10]}")
            shutil.rmtree(out, ignore_errors=True)
        print(f"{self.count['killed']} runs killed twice and resumed", flush=True)


def main():
    words = argparse.ArgumentParser()
    words.add_argument("program")
    words.add_argument("source")
    for name, default in ("checks", 2000), ("runs", 20), ("kills", 4), ("seed", 1), ("jobs", 1):
        words.add_argument("--" + name, type=int, default=default)
    words.add_argument("--keep", default="mutants_found")
    runner = Runner(words.parse_args())
    runner.checks()
    if runner.given.runs:
        runner.runs()
    if runner.given.kills:
        runner.kills()
    print("\n".join(runner.found) or "nothing fell")
    shutil.rmtree(runner.work, ignore_errors=True)
    sys.exit(1 if runner.found else 0)


main()
