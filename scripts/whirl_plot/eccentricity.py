"""Largest eccentricity of the journal over speed, one panel per unbalance: equilibria, cycles, and those of twice the period."""
import numpy as np

from .bifurcation import Followed, legend, without_twins
from .canvas import Line2D
from .style import grid_of, save


def groups(study):
    """(Omega_0 [rad/s], a*) of the study of a rigid rotor; nothing of others."""
    values = study.values
    if "nondimensional.speed_scale" not in values or "nondimensional.unbalance" not in values:
        return None
    return values["nondimensional.speed_scale"].value, values["nondimensional.unbalance"].value


def words_of(study):
    """Name and what kind of motion it is."""
    if study.kind == "equilibrium_branch":
        return f"{study.name}: equilibrium"
    turns = int(study.attribute("period_turns", 1))
    return f"{study.name}: " + (f"period {turns}" if study.attribute("unbalance", "") else "self-excited")


def eccentricity(branch):
    """Of the first bearing, per clearance."""
    if branch.study.kind == "cycle_branch":
        return branch.column("eccentricity_max")[:, 0]
    return np.hypot(branch.column("x")[:, 0], branch.column("y")[:, 0]) / branch.study.get("bearings/clearance")[0]


def draw(results):
    studies = [s for s in results.studies
               if groups(s) and s.has("branch/parameter", "bearings/clearance")
               and s.attribute("parameter_unit") == "rad/s" and s.attribute("parameter") == "speed"
               and (s.kind == "equilibrium_branch" or (s.kind == "cycle_branch" and s.has("branch/eccentricity_max")))]
    if len(studies) < 2:
        return []
    panels, branches = {}, without_twins([Followed(s) for s in studies])
    for branch in branches:
        # The equilibria of a rotor with unbalance are those of the balanced one.
        balanced = branch.study.kind == "equilibrium_branch" or not branch.study.attribute("unbalance", "")
        panels.setdefault(0.0 if balanced else groups(branch.study)[1], []).append(branch)
    figure, axes, _ = grid_of(len(panels), width=4.6, height=2.7 if len(panels) > 1 else 3.8, columns=2)
    for axis, (unbalance, members) in zip(axes, sorted(panels.items())):
        for branch in members:
            study = branch.study
            height, across = eccentricity(branch), 1 / groups(study)[0]
            branch.draw(axis, height, study.colour, across=across)
            branch.mark(axis, [height], size=5, across=across)
        axis.set_title(f"a* = {unbalance:.3g}" if unbalance else "balanced")
        axis.set_xlabel(r"$\Omega^* = \Omega/\Omega_0$")
        axis.set_ylabel(r"max $\varepsilon$")
        # Only a compliant wall lets the journal go further than the clearance.
        axis.set_ylim(0, max(1.02, 1.04 * max(np.nanmax(eccentricity(b)) for b in members)))
    handles = [Line2D([], [], color=b.study.colour, label=words_of(b.study)) for b in branches]
    return save(figure, results.whole("largest eccentricity"), "eccentricity",
                "largest eccentricity of the journal over one cycle, per clearance", legend(branches, handles))
