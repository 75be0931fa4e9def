"""Charts of sweeps: where bifurcations lie and what the films do over what changes, and branches and responses of all variants."""
import numpy as np

from . import sweep as sweeps
from .bifurcation import Followed
from .live import Styles, line, rounded, service_place
from .live_branches import axis_of, curve, marks
from .response import Validity
from .style import COLOURS, MARKS, length_unit, speed_axis
from .units import with_bar


def sweep(study, what):
    """The chart that replaces the picture `what` of a sweep: trends, coefficients, or a study of its variants by its name."""
    if what == "trends":
        return trends(study)
    if what in sweeps.COEFFICIENTS:
        return coefficients(study, what)
    for make in (branches, responses, at_rest):
        found = make(study, what)
        if found:
            return found
    return None


def hexadecimal(colour):
    from matplotlib.colors import to_hex
    return to_hex(colour)


def parted(label):
    """(name, unit) of a label `speed [rpm]`."""
    name, _, unit = label.partition(" [")
    return name, unit.rstrip("]")


def trends(study):
    panels, lines = [], []
    for number, (head, kind, unit, courses) in enumerate(sweeps.courses_of(study)):
        for k, course in enumerate(courses):
            place, value, bar, _ = zip(*course)
            colour = COLOURS[k % len(COLOURS)]
            ends = [np.ravel([(p, p, np.nan) for p in place]), np.ravel([(v - b, v + b, np.nan) for v, b in zip(value, bar)])]
            lines += [line(*ends, None, number, colour=colour, quiet=True, w=1), line(place, value, None, number, colour=colour, quiet=True, w=1.2)]
            lines.append(line(place, value, None, number, colour=colour, dots=True, t=[f"{sweeps.short(v)}: {with_bar(float(y), float(b) or None)} {unit}" for _, y, b, v in course]))
        panels.append({"x": parted(sweeps.axis_of(study)[0]), "y": parted(sweeps.label_of(study, head, unit)), "title": f"{head}: {MARKS[kind][2]}", "logx": bool(sweeps.wide([row[0] for course in courses for row in course]))})
    return {"panels": panels, "lines": lines} if panels else None


def coefficients(study, what):
    found = list(sweeps.coefficients_of(study, what))
    lines = [line(at, values, name, 0, option, colour, u=unit) for option, (_, at, entries, unit) in enumerate(found) for colour, (name, values) in zip(COLOURS, entries.items())]
    units = ", ".join(dict.fromkeys(unit for *_, unit in found))
    return {"choose": {"name": "at", "of": [sweeps.place_of(study, head) for head, *_ in found]}, "lines": lines, "panels": [{"x": parted(sweeps.axis_of(study)[0]), "y": (what, units), "by": "x"}]} if lines else None


def branches(study, what):
    for kind, columns in sweeps.BRANCHES:
        for name, rows in sweeps.each(study, kind, "branch/parameter", *(f"branch/{c}" for c in columns)):
            if sweeps.plain(name) != what:
                continue
            first, lines = rows[0][2], []
            relative = first.get("bearings/clearance") is not None
            for variant, colour, subject in rows:
                branch, colour = Followed(subject), hexadecimal(colour)
                for option in range(branch.column(columns[0]).shape[1]):
                    curves = [branch.column(c)[:, option] for c in columns]
                    scale = sweeps.scale_of_journal(subject, option)
                    for values in curves:
                        lines += curve(branch, values, sweeps.short(variant), option, colour, scale)
                    lines += marks(branch, curves, option, scale)
            places = first.bearings(branch.column(columns[0]).shape[1])
            panel = {"x": axis_of(first), "y": ("y / c" if relative else "y", "" if relative else "m"), "height": 420}
            return {"panels": [panel], "lines": lines, "styles": [{"t": "stable"}, {"d": 1, "t": "unstable"}], "choose": {"name": "at", "of": places}}
    return None


def responses(study, what):
    for name, rows in sweeps.each(study, "unbalance_response", "response/speed", "bearings/x_amplitude", "bearings/y_amplitude"):
        if sweeps.plain(name) != what:
            continue
        first, lines, styles = rows[0][2], [], Styles()
        unit = first.attribute("speed_unit", "rad/s")
        scale, length = length_unit(first.get("bearings/x_amplitude"))
        for variant, colour, subject in rows:
            speed = subject.get("response/speed") * speed_axis(unit)[0]
            validity = Validity(subject, len(speed))
            steady = "".join(styles() if s else styles(dash=1, words="unstable: no vibration settles") for s in validity.stable)
            for panel, direction in enumerate("xy"):
                for option, values in enumerate(subject.get(f"bearings/{direction}_amplitude").reshape(len(speed), -1).T):
                    lines.append(line(speed, np.where(validity.answer, values * scale, np.nan), sweeps.short(variant), panel, option, hexadecimal(colour), s=steady))
        shared = {"x": ("speed", unit), "by": "x", "low": 0, "span": rounded(speed[[0, -1]]), "places": service_place(first, unit)}
        panels = [{**shared, "y": (f"{direction}, amplitude, 0-peak", length)} for direction in "xy"]
        return {"panels": panels, "lines": lines, "styles": styles.table, "choose": {"name": "at", "of": first.bearings(option + 1)}}
    return None


def at_rest(study, what):
    for name, found in sweeps.at_rest(study).items():
        if sweeps.plain(name) != what:
            continue
        panels, lines = [], []
        for number, (words, unit, bearings) in enumerate(found):
            for k, (bearing, place, value, bar) in enumerate(bearings):
                colour = COLOURS[k % len(COLOURS)]
                lines += [line(place, value, bearing, number, colour=colour, quiet=True, w=1.2), line(place, value, bearing, number, colour=colour, dots=True, bar=bar)]
            panels.append({"x": parted(sweeps.axis_of(study)[0]), "y": (words, unit), "logx": bool(sweeps.wide(place))})
        return {"panels": panels, "lines": lines}
    return None
