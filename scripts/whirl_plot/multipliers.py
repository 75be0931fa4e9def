"""Floquet multipliers of a branch of cycles with the unit circle, and their moduli over the parameter."""
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.ticker import MaxNLocator

from .bore import shade
from .canvas import plt
from .style import BAD, GREY, INK, MARKS, levels, parameter_label, save, span_of
from .units import digits

CLOSE = 0.12  # half the height of the close-up around one


def both_of_pairs(values):
    """A branch may keep one multiplier of a conjugate pair: each row with the missing ones, NaN where there is none."""
    rows = []
    for row in values:
        row = row[np.isfinite(row) & (row != 0)]
        rows.append(np.concatenate([row, [np.conj(v) for v in row if v.imag and not np.any(np.isclose(row, np.conj(v), rtol=1e-9, atol=0))]]))
    full = np.full((len(rows), max(map(len, rows), default=0)), np.nan + 0j)
    for k, row in enumerate(rows):
        full[k, :len(row)] = row
    return full


def joined(values):
    """(point, column, column of the next point) of multipliers that are each other's nearest ones there: how each goes on."""
    gap = np.abs(values[:-1, :, None] - values[1:, None, :])
    gap = np.where(np.isfinite(gap), gap, np.inf)
    k, i = np.nonzero(np.isfinite(gap.min(axis=2, initial=np.inf)))
    j = gap[k, i].argmin(axis=1)
    mutual = (gap[k, :, j].argmin(axis=1) == i) & (gap[k, i, j] < 0.4 * np.maximum(1, np.abs(values[k, i])))
    return k[mutual], i[mutual], j[mutual]


def where_crossed(kind, value, parameter, values):
    """Where on the unit circle a multiplier is at a bifurcation; of a Neimark-Sacker point the one nearest to the circle there."""
    if kind in ("flip", "cyclic_fold", "fold", "branch_point"):
        return -1.0 if kind == "flip" else 1.0
    if kind == "hopf":  # where the cycles are born: no multiplier crosses there
        return None
    near = values[np.argsort(np.abs(parameter - value), kind="stable")[:4]].ravel()
    near = near[np.isfinite(near) & (near.imag > 1e-6)]
    if not len(near):
        return None
    chosen = near[np.argmin(np.abs(np.abs(near) - 1))]
    return chosen / abs(chosen)


def label_crossings(axis, events, parameter, values):
    """Names and parameters of the bifurcations outside the circle, those at one place together."""
    places = []
    for kind, value in events:
        at = where_crossed(kind, value, parameter, values)
        if at is None:
            continue
        words = f"{MARKS.get(kind, (kind,))[0]} {digits(float(value), 4)}"
        near = [p for p in places if abs(p[0] - at) < 0.35]
        if not near:
            places.append((at, [words]))
        elif words not in near[0][1]:
            near[0][1].append(words)
    for at, words in places:
        x, y = np.real(at), np.imag(at)
        axis.plot([x], [y], "o", color=INK, markersize=4, zorder=6)
        axis.annotate("\n".join(words[:4] + ["..."] * (len(words) > 4)), (x, y), xytext=(7 * np.sign(x or 1), 7 if y >= 0 else -7), textcoords="offset points", fontsize=7.5,
                      color=INK, ha="left" if x >= 0 else "right", va="bottom", zorder=6, bbox={"facecolor": "white", "alpha": 0.7, "linewidth": 0, "pad": 0.8})


