"""What was asked for, as tables: loads, journal positions, critical speeds, peaks, thresholds, and what happens beyond them."""
import math
import typing

import numpy as np

from . import sweep_tables
from .bifurcation import Followed
from .campbell import EITHER
from .locus import WORDS as LOCUS_WORDS
from .margins import MARGIN_HEAD, NOT_EXCITED, margin_cells, margin_note, operating_in
from .response import number, peaks_at
from .style import speed_axis
from .units import WORDS, digits, number as number_of, person, quantity, scale_of, with_bar


class Table(typing.NamedTuple):
    caption: str
    head: list
    rows: list
    note: str = ""


def column(values, unit):
    """Factor and head of a column of SI values in the one unit that suits the largest."""
    finite = [abs(v) for v in values if v is not None and math.isfinite(v)]
    factor, name = scale_of(unit, max(finite, default=0.0))
    return factor, f" [{name}]" if name else ""


def table_of(caption, labels, columns, note="", one_unit=False):
    """A table with one row per label and columns (head, SI unit, values), all in one unit if asked; columns without a value are
    left out."""
    head, cells = [""], [[label] for label in labels]
    for words, unit, values in columns:
        if not any(v is not None for v in values):
            continue
        factor, shown = column([v for _, _, some in columns for v in some] if one_unit else values, unit)
        head.append(words + shown)
        for row, value in zip(cells, values):
            row.append("\u2013" if value is None else digits(value * factor, 4))
    return Table(caption, head, cells, note) if len(head) > 1 and cells else None


def modes(study):
    out, unit = [], study.attribute("speed_unit", "rad/s")
    to_speed, _, to_frequency, frequency_unit = speed_axis(unit)
    if study.has("critical/speed"):
        operating, verdicts, whirls = operating_in(study), study.get("critical/verdict"), study.get("critical/whirl")
        rows, damped, states = [], [], study.get("critical/stability")
        for k, (speed, mode) in enumerate(zip(np.atleast_1d(study.get("critical/speed")), np.atleast_1d(study.get("critical/mode")))):
            found = [study.values.get(f"critical.{k + 1}.{name}") for name in ("speed", "log_decrement", "amplification_factor", "separation_margin", "required_margin")]
            speed_at, delta, factor, *margin = [(None, None) if v is None else (v.value, v.uncertainty) for v in found]
            verdict = "" if verdicts is None else str(np.atleast_1d(verdicts)[k])
            whirl = "\u2013" if whirls is None else str(np.atleast_1d(whirls)[k]) or "\u2013"
            row = [k + 1, digits(float(speed * to_speed), 5) if speed_at[0] is None else with_bar(*speed_at), int(mode), whirl, with_bar(*delta), with_bar(*factor)]
            row += margin_cells(*margin, verdict) if operating else []
            if states is not None and any(str(s) != "stable" for s in states):
                row.append("" if str(states[k]) == "stable" else str(states[k]))
            (damped if verdict.startswith("damped") else rows).append(row)
        head = ["critical", f"speed [{unit}]", "mode", "whirl", "log. decrement \u03b4", "amplification \u03c0/\u03b4"] + (MARGIN_HEAD if operating else [])
        head += [""] * (max(map(len, rows + damped), default=0) - len(head))
        note = margin_note(operating, unit) if operating else ""
        note += f"; {NOT_EXCITED}" if "not excited" in np.atleast_1d([] if verdicts is None else verdicts) else ""
        out.append(Table("Critical speeds: damped frequency equal to the speed", head, rows, note))
        if damped:
            out.append(Table("Damped, not critical: amplification factor below 2.5 (API 684)", head, damped))
    if study.has("spectrum/speed", "spectrum/log_decrement"):
        names = ["mode", "frequency", "log_decrement", "damping_ratio", "whirl", "stability"]
        rows = {k: study.get(f"spectrum/{k}") for k in ("speed", *names)}
        count = len(rows["speed"])
        rows = {k: [None] * count if v is None else v for k, v in rows.items()}
        shown = lambda v, n: "\u2013" if v is None or not math.isfinite(v) else digits(float(v), n)  # noqa: E731
        out.append(Table(f"Modes at {digits(float(rows['speed'][-1] * to_speed), 5)} {unit}",
                         ["mode", f"frequency [{frequency_unit}]", "log. decrement", "damping ratio", "whirl", ""],
                         [[int(m), digits(float(f * to_frequency), 5), shown(d, 3), shown(z, 3), str(w), "" if s in (None, "stable") else str(s)]
                          for speed, m, f, d, z, w, s in zip(rows["speed"], *(rows[k] for k in names)) if speed == rows["speed"][-1]],
                         EITHER if "either" in [w for speed, w in zip(rows["speed"], rows["whirl"]) if speed == rows["speed"][-1]] else ""))
    if study.has("unstable/from"):
        columns = [np.atleast_1d(study.get(f"unstable/{k}")) for k in ("from", "to", "mode", "whirl", "frequency")]
        if len(columns[0]):
            out.append(Table("Unstable speeds", [f"from [{unit}]", f"to [{unit}]", "mode", "whirl", f"frequency [{frequency_unit}]"],
                             [[digits(float(a * to_speed), 5), digits(float(b * to_speed), 5), int(m), str(w), digits(float(f * to_frequency), 5)]
                              for a, b, m, w, f in zip(*columns)], "a range that begins or ends with the speeds of the study may go on"))
    elif study.modes:
        out.append(Table("Natural frequencies at rest", ["mode", "frequency [Hz]"],
                         [[k, digits(m["imag"] / (2 * math.pi), 5)] for k, m in enumerate(study.modes, 1) if m.get("imag") is not None]))
    return out


