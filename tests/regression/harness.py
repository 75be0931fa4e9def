"""What the regression tests share: running the program, reading summary.json, comparing with reference values."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile


# Counts of ranks that must agree: three at night only.
RANKS = (1, 2, 3) if os.environ.get("WHIRL_TEST_RANKS") == "3" else (1, 2)
# Whether runs have error bars: no where other numbers are the subject of the test (tests/regression/CMakeLists.txt).
BARS = os.environ.get("WHIRL_TEST_BARS") != "none"


def family(pid):
    """A process and all that descend from it: mpirun gives its ranks process groups of their own."""
    parents = {}
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat") as f:
                    parents[int(entry)] = int(f.read().rsplit(")", 1)[1].split()[1])
            except OSError:
                pass
    found = [pid]
    for p in found:
        found += [child for child, parent in parents.items() if parent == p]
    return found


def kill(process):
    for pid in family(process.pid):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait()


class Harness:
    """Runs decks in a directory of its own; every comparison becomes a line of a table."""

    def __init__(self, program, source, launcher):
        self.program = program
        self.source = pathlib.Path(source).resolve()
        self.train = self.source / "inputs" / "turbine_train"
        self.launcher = launcher
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="whirl_regression_"))
        self.rows = []
        self.failures = []
        records = json.loads((self.source / "tests/reference/turbine_train/train.json").read_text())["records"]
        self.records = {r["id"]: r for r in records}

    def command(self, deck, out, overrides=(), flags=(), launcher=None, bars=BARS):
        words = [*(self.launcher if launcher is None else launcher), self.program, "run", str(self.train / deck)]
        for o in (*overrides, *([] if bars else ["bars=none"])):
            words += ["--set", o]
        return [*words, "-o", str(out), *flags]

    def run(self, deck, name, overrides=(), flags=(), launcher=None, code=0, bars=BARS):
        """The studies of a run by name. A run that ends with another code than `code` ends the test; None allows any.
        `bars`: True where the test looks at error bars."""
        out = self.work / name
        done = subprocess.run(self.command(deck, out, overrides, flags, launcher, bars), capture_output=True, text=True)
        if code is not None and done.returncode != code:
            sys.exit(f"{deck}: exit {done.returncode} instead of {code}\n{done.stdout}{done.stderr}")
        return self.studies(name)

    def kill_at_checkpoint(self, deck, out, overrides=(), flags=(), launcher=(), after=2):
        """Runs a deck, on one rank unless there is a launcher, until it kills itself: it has then written as many checkpoints into the
        directory `out` as `after` says."""
        command = self.command(deck, out, overrides, ["--stop-after-checkpoint", str(after), *flags], launcher)
        code = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
        killed = code in (-signal.SIGKILL, 128 + signal.SIGKILL)  # of the program, of mpirun
        self.true(f"{out.name}: killed at a checkpoint", killed and list(out.glob("*.checkpoint.h5*")), f"exit {code}")

    def studies(self, name):
        summary = json.loads((self.work / name / "summary.json").read_text())
        return {s["name"]: s for s in summary["studies"]}

    def close(self, what, value, reference, within):
        """|value - reference| <= within; a missing value fails."""
        good = value is not None and abs(value - reference) <= within
        shown = "missing" if value is None else f"{value:.6g}"
        self.rows.append(f"{'  ' if good else '! '}{what:<58} {shown:>13} {reference:>13.6g} {within:>11.3g}")
        if not good:
            self.failures.append(self.rows[-1])

    def true(self, what, condition, detail=""):
        self.rows.append(f"{'  ' if condition else '! '}{what} {detail}")
        if not condition:
            self.failures.append(self.rows[-1])

    def reference(self, record):
        """Values of a reference record with their uncertainties, as a list of pairs."""
        r = self.records[record]
        value, within = r["value"], r["uncertainty"]
        return list(zip(value, within)) if isinstance(value, list) else [(value, within)]

    def finish(self):
        shutil.rmtree(self.work)
        print(f"  {'':<58} {'value':>13} {'reference':>13} {'tolerance':>11}")
        print("\n".join(self.rows))
        print(f"{len(self.failures)} of {len(self.rows)} comparisons failed")
        sys.exit(1 if self.failures else 0)


def value(study, key):
    entry = study["values"].get(key)
    return entry["value"] if entry else None


def every_bearing(key, text):
    """Overrides that set an option of all five bearings."""
    return [f"bearings.B{b}.{key}={text}" for b in range(1, 6)]


GUYAN = [
    "rotor.reduction={type: guyan, masters: [6, 17, 25, 31, 43, 49, 59, 67, 76, 82, 93, 100, 106, 120, 130, 140, 154,"
    " 160, 173, 177, 181]}"
]
