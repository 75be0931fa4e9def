"""A motion in time on one page: orbit in the clearance, Poincare points, spectrum, convergence of the Lyapunov exponents."""
import numpy as np

from whirl.answer import in_print

from .bore import draw_clearance
from .canvas import plt
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


def frequencies_of(study):
    return "frequency / running speed" if study.in_space else f"frequency, cycles in {study.turns.replace('periods', 'a period')}"


def draw_spectrum(axis, order, x, y, unit, study, top=6.0):
    shown = order <= top
    floor = max(1e-9, 1e-8 * max(x[shown].max(), y[shown].max()))
    for values, colour, label in ((y, Y, f"y{', vertical' * study.in_space}"), (x, X, f"x{', horizontal' * study.in_space}")):
        axis.semilogy(order[shown], np.maximum(values[shown], floor), color=colour, linewidth=0.8, label=label)
    axis.set_xlim(0, top)
    axis.set_xlabel(frequencies_of(study))
    axis.set_ylabel("amplitude, 0-peak" + f" [{unit}]" * (unit != "1"))
    axis.legend(loc="upper right")


def exponents_of(study):
    return f"Lyapunov exponents per {'revolution' if study.in_space else 'period'}"


def exponent_in_words(value, bar):
    return with_bar(value, bar) if np.isfinite(bar) else f"{digits(value, 2)}, too short for a bar"


def draw_exponents(axis, study, running, speed, value, uncertainty):
    turns = np.arange(1, len(running) + 1)
    per_turn = 2 * np.pi / speed
    for k in range(running.shape[1]):
        axis.plot(turns, running[:, k] * per_turn, color=SHADES[k % len(SHADES)], linewidth=1.2,
                  label=exponent_in_words(value[k] * per_turn, uncertainty[k] * per_turn))
    axis.axhline(0, color=GREY, linewidth=0.8)
    axis.set_xlabel(study.turns)
    axis.set_ylabel(exponents_of(study))
    axis.legend(loc="best")


def stands_still(study):
    """Whether nothing moves but by rounding: pictures of it would be empty."""
    x, y = study.get("orbit/x"), study.get("orbit/y")
    return x is None or y is None or max(np.ptp(x), np.ptp(y)) <= 1e-12 * max(np.abs(x).max(), np.abs(y).max())


def draw(study):
    if not study.has("orbit/x", "poincare/x", "spectrum/x") or stands_still(study):
        return []
    first, later = twins(study)
    if first is not None:
        return []  # its picture names this one
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
        draw_spectrum(row[2], order, sx[:, b], sy[:, b], unit, study)
        row[2].set_title("spectrum")
        if exponents and b == rows[0]:
            draw_exponents(row[3], study, study.get("exponents/running"), study.attribute("speed"),
                           np.atleast_1d(study.get("exponents/value")), np.atleast_1d(study.get("exponents/uncertainty")))
            row[3].set_title(study.attribute("motion", "").replace("_", " "), color=INK)
        elif exponents:
            row[3].set_visible(False)
    turns = int(round(x.shape[0] / study.attribute("samples", 1)))
    mark = "shaft angle 0" if cut == "poincare" else str(study.group["section"].attrs["plane"])
    return save(figure, study, "motion", f"{in_print(study.attribute('evidence', ''))}; last {turns} {study.turns}, black: {mark}" + f"; {ROTATION}" * study.in_space + also(later))


def same(one, other):
    """Whether two motions are the same at every sample, to a thousandth of their size."""
    if any(one.attribute(k) != other.attribute(k) for k in ("speed", "samples", "unbalance")) or not (one.has("orbit/x", "orbit/y") and other.has("orbit/x", "orbit/y")):
        return False
    for d in "xy":
        a, b = one.get(f"orbit/{d}"), other.get(f"orbit/{d}")
        if a.shape != b.shape or np.abs(a - b).max() > 1e-3 * np.ptp(a, axis=0).max():
            return False
    return True


def also(later):
    return f"; the same to a thousandth: {', '.join(later)}" if later else ""


def twins(study):
    """(the first motion of the run that is the same as this one or None, the later ones that are the same)."""
    motions = [s for s in study.results.studies if s.kind == "motion"]
    at = next((k for k, s in enumerate(motions) if s.name == study.name), None)
    if at is None:
        return None, []
    first = next((s for s in motions[:at] if same(s, study)), None)
    return first, [] if first is not None else [s.name for s in motions[at + 1:] if same(study, s)]


LATEST = 24  # revolutions of a history: more are a band


def draw_history(study):
    """x and y over the time, the latest revolutions; black: once per revolution."""
    if not study.has("orbit/x", "orbit/y") or study.attribute("motion", "") == "fixed_point" or stands_still(study):
        return []
    scale, unit = study.micro
    samples = int(round(study.attribute("samples", 0)))
    first, later = twins(study)
    if samples < 2 or first is not None:
        return []
    x, y = (study.get(f"orbit/{d}")[-LATEST * samples:] * scale for d in "xy")
    names = study.bearings(x.shape[1])
    rows = distinct(study, names)
    turns = np.arange(1 - len(x), 1) / samples
    figure, axes = plt.subplots(2 * len(rows), 1, figsize=(9.6, 2.6 * len(rows) + 1.0), squeeze=False, sharex=True)
    for pair, b in zip(axes.reshape(-1, 2), rows):
        for axis, values, colour, letter in zip(pair, (y, x), (Y, X), "yx"):
            axis.plot(turns, values[:, b], color=colour, linewidth=0.9)
            if not study.has("section/x"):
                axis.plot(turns[::-samples], values[::-samples, b], ".", color=INK, markersize=3.5)
            axis.set_ylabel(letter if unit == "1" else f"{letter} [{unit}]")
            axis.margins(x=0.005)
        pair[0].set_title(names[b])
    axes[-1, 0].set_xlabel(f"{study.turns} before the end")
    note = "" if study.has("section/x") else "black: once per revolution, at shaft angle 0"
    return save(figure, study, "history", (note + also(later)).removeprefix("; "))


def draw_full_spectrum(study, top=4.0):
    """The circles that the orbits are made of, over the frequency with its sign: forward to the right, backward to the left."""
    if not study.has("full_spectrum/order", "full_spectrum/amplitude") or study.attribute("motion", "") == "fixed_point" or stands_still(study):
        return []
    first, later = twins(study)
    if study.has("places/name") or first is not None:
        return []  # what is no rotor does not whirl
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
    return save(figure, study, "full-spectrum", f"circles of z = x + i y; {ROTATION}" + also(later))
