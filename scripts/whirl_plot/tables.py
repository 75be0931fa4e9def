"""Tables of the report: the answers of the studies, and the machine that was computed."""
import typing

import numpy as np

from .units import number as number_of, person, quantity


class Table(typing.NamedTuple):
    caption: str
    head: list
    rows: list
    note: str = ""


def findings(study):
    """The tables of its answer."""
    return [Table(t.caption, t.heads, [[c.text for c in row] for row in t.rows], t.note) for t in study.answer.tables]


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
    matrix = lambda e, key: ", ".join(quantity(v) if number_of(v) else "0" for v in e.get(key) or []) if any(str(v)[:2] not in ("0", "0 ") for v in e.get(key) or []) else ""  # noqa: E731
    lubricants = deck.get("lubricants") or {}
    for name, b in (deck.get("bearings") or {}).items():
        g, f, p = b.get("geometry") or {}, b.get("film") or {}, b.get("pedestal") or {}
        film = ", ".join(("cavitation " if k == "cavitation" else "") + str(f[k]).replace("_", " ") for k in ("type", "cavitation", "turbulence") if k in f)
        film += ", " + " \u00d7 ".join(map(str, f["cells"])) + " cells" if isinstance(f.get("cells"), list) else ""
        if results.studies and all(s.kind == "thd" for s in results.studies):  # they have a film of their own
            film = "with heat, see the studies"
        shape = ", ".join([str(g.get("type", "")).replace("_", " ")] + [f"{k} {quantity(g[k])}" for k in ("arc", "preload", "offset")
                                                                        if k in g and str(g[k]) not in ("0", "0 m")]).strip(", ")
        oil = lubricants.get(b.get("lubricant"), {}) if isinstance(b.get("lubricant"), str) else b.get("lubricant") or {}
        stiffness = " / ".join(quantity(k) for k in p.get("stiffness", [])) if isinstance(p, dict) else ""
        own = [matrix(f, key) if f.get("type") == "linear" else "" for key in ("stiffness", "damping")]
        rows.append([name, b.get("node", ""), shape, *[quantity(g.get(k, "")) for k in ("radius", "length", "clearance")], film,
                     quantity(oil.get("viscosity", "")) if isinstance(oil, dict) else "", quantity(b.get("elevation", "")), *own, stiffness])
    if rows:
        head = ["bearing", "node", "bore", "radius", "length", "clearance", "film", "viscosity", "elevation", "K xx xy yx yy", "C xx xy yx yy", "pedestal stiffness x / y"]
        keep = [k for k in range(len(head)) if k == 0 or any(str(r[k]) not in ("", "0 m", "0 \u00b5m") for r in rows)]
        out.append(Table("Bearings", [head[k] for k in keep], [[r[k] for k in keep] for r in rows]))
    rows = []
    for name, e in (deck.get("elements") or {}).items():
        e = {**e, "stiffness": stiffness_of(e)}
        end = f"node {e['to_node']}" if e.get("to_node") else f"pedestal of {e['to_pedestal']}" if e.get("to_pedestal") else "ground"
        carries = e.get("static_load", e.get("role") in ("support", "other"))
        rows.append([name, e.get("role", ""), e.get("node", ""), end, "yes" if carries is True or str(carries) == "true" else "\u2013",
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
