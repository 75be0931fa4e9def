"""Charts of branches over a parameter, with the orbit of the point under the cursor beside them, and of the orbits themselves."""
import numpy as np

from whirl.answer import in_print

from .bifurcation import Followed, damped, distinct, without_twins, words_of_dashes
from .bore import outline
from .live import line, rounded, service_place
from .orbits import picked, shades_of, stability
from .style import BAD, GREY, INK, MARKS, X, Y, span_of
from .units import with_bar

SHAPES = {"o": "circle", "s": "rect", "D": "rectRot", "^": "triangle", "P": "cross", "x": "crossRot"}
PIECES = 4  # of the sixteen parts of a stretch of a curve one is one of these
KEPT, TIMES = 24, 96  # orbits of a branch, times of an orbit
SCALE = np.array([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]])  # viridis


def axis_of(study):
    unit = study.attribute("parameter_unit", "")
    return study.attribute("parameter", "speed" if unit in ("rpm", "rad/s", "Hz") else "parameter").split(".")[-1].replace("_", " "), "" if unit == "1" else unit


def curve(branch, values, name, option, colour, scale, panel=0, more=()):
    """A curve of a branch, solid where it is stable, and its computed points, which the cursor finds."""
    values = np.asarray(values, float) * scale
    at = branch.curve_of(values)
    parameter, stable = branch.along(values)
    changes = branch.changes if at is branch.curve else {i - int(branch.born): c for i, c in branch.changes.items()}
    found = []
    for x, y, solid in at.stretches(values, stable, [p for _, _, p in branch.places_on(at)], changes):
        found.append(line(x[::PIECES], y[::PIECES], name, panel, option, colour, quiet=True, d=None if solid else 1, w=1.8 if solid else 1.4, digits=5))
    whole = len(values) == len(branch.parameter)
    points = np.clip(np.arange(len(values)) - (int(branch.born) if whole else 0), 0, branch.points - 1)
    words = "01"  # styles of the points
    more = [(what, unit, column[points] if len(column) == branch.points else column) for what, unit, column in more]
    return [*found, line(parameter, values, name, panel, option, colour, bare=True, at=points.tolist(), s="".join(words[0 if s else 1] for s in stable), more=more)]


def marks(branch, tables, option, scale, panel=0):
    """Bifurcations on curves of a branch, each with its sentence, and where the branch stops early."""
    found, known = [], branch.study.bifurcations
    kinds = branch.study.get("bifurcations/type")
    same = kinds is not None and [b.get("type") for b in known] == list(kinds)
    for values in tables:
        values = np.asarray(values, float) * scale
        at = branch.curve_of(values)
        for number, (kind, value, place) in enumerate(branch.places_on(at)):
            if place is None:
                continue
            short, marker, words = MARKS.get(kind, (kind, "x", kind))
            told = known[number] if same else {}
            text = f"{short}, {words}: {axis_of(branch.study)[0]} {with_bar(float(value), told.get('uncertainty'))} {axis_of(branch.study)[1]}".rstrip()
            text += f", {told['criticality']}" if isinstance(told.get("criticality"), str) and told["criticality"] in ("subcritical", "supercritical") else ""
            text += f", {told['sentence']}" if isinstance(told.get("sentence"), str) else ""
            found.append(line([value], [at.at(values, place)], words, panel, option, INK, m=SHAPES.get(marker, "crossRot"), t=[text]))
        for reason in branch.ends:
            found.append(line(at.parameter[-1:], values[-1:], "early end", panel, option, INK, m="crossRot", t=[f"the branch ends: {in_print(reason)}"]))
    return found


def orbit_lines(branch, shown, scale, unit, name, panel=1, walls=True):
    """The kept orbits of a branch, of which the chart shows the one that is nearest to the cursor, and the clearance."""
    study, found = branch.study, []
    orbits = [o for o in study.orbits if o.point is not None]
    if not orbits:
        return []
    orbits = [orbits[k] for k in np.unique(np.linspace(0, len(orbits) - 1, KEPT).round().astype(int))] if len(orbits) > KEPT else orbits
    over, of = axis_of(study)
    for option, b in enumerate(shown):
        if walls:
            found += walls_of(study, b, option, scale, panel)
        for o, stable in zip(orbits, stability(study, orbits)):
            x, y = closed(o.x[:, b] * scale), closed(o.y[:, b] * scale)
            words = f"{name}: orbit at {over} {o.parameter:.5g} {of}".rstrip() + (", unstable" if stable is False else "")
            found.append(line(x, y, name, panel, option, study.colour, f=o.point, t0=words, d=1 if stable is False else None, digits=5))
    return found


