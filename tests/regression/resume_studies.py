#!/usr/bin/env python3
"""Studies other than branches of cycles that are killed and resumed find what undisturbed ones find, and work that a
checkpoint holds is not done again.

resume_studies.py PROGRAM SOURCE CASE KILLS SEED
"""
import os
import random
import signal
import subprocess
import sys
import time

from compare import same_results
from harness import Harness

program, source, case, kills, seed = *sys.argv[1:4], int(sys.argv[4]), int(sys.argv[5])
h = Harness(program, source, [])
random.seed(seed)
COARSE = [f"bearings.B{k}.film.cells=[30, 8]" for k in range(1, 6)]
CASES = {
    "modes": ("modes.yaml", ["studies=[{modes: {name: s, supports: films, range: {from: 600 rpm, to: 5000 rpm}, points: 12, count: 14}}]"]),
    "response": ("response.yaml", ["studies.1.unbalance_response.points=22"]),
    "equilibria": ("balanced.yaml", COARSE),
    "locus": (str(h.source / "inputs/rigid_rotor/loci.yaml"), []),
}
deck, overrides = CASES[case]


def cpu(pid):
    """Processor time of a process so far, which on a busy machine tells how far it is; nothing once it has ended."""
    with open(f"/proc/{pid}/stat") as f:
        words = f.read().rsplit(")", 1)[1].split()
    return None if words[0] == "Z" else (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def run(out, flags=(), limit=None):
    """Processor time of a run, and whether it was killed, which happens when it has used `limit`."""
    process = subprocess.Popen(h.command(deck, out, overrides, flags), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    killed = False
    while limit is not None and not killed and (now := cpu(process.pid)) is not None:
        if now >= limit:
            process.send_signal(signal.SIGKILL)
            killed = True
        time.sleep(2e-3)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = status
    if status != 0 and not killed:
        sys.exit(f"{case}: exit status {status}")
    return usage.ru_utime + usage.ru_stime, killed


whole, _ = run(h.work / "undisturbed")
start, _ = run(h.work / "undisturbed", ["--resume"])  # nothing left to do: what starting and ending takes
lost = []
moments = sorted(start + (whole - start) * random.uniform(0.15, 0.95) for _ in range(kills))
for k, moment in enumerate(moments):
    # Each kill is that of a run of its own, so that what each of them costs can be told.
    out = h.work / f"killed {k}"
    before, killed = run(out, limit=moment)
    after, _ = run(out, ["--resume"])
    if killed:
        lost.append(before + after - whole - start)
    for what, d, within in same_results(h.work / "undisturbed", out):
        h.close(f"kill {k} at {moment:.1f} s: {what}", d, 0, within)
    h.true(f"kill {k}: nothing is left behind", sorted(p.name for p in out.iterdir()) == sorted(p.name for p in (h.work / "undisturbed").iterdir()))
h.true("it was killed", lost)
print(f"{case}: undisturbed {whole:.2f} s, start and end {start:.2f} s, lost at {len(lost)} kills: largest {max(lost):.2f}, "
      f"mean {sum(lost) / len(lost):.2f} s of processor time")
# Half a second between checkpoints, a piece of work under way, and as much for the start of a resumed study.
h.true("about a second of work is lost at most", max(lost) < 2, f"{max(lost):.2f} s")
h.finish()
