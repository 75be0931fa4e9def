"""Amplitude over speed on the way up and down, the run-ups of a run together; linear steady response of the same nodes beside it."""
import numpy as np

from .canvas import Line2D
from .response import Validity
from .style import GREY, grid_of, length_unit, mark_service, save, span_of
from .units import digits

RESPONSE_COLUMN = {"bearings": "bearings/semi_major", "node": "response/semi_major"}


def places(study):
    """(title, key, index, amplitude in m) of every bearing and node of a study."""
    rows = len(study.get("run_up/speed"))
    amplitude = study.get("run_up/amplitude").reshape(rows, -1)
    for b, name in enumerate(study.labels("run_up/amplitude")[0]):
        yield f"{name}, journal", ("bearings", name), amplitude[:, b]
    nodes = study.get("node")
    if nodes is not None and np.size(nodes):
        amplitude = study.get("run_up/node_amplitude").reshape(rows, -1)
        for k, node in enumerate(np.atleast_1d(nodes)):
            yield f"node {node}, shaft", ("node", int(node)), amplitude[:, k]


def distinct(found):
    """Without bearings that move exactly like one before: those at one node of a rigid rotor."""
    kept = []
    for entry in found:
        if not any(entry[1][0] == other[1][0] and np.array_equal(entry[2], other[2]) for other in kept):
            kept.append(entry)
    return kept


def steady(results, key):
    """(speed in rad/s, semi-major axis in m) of the linear response at the same place, for the run-ups' unbalance; not a number where it is no answer."""
    for study in results.studies:
        if study.kind != "unbalance_response" or not study.has("response/speed", RESPONSE_COLUMN[key[0]]):
            continue
        speed = study.get("response/speed")
        values = study.get(RESPONSE_COLUMN[key[0]]).reshape(len(speed), -1)
        names = study.bearings(values.shape[1]) if key[0] == "bearings" else [int(n) for n in np.atleast_1d(study.get("response/node"))]
        if key[1] in names:
            yield speed, np.where(Validity(study, len(speed)).answer, values[:, list(names).index(key[1])], np.nan)


def draw_together(results):
    studies = [s for s in results.studies if s.kind == "run_up" and s.has("run_up/speed", "run_up/amplitude")]
    if not studies:
        return []
    unit = studies[0].attribute("speed_unit", "rad/s")
    studies = [s for s in studies if s.attribute("speed_unit", "rad/s") == unit]
    panels = distinct(list(places(studies[0])))
    figure, axes, _ = grid_of(len(panels), width=4.2 if len(panels) < 3 else 3.4, height=2.9)
    scale, length = length_unit(np.concatenate([amplitude for s in studies for _, _, amplitude in places(s)]))
    per_unit = {"rpm": 30 / np.pi, "Hz": 0.5 / np.pi}.get(unit, 1)
    handles = [Line2D([], [], color=s.colour,
                      label=f"{s.name}, {'+' * (s.attribute('acceleration') > 0)}{digits(s.attribute('acceleration') * per_unit, 3)} {unit.removesuffix('/s')}/s" + "\u00b2" * unit.endswith("/s")) for s in studies]
    linear = started = cut = False
    for axis, (title, key, _) in zip(axes, panels):
        steadily = passing = 0.0
        for speed, major in steady(results, key):
            axis.plot(speed * per_unit, major * scale, color=GREY, linewidth=2.6, alpha=0.45, zorder=1)
            linear = True
            steadily = max(steadily, np.nanmax(major, initial=0) * scale)
        for study in studies:
            for _, other, amplitude in places(study):
                if other == key:
                    speed, starting = study.get("run_up/speed"), study.get("run_up/start_transient")
                    free = 0 if starting is None else int(np.count_nonzero(starting))
                    free = free if free < len(speed) else 0  # it never fades, which a warning says
                    # Whirl at half the speed is farther out in every other revolution, which would be a band of saw-teeth.
                    amplitude = np.maximum(amplitude, np.append(amplitude[1:], 0))
                    axis.plot(speed[max(free - 1, 0):], amplitude[max(free - 1, 0):] * scale, color=study.colour, linewidth=1.2)
                    axis.plot(speed[:free], amplitude[:free] * scale, color=study.colour, linewidth=0.8, alpha=0.35)
                    started = started or free > 1
                    passing = max(passing, np.nanmax(amplitude) * scale)
        ends = np.concatenate([study.get("run_up/speed") for study in studies])
        axis.set_xlim(*span_of(ends.min(), ends.max()))
        axis.set_ylim(bottom=0)
        if 0 < 4 * passing < steadily:  # a peak that a run-up never reaches would hide it
            axis.set_ylim(top=2 * passing)
            cut = True
        mark_service(axis, studies[0], unit)
        axis.set_title(title)
        axis.set_xlabel(f"speed [{unit}]")
        axis.set_ylabel(f"amplitude, 0-peak [{length}]")
    if linear:
        handles.append(Line2D([], [], color=GREY, linewidth=2.6, alpha=0.45, label="steady, linear" + ", cut off above" * cut))
    if started:
        handles.append(Line2D([], [], color=GREY, linewidth=0.8, alpha=0.6, label="start: free vibration fades"))
    unbalance = studies[0].attribute("unbalance", "")
    return save(figure, results.whole("run-up"), "run-up",
                 f"largest distance in two revolutions from the mean position over nine; unbalance {unbalance}", handles, columns=4)
