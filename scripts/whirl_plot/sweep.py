"""Sweeps: what was asked of all variants on one picture, and values over what changes."""
import re

import numpy as np

from .bifurcation import Followed
from .canvas import Line2D, plt
from .curves import through
from .response import Validity
from .style import COLOURS, DASHED, GREY, INK, MARKS, branch_legend, grid_of, length_unit, save, speed_axis
from .units import WORDS, scale_of

BAR = dict(capsize=2.5, elinewidth=0.9, linewidth=1.3, markersize=4.5)


def variants(study):
    """(name, colour, {study: Subject}) of the deck as it stands, if it was computed, and of all variants in their order."""
    groups = sorted(study.group["variants"].values(), key=lambda g: int(g.attrs.get("order", 0)))
    entries = {v["name"]: v for v in study.summary.get("variants", [])}
    found = []
    for group in groups:
        name = str(group.attrs["title"])
        summaries = {s["name"]: s for s in entries.get(name, {}).get("studies", [])}
        members = {}
        for one in group.values():
            subject = type(study)(study.results, one, {})
            subject.summary = summaries.get(subject.name, {})
            members[subject.name] = subject
        found.append((name, members))
    asked = set().union(*(m for _, m in found)) if found else set()
    given = {s.name: s for s in study.results.studies if s.name in asked}
    if given:
        found.insert(0, (as_given(study), given))
    named = [name for name, _ in found[bool(given):]]
    colours = ([INK] if given else []) + colours_of(study, named)
    return [(name, colour, members) for (name, members), colour in zip(found, colours)]


def colours_of(study, names):
    """Of a quantity that is ordered, over a scale from dark to bright; of a few others each its own."""
    where = axis_of(study)
    rows = study.get("table/variant") if where is not None and study.has("table/variant") else None
    place = {} if rows is None else {str(n): float(v) for n, v in zip(rows, where[1]) if np.isfinite(v)}
    at = np.array([place.get(n, np.nan) for n in names])
    if len(names) > 2 and np.all(np.isfinite(at)) and len(np.unique(at)) == len(at):
        if at.min() > 0 and at.max() / at.min() > 20:
            at = np.log(at)
        return list(plt.cm.viridis(0.9 * (at - at.min()) / np.ptp(at)))
    return COLOURS[:len(names)] if len(names) <= len(COLOURS) else list(plt.cm.viridis(np.linspace(0, 0.9, len(names))))


def as_given(study):
    """The deck as it stands, by what the variants change where that is one thing that is no number: `reduction guyan`."""
    paths = {path for v in study.summary.get("variants", []) for path in v.get("changes", {})}
    node = study.results.deck or {}
    for key in paths.pop().split(".") if len(paths) == 1 else [""]:
        node = node.get(key) if isinstance(node, dict) else None
        name = key
    if isinstance(node, dict) and "type" in node:
        return f"{name.replace('_', ' ')} {node['type']} (as given)"
    return "as given"


def each(study, kind, *needed):
    """(name of a study of that kind, [(variant, colour, Subject)]) for those that hold what a picture needs."""
    rows = variants(study)
    names = list(dict.fromkeys(n for _, _, members in rows for n, s in members.items() if s.kind == kind))
    for name in names:
        having = [(v, c, m[name]) for v, c, m in rows if name in m and m[name].has(*needed)]
        if len(having) > 1:
            yield name, having


def words_of(rows):
    """A study by its name and what drives it in all variants: the grade of its unbalance is in one or the other."""
    subjects = [s for *_, s in rows]
    unbalances = {s.attribute("unbalance", "") for s in subjects}
    return subjects[0].name + (f", unbalance {unbalances.pop()}" if len(unbalances) == 1 and unbalances != {""} else "")


def short(variant):
    """A name with numbers of six digits: variants of a range are called `speed 106.12244898 rad/s`."""
    words = re.sub(r"\d+\.\d{4,}", lambda number: f"{float(number[0]):.6g}", variant)
    return re.sub(r"(?<=\d) um\b", " \u00b5m", words)


