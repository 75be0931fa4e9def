"""Charts of motions in time: the last revolutions, the orbit with its section, the spectrum, the exponents."""
import numpy as np

from .live import line, rounded
from .live_branches import walls_of
from .motion import LATEST, SHADES, distinct, exponent_in_words, exponents_of, frequencies_of
from .style import GREY, INK, X, Y

LONGEST, ORBIT, TOP = 4000, 6000, 6.0  # points of a history, of an orbit; highest order of a spectrum


def history(study, _):
    if not study.has("orbit/x", "orbit/y"):
        return None
    scale, unit = study.micro
    samples = int(round(study.attribute("samples", 0)))
    x, y = (study.get(f"orbit/{d}")[-LATEST * samples:] * scale for d in "xy")
    names, turns = study.bearings(x.shape[1]), np.arange(1 - len(x), 1) / samples
    rows, step = distinct(study, names), -(-len(x) // LONGEST)
    lines = []
    for option, b in enumerate(rows):
        for name, values, colour in (("y", y, Y), ("x", x, X)):
            lines.append(line(turns[::step], values[::step, b], name, 0, option, colour))
            if not study.has("section/x"):
                lines.append(line(turns[::-samples], values[::-samples, b], "once per revolution", 0, option, INK, quiet=True, dots=True))
    over = f"{study.turns} before the end"
    return {"choose": {"name": "at", "of": [names[b] for b in rows]}, "lines": lines, "panels": [{"x": (over, ""), "y": ("position", "" if unit == "1" else unit), "by": "x", "span": rounded(turns[[0, -1]])}]}


def motion(study, _):
    if not study.has("orbit/x", "poincare/x", "spectrum/x"):
        return None
    scale, unit = study.micro
    unit = "" if unit == "1" else unit
    cut = "section" if study.has("section/x", "section/y") else "poincare"
    x, y, px, py = (study.get(f"{p}") * scale for p in ("orbit/x", "orbit/y", f"{cut}/x", f"{cut}/y"))
    order, sx, sy = study.get("spectrum/order"), study.get("spectrum/x") * scale, study.get("spectrum/y") * scale
    names, low, where = study.bearings(x.shape[1]), order <= TOP, "on the section" if cut == "section" else "once per revolution"
    rows, lines = distinct(study, names), []
    for option, b in enumerate(rows):
        lines += walls_of(study, b, option, scale, 0)
        lines.append(line(x[-ORBIT:, b], y[-ORBIT:, b], "orbit", 0, option, GREY, w=1, digits=5))
        lines.append(line(px[:, b], py[:, b], where, 0, option, INK, dots=True, digits=5))
        floor = max(1e-9, 1e-8 * max(sx[low].max(), sy[low].max()))
        for name, values, colour in (("y" + ", vertical" * study.in_space, sy, Y), ("x" + ", horizontal" * study.in_space, sx, X)):
            lines.append(line(order[low], np.maximum(values[low, b], floor), name, 1, option, colour, w=1.2, digits=5))
    panels = [{"x": ("x", unit), "y": ("y", unit), "equal": True, "height": 400}, {"x": (frequencies_of(study), ""), "y": ("amplitude, 0-peak", unit), "log": True, "by": "x", "height": 400}]
    if study.has("exponents/running"):
        running, turn = study.get("exponents/running"), 2 * np.pi / study.attribute("speed")
        value, bar = (np.atleast_1d(study.get(f"exponents/{k}")) for k in ("value", "uncertainty"))
        for k in range(running.shape[1]):
            lines.append(line(np.arange(1, len(running) + 1), running[:, k] * turn, f"exponent {exponent_in_words(value[k] * turn, bar[k] * turn)}", 2, None, SHADES[k % len(SHADES)]))
        panels.append({"x": (study.turns, ""), "y": (exponents_of(study), ""), "by": "x", "height": 280})
    return {"choose": {"name": "at", "of": [names[b] for b in rows]}, "lines": lines, "panels": panels, "side": True}
