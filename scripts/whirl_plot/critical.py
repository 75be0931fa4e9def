"""Undamped critical speeds over the stiffness of the bearings."""
import numpy as np

from .canvas import Line2D, plain_numbers, plt
from .style import COLOURS, INK, save

LINES = (("forward", "-"), ("backward", (0, (4, 2))))
TO_RPM = 30 / np.pi


def draw_map(study):
    """Critical speeds of forward and backward whirl, both axes logarithmic."""
    if not study.has("map/stiffness", "map/forward", "map/backward"):
        return []
    k = study.get("map/stiffness")
    figure, axis = plt.subplots(figsize=(8.6, 5.2))
    modes = 0
    for name, line in LINES:
        speeds = np.atleast_2d(study.get(f"map/{name}")) * TO_RPM
        modes = max(modes, speeds.shape[1])
        for n in range(speeds.shape[1]):
            if np.isfinite(speeds[:, n]).any():
                axis.loglog(k, speeds[:, n], color=COLOURS[n % len(COLOURS)], linestyle=line, linewidth=1.4)
    axis.set_xlabel("stiffness of each bearing [N/m]")
    axis.set_ylabel("undamped critical speed [rpm]")
    plain_numbers(axis.yaxis)
    handles = [Line2D([], [], color=COLOURS[n % len(COLOURS)], label=f"no. {n + 1}") for n in range(modes)]
    handles += [Line2D([], [], color=INK, linestyle=line, label=f"{name} whirl") for name, line in LINES]
    return save(figure, study, "critical-speeds", "equal springs at all bearings, with their pedestals; no damping or films", handles=handles)