def legend(rows, most=16):
    """Of many variants some, evenly: their colours are those of a scale."""
    shown = rows if len(rows) <= most else [rows[k] for k in np.linspace(0, len(rows) - 1, most).round().astype(int)]
    return [Line2D([], [], color=c, label=short(v)) for v, c, _ in shown]


def plain(text):
    return "".join(c if c.isalnum() or c in ".+-" else "_" for c in text).strip("_.") or "study"


BRANCHES = (("equilibrium_branch", ("y",)), ("cycle_branch", ("y_max", "y_min")))  # kinds of study, and the columns that are drawn


def scale_of_journal(subject, b):
    """Factor of positions in a bearing: per clearance of the variant, where it has one."""
    own = subject.get("bearings/clearance")
    return 1 / own[b] if own is not None and len(own) > b and own[b] > 0 else 1


def draw_branches(study):
    """Vertical position of every journal: equilibria, or the highest and the lowest point of cycles."""
    files = []
    for kind, columns in BRANCHES:
        for name, rows in each(study, kind, "branch/parameter", *(f"branch/{c}" for c in columns)):
            followed = [(c, Followed(s)) for _, c, s in rows]
            first = rows[0][2]
            unit = first.attribute("parameter_unit", "")
            clearance = first.get("bearings/clearance")
            places = first.bearings(followed[0][1].column(columns[0]).shape[1])
            figure, axes, _ = grid_of(len(places), width=4.2, height=3.0, columns=2 if len(places) < 5 else 3)
            for b, (axis, place) in enumerate(zip(axes, places)):
                for (colour, branch), (_, _, subject) in zip(followed, rows):
                    scale = scale_of_journal(subject, b)
                    curves = [branch.column(c)[:, b] for c in columns]
                    for values in curves:
                        branch.draw(axis, values, colour, scale, linewidth=1.3)
                    branch.mark(axis, curves, scale, size=4.5)
                axis.set_title(place)
                axis.set_xlabel(f"{first.attribute('parameter', 'parameter')} [{unit}]")
                axis.set_ylabel("y / c" if clearance is not None else "y [m]")
            note = first.shown + (", in clearances of each variant" if clearance is not None else "")
            note += "; all points of a cycle lie between its two curves" if len(columns) > 1 else ""
            files += save(figure, study, plain(name), note,
                          branch_legend([k for _, f in followed for k in f.kinds], legend(rows), [e for _, f in followed for e in f.ends]),
                          of=words_of(rows))
    return files


def draw_response(study):
    """Amplitude of the linear response, and of the cycles under the same unbalance, relative to the bearings."""
    files = []
    cycles = {name: rows for name, rows in nonlinear(study)}
    for name, rows in each(study, "unbalance_response", "response/speed", "bearings/x_amplitude", "bearings/y_amplitude"):
        first = rows[0][2]
        factor, label, _, _ = speed_axis(first.attribute("speed_unit", "rad/s"))
        x = first.get("bearings/x_amplitude").reshape(len(first.get("response/speed")), -1)
        scale, unit = length_unit(x)
        places = first.bearings(x.shape[1])
        figure, _, axes = grid_of(2 * len(places), width=3.0, height=2.5, columns=len(places), sharex=True)
        # Wide and pale is linear, thin is nonlinear, dashed is unstable.
        pale = dict(linewidth=3.2, alpha=0.4, solid_capstyle="butt")
        handles = [Line2D([], [], color=c, label=f"{v}, linear", **pale) for v, c, _ in rows]
        own = {v: c for v, c, _ in rows}
        driven = dict.fromkeys(s.attribute("unbalance", "") for *_, s in rows)
        members = [(v, own.get(v, INK), Followed(s)) for unbalance in driven for v, s in cycles.get(unbalance, [])]
        for row, direction in enumerate("xy"):
            for b, place in enumerate(places):
                axis = axes[row, b]
                for _, colour, s in rows:
                    speed = s.get("response/speed") * factor
                    answer = Validity(s, len(speed)).answer
                    axis.plot(speed, np.where(answer, s.get(f"bearings/{direction}_amplitude").reshape(len(speed), -1)[:, b] * scale, np.nan), color=colour, **pale)
                for _, colour, branch in members:
                    branch.draw(axis, (branch.column(f"{direction}_max") - branch.column(f"{direction}_min"))[:, b] / 2, colour, scale, linewidth=1.2)
                if row == 0:
                    axis.set_title(place)
                else:
                    axis.set_xlabel(label)
                if b == 0:
                    axis.set_ylabel(f"{direction}, half of peak to peak [{unit}]")
                axis.set_ylim(bottom=0)
        handles += [Line2D([], [], color=c, linewidth=1.2, label=f"{v}, nonlinear") for v, c, _ in members]
        if any(not branch.stable.all() for *_, branch in members):
            handles.append(Line2D([], [], color=GREY, linestyle=DASHED, linewidth=1.2, label="nonlinear, unstable"))
        files += save(figure, study, plain(name), "journal relative to the bearing centre", handles, of=words_of(rows))
    return files


