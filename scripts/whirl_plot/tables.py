"""What was asked for, as tables: loads, journal positions, critical speeds, peaks, thresholds, and what happens beyond them."""
import math
import typing

import numpy as np

from .bifurcation import Followed
from .locus import WORDS as LOCUS_WORDS
from .units import WORDS, digits, number as number_of, person, quantity, with_bar


class Table(typing.NamedTuple):
    caption: str
    head: list
    rows: list
    note: str = ""


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


FINDINGS = {"equilibrium_branch": branch, "cycle_branch": branch, "motion": motion, "run_up": run_up, "locus": locus}


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
