"""Stiffness and damping of one bearing by enforced motion: over the amplitude, and over the frequency beside the perturbation."""
import numpy as np

from .canvas import Line2D, plain_numbers, plt
from .dynamic import SHORT, UNITS, blocks_of, name_of
from .style import DASHED, INK, save


def draw_block(study, what, pairs, over, along, label, shown, colours, labels, of):
    """`along` is the axis of the tables that is drawn along; `shown` are the places on the others."""
    figure, grid = plt.subplots(2, 4, figsize=(12.4, 5.6), sharex=True)
    slopes = 2 if what == "tilt" else 0
    order = np.argsort(over, kind="stable")
    for axes, letter in zip(grid, "kc"):
        factor = 1e-6 if letter == "k" and slopes == 0 else 1
        for axis, pair in zip(axes, pairs):
            small = study.get(name_of(letter, pair)) * factor
            table = study.get(name_of(letter, pair).replace("coefficients/", "enforced/")) * factor
            for place, colour in zip(shown, colours):
                line = table[place] if along == 2 else table[place[0], :, place[1]] if along == 1 else table[:, place[0], place[1]]
                axis.plot(over[order], line[order], color=colour, marker=".", markersize=4)
                if along == 2:
                    axis.axhline(small[place], color=colour, linestyle=DASHED, linewidth=1)
            if along < 2:
                line = small[shown[0][0]] if along == 1 else small[:, shown[0][0]]
                axis.plot(over[order], line[order], color=INK, linestyle=DASHED, linewidth=1)
            low, high = axis.get_ylim()
            if low > 0 and high > 0 and pair[0] == pair[1]:
                axis.set_ylim(0, 1.05 * high)
            axis.axhline(0, color=INK, linewidth=0.7)
            if along == 1:
                axis.set_xscale("log")
                plain_numbers(axis.xaxis)
            axis.set_title(f"${letter}_{{{SHORT[pair[0]]}{SHORT[pair[1]]}}}$ [{UNITS[letter][slopes]}]")
            if letter == "c":
                axis.set_xlabel(label)
    handles = [Line2D([], [], color=c, marker=".", label=t) for c, t in zip(colours, labels)]
    handles.append(Line2D([], [], color=INK, linestyle=DASHED, label="by perturbation"))
    note = "K = \u2212dF/dx, C = \u2212dF/d(dx/dt); first index: force (moment), second: motion (x', y': slopes). Amplitudes: 0-peak, in clearances; slopes: the same length over twice the bearing's"
    return save(figure, study, f"enforced-{what}-{of}", note, handles)


def draw(study):
    if not study.has("enforced/amplitude", "enforced/ratio", "enforced/speed"):
        return []
    speed, ratio, amplitude = (study.get(f"enforced/{n}") for n in ("speed", "ratio", "amplitude"))
    colours = lambda n: [INK] if n == 1 else list(plt.cm.viridis(np.linspace(0, 0.9, n)))  # noqa: E731
    files = []
    for what, pairs in blocks_of(study):
        if len(amplitude) > 1:
            shown = [(s, f) for s in range(len(speed)) for f in range(len(ratio))][:6]
            files += draw_block(study, what, pairs, amplitude, 2, "amplitude [clearances]", shown, colours(len(shown)),
                                [rf"{speed[s]:.6g} rad/s, $\omega/\Omega$ = {ratio[f]:.4g}" for s, f in shown], "amplitude")
        few = range(min(len(amplitude), 6))
        labels = [f"amplitude {amplitude[k]:g}" for k in few]
        if len(ratio) > 1:
            files += draw_block(study, what, pairs, ratio, 1, r"frequency $\omega/\Omega$", [(0, k) for k in few], colours(len(few)), labels, "frequency")
        if len(speed) > 1:
            files += draw_block(study, what, pairs, speed, 0, "speed [rad/s]", [(0, k) for k in few], colours(len(few)), labels, "speed")
    return files