def nonlinear(study):
    """(unbalance, [(words, Subject)]) of branches of forced cycles over speed beside the sweep, and of its own."""
    found = {}
    own = [(f"{v}", s) for v, _, m in variants(study) for s in m.values()]
    beside = [(as_given(study), s) for s in study.results.studies if s.name not in {o.name for _, o in own}]
    for words, s in own + beside:
        if s.kind == "cycle_branch" and s.attribute("parameter") == "speed" and s.attribute("parameter_unit") == "rpm" \
                and s.attribute("unbalance", "") and s.attribute("period_turns", 1) == 1 and s.has("branch/x_max", "branch/x_min"):
            found.setdefault(s.attribute("unbalance"), []).append((words, s))
    return found.items()


def draw_stability_factors(study):
    """Stability factors of all variants over the damped frequency, a panel for each speed; where there are few speeds."""
    files = []
    for name, rows in each(study, "modes", "spectrum/speed", "spectrum/frequency", "spectrum/stability_factor"):
        if all(np.all(s.get("spectrum/stability_factor") == 1) for _, _, s in rows):
            continue  # without damping all factors are one
        factor, label, _, _ = speed_axis(rows[0][2].attribute("speed_unit", "rad/s"))
        speeds = np.unique(rows[0][2].get("spectrum/speed"))
        if len(speeds) > 6:
            continue
        unit = label.partition("[")[2].rstrip("]")
        figure, axes, _ = grid_of(len(speeds), width=4.6, height=3.6, columns=2)
        marks = [("os^Dv"[k % 5], 9 - 2 * min(k, 3)) for k in range(len(rows))]
        for axis, speed in zip(axes, speeds):
            for (_, colour, s), (mark, size) in zip(rows, marks):
                here = np.isclose(s.get("spectrum/speed"), speed) & (s.get("spectrum/frequency") > 0)
                axis.plot(s.get("spectrum/frequency")[here] * factor, s.get("spectrum/stability_factor")[here], mark, color=colour,
                          markersize=size, markerfacecolor="none")
            found = np.concatenate([line.get_xdata() for line in axis.get_lines()])
            if len(found) and found.min() > 0 and found.max() > 50 * found.min():
                axis.set_xscale("log")
            axis.axhline(1, color=INK, linewidth=0.8)
            axis.set_ylim(0, max(1.05, axis.get_ylim()[1]))
            axis.set_title(f"{speed * factor:.6g} {unit}")
            axis.set_xlabel(f"damped frequency [{unit}]")
            axis.set_ylabel("stability factor $10^{-\\delta}$")
        handles = [Line2D([], [], color=c, marker=mark, markersize=size, markerfacecolor="none", linestyle="", label=v)
                   for (v, c, _), (mark, size) in zip(rows, marks)]
        files += save(figure, study, plain(name), "unstable above 1; delta: logarithmic decrement", handles, of=name)
    return files