def cell(peak, name, factor=1):
    """A value of a peak with its bar; a dash where there is none."""
    size, bar = number(peak, name), (peak.get(name) or {}).get("uncertainty")
    return with_bar(None if size is None else size * factor, bar * factor if isinstance(bar, (int, float)) else None)


def peak_row(peak, operating):
    margin = margin_cells(*((number(peak, name), (peak.get(name) or {}).get("uncertainty")) for name in ("separation_margin", "required_margin")), peak.get("verdict"))
    return [cell(peak, "speed"), cell(peak, "semi_major", 1e6), cell(peak, "amplification_factor"), *(margin if operating else []),
            str(peak.get("stability", "\u2013")), "; ".join(str(n) for n in peak.get("notes", []))]


def unbalance_response(study):
    if not study.has("response/speed"):
        return []
    unit = study.attribute("speed_unit", "rad/s")
    operating, rows = operating_in(study), []
    for place in dict.fromkeys(str(p.get("place")) for p in study.peaks):
        rows += [[place if n == 0 else "", *peak_row(p, operating)] for n, p in enumerate(peaks_at(study, place)[:4])]
    margins_head = MARGIN_HEAD if operating else []
    head = ["probe", f"peak at [{unit}]", "amplitude [\u00b5m]", "amplification N/(N2 \u2212 N1)", *margins_head, "equilibrium", ""]
    if rows and not any(r[-1] for r in rows):
        head, rows = head[:-1], [r[:-1] for r in rows]
    note = "0-peak, semi-major axis of the orbit; amplification N/(N2 \u2212 N1) at 0.707 of the peak (API 684); a response about an unstable equilibrium is no motion"
    shown = f"; {margin_note(operating, unit)}" if operating else ""
    modes = next((s.name for s in study.results.studies if s.kind == "modes" and "critical.1.amplification_factor" in s.values), None)
    if modes is not None:
        shown = f"; the factor in {modes} is \u03c0/\u03b4 of the mode at fixed speed, and differs from this one where the frequency of the mode changes with the speed{shown}"
    out = [Table("Peaks of the response, the four largest of each probe", head, rows, note + shown)] if rows else []
    at = {k.removeprefix("operating."): v for k, v in study.values.items() if k.startswith("operating.")}
    if at:
        words = {k: k.replace("node.", "node ").replace("bearing.", "").replace(".semi_major", "").replace(".", ", ") for k in at}
        out.append(Table("At the operating speed" + (f", {digits(operating[0], 5)} {unit}" if operating and operating[0] == operating[1] else ""),
                         ["place", "amplitude 0-peak"], [[words[k], person(v.value, v.unit, 4)] for k, v in at.items()]))
    return out


KINDS = {"hopf": "Hopf point: whirl sets in", "fold": "limit point", "cyclic_fold": "limit point of cycles: the motion jumps",
         "flip": "flip: the period doubles", "neimark_sacker": "Neimark-Sacker point: a second frequency sets in", "branch_point": "branch point"}


def beyond(b):
    """What a bifurcation means, as summary.json says it."""
    words = b.get("sentence", "")
    if b.get("criticality") == "undetermined" and b.get("criticality_by"):
        words += f" ({b['criticality_by'].removeprefix('undetermined: ')})"
    return words.strip()


def frequency(b):
    """Of the motion that is born, in Hz."""
    if b.get("whirl_frequency_rad_s"):
        return digits(b["whirl_frequency_rad_s"] / (2 * math.pi), 4)
    return "\u2013" if not b.get("period_s") or b["period_s"] <= 0 else digits(1 / b["period_s"] / (2 if b.get("type") == "flip" else 1), 4)


