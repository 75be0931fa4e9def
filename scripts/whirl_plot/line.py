"""Shapes of torsion and of motion along the shaft."""
import numpy as np

from .canvas import Line2D, plt
from .style import COLOURS, save
from .units import digits

SHOWN = 6


def draw(study):
    """The lowest modes along the shaft, each named by its frequency."""
    if not study.has("line/z", "line/shape", "spectrum/frequency"):
        return []
    z, frequency = study.get("line/z"), np.atleast_1d(study.get("spectrum/frequency"))
    shapes = np.reshape(study.get("line/shape"), (len(frequency), len(z)))
    figure, axis = plt.subplots(figsize=(8.6, 4.4))
    handles = []
    for k, (f, shape) in enumerate(zip(frequency[:SHOWN], shapes)):
        colour = COLOURS[k % len(COLOURS)]
        axis.plot(z, shape, color=colour, linewidth=1.4, marker=".", markersize=4)
        handles.append(Line2D([], [], color=colour, marker=".", label=f"{k + 1}: {digits(f / (2 * np.pi), 5)} Hz"))
    axis.axhline(0, color="black", linewidth=0.5)
    axis.set_xlabel("z [m]")
    twists = "twist" in str(study.group["line/shape"].attrs.get("description", ""))
    axis.set_ylabel(("angle of twist" if twists else "axial displacement") + ", scaled to 1 [-]")
    return save(figure, study, "line-modes", "undamped modes; bearings take no part", handles=handles)
