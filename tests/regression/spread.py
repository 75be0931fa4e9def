#!/usr/bin/env python3
"""Cycles of films whose states the ranks share, by collocation: those of one rank with a whole machine, on any number of
ranks. What a killed run leaves is written by rows and serves any number of ranks. A flip, the branch born there and the
flip on finer films go the same way.

spread.py PROGRAM SOURCE two|flip|more LAUNCHER      two ranks; at night with the flip, three and four ranks, groups that share intervals
"""
import shutil
import subprocess
import sys

import h5py
import numpy

from compare import datasets
from harness import Harness

h = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
SHORT = "      max_points: 3\n"
FLIP = """      max_points: 3
      at: [325 rad/s]
      follow_flips: true
      flips: [1]
  - mesh_convergence: {name: fine, of: s, doublings: 1}
"""
TABLE = ("parameter", "period", "x_max", "x_min", "y_max", "y_min", "film_min", "unstable_count", "intervals")


def on(ranks):
    return [*h.launcher, "-n", str(ranks)] if ranks > 1 else []


def deck(machine, more=FLIP, groups=1):
    path = h.work / f"{machine}{len(more)}{groups}.yaml"
    path.write_text(f"""base: {h.source / 'inputs/compliant_rotor/finite_curve.yaml'}
layout: {{machine: {machine}, time_groups: {groups}}}
bearings: {{half: {{film: {{cells: [16, 4]}}}}}}
studies:
  - cycle_branch:
      name: s
      unbalance: [a]
      parameter: speed
      range: {{from: 320 rad/s, to: 350 rad/s}}
      step: {{initial: 4 rad/s, min: 0.001 rad/s, max: 20 rad/s}}
      method: collocation
      intervals: 12
      degree: 2
      mesh_tolerance: 1e-3
""" + more)
    return path


def killed(name, ranks, more, wanted, groups=1, most=40, apart=1):
    """A run, resumed if there is one, that kills itself at each `apart`-th checkpoint until one holds the dataset `wanted`: whether
    that is by rows. None if there is none such."""
    out = h.work / name
    for _ in range(most):
        flags = ["--stop-after-checkpoint", str(apart), *(["--resume"] if out.exists() else [])]
        subprocess.run(h.command(deck("all_ranks", more, groups), out, flags=flags, launcher=on(ranks)), stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        if not (out / "s.checkpoint.h5").exists():
            return None
        with h5py.File(out / "s.checkpoint.h5") as f:
            if wanted in f:
                return f[wanted].id.get_create_plist().get_fill_time() == h5py.h5d.FILL_TIME_NEVER
    return None


def compare(one, other, studies, within):
    """Of both runs: tables, leading multipliers, bifurcations."""
    a, b = (datasets(h.work / name / "results.h5") for name in (one, other))
    for s in studies:
        worst, where = 0, "all"
        for key in TABLE:
            x, y = (d[f"studies/{s}/branch/{key}"] for d in (a, b))
            d = abs(x - y).max() / (abs(y).max() or 1) if x.shape == y.shape else float("inf")
            if not d <= worst:
                worst, where = d, key
        h.close(f"{one}, {other}: {s}, worst difference, of {where}", worst, 0, within)
        mu = [abs(d[f"studies/{s}/branch/multipliers_real"][:, :2] + 1j * d[f"studies/{s}/branch/multipliers_imag"][:, :2])
              for d in (a, b)]
        h.close(f"{one}, {other}: {s}, moduli of the first two multipliers", abs(mu[0] - mu[1]).max(), 0, within)
    for k, (x, y) in enumerate(zip(h.studies(one)["s"]["bifurcations"], h.studies(other)["s"]["bifurcations"], strict=True)):
        h.close(f"{one}, {other}: bifurcation {k + 1} [rad/s]", x["value"], y["value"], 1e-4)


def two(more):
    flip = more == FLIP
    studies = ("s", "s flip 1") if flip else ("s",)
    h.run(deck("one_rank", more), "whole", launcher=[])
    alone = h.run(deck("all_ranks", more), "alone", launcher=[])
    points = [s["points"] for s in alone.values()]
    h.true("the flip is met and followed" if flip else "three points", points == ([3, 3, 2] if flip else [3]), f"{points}")
    compare("alone", "whole", studies, 1e-6)
    found = datasets(h.work / "alone/results.h5")
    real, imag = (found[f"studies/s/branch/multipliers_{part}"] for part in ("real", "imag"))
    h.true("multipliers that were not searched for are no numbers, and none is zero",
           numpy.isnan(real[:, -1]).all() and not numpy.any((real == 0) & (imag == 0)), f"{real[0]}")
    # Killed within the location of the flip, and behind the first point; the rest on as many ranks, with all that was left.
    if flip:
        h.true("two ranks: killed with a replay log by rows", killed("two", 2, more, "state/replay_log/vector 1"))
    h.true("two ranks: killed with cycles by rows", killed("two", 2, more, "state/state/cycle/states", apart=1 if flip else 3))
    shutil.copytree(h.work / "two", h.work / "one")
    for name, ranks in (("two", 2), ("one", 1)):
        h.run(deck("all_ranks", more), name, flags=["--resume"], launcher=on(ranks))
        compare(name, "alone", studies, 1e-7)
        if flip:
            fine = [h.studies(run)["fine"]["bifurcations"][0]["value"] for run in (name, "alone")]
            h.close(f"{name}, alone: the flip's limit of fine films [rad/s]", fine[0], fine[1], 1e-4)


def more():
    h.run(deck("all_ranks", SHORT), "branch", launcher=[])
    h.true("one rank: killed with cycles by rows", killed("three", 1, SHORT, "state/state/cycle/states"))
    h.run(deck("all_ranks", SHORT), "three", flags=["--resume"], launcher=on(3))
    compare("three", "branch", ("s",), 1e-7)
    # Groups that share the intervals, of one rank each and of two: what they leave serves them, and ranks without groups.
    h.true("two groups: killed with cycles by rows", killed("in time", 2, SHORT, "state/state/cycle/states", groups=2))
    h.true("four ranks in two groups: killed with cycles by rows", killed("both", 4, SHORT, "state/state/cycle/states", groups=2))
    for name, ranks in (("in time", 2), ("both", 1)):
        h.run(deck("all_ranks", SHORT, 2), name, flags=["--resume"], launcher=on(ranks))
        compare(name, "branch", ("s",), 1e-7)
    said = h.studies("in time")["s"]["layout"]
    h.true("it says so", said.startswith("intervals shared by 2 groups, a machine on each one's 1 ranks"), said)


{"two": lambda: two(SHORT), "flip": lambda: two(FLIP), "more": more}[sys.argv[3]]()
h.finish()