def bifurcations(study):
    found = study.bifurcations
    if not found:
        return None
    unit = next((b.get("unit") for b in found), "")
    name = str(found[0].get("parameter", "parameter")).rsplit(".", 1)[-1].replace("_", " ")
    rows = [[KINDS.get(b.get("type"), b.get("type")), with_bar(b.get("value"), b.get("uncertainty")), frequency(b), b.get("criticality") or "\u2013", beyond(b)]
            for b in found]
    return Table("Bifurcations", ["what", f"{name} [{unit}]" if unit not in ("", "1") else name, "frequency [Hz]", "criticality", "what it means"], rows,
                 "the bar estimates the error from film mesh, time mesh and location; the frequency is that of the motion born there")


# What a branch is where it is not unstable, by the verdict of summary.json.
SOLID = {"undamped throughout": "undamped", "undamped, then unstable": "undamped", "stable or undamped": "stable or undamped"}


def stability(study, branch):
    """Where the branch is stable, in words: stretches of the parameter between its changes."""
    unit = study.attribute("parameter_unit", "")
    known = study.summary.get("ranges")
    if known:
        rows = [[f"{digits(r['from'], 6)} to {digits(r['to'], 6)}", r["stability"]] for r in known]
    else:
        pieces = branch.curve.stretches(branch.parameter, branch.stable, [place for _, _, place in branch.events])
        solid_words = SOLID.get(study.summary.get("stability"), "stable")
        rows = [[f"{digits(float(x[0]), 6)} to {digits(float(x[-1]), 6)}", solid_words if solid else "unstable"] for x, _, solid in pieces]
    if not 0 < len(rows) <= 12:
        return None
    name = study.attribute("parameter", "parameter").rsplit(".", 1)[-1].replace("_", " ")
    return Table("Along the branch", [f"{name} [{unit}]" if unit not in ("", "1") else name, ""], rows,
                 "; ".join(f"the branch ends: {e}" for e in branch.ends))


def branch(study):
    if not study.has("branch/parameter"):
        return [bifurcations(study)]
    followed = Followed(study)
    out = [bifurcations(study), stability(study, followed)]
    if study.kind == "cycle_branch" and study.has("branch/x_max", "branch/y_max"):
        names = study.bearings(followed.column("x_max").shape[1])
        factor, unit = study.measure(np.concatenate([followed.column("x_max"), followed.column("y_max")]))
        rows = []
        tables = [(names[b], [(followed.column(f"{d}_max")[:, b] - followed.column(f"{d}_min")[:, b]) / 2 for d in "xy"]) for b in range(len(names))]
        if study.has("nodes/amplitude"):
            node = {d: study.get(f"nodes/{d}").reshape(followed.points, -1) for d in "xy"}
            tables += [(f"node {n}, shaft", [node["x"][:, k], node["y"][:, k]]) for k, n in enumerate(np.atleast_1d(study.get("nodes/node")))]
        for name, (x, y) in tables:
            row = [name]
            for values in (x, y):
                at, stable = followed.along(values)
                k = int(np.argmax(np.where(stable, values, -np.inf) if stable.any() else values))
                row += [digits(float(values[k] * factor), 4), digits(float(at[k]), 5)]
            rows.append(row)
        at = f"at [{study.attribute('parameter_unit', '')}]" if study.attribute("parameter_unit", "1") != "1" else "at"
        shown = f" [{unit}]" if unit != "1" else ""
        what = "Largest vibration of the stable cycles" if followed.stable.any() else "Largest vibration of the cycles, none of which is stable"
        out.append(Table(what, ["place", f"x{shown}", at, f"y{shown}", at], rows, f"0-peak: half of the travel; {study.shown}"))
    return out


