"""Convergence over the elements of a shaft: errors of whirl frequencies, shifts by shear, condition numbers."""
import numpy as np
from matplotlib.ticker import NullLocator

from .canvas import Line2D, plt
from .style import COLOURS, INK, save, ticks_at

NUMBERS = (("condition_vectors", "-", "vectors of the modes"), ("condition_stiffness", (0, (4, 2)), "stiffness"),
           ("condition_mass", (0, (1.2, 1.4)), "mass"))


def kinds_of(study):
    """(name, table) of each kind of element in the order of the deck."""
    if "convergence" not in study.group:
        return []
    return sorted(study.group["convergence"].items(), key=lambda item: item[1].attrs["place"])


def count_elements(axis, elements):
    """Names the meshes on a logarithmic axis."""
    ticks_at(axis.xaxis, elements, [f"{n:.0f}" for n in elements])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xlabel("elements")


def draw_errors(study):
    """A panel for each kind of element, a line for each mode: relative distance from the last mesh."""
    kinds = kinds_of(study)
    if not kinds:
        return []
    figure, axes = plt.subplots(1, len(kinds), figsize=(max(7.2, 3.7 * len(kinds)), 4.4), sharey=True, squeeze=False)
    for axis, (name, table) in zip(axes[0], kinds):
        elements, error = table["elements"][()], table["error"][()]
        colours = plt.cm.viridis(np.linspace(0, 0.92, error.shape[1]))
        for mode in range(error.shape[1]):
            shown = error[:-1, mode] > 0
            axis.loglog(elements[:-1][shown], error[:-1, mode][shown], color=colours[mode], marker=".", linewidth=1.3)
        for power, line in ((2, (0, (1.2, 1.4))), (4, (0, (4, 2)))):
            lines = error[0][np.isfinite(error[0]) & (error[0] > 0)]
            if len(lines):
                axis.loglog(elements[:-1], lines.max() * (elements[0] / elements[:-1]) ** power, color=INK, linewidth=0.8, linestyle=line)
        axis.set_title(name)
        count_elements(axis, elements)
    axes[0, 0].set_ylabel("relative distance from the last mesh")
    count = kinds[0][1]["error"].shape[1]
    colours = plt.cm.viridis(np.linspace(0, 0.92, count))
    handles = [Line2D([], [], color=colours[k], label=f"mode {k + 1}") for k in sorted({0, count // 2, count - 1})]
    handles += [Line2D([], [], color=INK, linewidth=0.8, linestyle=(0, (1.2, 1.4)), label=r"$\propto$ elements$^{-2}$"),
                Line2D([], [], color=INK, linewidth=0.8, linestyle=(0, (4, 2)), label=r"$\propto$ elements$^{-4}$")]
    return save(figure, study, "convergence", f"speed {study.attribute('speed', 0):.6g} rad/s; modes by rising frequency", handles)


def draw_shifts(study):
    """What each kind of element says differently from the first: over the number of the mode, and over its frequency."""
    kinds = kinds_of(study)
    if len(kinds) < 2:
        return []
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 4.0), sharey=True)
    base = kinds[0][1]["frequency"][-1]
    for colour, (name, table) in zip(COLOURS, kinds[1:]):
        shift = 100 * table["shift"][()]
        left.plot(np.arange(1, len(shift) + 1), shift, "o-", color=colour, markersize=4)
        right.plot(base / (2 * np.pi), shift, "o-", color=colour, markersize=4)
    left.set_xlabel("mode")
    right.set_xlabel(f"frequency of {kinds[0][0]} [Hz]")
    left.set_ylabel(f"shift from {kinds[0][0]} [%]")
    handles = [Line2D([], [], color=c, marker="o", markersize=4, label=name) for c, (name, _) in zip(COLOURS, kinds[1:])]
    return save(figure, study, "shifts", f"on the last mesh; speed {study.attribute('speed', 0):.6g} rad/s", handles)


def draw_conditions(study):
    """Condition numbers over the number of elements, a colour for each kind of element."""
    kinds = [(name, table) for name, table in kinds_of(study) if "condition_vectors" in table]
    if not kinds:
        return []
    figure, axis = plt.subplots(figsize=(7.6, 4.6))
    for colour, (name, table) in zip(COLOURS, kinds):
        for key, line, _ in NUMBERS:
            axis.loglog(table["elements"][()], table[key][()], color=colour, linestyle=line, marker=".")
    count_elements(axis, kinds[0][1]["elements"][()])
    axis.set_ylabel("condition number")
    handles = [Line2D([], [], color=c, label=name) for c, (name, _) in zip(COLOURS, kinds)]
    handles += [Line2D([], [], color=INK, linestyle=line, label=words) for _, line, words in NUMBERS]
    return save(figure, study, "conditions", "2-norm, states and rows in the system's scales, vectors of length one", handles)
