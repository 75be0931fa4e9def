"""Floquet multipliers of a branch of cycles with the unit circle, and their moduli over the parameter."""
import matplotlib.pyplot as plt
import numpy as np

from .bifurcation import events_of
from .style import BAD, GREY, INK, MARKS, levels, parameter_label, save


def draw(study):
    if not study.has("branch/multipliers_real"):
        return []
    parameter = study.get("branch/parameter")
    values = study.get("branch/multipliers_real") + 1j * study.get("branch/multipliers_imag")
    values = values.reshape(len(parameter), -1)
    figure, (plane, moduli) = plt.subplots(1, 2, figsize=(10.4, 5.2), width_ratios=[1.05, 1])
    angle = np.linspace(0, 2 * np.pi, 361)
    plane.fill(np.cos(angle), np.sin(angle), color="#f3f6f9", zorder=0)
    plane.plot(np.cos(angle), np.sin(angle), color=INK, linewidth=1.1)
    plane.axhline(0, color=GREY, linewidth=0.5)
    plane.axvline(0, color=GREY, linewidth=0.5)
    colour = np.repeat(parameter[:, None], values.shape[1], axis=1)
    inside = np.abs(values) <= 1
    points = plane.scatter(values.real[inside], values.imag[inside], c=colour[inside], s=13, cmap="viridis", linewidths=0,
                           vmin=parameter.min(), vmax=parameter.max(), zorder=3)
    plane.scatter(values.real[~inside], values.imag[~inside], c=colour[~inside], s=22, cmap="viridis", edgecolors=BAD,
                  linewidths=0.5, vmin=parameter.min(), vmax=parameter.max(), zorder=4)
    reach = 1.12 * max(1.0, min(2.5, np.nanmax(np.abs(values))))
    plane.set_xlim(-reach, reach)
    plane.set_ylim(-reach, reach)
    plane.set_aspect("equal")
    plane.set_xlabel("real part")
    plane.set_ylabel("imaginary part")
    plane.set_title("Floquet multipliers (red rim: unstable)")
    figure.colorbar(points, ax=plane, shrink=0.8, pad=0.02, label=parameter_label(study)).outline.set_visible(False)

    sizes = -np.sort(-np.abs(values), axis=1)
    for k in range(sizes.shape[1]):
        moduli.plot(parameter, sizes[:, k], color=INK if k == 0 else GREY, linewidth=1.6 if k == 0 else 0.8)
    moduli.axhline(1, color=BAD, linewidth=1.0)
    top = 1.08 * max(1.0, min(2.5, np.nanmax(sizes)))
    events = events_of(study)
    for (kind, value), level in zip(events, levels([v for _, v in events], np.ptp(parameter), 0.09)):
        short, _, colour_, _ = MARKS.get(kind, (kind, "", INK, ""))
        moduli.axvline(value, color=colour_, linewidth=0.8, linestyle=":")
        moduli.annotate(short, (value, top), xytext=(2, -2 - 10 * level), textcoords="offset points", fontsize=8, color=colour_,
                        va="top", fontweight="bold")
    moduli.set_ylim(0, top)
    moduli.set_xlim(parameter.min(), parameter.max())
    moduli.set_xlabel(parameter_label(study))
    moduli.set_ylabel("modulus")
    moduli.set_title("modulus over the branch")
    return [save(figure, study, "multipliers")]