def safe_perturbation(results):
    """Of self-excited whirl that exists below its threshold: how far the rotor may be disturbed before it jumps to it."""
    rows = []
    for study in results.studies:
        if study.kind != "cycle_branch" or study.attribute("unbalance", "") or not study.has("branch/parameter", "branch/y_max"):
            continue
        hopf = next((b["value"] for b in study.bifurcations if b.get("type") == "hopf" and b.get("criticality") == "subcritical"), None)
        followed = Followed(study)
        if hopf is None or followed.stable[0]:
            continue
        # The unstable cycles from the Hopf point to the first limit point part small from large disturbances.
        last = int(np.argmax(followed.stable)) if followed.stable.any() else len(followed.parameter)
        p, names = followed.parameter[:last], study.bearings(followed.column("y_max").shape[1])
        if last < 2:
            continue
        half = [np.hypot(*((followed.column(f"{d}_max")[:last, b] - followed.column(f"{d}_min")[:last, b]) / 2 for d in "xy"))
                for b in range(len(names))]
        factor, unit = study.measure(np.concatenate(half))
        for share in (0.25, 0.5, 0.75, 1.0):
            k = int(np.argmin(np.abs(p - (hopf + share * (p[-1] - hopf)))))
            rows.append([study.name, f"{digits(float(p[k]), 5)} {study.attribute('parameter_unit', '')}".strip(), *[digits(float(h[k] * factor), 3) for h in half]])
        head = ["whirl", study.attribute("parameter", "parameter"), *[f"{n} [{unit}]" if unit != "1" else n for n in names]]
        return Table("Safe perturbation between the limit point and the threshold", head, rows,
                     "size of the unstable whirl, 0-peak (root of the squares of x and y): from smaller disturbances the rotor comes back, larger ones "
                     "lead to the large whirl")
    return None


def motion(study):
    values = study.values
    rows = [["kind of motion", str(study.attribute("motion", "")).replace("_", " ")], ["evidence", study.attribute("evidence", "")]]
    for k in range(1, 5):
        if f"lyapunov.{k}" in values:
            bar = values.get(f"lyapunov.{k}.uncertainty")
            rows.append([f"Lyapunov exponent {k} [1/s]", with_bar(values[f"lyapunov.{k}"].value, values[f"lyapunov.{k}"].uncertainty or (bar.value if bar else None))])
    rows += [[k.replace("peak_to_peak.", "peak to peak, ").replace(".", " "), person(v.value, v.unit, 4)] for k, v in values.items() if k.startswith("peak_to_peak.")]
    return [Table("Motion", ["", ""], rows)]


def run_up(study):
    values, rows = study.values, []
    for key, v in values.items():
        if key.endswith(".peak.amplitude"):
            head = key.removesuffix(".amplitude")
            at = values.get(f"{head}.speed")
            rows.append([head.removesuffix(".peak").replace("bearing.", "").replace("node.", "node "), person(v.value, v.unit, 4),
                         f"{digits(at.value, 5)} {at.unit}" if at else "\u2013"])
    return [Table("Largest vibration on the way", ["place", "amplitude 0-peak", "at"], rows)] if rows else []


def locus(study):
    rows = [[LOCUS_WORDS.get(c.get("type"), str(c.get("type"))), with_bar(c.get("value"), c.get("value_uncertainty")), f"{with_bar(c.get('second_value'), c.get('second_value_uncertainty'))}"]
            for c in study.summary.get("codimension_two", [])]
    first, second = study.attribute("parameter", ""), study.attribute("second", "").rsplit(".", 1)[-1].replace("_", " ")
    unit = study.attribute("second_unit", "")
    return [Table("Points of codimension two", ["what", f"{first} [{study.attribute('parameter_unit', '')}]", f"{second} [{WORDS.get(unit, unit)}]"],
                  rows)] if rows else []


def sweep(study):
    return sweep_tables.tables(study, Table)


FINDINGS = {"modes": modes, "unbalance_response": unbalance_response, "equilibrium_branch": branch,
            "cycle_branch": branch, "motion": motion, "run_up": run_up, "locus": locus, "sweep": sweep}


def findings(study):
    """The tables of a study that answer what it was asked, without those that have nothing to say."""
    own = [Table(t.caption, t.heads, [[c.text for c in row] for row in t.rows], t.note) for t in study.answer.tables]
    return own + [t for t in FINDINGS.get(study.kind, lambda s: [bifurcations(s)])(study) if t is not None and t.rows]


def applied_unbalance(results):
    """(name, plane from 1) -> U in kg m, and name -> mass in kg to which its grade applies, as the studies applied them."""
    amounts, masses = {}, {}
    for study in results.studies:
        if not study.has("unbalance/amount"):
            continue
        names, planes, some = (np.atleast_1d(study.get(f"unbalance/{k}")) for k in ("unbalance", "plane", "amount"))
        amounts.update({(str(n), int(p)): float(u) for n, p, u in zip(names, planes, some)})
        masses.update({n: study.values[f"unbalance.{n}.mass"].value for n in map(str, names) if f"unbalance.{n}.mass" in study.values})
    return amounts, masses