def draw(study):
    if not study.has("branch/multipliers_real"):
        return []
    parameter = study.get("branch/parameter")
    values = study.get("branch/multipliers_real") + 1j * study.get("branch/multipliers_imag")
    values = both_of_pairs(values.reshape(len(parameter), -1))
    if not np.any(np.isfinite(values)):
        return []
    figure = plt.figure(figsize=(10.8, 5.2))
    cells = figure.add_gridspec(2, 2, width_ratios=[1.05, 1], height_ratios=[1, 1])
    plane, close = figure.add_subplot(cells[:, 0]), figure.add_subplot(cells[0, 1])
    moduli = figure.add_subplot(cells[1, 1], sharex=close)
    angle = np.linspace(0, 2 * np.pi, 361)
    shade(plane, np.cos(angle), np.sin(angle))
    plane.plot(np.cos(angle), np.sin(angle), color=INK, linewidth=1.1)
    plane.axhline(0, color=GREY, linewidth=0.5)
    plane.axvline(0, color=GREY, linewidth=0.5)
    size = np.abs(values)
    shown = np.isfinite(size)
    colour = np.repeat(parameter[:, None], values.shape[1], axis=1)
    inside, outside = shown & (size <= 1), shown & (size > 1)
    # The brightest tenth of the scale would be yellow on white.
    scale, norm = ListedColormap(plt.cm.viridis(np.linspace(0, 0.88, 200))), plt.Normalize(*span_of(parameter.min(), parameter.max()))
    limits = {"norm": norm, "cmap": scale}
    k, i, j = joined(values)
    ends = np.stack([values[k, i], values[k + 1, j]], axis=1)
    plane.add_collection(LineCollection(np.stack([ends.real, ends.imag], axis=2), array=(parameter[k] + parameter[k + 1]) / 2, linewidths=0.9, zorder=2, **limits),
                         autolim=False)
    points = plane.scatter(values.real[inside], values.imag[inside], c=colour[inside], s=9, linewidths=0, zorder=3, **limits)
    plane.scatter(values.real[outside], values.imag[outside], c=colour[outside], s=24, edgecolors=BAD, linewidths=0.6, zorder=4, **limits)
    reach = 1.12 * max(1.0, min(2.5, np.nanmax(size)))
    plane.set_xlim(-reach, reach)
    plane.set_ylim(-reach, reach)
    plane.set_aspect("equal")
    plane.set_xlabel("real part")
    plane.set_ylabel("imaginary part")
    beyond = np.count_nonzero(shown & ((np.abs(values.real) > reach) | (np.abs(values.imag) > reach)))
    plane.set_title("Floquet multipliers, red rim: unstable" + (f"; {beyond} lie outside the picture" if beyond else ""))
    figure.colorbar(points, ax=plane, ticks=MaxNLocator(6), shrink=0.8, pad=0.02, label=parameter_label(study)).outline.set_visible(False)

    kinds, where = study.get("bifurcations/type"), np.atleast_1d(study.get("bifurcations/parameter", np.array([])))
    events = list(zip(kinds, where)) if kinds is not None and len(kinds) else []
    label_crossings(plane, events, parameter, values)
    lines = np.stack([np.stack([parameter[k], parameter[k + 1]], axis=1), np.abs(ends)], axis=2)
    flat = np.repeat(parameter[:, None], values.shape[1], axis=1)
    for axis in (close, moduli):
        axis.axhline(1, color=BAD, linewidth=1.0)
        axis.add_collection(LineCollection(lines, colors=GREY, linewidths=0.7), autolim=False)
        axis.plot(flat[shown], size[shown], ".", color=GREY, markersize=3.2)
        axis.plot(flat[outside], size[outside], ".", color=BAD, markersize=3.8)
        for _, value in events:
            axis.axvline(value, color=INK, linewidth=0.7, linestyle=":")
        axis.set_ylabel("modulus")
    for (kind, value), level in zip(events, levels([v for _, v in events], np.ptp(parameter), 0.09)):
        close.annotate(MARKS.get(kind, (kind,))[0], (value, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2 + 9 * level),
                       textcoords="offset points", fontsize=7.5, ha="center", va="bottom", color=INK)
    close.set_ylim(1 - CLOSE, 1 + CLOSE)
    close.tick_params(labelbottom=False)
    close.set_title("close to one", pad=14 + 9 * max(levels([v for _, v in events], np.ptp(parameter), 0.09), default=0))
    moduli.set_ylim(0, 1.08 * max(1.0, min(2.5, np.nanmax(size))))
    low, high = parameter.min(), parameter.max()
    moduli.set_xlim(low, high if high > low else low + 1)
    moduli.set_xlabel(parameter_label(study))
    moduli.set_title("all that were kept")
    return save(figure, study, "multipliers", "lines join each multiplier to the nearest one of the next cycle; conjugate pairs are both drawn; the table keeps the largest")