def draw_films(study):
    """Pressure of each bearing's first pad in its middle, and along the bearing where it is highest."""
    files = []
    for name, rows in each(study, "static", "films"):
        films = [s.fields for *_, s in rows]
        for bearing in films[0]:
            figure, axes, _ = grid_of(2, width=4.6, height=3.4, columns=2)
            for (_, colour, _), fields in zip(rows, films):
                pad = fields[bearing]["pad1"]
                theta, z, p = np.degrees(pad["theta"]), pad["z"] * 1e3, pad["pressure"] / 1e6
                middle, top = int(np.argmin(np.abs(z))), int(np.argmax(p.max(axis=1)))
                mark = "o" if len(theta) <= 41 else None
                axes[0].plot(theta, p[:, middle], color=colour, marker=mark, markersize=2.5, linewidth=1.2)
                axes[1].plot(z, p[top], color=colour, marker=mark, markersize=2.5, linewidth=1.2)
            axes[0].set_xlabel("angle from +x [deg]")
            axes[1].set_xlabel("z from the middle of the bearing [mm]")
            axes[0].set_ylabel("pressure [MPa]")
            axes[0].set_title("around, at the middle")
            axes[1].set_title("along, at the highest pressure")
            files += save(figure, study, f"{plain(name)}.{plain(bearing)}", f"{bearing}, first pad", legend(rows), of=name)
    return files


COEFFICIENTS = {"stiffness": ("K", "N/m"), "damping": ("C", "N s/m")}


def coefficients_of(study, words):
    """(bearing, places, {name: values}, unit) of the coefficients of each film over what the sweep changes, where there are enough variants
    for a curve."""
    quantity, (letter, unit) = axis_of(study), COEFFICIENTS[words]
    heads = dict.fromkeys(c.rsplit(".K.", 1)[0] for c in study.group.get("table", ()) if c.endswith(".K.xx"))
    if quantity is None or len(quantity[1]) < 5:
        return
    order = np.argsort(quantity[1])
    for head in heads:
        entries = {f"{letter} {c}": study.get(f"table/{head}.{letter}.{c}")[order] for c in ("xx", "xy", "yx", "yy")}
        factor, shown = scale_of(unit, max(np.nanmax(np.abs(v)) for v in entries.values()))
        yield head.split(".bearing.")[-1], np.array(quantity[1])[order], {name: values * factor for name, values in entries.items()}, shown


def draw_coefficients(study):
    """Stiffness and damping of the films over what the sweep changes."""
    files = []
    for words in COEFFICIENTS:
        found = list(coefficients_of(study, words))
        if not found:
            continue
        figure, axes, _ = grid_of(len(found), width=3.4, height=2.9, columns=min(3, len(found)))
        for axis, (bearing, at, entries, unit) in zip(axes, found):
            for colour, values in zip(COLOURS, entries.values()):
                known = np.isfinite(values)
                axis.plot(*smooth(at[known], values[known]), color=colour, linewidth=1.4)
            axis.set_title(place_of(study, bearing))
            axis.set_xlabel(axis_of(study)[0])
            axis.set_ylabel(f"{words} [{unit}]")
            axis.axhline(0, color=INK, linewidth=0.6)
        handles = [Line2D([], [], color=colour, label=name) for colour, name in zip(COLOURS, found[0][2])]
        files += save(figure, study, words, "minus the derivatives of the film's force on the journal", handles)
    return files


def place_of(study, name):
    """`coefficients.speed.2000.ratio.0.5` as `coefficients: 2000 rad/s, \u03c9/\u03a9 = 0.5`; a bearing as it is."""
    found = re.fullmatch(r"(.*)\.speed\.([0-9.]+)\.ratio\.([0-9.]+)", name)
    if not found:
        return name
    unit = next((c["unit"] for c in study.summary["columns"] if c["name"] == f"{found[1]}.speed.{found[2]}.speed"), "")
    return f"{found[1]}: {found[2]} {unit}, \u03c9/\u03a9 = {found[3]}"


def smooth(at, values):
    """Through the variants, as far as no two stand at one place."""
    return through(at, values) if np.all(np.diff(at) > 0) else (at, values)


