#!/usr/bin/env python3
"""Studies without checkpoints of their own - equilibria, modes, response - start anew when a killed run is resumed, and find
the same; those that were finished are not computed again.

restarts.py PROGRAM SOURCE
"""
import json
import os
import signal
import subprocess
import sys
import time

from compare import same_results
from harness import GUYAN, Harness

DECK = """base: {base}
studies:
  - equilibrium_branch: {{name: first, parameter: speed, range: {{from: 5000 rpm, to: 5600 rpm}}}}
  - modes: {{range: {{from: 1000 rpm, to: 4000 rpm}}, points: 12}}
  - unbalance_response: {{unbalance: [gen_pair], range: {{from: 1000 rpm, to: 4000 rpm}}, points: 60, nodes: [120]}}
  - equilibrium_branch: {{name: last, parameter: speed, range: {{from: 5600 rpm, to: 5000 rpm}}}}
"""


def finished(out):
    """Names of the studies that a summary holds, with the seconds each took."""
    try:
        studies = json.loads((out / "summary.json").read_text())["studies"]
    except (OSError, ValueError):
        return {}
    return {s["name"]: s["wall_seconds"] for s in studies if s["status"] == "completed"}


h = Harness(sys.argv[1], sys.argv[2], [])
deck = h.work / "deck.yaml"
deck.write_text(DECK.format(base=h.train / "train.yaml"))
h.run(deck, "whole", GUYAN)
names = list(finished(h.work / "whole"))
h.true("four studies", len(names) == 4, str(names))

# Killed in the second, the third and the last study: as soon as the one before is in the summary.
out = h.work / "killed"
before = {}
for k in range(1, 4):
    process = subprocess.Popen(h.command(deck, out, GUYAN, ["--resume"] if k > 1 else []), stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    limit = time.monotonic() + 200
    while len(finished(out)) < k and process.poll() is None and time.monotonic() < limit:
        time.sleep(0.002)
    h.true(f"killed while study {k + 1} of 4 runs", process.poll() is None and len(finished(out)) == k, str(list(finished(out))))
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    now = finished(out)
    h.true("what was finished is kept, not computed again", all(now[name] == before[name] for name in before))
    before = now
h.run(deck, "killed", GUYAN, ["--resume"])
for what, difference, within in same_results(h.work / "whole", out, 1e-14):
    h.close(f"resumed: {what}", difference, 0, within)
h.finish()
