"""Charts of modes: Campbell diagram, and shapes that move."""
import numpy as np

from .campbell import EITHER, LOW_DAMPING, OVERDAMPED, between, colour_of, crowded_out, modes_of, range_of, ranges_of, senses, stretches, vibrates, with_borders
from .live import Styles, line, rounded, service_place
from .shapes import at_words, bearing_places, normalised, tables_of
from .style import BAD, GOOD, GREY, INK, LIGHT, UNDAMPED, WARN, speed_axis
from .units import digits, with_bar

DASHES = {"forward": 0, "backward": 1, "mixed": 3, "planar": 2, "either": 3}
WORDS = {BAD: "unstable", UNDAMPED: "undamped", WARN: f"log. decrement below {LOW_DAMPING}", GOOD: "", LIGHT: ""}
PLACES = 121  # along a shaft that moves


def looks(styles, sense, worst):
    """The style of each stretch of a track: colour of its damping, dash of its whirl."""
    colours = [LIGHT if w > OVERDAMPED else colour_of(w) for w in worst]
    return "".join(styles(c, DASHES.get(s, 0), ", ".join(filter(None, (s, WORDS[c])))) for c, s in zip(colours, sense))


def campbell(study, _):
    if not vibrates(study):
        return None
    unit = study.attribute("speed_unit", "rad/s")
    to_speed, _, to_frequency, hertz = speed_axis(unit)
    every, full, styles, lines = np.unique(study.get("spectrum/speed")), crowded_out(study), Styles(), []
    modes = list(modes_of(study))
    damped_at_all = any(np.any(m[3] != 0) for m in modes)
    for mode, speed, frequency, decrement, whirl in modes:
        for a, b in stretches(speed, frequency, every, full):
            ranges = ranges_of(study, mode)
            at, height, damped, sense, border = with_borders(ranges, *(column[a:b] for column in (speed, frequency, decrement, whirl)))
            look = looks(styles, senses(sense), between(at, damped, border, ranges)) or None
            colour = colour_of(np.nanmin(damped)) if np.isfinite(damped).any() else GREY
            bar, bar_of_damping = bars_at(study, mode, at, to_frequency)
            lines.append(line(at * to_speed, height * to_frequency, f"mode {mode}", 0, colour=colour, s=look, bar=bar, more=[("log. decrement", "", damped, bar_of_damping)]))
            if damped_at_all:
                lines.append(line(at * to_speed, damped, f"mode {mode}", 1, colour=colour, s=look, bar=bar_of_damping, more=[("frequency", hertz, height * to_frequency, bar)]))
    ends = np.array([every[0], every[-1]])
    frequencies, decrements = (np.concatenate([m[k] for m in modes]) for k in (2, 3))
    limit = min(np.nanmax(frequencies) * 1.06, 3 * ends[1])
    for times in (1, 2):
        lines.append(line(ends * to_speed, times * ends * to_frequency, f"{times}\u00d7 speed", colour=INK, quiet=True, w=1.0 if times == 1 else 0.7))
    lines += critical_speeds(study, to_speed, to_frequency, unit)
    panels = [{"x": ("speed", unit), "y": ("natural frequency", hertz), "limits": [0, *rounded([limit * to_frequency], 2)], "span": rounded(span(ends) * to_speed), "height": 420,
               "places": service_place(study, unit)}]
    if damped_at_all:
        low, high = range_of(decrements)
        lines.append(line(ends * to_speed, [0, 0], None, 1, colour=INK, quiet=True, w=1.0))
        panels.append({"x": ("speed", unit), "y": ("logarithmic decrement", ""), "limits": rounded([low, high], 2), "span": panels[0]["span"], "height": 260, "places": panels[0]["places"],
                       "title": "Damping, unstable below zero"})
    return {"panels": panels, "lines": lines, "styles": styles.table, "keys": keys_of(styles)}