def is_factor(study, name):
    """Whether a number without a unit is a factor: the variants say so, or what they change has a unit."""
    variants = study.summary.get("variants", [])
    changed = [str(value) for v in variants for path, value in v.get("changes", {}).items() if path.split(".")[-1] == name.split(".")[-1]]
    return any(re.search(r"\bx\d", v["name"]) for v in variants) or any(re.search(r"\d [A-Za-z]", value) for value in changed)


def axis_of(study):
    """Label and place of every row on the first quantity that changes as a number."""
    trends = study.summary.get("trends", [])
    if not trends:
        return None
    name, unit = trends[0]["quantity"], trends[0]["unit"]
    at = study.get("table/" + name.replace("/", "_"))
    short = name.split(".")[-1] if name != "at" else study.name
    short = short.replace("_", " ")
    if unit == "1" and name != "at" and is_factor(study, name):
        short += ", factor on the deck's value"
    return None if at is None else (short + (f" [{WORDS.get(unit, unit)}]" if unit != "1" else ""), at)


ALIKE = 0.2  # largest relative difference of the whirl frequencies of what a line joins


def events_of(study, head, kind, names):
    """Of each row of the table the bifurcations of a kind of the study `head`, in their order along the branch."""
    entries = {v["name"]: {s["name"]: s for s in v.get("studies", [])} for v in study.summary.get("variants", [])}
    own = {s.name: s.summary for s in study.results.studies}
    rows = [entries.get(n, own if n not in entries else {}).get(head, {}).get("bifurcations", []) for n in names]
    return [[b for b in row if b.get("type") == kind] for row in rows]


def pairs_of(before, after):
    """(i, j) of bifurcations of two variants that are the same: the nearest with the same side of stability and about the same frequency."""
    gaps = []
    for i, a in enumerate(before):
        for j, b in enumerate(after):
            rates = [x.get("whirl_frequency_rad_s") for x in (a, b)]
            if a.get("stable_side") != b.get("stable_side") or None in rates and rates != [None, None]:
                continue
            if None not in rates and abs(rates[0] - rates[1]) > ALIKE * max(rates):
                continue
            gaps.append((abs(a["value"] - b["value"]), i, j))
    pairs = []
    for _, i, j in sorted(gaps):
        if all(i != p and j != q for p, q in pairs):
            pairs.append((i, j))
    return pairs


def label_of(study, head, unit):
    """Name and unit of the parameter of a branch in the deck: `speed [rpm]`."""
    studies = (study.results.deck or {}).get("studies") or []
    options = next((o for entry in studies if isinstance(entry, dict) for o in entry.values() if isinstance(o, dict) and o.get("name") == head), {})
    name = str(options.get("parameter", "speed")).split(".")[-1].replace("_", " ")
    return f"{name} [{unit}]" if unit != "1" else name


def courses_of(study):
    """(name of a study, kind of its bifurcations, their unit, courses) of each panel. A course is what is the same bifurcation over what the
    sweep changes: rows (place, value, bar or zero, variant)."""
    where = axis_of(study)
    columns = {c["name"]: c for c in study.summary.get("columns", [])}
    if where is None or any(t["beside"] for t in study.summary["trends"]):
        return []
    at, panels = where[1], {}
    for name in columns:
        head, kind, number = (name.rsplit(".", 2) + ["", ""])[:3]
        if kind in MARKS and number.isdigit():
            panels.setdefault((head, kind), []).append(int(number))
    rows = [r for r in np.argsort(at, kind="stable") if np.isfinite(at[r])]
    names, found = [str(n) for n in np.atleast_1d(study.get("table/variant"))], []
    for (head, kind), numbers in panels.items():
        events, courses, before = events_of(study, head, kind, names), [], {}
        last = None
        for r in rows:
            here = {n: c for n, c in ((n, columns[f"{head}.{kind}.{n}"]) for n in numbers) if c["values"][r] is not None}
            joined = {} if last is None or not here else {j + 1: i + 1 for i, j in pairs_of(events[last], events[r])}
            now = {}
            for n, c in here.items():
                now[n] = before.get(joined.get(n))
                if now[n] is None:
                    now[n] = []
                    courses.append(now[n])
                now[n].append((at[r], c["values"][r], c["uncertainties"][r] or 0, names[r]))
            if here:
                before, last = now, r
        found.append((head, kind, columns[f"{head}.{kind}.{numbers[0]}"]["unit"], courses))
    return found


