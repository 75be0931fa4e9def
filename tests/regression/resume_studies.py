#!/usr/bin/env python3
"""Studies that are killed and resumed find what undisturbed ones find, and work that a
checkpoint holds is not done again.

resume_studies.py PROGRAM SOURCE CASE KILLS SEED     kills at random amounts of work
resume_studies.py PROGRAM SOURCE CASE 0 CHECKPOINT   one stop, at that checkpoint
"""
import ctypes
import os
import platform
import random
import signal
import struct
import subprocess
import sys
import time

import h5py

from branches import SHORT
from compare import same_results
from harness import Harness

program, source, case, kills, seed = *sys.argv[1:4], int(sys.argv[4]), int(sys.argv[5])
h = Harness(program, source, [])
random.seed(seed)
COARSE = [f"bearings.B{k}.film.cells=[30, 8]" for k in range(1, 6)]
FIGURE = str(h.source / "inputs/compliant_rotor/figure_5_7.yaml")
CASES = {
    "modes": ("modes.yaml", ["studies=[{modes: {name: s, supports: films, range: {from: 600 rpm, to: 5000 rpm}, points: 12, count: 14}}]"]),
    "response": ("response.yaml", ["studies.1.unbalance_response.points=22"]),
    "equilibria": ("balanced.yaml", [*COARSE, "studies.1.equilibrium_branch.range={from: 4000 rpm, to: 5400 rpm}"]),
    # Bifurcations on compliant films, whose locations and error estimates take most of the time: the first ones, and all.
    "compliant": (FIGURE, ["studies.2.cycle_branch.max_eccentricity=0.3"]),
    "figure": (FIGURE, []),
    "cycles": ("unbalance.yaml", SHORT),
    "convergence": (str(h.source / "inputs/compliant_rotor/finite_curve.yaml"), [
        "bearings.half.film.cells=[24, 6]", "studies.1.cycle_branch.range={from: 320 rad/s, to: 340 rad/s}",
        "studies.1.cycle_branch.follow_flips=false", "studies.1.cycle_branch.flips=[]",
        "studies.2.mesh_convergence.doublings=2",
        "studies.3.mesh_convergence={name: again, of: unbalanced, bifurcations: [1], doublings: 1}"]),
    "locus": (str(h.source / "inputs/rigid_rotor/loci.yaml"), []),
}
# One stop needs no long run: the checkpoint lies behind most of its work.
ONE_STOP = {
    "modes": ["studies=[{modes: {name: s, supports: films, range: {from: 600 rpm, to: 1400 rpm}, points: 3, count: 6}}]"],
    "response": [f"studies.1.unbalance_response.{o}" for o in ("points=12", "nodes=[6]", "range={from: 600 rpm, to: 1300 rpm}")],
    "compliant": ["studies.2.cycle_branch.max_eccentricity=0.3", "bearings.half.film.cells=[24, 4]", "studies.2.cycle_branch.intervals=20"],
}
deck, overrides = CASES[case]
if kills == 0:
    overrides = ONE_STOP.get(case, overrides)


def counter():
    """Instructions of this process and all that it starts, which other work on the machine does not change as it changes
    processor time: perf_event_open(2). Nothing where the kernel does not let us."""
    hardware, instructions, disabled, inherit, no_kernel, no_hypervisor = 0, 1, 1 << 0, 1 << 1, 1 << 5, 1 << 6
    if platform.machine() != "x86_64":
        return None
    attributes = struct.pack("IIQQQQQ", hardware, 64, instructions, 0, 0, 0, inherit | no_kernel | no_hypervisor)
    attributes += bytes(64 - len(attributes))
    fd = ctypes.CDLL(None).syscall(298, ctypes.create_string_buffer(attributes, 64), 0, -1, -1, 0)
    return fd if fd >= 0 else None


COUNTER = counter()


def cpu(pid):
    """Processor time of a process so far, which on a busy machine tells how far it is; nothing once it has ended."""
    with open(f"/proc/{pid}/stat") as f:
        words = f.read().rsplit(")", 1)[1].split()
    return None if words[0] == "Z" else (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def between(out):
    """Seconds of work between the files that a killed run left behind: more where the disk is slow, so that saving takes no
    more than a twentieth of the time. Half a second before the first file."""
    found = [0.5]
    for path in out.glob("*.checkpoint.h5"):
        with h5py.File(path) as f:
            f.visititems(lambda _, x: found.append(float(x.attrs.get("seconds_between_files", 0))))
    return max(found)


def run(out, flags=(), limit=None):
    """Work of a run (instructions, or processor time where they are not counted), its processor time, and whether it was
    killed, by itself or when its work has come to `limit`."""
    counted = lambda: int.from_bytes(os.read(COUNTER, 8), "little")
    begin = counted() if COUNTER else 0
    process = subprocess.Popen(h.command(deck, out, overrides, flags), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    killed = False
    while limit is not None and not killed and (now := cpu(process.pid)) is not None:
        if (counted() - begin if COUNTER else now) >= limit:
            process.send_signal(signal.SIGKILL)
            killed = True
        time.sleep(5e-3)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = status
    killed = killed or status == signal.SIGKILL
    if status != 0 and not killed:
        sys.exit(f"{case}: exit status {status}")
    seconds = usage.ru_utime + usage.ru_stime
    return counted() - begin if COUNTER else seconds, seconds, killed


whole, seconds, _ = run(h.work / "undisturbed")
start, _, _ = run(h.work / "undisturbed", ["--resume"])  # nothing left to do: what starting and ending takes
lost, allowed = [], []
# The work under way, and the start of a resumed study.
work = 0.5 if case in ("compliant", "figure", "cycles", "convergence") else 1.5
# The same work takes more or less processor time, by what else runs on the cores; instructions do not.
noise = 0 if COUNTER else 0.2
moments = sorted(start + (whole - start) * random.uniform(0.15, 0.95) for _ in range(kills)) or [None]
for k, moment in enumerate(moments):
    # Each kill is that of a run of its own, so that what each of them costs can be told.
    out = h.work / f"killed {k}"
    before, _, killed = run(out, ["--stop-after-checkpoint", str(seed)] if moment is None else [], limit=moment)
    waited = between(out)
    after, _, _ = run(out, ["--resume"])
    share = (before if moment is None else moment) / whole
    if killed:
        lost.append((before + after - whole - start) / whole * seconds)
        # The file written last may have taken longer than those that its interval was chosen from.
        allowed.append(work + 2 * waited + noise * seconds)
        if kills == 0:  # a small run: one that began anew would lose all that was done
            allowed[-1] = min(allowed[-1], (share / 2 + noise) * seconds)
        print(f"killed at {share:.0%}: {lost[-1]:.2f} s lost, {waited:.2f} s between files", flush=True)
    for what, d, within in same_results(h.work / "undisturbed", out):
        h.close(f"kill {k} at {share:.0%}: {what}", d, 0, within)
    h.true(f"kill {k}: nothing is left behind", sorted(p.name for p in out.iterdir()) == sorted(p.name for p in (h.work / "undisturbed").iterdir()))
h.true("it was killed", lost)
print(f"{case}: undisturbed {seconds:.2f} s, start and end {start / whole * seconds:.2f} s, lost at {len(lost)} kills: largest "
      f"{max(lost):.2f}, mean {sum(lost) / len(lost):.2f} s of processor time")
worst = max(range(len(lost)), key=lambda k: lost[k] - allowed[k], default=None)
if worst is not None:
    h.true(f"at most {allowed[worst]:.1f} s of work are lost", lost[worst] < allowed[worst], f"{lost[worst]:.2f} s")
h.finish()
