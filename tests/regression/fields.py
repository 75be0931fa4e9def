#!/usr/bin/env python3
"""Fields of films whose states all ranks share: each rank writes rows of them.

fields.py PROGRAM SOURCE LAUNCHER WORDS...
"""
import subprocess
import sys
import time

import h5py
import numpy as np

from harness import Harness, kill

h = Harness(sys.argv[1], sys.argv[2], sys.argv[3:])
path = h.work / "deck.yaml"
path.write_text(f"base: {h.source / 'inputs/compliant_rotor/finite_curve.yaml'}\nlayout: {{machine: all_ranks}}\n"
                "bearings: {half: {film: {cells: [12, 4]}}}\n"
                "studies:\n  - static: {name: a, speed: 320 rad/s}\n  - static: {name: b, speed: 480 rad/s}\n")


def on(ranks):
    return [*h.launcher, "-n", str(ranks)]


def films(out):
    """All datasets of films, and which of them were written by rows."""
    found, by_rows = {}, set()
    with h5py.File(out / "results.h5") as f:
        def visit(name, item):
            if isinstance(item, h5py.Dataset) and "/films/" in name:
                found[name] = item[()]
                if item.id.get_create_plist().get_fill_time() == h5py.h5d.FILL_TIME_NEVER:
                    by_rows.add(name.rsplit("/", 1)[1])
        f.visititems(visit)
    return found, by_rows


h.run(path, "whole", launcher=on(1))
# Three ranks write the first study; two ranks read it, and write it again with the second one.
out = h.work / "killed"
process = subprocess.Popen(h.command(path, out, launcher=on(3)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
while process.poll() is None and not (out / "summary.json").exists():
    time.sleep(1e-3)
h.true("killed behind the first study", process.poll() is None)
kill(process)
first, by_rows = films(out)
h.true("one study is there", len({name.split("/")[1] for name in first}) == 1, str(sorted(first)[:2]))
h.true("written by rows", by_rows == {"pressure", "thickness", "node_xyz", "node_flat"}, str(by_rows))
h.run(path, "killed", flags=["--resume"], launcher=on(2))

whole, found = films(h.work / "whole")[0], films(out)[0]
h.true("as many datasets as on one rank", whole.keys() == found.keys() and len(whole) == 12, f"{len(whole)}, {len(found)}")
for name, values in whole.items():
    scale = np.abs(values).max()
    h.close(f"{name}, per its largest", np.abs(found[name] - values).max() / scale, 0, 1e-9)
    if name in first:
        h.true(f"{name}: kept to the bit", np.array_equal(found[name], first[name]))
    rows = np.abs(values).reshape(len(values), -1).max(axis=1)
    if name.endswith("thickness"):
        h.true(f"{name}: every row is there", rows.min() > 0.1 * rows.max())
h.finish()
