"""Charts of maps: critical speeds over the stiffness, curves of bifurcations over two parameters, Floquet multipliers along a branch."""
import numpy as np

from . import locus
from .critical import LINES, TO_RPM
from .live import line, rounded
from .live_branches import axis_of, over_parameter
from .multipliers import both_of_pairs, joined
from .style import BAD, COLOURS, GREY, INK, MARKS
from .units import with_bar

KEPT = 80  # points of a branch of which the plane shows the multipliers
FARTHEST = 2.5  # modulus that it shows


def critical(study, _):
    if not study.has("map/stiffness", "map/forward", "map/backward"):
        return None
    stiffness, lines = study.get("map/stiffness"), []
    for whirl, (name, _) in enumerate(LINES):
        speeds, bars = (study.get(f"map/{name}{end}") for end in ("", "_uncertainty"))
        for n, speed in enumerate(speeds.reshape(len(stiffness), -1).T):
            bar = None if bars is None else bars.reshape(len(stiffness), -1)[:, n] * TO_RPM
            lines.append(line(stiffness, speed * TO_RPM, f"no. {n + 1}", colour=COLOURS[n % len(COLOURS)], d=whirl, s=str(whirl) * len(stiffness), bar=bar))
    panel = {"x": ("stiffness of each bearing", "N/m"), "y": ("undamped critical speed", "rpm"), "logx": True, "log": True, "by": "x", "span": rounded(stiffness[[0, -1]]), "height": 420}
    return {"panels": [panel], "lines": lines, "styles": [{"d": whirl, "t": f"{name} whirl"} for whirl, (name, _) in enumerate(LINES)]}


def loci(results, _):
    studies, lines = locus.of_one_pair(results), []
    (one, of_one), (two, of_two) = (locus.name_and_unit(studies[0], key) for key in ("parameter", "second"))

    def told(name, x, y, bars, k):
        bars = [None if b is None else float(b[k]) for b in bars]
        return f"{name}: {one} {with_bar(float(x[k]), bars[0])} {of_one}".rstrip() + f", {two} {with_bar(float(y[k]), bars[1])} {of_two}".rstrip()

    for study in studies:
        name, (x, y, _) = locus.described(study), locus.borders(study)
        others, bars = study.get("locus/others_unstable", np.zeros(len(x))), [study.get(f"locus/{k}_uncertainty") for k in ("parameter", "second")]
        lines += [line(a, b, name, colour=study.colour, quiet=True, d=None if border else 2, digits=5) for a, b, border in locus.pieces(study)]
        found = locus.bars_of(study)
        if found:
            ends = [np.ravel([(v - e, v + e, np.nan) for v, e in zip(values, bar)]) for values, bar in ((np.array(v), np.array(e)) for v, e in (list(zip(*found))[::2], list(zip(*found))[1::2]))]
            lines.append(line(*ends, name, colour=study.colour, quiet=True, w=2.5))
        lines.append(line(x, y, name, colour=study.colour, bare=True,
                          t=[told(name, x, y, bars, k) + (f", {locus.dotted_words(study)}" if others[k] else "") for k in range(len(x))]))
        kinds = study.get("codimension_two/type")
        if kinds is not None and len(kinds):
            x, y, *bars = (np.atleast_1d(study.get(f"codimension_two/{k}")) if study.has(f"codimension_two/{k}") else None
                           for k in ("parameter", "second", "parameter_uncertainty", "second_uncertainty"))
            lines.append(line(x, y, "points of codimension two", colour=INK, m="circle", t=[told(locus.WORDS.get(kind, kind.replace("_", " ")), x, y, bars, k) for k, kind in enumerate(kinds)]))
    limits = any(s.attribute("bifurcation") == "limit" for s in studies)
    keys = [{"c": GREY, "t": "border of stability" + ", or stable cycles" * limits}, {"c": GREY, "d": 2, "t": "no border" + ", or unstable cycles" * limits}]
    return {"panels": [{"x": (one, of_one), "y": (two, of_two), "height": 440}], "lines": lines, "keys": keys}


def multipliers(study, _):
    """The moduli over the parameter, and beside them the plane with the multipliers of the point under the cursor."""
    parameter, found = study.get("branch/parameter"), study.multipliers
    values = both_of_pairs(found.reshape(len(parameter), -1)) if found is not None else np.zeros((0, 0))
    if not np.any(np.isfinite(values)):
        return None
    follows = {(k, i): j for k, i, j in zip(*(v.tolist() for v in joined(values)))}
    begins = [(k, i) for k, i in np.argwhere(np.isfinite(values)).tolist() if (k, i) not in {(k + 1, j) for (k, _), j in follows.items()}]
    lines = [line(parameter[[np.argmin(parameter), np.argmax(parameter)]], [1, 1], colour=BAD, quiet=True, w=1)]
    for k, i in begins:
        way = [i]
        while (k + len(way) - 1, way[-1]) in follows:
            way.append(follows[k + len(way) - 1, way[-1]])
        at = np.arange(k, k + len(way))
        here = values[at, way]
        lines.append(line(parameter[at], np.abs(here), "modulus", colour=GREY, at=at.tolist(), s="".join("01"[int(abs(v) > 1)] for v in here), digits=5,
                          more=[("real part", "", here.real), ("imaginary part", "", here.imag)]))
    turn = np.linspace(0, 2 * np.pi, 121)
    lines.append(line(np.cos(turn), np.sin(turn), None, 1, colour=INK, quiet=True, w=1, digits=4))
    name, unit = axis_of(study)
    for k in np.unique(np.linspace(0, len(parameter) - 1, KEPT).round().astype(int)):
        known = values[k][np.isfinite(values[k])]
        near = known[np.abs(known) <= FARTHEST]
        words = f"Multipliers at {name} {parameter[k]:.5g} {unit}".rstrip() + (f"; {len(known) - len(near)} beyond {FARTHEST}" if len(near) < len(known) else "")
        lines.append(line(near.real, near.imag, "modulus", 1, colour=GREY, f=int(k), t0=words, dots=True, digits=5))
    kinds, where = study.get("bifurcations/type"), np.atleast_1d(study.get("bifurcations/parameter", np.array([])))
    places = [(round(float(v), 6), MARKS.get(kind, (kind,))[0]) for kind, v in zip(kinds, where)] if kinds is not None else []
    top = 1.08 * max(1.0, min(FARTHEST, np.nanmax(np.abs(values))))
    panels = [{**over_parameter(study, parameter), "y": ("modulus", ""), "limits": [0, round(top, 3)], "places": places},
              {"x": ("real part", ""), "y": ("imaginary part", ""), "equal": True, "follows": True}]
    return {"panels": panels, "lines": lines, "styles": [{"t": ""}, {"c": BAD, "t": "unstable"}], "keys": [{"c": GREY, "t": "stable"}, {"c": BAD, "t": "beyond one: unstable"}], "side": True}