def closed(values):
    """A period of at most TIMES times, with the first one again."""
    step = max(1, len(values) // TIMES)
    return np.append(values[::step], values[:1])


def walls_of(study, b, option, scale, panel):
    """The wall of the bore and the pads; switched off where an orbit should fill the panel."""
    return [line(x[::4] * scale, y[::4] * scale, "clearance", panel, option, colour, quiet=True, w=width, d=dash, off=True, digits=4) for x, y, colour, width, dash in outline(study, b)]


def orbit_panel(unit):
    unit = "" if unit == "1" else unit
    return {"x": ("x", unit), "y": ("y", unit), "equal": True, "follows": True}


def chart(study, lines, panels, names, **more):
    styles = [{"t": "stable"}, {"d": 1, "t": words_of_dashes(study.get("branch/unstable_count", np.zeros(1)))}]
    both = any(c.get("d") == 1 for c in lines)
    return {"panels": panels, "lines": lines, "styles": styles, "keys": styles if both else [], "choose": {"name": "at", "of": names}, **more}


def over_parameter(study, parameter):
    """The axis of a branch. One that ends where it begins has an axis on which numbers differ."""
    ends = float(np.min(parameter)), float(np.max(parameter))
    wide = span_of(*ends)
    return {"x": axis_of(study), "places": services(study), **({"span": rounded(wide)} if wide != ends else {})}


def services(study):
    return service_place(study, study.attribute("parameter_unit", "")) if study.attribute("parameter", "") == "speed" else []


def equilibria(study, _):
    if not study.has("branch/parameter", "branch/y"):
        return None
    branch = Followed(study)
    x, y = branch.column("x"), branch.column("y")
    names, shown, growth = study.bearings(x.shape[1]), distinct(x, y), damped(study)
    scale, unit = study.measure(np.concatenate([x, y]))
    lines = []
    for option, b in enumerate(shown):
        lines += curve(branch, y[:, b], "y" + ", vertical" * study.in_space, option, Y, scale) + curve(branch, x[:, b], "x" + ", horizontal" * study.in_space, option, X, scale)
        lines += marks(branch, [y[:, b], x[:, b]], option, scale)
    panels = [{**over_parameter(study, branch.parameter), "y": ("position", "" if unit == "1" else unit)}]
    if growth is not None:
        ends = branch.parameter[[np.argmin(branch.parameter), np.argmax(branch.parameter)]]
        lines += [line(ends, [0, 0], None, 1, colour=BAD, quiet=True, w=1)] + curve(branch, growth, "least stable eigenvalue", None, INK, 1.0, 1, frequency_of(study))
        panels.append({**over_parameter(study, branch.parameter), "y": ("real part", "1/s"), "height": 240})
    return chart(study, lines, panels, [names[b] for b in shown])


def frequency_of(study):
    imag = study.get("branch/leading_imag")
    return [] if imag is None else [("frequency", "rad/s", np.abs(imag))]


def facts_of(study):
    """What stands beside the position of a cycle: its whirl frequency, the largest multiplier."""
    found, period, multipliers = [], study.get("branch/period"), study.multipliers
    if period is not None and not study.attribute("unbalance", ""):
        found.append(("frequency", "Hz", 1 / np.where(period > 0, period, np.nan)))
    if multipliers is not None and multipliers.size:
        size = np.abs(multipliers)
        if not study.attribute("unbalance", ""):  # one of them is 1, along the cycle
            size = np.sort(np.where(np.arange(size.shape[1]) == np.argmin(np.abs(multipliers - 1), axis=1)[:, None], 0, size), axis=1)
        found.append(("largest multiplier", "", np.nanmax(size, axis=1)))
    return found


def cycles(study, direction):
    if not study.has(f"branch/{direction}_max", f"branch/{direction}_min"):
        return None
    branch = Followed(study)
    tables = [branch.column(f"{d}_{k}") for d in "xy" for k in ("max", "min") if study.has(f"branch/{d}_{k}")]
    shown, names = distinct(*tables), study.bearings(tables[0].shape[1])
    high, low = (branch.column(f"{direction}_{k}") for k in ("max", "min"))
    scale, unit = study.measure(np.concatenate([high, low]))
    lines, facts = [], facts_of(study)
    for option, b in enumerate(shown):
        for values in (high, low):
            lines += curve(branch, values[:, b], study.name, option, study.colour, scale, more=facts)
        lines += marks(branch, [high[:, b], low[:, b]], option, scale)
    beside = orbit_lines(branch, shown, scale, unit, study.name)
    panels = [{**over_parameter(study, branch.parameter), "y": (f"{direction}, largest and smallest", "" if unit == "1" else unit)}]
    return chart(study, lines + beside, panels + [orbit_panel(unit)] * bool(beside), [names[b] for b in shown], side=bool(beside))


def vertical(study, _):
    return cycles(study, "y")


def horizontal(study, _):
    return cycles(study, "x")


def nodes(study, _):
    if not study.has("branch/parameter", "nodes/amplitude", "nodes/node"):
        return None
    branch = Followed(study)
    every = np.atleast_1d(study.get("nodes/node"))
    tables = {k: study.get(f"nodes/{k}").reshape(branch.points, -1) for k in ("amplitude", "x", "y")}
    scale, unit = study.measure(tables["amplitude"])
    lines = []
    for k in range(len(every)):
        for key, name, colour in (("amplitude", "largest distance from the mean", INK), ("x", "x, horizontal", X), ("y", "y, vertical", Y)):
            lines += curve(branch, tables[key][:, k], name, k, colour, scale, more=facts_of(study))
        lines += marks(branch, [tables["amplitude"][:, k]], k, scale)
    return chart(study, lines, [{**over_parameter(study, branch.parameter), "y": ("amplitude, 0-peak", "" if unit == "1" else unit), "low": 0}], [f"node {n}, shaft" for n in every])


def together(results, _):
    """All branches over the same parameter, the vertical motion of each journal."""
    studies = [s for s in results.studies if s.has("branch/parameter") and (s.kind == "cycle_branch" and s.has("branch/y_max") or s.kind == "equilibrium_branch" and s.has("branch/y"))]
    studies = [s for s in studies if axis_of(s) == axis_of(studies[0])]
    branches = without_twins([Followed(s) for s in studies])
    tables = [[b.column(k) for k in (("y_max", "y_min") if b.study.kind == "cycle_branch" else ("y",))] for b in branches]
    count = min(t[0].shape[1] for t in tables)
    names, shown = studies[0].bearings(count), distinct(*(t[0][:, :count] for t in tables))
    scale, unit = studies[0].measure(np.concatenate([t[0][:, :count].ravel() for t in tables]))
    lines, beside = [], []
    for branch, table in zip(branches, tables):
        facts = facts_of(branch.study) if branch.study.kind == "cycle_branch" else frequency_of(branch.study)
        for option, b in enumerate(shown):
            for values in table:
                lines += curve(branch, values[:, b], branch.study.name, option, branch.study.colour, scale, more=facts)
            lines += marks(branch, [values[:, b] for values in table], option, scale)
        beside += orbit_lines(branch, shown, scale, unit, branch.study.name, walls=not beside)
    panels = [{"x": axis_of(studies[0]), "y": ("y, largest and smallest", "" if unit == "1" else unit), "height": 440, "places": services(studies[0])}]
    return chart(studies[0], lines + beside, panels + [orbit_panel(unit)] * bool(beside), [names[b] for b in shown], side=bool(beside))


def orbits(study, _):
    if not study.orbits:
        return None
    every = picked(study)
    scale, unit = study.micro
    colours = colours_at(shades_of(every)[0])
    over, of = axis_of(study)
    lines = []
    for option in range(len(every[0].places)):
        lines += walls_of(study, option, option, scale, 0)
        for o, colour, stable in zip(every, colours, stability(study, every)):
            words = f"{o.parameter:.5g} {of}".rstrip() + (", unstable" if stable is False else "")
            lines.append(line(closed(o.x[:, option] * scale), closed(o.y[:, option] * scale), words, 0, option, colour, d=1 if stable is False else None))
    return chart(study, lines, [{**orbit_panel(unit), "follows": False, "title": f"Orbits over {over}"}], list(every[0].places))


def colours_at(shades):
    """Colours of viridis at numbers from 0 to 1."""
    knots = np.linspace(0, 1, len(SCALE))
    return ["#" + "".join(f"{int(round(np.interp(s, knots, SCALE[:, c]))):02x}" for c in range(3)) for s in shades]