def wide(places):
    """Whether places want a logarithmic axis."""
    return len(places) > 1 and min(places) > 0 and max(places) / min(places) > 20


def draw_trends(study):
    """Where bifurcations lie over what the sweep changes, with their bars. Lines join what is the same bifurcation."""
    panels = courses_of(study)
    if not panels:
        return []
    figure, axes, _ = grid_of(len(panels), width=3.6, height=2.9, columns=3)
    for axis, (head, kind, unit, courses) in zip(axes, panels):
        for k, course in enumerate(courses):
            place, value, bar, _ = zip(*course)
            axis.errorbar(place, value, yerr=bar, marker=MARKS[kind][1], color=COLOURS[k % len(COLOURS)], **BAR)
        axis.set_title(f"{head}: {MARKS[kind][2]}")
        axis.set_xlabel(axis_of(study)[0])
        axis.set_ylabel(label_of(study, head, unit))
        if wide([row[0] for course in courses for row in course]):
            axis.set_xscale("log")
    return save(figure, study, "trends", "with error bars; a line joins bifurcations of like stability whose whirl frequencies differ by less than 20 %")


# What a study at rest says of each bearing: the end of the name of its column, and words.
AT_REST = {"load": "load", "min_thickness": "thinnest film", "max_pressure": "largest pressure", "side_flow": "side flow", "power_loss": "power loss"}


def at_rest(study):
    """{study at rest: panels} of what changes by more than rounding; a panel is (words, unit, [(bearing, places, values, bars)])."""
    where = axis_of(study)
    if where is None or any(t["beside"] for t in study.summary["trends"]):
        return {}
    rows = [r for r in np.argsort(where[1], kind="stable") if np.isfinite(where[1][r])]
    found = {}
    for name in dict.fromkeys(n for *_, members in variants(study) for n, s in members.items() if s.kind == "static"):
        for value, words in AT_REST.items():
            form = re.compile(re.escape(name) + (r"\.load\.(.+)" if value == "load" else rf"\.bearing\.(.+)\.{value}"))
            columns = [(form.fullmatch(c["name"]), c) for c in study.summary.get("columns", [])]
            lines = [(match[1], c["unit"], *(np.array(c[key], float)[rows] for key in ("values", "uncertainties"))) for match, c in columns if match]
            largest = max((np.nanmax(np.abs(v), initial=0) for *_, v, _ in lines), default=0)
            if any(np.nanmax(np.abs(v - v[0]), initial=0) > 1e-6 * largest for *_, v, _ in lines):
                factor, unit = scale_of(lines[0][1], largest)
                found.setdefault(name, []).append((words, unit, [(bearing, where[1][rows], v * factor, np.nan_to_num(b) * factor) for bearing, _, v, b in lines]))
    return found


def draw_at_rest(study):
    """What studies at rest say of each bearing over what the sweep changes, with their bars."""
    files = []
    for name, panels in at_rest(study).items():
        figure, axes, _ = grid_of(len(panels), width=3.6, height=2.9, columns=2 if len(panels) == 4 else 3)
        colours = {bearing: COLOURS[k % len(COLOURS)] for k, bearing in enumerate(dict.fromkeys(b for *_, lines in panels for b, *_ in lines))}
        for axis, (words, unit, lines) in zip(axes, panels):
            for bearing, place, value, bar in lines:
                axis.errorbar(place, value, yerr=bar, marker="o", color=colours[bearing], **BAR)
            axis.set_xlabel(axis_of(study)[0])
            axis.set_ylabel(f"{words} [{unit}]")
            if wide(place):
                axis.set_xscale("log")
        handles = [Line2D([], [], color=c, marker="o", markersize=4.5, label=bearing) for bearing, c in colours.items()]
        known = any((bar > 0).any() for *_, lines in panels for *_, bar in lines)
        files += save(figure, study, plain(name), "with error bars" if known else "no error bars are known", handles, of=name)
    return files
