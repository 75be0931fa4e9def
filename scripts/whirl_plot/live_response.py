"""Charts of responses: amplitude and lag over speed (Bode), run-ups, transfer functions."""
import re

import numpy as np

from . import run_up as ups, transfer as transfers
from .live import Styles, line, rounded, service_place
from .margins import operating_in
from .response import Validity, is_answer, number, peaks_at
from .style import COLOURS, GREY, INK, X, Y, length_unit, runs, speed_axis
from .units import digits, person, with_bar

KEYS = ("x_amplitude", "x_phase", "y_amplitude", "y_phase", "semi_major")
FEW = 5  # places in one picture
LONGEST = 4000  # points of a curve over the time


def shaft(study, what):
    nodes = np.atleast_1d(study.get("response/node", np.array([], int)))
    return bode(study, "response", [f"node {n}" for n in nodes], what)


def journals(study, what):
    if not study.has("response/speed", "bearings/semi_major"):
        return None
    count = study.get("bearings/semi_major").reshape(len(study.get("response/speed")), -1).shape[1]
    return bode(study, "bearings", [f"{n}, journal" for n in study.bearings(count)], what)


def part_of(count, what):
    """Indices of the places in the picture `response2` of several."""
    at = re.search(r"(\d+)$", what)
    parts = np.array_split(np.arange(count), -(-count // FEW))
    return parts[int(at[1]) - 1] if at else parts[0]


def unstable_bands(speed, stable):
    half = np.concatenate([speed[:1], (speed[1:] + speed[:-1]) / 2, speed[-1:]])
    return [(half[a], half[b]) if b - a == 1 else (speed[a], speed[b - 1]) for a, b in runs(list(stable)) if not stable[a]]


def bode(study, group, names, what):
    if not study.has("response/speed", *(f"{group}/{k}" for k in KEYS)):
        return None
    unit = study.attribute("speed_unit", "rad/s")
    speed = study.get("response/speed") * speed_axis(unit)[0]
    data = {k: study.get(f"{group}/{k}").reshape(len(speed), -1) for k in KEYS}
    scale, length = length_unit(data["semi_major"])
    validity, styles, lines, pick = Validity(study, len(speed)), Styles(), [], part_of(len(names), what)
    steady = np.array([styles() if s else styles(dash=1, words="unstable: no vibration settles") for s in validity.stable])
    gap = styles("transparent")
    for option, k in enumerate(pick):
        lag = {d: np.mod(-np.degrees(data[f"{d}_phase"][:, k]), 360) for d in "xy"}
        for name, colour, values, d in (("semi-major axis", INK, data["semi_major"], None), ("y, vertical", Y, data["y_amplitude"], "y"), ("x, horizontal", X, data["x_amplitude"], "x")):
            values = np.where(validity.answer, values[:, k] * scale, np.nan)
            lines.append(line(speed, values, name, 0, option, colour, s="".join(steady), w=2 if d is None else 1.4, more=[("lag", "deg", lag[d])] if d else None))
            if d:
                turned = np.append(np.abs(np.diff(lag[d])) > 180, False)  # to the other end of the axis
                lines.append(line(speed, np.where(validity.answer, lag[d], np.nan), name, 1, option, colour, s="".join(np.where(turned, gap, steady))))
        lines += peaks(study, names[k], option, scale, unit)
    operating = operating_in(study)
    places = service_place(study, unit) if operating is None else [(v, "" if k else "operating speed") for k, v in enumerate(dict.fromkeys(operating))]
    ends = rounded([speed[0], speed[-1]]) if speed[-1] > speed[0] else None
    shared = {"x": ("speed", unit), "by": "x", "places": places, "bands": [rounded(b) for b in unstable_bands(speed, validity.stable)], "span": ends}
    return {"choose": {"name": "at", "of": [names[k] for k in pick]}, "lines": lines, "styles": styles.table,
            "panels": [{**shared, "y": ("amplitude, 0-peak", length), "low": 0}, {**shared, "y": ("lag", "deg"), "limits": [0, 360], "reverse": True, "step": 90, "height": 220}]}


def peaks(study, place, option, scale, unit):
    """A circle at each peak of a place that is a motion, with what is known of it."""
    x, y, texts = [], [], []
    for peak in peaks_at(study, place):
        speed, height = number(peak, "speed"), number(peak, "semi_major")
        if speed is None or height is None or not is_answer(peak):
            continue
        bar, factor, margin = (peak.get("speed") or {}).get("uncertainty"), number(peak, "amplification_factor"), number(peak, "separation_margin")
        words = f"peak {person(height, 'm', 4)} at {with_bar(speed, bar)} {unit}" + (f", AF {digits(factor, 3)}" if factor is not None else "")
        words += f", margin {digits(100 * margin, 3)} %" if margin is not None else ""
        x, y, texts = [*x, speed], [*y, height * scale], [*texts, words + (f", {peak['verdict']}" if isinstance(peak.get("verdict"), str) and peak["verdict"] else "")]
    return [line(x, y, "peaks", 0, option, INK, m="circle", t=texts)] if x else []


def run_up(results, _):
    """Amplitudes of all run-ups over the speed, with the linear response beside them."""
    studies = [s for s in results.studies if s.kind == "run_up" and s.has("run_up/speed", "run_up/amplitude")]
    unit = studies[0].attribute("speed_unit", "rad/s")
    studies = [s for s in studies if s.attribute("speed_unit", "rad/s") == unit]
    panels, per_unit = ups.distinct(list(ups.places(studies[0]))), speed_axis(unit)[0]
    scale, length = length_unit(np.concatenate([a for s in studies for _, _, a in ups.places(s)]))
    lines = []
    for option, (_, key, _) in enumerate(panels):
        lines += [line(w * per_unit, major * scale, "steady, linear", 0, option, GREY, w=3) for w, major in ups.steady(results, key)]
        for study in studies:
            step = -(-len(study.get("run_up/speed")) // LONGEST)
            lines += [line(study.get("run_up/speed")[::step], np.maximum(a, np.append(a[1:], 0))[::step] * scale, study.name, 0, option, study.colour)
                      for _, other, a in ups.places(study) if other == key]
    return {"choose": {"name": "at", "of": [title for title, *_ in panels]}, "lines": lines,
            "panels": [{"x": ("speed", unit), "y": ("amplitude, 0-peak", length), "low": 0, "places": service_place(studies[0], unit)}]}


def transfer(study, what):
    """Amplitude and phase of one output over the frequency, a colour for each input."""
    response = study.group.get("response", {})
    if "machine" not in response:
        return None
    ways, output = list(transfers.ways_of(response)), what.removeprefix("response-")
    pairs = [p for p in response["machine"] if study_name(p.split(".from.")[0]) == study_name(output)]
    unit = study.attribute("frequency_unit", "rad/s")
    frequency = response["frequency"][()] * speed_axis(unit)[0]
    step, unstable, lines, units = -(-len(frequency) // LONGEST), study.summary.get("stability") == "unstable", [], []
    for colour, pair in zip(COLOURS * len(pairs), pairs):
        for k, (way, words) in enumerate(ways):
            table = response[way][pair]
            amplitude, of = table["amplitude"][()], str(table["amplitude"].attrs.get("unit", ""))
            if not np.any(amplitude):
                continue
            name = f"from {re.sub('[._]', ' ', pair.split('.from.')[1])}" + (f", {words}" if len(ways) > 1 else "")
            look = {"d": 1 if k == 0 and unstable else min(k, 3) or None, "u": of}
            units.append(of)
            lines.append(line(frequency[::step], np.where(amplitude > 0, amplitude, np.nan)[::step], name, 0, colour=colour, **look))
            degrees = np.rad2deg(table["phase"][()])
            # A break where the phase passes 180 degrees, behind the point before.
            lines.append(line(frequency[::step], degrees[::step], name, 1, colour=colour, **{**look, "u": "deg"},
                              s="".join("01"[int(j)] for j in np.append(np.abs(np.diff(degrees[::step])) > 180, False))))
    if not lines:
        return None
    log = len(frequency) > 2 and frequency[0] > 0 and np.allclose(np.diff(np.log(frequency)), np.log(frequency[1] / frequency[0]), rtol=1e-6)
    shared = {"x": ("frequency", unit), "by": "x", "logx": bool(log), "span": rounded(frequency[[0, -1]])}
    return {"lines": lines, "styles": [{}, {"c": "transparent"}], "panels": [
        {**shared, "y": ("amplitude", ", ".join(dict.fromkeys(units))), "log": True},
        {**shared, "y": ("phase", "deg"), "limits": [-180, 180], "step": 90, "height": 220}]}


def study_name(text):
    """As in names of files."""
    return re.sub(r"[^A-Za-z0-9]+", "_", text)
