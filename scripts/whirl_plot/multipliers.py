"""Floquet multipliers of a branch of cycles with the unit circle, and their moduli over the parameter."""
import matplotlib.pyplot as plt
import numpy as np

from .style import BAD, GREY, INK, MARKS, SHADE, levels, parameter_label, save

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
    plane.fill(np.cos(angle), np.sin(angle), color=SHADE, zorder=0)
    plane.plot(np.cos(angle), np.sin(angle), color=INK, linewidth=1.1)
    plane.axhline(0, color=GREY, linewidth=0.5)
    plane.axvline(0, color=GREY, linewidth=0.5)
    size = np.abs(values)
    shown = np.isfinite(size)
    colour = np.repeat(parameter[:, None], values.shape[1], axis=1)
    inside, outside = shown & (size <= 1), shown & (size > 1)
    limits = {"vmin": parameter.min(), "vmax": parameter.max(), "cmap": "viridis"}
    points = plane.scatter(values.real[inside], values.imag[inside], c=colour[inside], s=13, linewidths=0, zorder=3, **limits)
    plane.scatter(values.real[outside], values.imag[outside], c=colour[outside], s=24, edgecolors=BAD, linewidths=0.6, zorder=4, **limits)
    reach = 1.12 * max(1.0, min(2.5, np.nanmax(size)))
    plane.set_xlim(-reach, reach)
    plane.set_ylim(-reach, reach)
    plane.set_aspect("equal")
    plane.set_xlabel("real part")
    plane.set_ylabel("imaginary part")
    beyond = np.count_nonzero(shown & ((np.abs(values.real) > reach) | (np.abs(values.imag) > reach)))
    plane.set_title("Floquet multipliers, red rim: unstable" + (f"; {beyond} lie outside the picture" if beyond else ""))
    figure.colorbar(points, ax=plane, shrink=0.8, pad=0.02, label=parameter_label(study)).outline.set_visible(False)

    kinds, where = study.get("bifurcations/type"), np.atleast_1d(study.get("bifurcations/parameter", np.array([])))
    events = list(zip(kinds, where)) if kinds is not None and len(kinds) else []
    # Points, not lines: a table of multipliers does not say which of one cycle is which of the next.
    flat = np.repeat(parameter[:, None], values.shape[1], axis=1)
    for axis in (close, moduli):
        axis.axhline(1, color=BAD, linewidth=1.0)
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
    return save(figure, study, "multipliers", "conjugate pairs are both drawn; the table keeps the largest multipliers")