def stiffness_of(element):
    """K xx, xy, yx, yy of an element: K_xy holds its cross-coupling, K_yx the negative of it."""
    given, cross = element.get("stiffness"), number_of(element.get("cross_coupling"))
    if not cross:
        return given
    k = [number_of(v) or 0.0 for v in given or [0] * 4]
    return [f"{v:.12g} N/m" for v in (k[0], k[1] + cross, k[2] - cross, k[3])]


def inputs(results):
    """Tables of what was computed: bearings, lubricants, unbalance, from the deck as it was understood."""
    deck = results.deck
    if not isinstance(deck, dict):
        return []
    out, rows = [], []
    lubricants = deck.get("lubricants") or {}
    for name, b in (deck.get("bearings") or {}).items():
        g, f, p = b.get("geometry") or {}, b.get("film") or {}, b.get("pedestal") or {}
        film = ", ".join(str(f[k]).replace("_", " ") for k in ("type", "cavitation", "turbulence") if k in f)
        film += ", " + " \u00d7 ".join(map(str, f["cells"])) + " cells" if isinstance(f.get("cells"), list) else ""
        shape = ", ".join([str(g.get("type", "")).replace("_", " ")] + [f"{k} {quantity(g[k])}" for k in ("arc", "preload", "offset")
                                                                        if k in g and str(g[k]) not in ("0", "0 m")]).strip(", ")
        oil = lubricants.get(b.get("lubricant"), {}) if isinstance(b.get("lubricant"), str) else b.get("lubricant") or {}
        stiffness = " / ".join(quantity(k) for k in p.get("stiffness", [])) if isinstance(p, dict) else ""
        rows.append([name, b.get("node", ""), shape, *[quantity(g.get(k, "")) for k in ("radius", "length", "clearance")], film,
                     quantity(oil.get("viscosity", "")) if isinstance(oil, dict) else "", quantity(b.get("elevation", "")), stiffness])
    if rows:
        head = ["bearing", "node", "bore", "radius", "length", "clearance", "film", "viscosity", "elevation", "pedestal stiffness x / y"]
        keep = [k for k in range(len(head)) if k == 0 or any(str(r[k]) not in ("", "0 m", "0 \u00b5m") for r in rows)]
        out.append(Table("Bearings", [head[k] for k in keep], [[r[k] for k in keep] for r in rows]))
    rows = []
    matrix = lambda e, key: " ".join(quantity(v) for v in e.get(key) or []) if any(str(v)[:2] not in ("0", "0 ") for v in e.get(key) or []) else ""  # noqa: E731
    for name, e in (deck.get("elements") or {}).items():
        e = {**e, "stiffness": stiffness_of(e)}
        end = f"node {e['to_node']}" if e.get("to_node") else f"pedestal of {e['to_pedestal']}" if e.get("to_pedestal") else "ground"
        carries = e.get("static_load", e.get("role") in ("support", "other"))
        rows.append([name, e.get("role", ""), e.get("node", ""), end, "yes" if carries is True or str(carries) == "true" else "no",
                     *[matrix(e, k) for k in ("stiffness", "damping", "mass")], f"{len(e['table'])} speeds" if e.get("table") else ""])
    if rows:
        head = ["element", "role", "node", "other end", "static load", "K xx xy yx yy", "C", "M", "table"]
        keep = [k for k in range(len(head)) if k == 0 or any(r[k] for r in rows)]
        out.append(Table("Elements", [head[k] for k in keep], [[r[k] for k in keep] for r in rows]))
    rows = [[load.get("node", ""), *[" / ".join(quantity(v) for v in load.get(k) or []) for k in ("force", "moment")]] for load in deck.get("loads") or []]
    if rows:
        out.append(Table("Static loads", ["node", "force x / y", "moment about x / y"], rows))
    rows = []
    amounts, masses = applied_unbalance(results)
    for name, u in (deck.get("unbalance") or {}).items():
        planes = ", ".join(f"node {p.get('node')}: " + " ".join([f"{k} {quantity(p[k])}" for k in ("eccentricity", "amount", "fraction", "phase") if k in p]
                                                                + ([f"(U = {person(amounts[name, k], 'kg m', 4)})"] if (name, k) in amounts else []))
                           for k, p in enumerate(u.get("planes", []), 1))
        rows.append([name, u.get("grade", ""), u.get("rotor", ""), person(masses[name], "kg", 4) if name in masses else "",
                     quantity(u.get("service_speed", "")), planes])
    if rows:
        keep = [k for k in range(6) if any(r[k] for r in rows)]
        head = ["unbalance", "grade", "rotor", "mass", "service speed", "planes"]
        out.append(Table("Unbalance", [head[k] for k in keep], [[r[k] for k in keep] for r in rows]))
    return out
