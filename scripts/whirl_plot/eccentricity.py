"""Largest eccentricity of the journal over speed, one panel per unbalance: equilibria, cycles, and those of twice the period."""
import json

import numpy as np
from matplotlib.lines import Line2D

from .bifurcation import branch_of, events_of, heights
from .style import COLOURS, INK, branch_legend, draw_branch, grid_of, mark, save


def groups(results):
    """(Omega_0 [rad/s], a*) of each study of a rigid rotor, from summary.json."""
    found = {}
    try:
        for s in json.loads((results.directory / "summary.json").read_text())["studies"]:
            v = s["values"]
            if "nondimensional.speed_scale" in v:
                found[s["name"]] = v["nondimensional.speed_scale"]["value"], v["nondimensional.unbalance"]["value"]
    except (OSError, ValueError, KeyError):
        return {}
    return found


def eccentricity(study):
    """Of the first bearing, per clearance."""
    points = len(study.get("branch/parameter"))
    if study.kind == "cycle_branch":
        return study.get("branch/eccentricity_max").reshape(points, -1)[:, 0]
    x, y = (study.get(f"branch/{k}").reshape(points, -1)[:, 0] for k in "xy")
    return np.hypot(x, y) / study.get("bearings/clearance")[0]


def draw(results):
    known = groups(results)
    studies = [s for s in results.studies
               if s.name in known and s.has("branch/parameter", "bearings/clearance")
               and s.attribute("parameter_unit") == "rad/s" and s.attribute("parameter") == "speed"
               and (s.kind == "equilibrium_branch" or (s.kind == "cycle_branch" and s.has("branch/eccentricity_max")))]
    if len(studies) < 2:
        return []
    panels = {}
    for s in studies:
        # The equilibria of a rotor with unbalance are those of the balanced one.
        balanced = s.kind == "equilibrium_branch" or not s.attribute("unbalance", "")
        panels.setdefault(0.0 if balanced else known[s.name][1], []).append(s)
    figure, axes, _ = grid_of(len(panels), width=4.6, height=2.7 if len(panels) > 1 else 3.8, columns=2)
    kinds = {}
    for axis, (unbalance, members) in zip(axes, sorted(panels.items())):
        for s in members:
            turns = s.attribute("period_turns", 1) if s.attribute("unbalance", "") else 0
            words, colour = {1: ("period 1", COLOURS[0]), 2: ("period 2", COLOURS[1])}.get(turns, ("self-excited", COLOURS[2]))
            if s.kind == "equilibrium_branch":
                words, colour = "equilibrium", INK
            kinds[words] = colour
            parameter, stable, _ = branch_of(s)
            scale, height = known[s.name][0], eccentricity(s)
            draw_branch(axis, parameter / scale, height, stable, colour)
            for kind, value in events_of(s):
                mark(axis, kind, value / scale, heights(s, [height], kind, value)[0], size=5)
        axis.set_title(f"a* = {unbalance:.3g}" if unbalance else "balanced")
        axis.set_xlabel(r"$\Omega^* = \Omega/\Omega_0$")
        axis.set_ylabel(r"max $\varepsilon$")
        # Only a compliant wall lets the journal go further than the clearance.
        axis.set_ylim(0, max(1.02, 1.04 * max(np.nanmax(eccentricity(s)) for s in members)))
    handles = [Line2D([], [], color=c, label=w) for w, c in kinds.items()]
    return [save(figure, results.whole("largest eccentricity"), "eccentricity", "largest eccentricity of the journal over one cycle, per clearance",
                 branch_legend([k for s in studies for k, _ in events_of(s)], handles))]
