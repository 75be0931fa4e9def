"""A motion in time on one page: orbit in the clearance, Poincare points, spectrum, convergence of the Lyapunov exponents."""
import matplotlib.pyplot as plt
import numpy as np

from .bore import draw_clearance
from .orbits import finish, square, turn_arrow
from .style import GREY, INK, ROTATION, X, Y, save
from .units import digits, with_bar


SHADES = (INK, GREY, "#a8a8a8", "#c9c9c9")  # of the exponents, the largest first


def distinct(study, names):
    """Bearings at different nodes: those at one node of a rigid rotor move alike."""
    nodes = study.get("bearings/node")
    if nodes is None:
        return list(range(len(names)))
    return [int(i) for i in np.sort(np.unique(np.atleast_1d(nodes), return_index=True)[1])]


def draw_orbit(axis, study, b, x, y, px, py, unit):
    if draw_clearance(axis, study, b, (x, y)):
        turn_arrow(axis)
    else:
        square(axis, x, y)
    axis.plot(x, y, color=GREY, linewidth=0.6, rasterized=len(x) > 4000)
    axis.plot(px, py, ".", color=INK, markersize=4, zorder=4)
    finish(axis, unit=unit)


def draw_points(axis, px, py, unit):
    axis.plot(px, py, ".", color=INK, markersize=3)
    if max(np.ptp(px), np.ptp(py)) < 1e-6:  # um: one point
        axis.set_xlim(px.mean() - 1, px.mean() + 1)
        axis.set_ylim(py.mean() - 1, py.mean() + 1)
    else:
        square(axis, px, py)
    axis.ticklabel_format(useOffset=False)
    finish(axis, unit=unit)


def draw_spectrum(axis, order, x, y, unit, top=6.0):
    shown = order <= top
    floor = max(1e-9, 1e-8 * max(x[shown].max(), y[shown].max()))
    for values, colour, label in ((y, Y, "y, vertical"), (x, X, "x, horizontal")):
        axis.semilogy(order[shown], np.maximum(values[shown], floor), color=colour, linewidth=0.8, label=label)
    axis.set_xlim(0, top)
    axis.set_xlabel("frequency / running speed")
    axis.set_ylabel(f"amplitude, 0-peak [{unit}]")
    axis.legend(loc="upper right")


def exponent_in_words(value, bar):
    return with_bar(value, bar) if np.isfinite(bar) else f"{digits(value, 2)}, too short for a bar"


def draw_exponents(axis, running, speed, value, uncertainty):
    turns = np.arange(1, len(running) + 1)
    per_turn = 2 * np.pi / speed
    for k in range(running.shape[1]):
        axis.plot(turns, running[:, k] * per_turn, color=SHADES[k % len(SHADES)], linewidth=1.2,
                  label=exponent_in_words(value[k] * per_turn, uncertainty[k] * per_turn))
    axis.axhline(0, color=GREY, linewidth=0.8)
    axis.set_xlabel("revolutions")
    axis.set_ylabel("Lyapunov exponents per revolution")
    axis.legend(loc="best")


def draw(study):
    if not study.has("orbit/x", "poincare/x", "spectrum/x"):
        return []
    scale, unit = study.micro
    # A motion that nothing forces has a section in place of a shaft angle.
    cut = "section" if study.has("section/x", "section/y") else "poincare"
    where = "on the section" if cut == "section" else "once per revolution"
    x, y, px, py = (study.get(p) * scale for p in ("orbit/x", "orbit/y", f"{cut}/x", f"{cut}/y"))
    order, sx, sy = study.get("spectrum/order"), study.get("spectrum/x") * scale, study.get("spectrum/y") * scale
    names = study.bearings(x.shape[1])
    rows = distinct(study, names)
    exponents = study.has("exponents/running")
    columns = 4 if exponents else 3
    figure, axes = plt.subplots(len(rows), columns, figsize=(3.5 * columns, 3.3 * len(rows) + 1.0), squeeze=False)
    for row, b in zip(axes, rows):
        draw_orbit(row[0], study, b, x[:, b], y[:, b], px[:, b], py[:, b], unit)
        row[0].set_title("orbit" if len(rows) == 1 else f"orbit, {names[b]}")
        draw_points(row[1], px[:, b], py[:, b], unit)
        row[1].set_title(where)
        draw_spectrum(row[2], order, sx[:, b], sy[:, b], unit)
        row[2].set_title("spectrum")
        if exponents and b == rows[0]:
            draw_exponents(row[3], study.get("exponents/running"), study.attribute("speed"),
                           np.atleast_1d(study.get("exponents/value")), np.atleast_1d(study.get("exponents/uncertainty")))
            row[3].set_title(study.attribute("motion", "").replace("_", " "), color=INK)
        elif exponents:
            row[3].set_visible(False)
    turns = int(round(x.shape[0] / study.attribute("samples", 1)))
    mark = "shaft angle 0" if cut == "poincare" else str(study.group["section"].attrs["plane"])
    return save(figure, study, "motion", f"{study.attribute('evidence', '')}; last {turns} revolutions, black: {mark}; {ROTATION}")


def draw_full_spectrum(study, top=4.0):
    """The circles that the orbits are made of, over the frequency with its sign: forward to the right, backward to the left."""
    if not study.has("full_spectrum/order", "full_spectrum/amplitude") or study.attribute("motion", "") == "fixed_point":
        return []
    scale, unit = study.micro
    order, amplitude = study.get("full_spectrum/order"), study.get("full_spectrum/amplitude") * scale
    names = study.bearings(amplitude.shape[1])
    rows = distinct(study, names)
    shown = (np.abs(order) <= top) & (order != 0)
    figure, axes = plt.subplots(len(rows), 1, figsize=(8.6, 2.6 * len(rows) + 0.8), squeeze=False, sharex=True)
    for axis, b in zip(axes[:, 0], rows):
        values = amplitude[shown, b]
        axis.semilogy(order[shown], np.maximum(values, max(1e-9, 1e-8 * values.max())), color=INK, linewidth=0.8)
        axis.axvline(0, color=GREY, linewidth=0.8)
        axis.set_ylabel(f"radius, 0-peak [{unit}]")
        axis.set_title(names[b])
    axes[-1, 0].set_xlim(-top, top)
    axes[-1, 0].set_xlabel("frequency / running speed; backward whirl below zero")
    return save(figure, study, "full-spectrum", f"circles of z = x + i y; {ROTATION}")