def bars_at(study, mode, speeds, to_frequency):
    """Bars of frequency and logarithmic decrement of a mode at these speeds; None where the study has none."""
    rows = np.nonzero(study.get("spectrum/mode") == mode)[0]
    rows = rows[np.argsort(study.get("spectrum/speed")[rows], kind="stable")]
    bars = [study.get(f"spectrum/{k}_uncertainty") for k in ("frequency", "log_decrement")]
    return [None if b is None else np.interp(speeds, study.get("spectrum/speed")[rows], b[rows]) * factor for b, factor in zip(bars, (to_frequency, 1))]


def keys_of(styles):
    """What colours and dashes of the tracks mean, as far as they occur."""
    colours, dashes = ({k[i] for k in styles.known} for i in (0, 1))
    words = {GOOD: f"log. decrement \u2265 {LOW_DAMPING}", WARN: f"0 to {LOW_DAMPING}", BAD: "unstable", UNDAMPED: "undamped", LIGHT: f"above {OVERDAMPED:.0f}"}
    senses = dict.fromkeys(sense for _, _, said in styles.known for sense in DASHES if said.split(",")[0] == sense)
    return [{"c": c, "t": t} for c, t in words.items() if c in colours] + [{"c": GREY, "d": DASHES[s], "t": s} for s in senses if DASHES[s] in dashes]


def span(ends):
    return ends if ends[1] > ends[0] else ends + np.array([-1, 1]) * (abs(ends[0]) or 1) / 20


def critical_speeds(study, to_speed, to_frequency, unit):
    """Circles where a mode meets the speed, each with what is known of it."""
    if not study.has("critical/speed"):
        return []
    column = lambda name: np.atleast_1d(study.get(f"critical/{name}")) if study.has(f"critical/{name}") else None  # noqa: E731
    speed, bar, mode, whirl, factor, margin, verdict = map(column, ("speed", "speed_uncertainty", "mode", "whirl", "amplification_factor", "separation_margin", "verdict"))
    texts = []
    for k, at in enumerate(speed):
        words = f"critical speed {with_bar(at * to_speed, bar[k] * to_speed if bar is not None else None)} {unit}"
        if mode is not None:
            words += f", mode {int(mode[k])}" + (f" {whirl[k]}" if whirl is not None and whirl[k] else "")
        if factor is not None and np.isfinite(factor[k]):
            words += f", AF {digits(float(factor[k]), 4)}"
        if margin is not None and np.isfinite(margin[k]):
            words += f", margin {digits(100 * float(margin[k]), 3)} %"
        texts.append(words + (f", {verdict[k]}" if verdict is not None and verdict[k] else ""))
    return [line(speed * to_speed, speed * to_frequency, "critical speeds", colour=INK, m="circle", hollow=True, t=texts)]


def shapes(study, what):
    """The shapes at one speed; the picture of a run with several names it behind a dash."""
    found = list(tables_of(study))
    factor = speed_axis(study.attribute("speed_unit", "rad/s"))[0]
    named = what.removeprefix("shapes-3d").lstrip("-")
    for speed, z, every in found:
        if len(found) == 1 or f"{speed * factor:.0f}" == named:
            break
    else:
        return None
    every = [s for s in every if not s.decrement > OVERDAMPED] or every
    pick = np.unique(np.linspace(0, len(z) - 1, PLACES).round().astype(int))
    at, to_frequency, unit = at_words(study, speed)
    modes = []
    for shape in every[:12]:
        x, y, _ = normalised(shape.x, shape.y)
        words = f"{shape.mode}: {digits(shape.frequency * to_frequency, 5)} {unit}" + (f", {shape.whirl}" if shape.whirl else "")
        words += f", log. decrement {digits(float(shape.decrement), 3)}" if np.isfinite(shape.decrement) else ", diverges" if shape.decrement == -np.inf else ""
        if shape.whirl == "either":
            words += f" ({EITHER})"
        modes.append({"t": words, "x": [rounded(x[pick].real, 4), rounded(x[pick].imag, 4)], "y": [rounded(y[pick].real, 4), rounded(y[pick].imag, 4)]})
    return {"kind": "shapes", "at": at, "z": rounded(z[pick], 5), "bearings": [(round(float(place), 5), str(name)) for place, name in bearing_places(study, study.get("shapes/z"))],
            "modes": modes}
