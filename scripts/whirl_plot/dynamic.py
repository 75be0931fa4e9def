"""Stiffness and damping of one bearing over the frequency, and where there are several speeds over the speed."""
import numpy as np

from .canvas import Line2D, plain_numbers, plt
from .style import INK, save

PORTS = ("x", "y", "slope_x", "slope_y")
SHORT = {"x": "x", "y": "y", "slope_x": "x'", "slope_y": "y'"}
UNITS = {"k": ("N/\u00b5m", "N", "N m"), "c": ("N s/m", "N s", "N m s")}


def blocks_of(study):
    """Pairs of the shifts, and of the slopes where there are any; those between are zero in most bearings and drawn only if not."""
    pairs = [[(a, b) for a in ports for b in ports] for ports in (PORTS[:2], PORTS[2:])]
    return [("translation", pairs[0])] + ([("tilt", pairs[1])] if study.has("coefficients/k_slope_x_slope_x") else [])


def name_of(letter, pair):
    return f"coefficients/{letter}_" + ("_" if "slope" in "".join(pair) else "").join(pair)


def draw_block(study, what, pairs, over, along, axis_label, lines, colours, labels):
    figure, grid = plt.subplots(2, 4, figsize=(12.4, 5.6), sharex=True)
    slopes = 2 if what == "tilt" else 0
    for axes, letter in zip(grid, "kc"):
        factor = 1e-6 if letter == "k" and slopes == 0 else 1
        for axis, pair in zip(axes, pairs):
            table = np.moveaxis(study.get(name_of(letter, pair)), along, -1) * factor
            error = study.get(name_of(letter, pair) + "_uncertainty") if study.has(name_of(letter, pair) + "_uncertainty") else None
            error = None if error is None else np.moveaxis(error, along, -1) * factor
            order = np.argsort(over, kind="stable")
            for i, colour in zip(lines, colours):
                axis.plot(over[order], table[i][order], color=colour, marker=".", markersize=3.5)
                if error is not None and np.all(np.isfinite(error[i])):
                    axis.fill_between(over[order], (table[i] - error[i])[order], (table[i] + error[i])[order], color=colour, alpha=0.2, linewidth=0)
            axis.axhline(0, color=INK, linewidth=0.7)
            if along == 1:
                axis.set_xscale("log")
                plain_numbers(axis.xaxis)
            axis.set_title(f"${letter}_{{{SHORT[pair[0]]}{SHORT[pair[1]]}}}$ [{UNITS[letter][slopes]}]")
            if letter == "c":
                axis.set_xlabel(axis_label)
    handles = [Line2D([], [], color=c, marker=".", label=label) for c, label in zip(colours, labels)]
    note = "K = \u2212dF/dx, C = \u2212dF/d(dx/dt); first index: force (moment), second: motion (x', y': slopes dx/dz, dy/dz); bands: error of the film mesh"
    return save(figure, study, f"coefficients-{what}-{'frequency' if along == 1 else 'speed'}", note, handles)


def draw(study):
    """Over the frequency, a colour for each speed; over the speed, a colour for each frequency of the summary."""
    if not study.has("coefficients/ratio", "coefficients/speed"):
        return []
    ratio, speed = study.get("coefficients/ratio"), study.get("coefficients/speed")
    files = []
    for what, pairs in blocks_of(study):
        if len(ratio) > (2 if len(speed) > 1 else 1):  # fewer make no curve; those of several speeds are drawn over the speed
            colours = [INK] if len(speed) == 1 else list(plt.cm.viridis(np.linspace(0, 0.9, len(speed))))
            files += draw_block(study, what, pairs, ratio, 1, r"frequency $\omega/\Omega$", range(len(speed)), colours,
                                [f"{s:.6g} rad/s" for s in speed])
        if len(speed) > 1:
            shown = range(min(len(ratio), 6))
            colours = list(plt.cm.viridis(np.linspace(0, 0.9, len(shown))))
            files += draw_block(study, what, pairs, speed, 0, "speed [rad/s]", shown, colours, [rf"$\omega/\Omega$ = {ratio[k]:g}" for k in shown])
    return files
