#!/usr/bin/env python3
"""A run that is killed again and again and resumed finds what an undisturbed one finds.

resume.py PROGRAM SOURCE KILLS SEED LAUNCHER WORDS...

Every kill is a SIGKILL to the launcher and all its ranks at a random moment of the run; the next attempt resumes, on
one or two ranks.
"""
import random
import subprocess
import sys
import time

from branches import G25, G63, SHORT
from compare import same_results
from harness import Harness, kill

program, source, kills, seed = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
h = Harness(program, source, sys.argv[5:])
random.seed(seed)
# Many kills need a longer way: seven bifurcations.
LONG = [G25 + "range={from: 4000 rpm, to: 5200 rpm}", G25 + "at=[4300 rpm]", G63 + "range={from: 2500 rpm, to: 4100 rpm}",
        G63 + "at=[2700 rpm, 3600 rpm]", *SHORT[-4:]]
deck = LONG if kills > 6 else SHORT


def on(ranks):
    return [*h.launcher, "-n", str(ranks)] if ranks > 1 else []


def left(out):
    return sorted(p.name for p in out.iterdir()) if out.exists() else []


begin = time.monotonic()
h.run("unbalance.yaml", "undisturbed", deck, launcher=on(1))
duration = time.monotonic() - begin

out, done, seen = h.work / "killed", 0, {}
flags = []
# Early ones first: before the first checkpoint, before anything is written.
moments = [0.02 * duration, 0.08 * duration] + [random.uniform(0.05, 0.5) * duration for _ in range(kills - 2)]
while True:
    ranks = random.choice([1, 1, 2]) if kills > 6 else 1 + (done == kills // 2)
    process = subprocess.Popen(h.command("unbalance.yaml", out, deck, flags, on(ranks)), stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    if done < kills:
        if done % 4 == 3:
            # As soon as the next checkpoint is being written.
            limit = time.monotonic() + duration
            while process.poll() is None and time.monotonic() < limit and not any(".next" in n for n in left(out)):
                time.sleep(2e-4)
        else:
            try:
                process.wait(moments[done])
            except subprocess.TimeoutExpired:
                pass
    text = ""
    if done < kills and process.poll() is None:
        kill(process)
        done += 1
        for name in left(out):
            seen[name] = seen.get(name, 0) + 1
    else:
        text = process.communicate()[0]
        if process.returncode != 0:
            sys.exit(f"resumed run: exit {process.returncode}\n{text}")
        if done >= kills:
            break
        # Finished before the kill: begin anew, so that all the kills happen.
        for what, d, within in same_results(h.work / "undisturbed", out):
            h.close(f"after {done} kills: {what}", d, 0, within)
        subprocess.run(["rm", "-r", out], check=True)
    flags = ["--resume"] if out.exists() else []

for what, d, within in same_results(h.work / "undisturbed", out):
    h.close(f"after {done} kills: {what}", d, 0, within)
h.true("nothing is left behind", left(out) == left(h.work / "undisturbed"), str(left(out)))
print(f"{done} kills, undisturbed {duration:.1f} s; what a kill left: {seen}")

# A finished run resumes to itself.
before = (out / "results.h5").read_bytes()
h.run("unbalance.yaml", "killed", deck, ["--resume"], launcher=on(1))
h.true("a finished run is not computed again", (out / "results.h5").read_bytes() == before)
h.finish()
