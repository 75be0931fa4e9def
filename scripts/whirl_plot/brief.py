"""What each study found, in a sentence or two."""
import math

import numpy as np

from . import sweep_tables
from .bifurcation import Followed
from .locus import WORDS as LOCUS_WORDS
from .response import is_answer, number
from .style import speed_axis
from .units import WORDS, digits, person, with_bar

NAMES = {"hopf": "Hopf point", "fold": "limit point", "cyclic_fold": "limit point of cycles", "flip": "flip", "neimark_sacker": "Neimark-Sacker point",
         "branch_point": "branch point"}


def at(b):
    unit = b.get("unit", "")
    return f"{with_bar(b.get('value'), b.get('uncertainty'))} {unit if unit != '1' else ''}".strip()


def modes(study):
    if not study.has("spectrum/speed"):
        return [f"{len(study.modes)} natural frequencies"] if study.modes else []
    factor, unit = speed_axis(study.attribute("speed_unit", "rad/s"))[0], study.attribute("speed_unit", "rad/s")
    out = []
    if study.has("critical/speed", "critical/log_decrement"):
        known = [digits(float(s * factor), 4) for s, d in zip(np.atleast_1d(study.get("critical/speed")), np.atleast_1d(study.get("critical/log_decrement")))
                 if 0 < d < math.pi / 2.5 or d <= 0]
        out.append(f"critical speeds with an amplification above 2.5: {', '.join(known) or 'none'}" + (f" {unit}" if known else ""))
    undamped = study.get("spectrum/log_decrement") == 0
    if np.any(undamped):
        out.append("undamped" if np.all(undamped) else "some modes are undamped")
    return out + unstable_from(study, factor, unit)


def unstable_from(study, factor, unit):
    """Where the modes become unstable: the value of summary.json, else the two computed speeds that it lies between."""
    if "threshold" in study.values:
        v = study.values["threshold"]
        first = next(iter(study.summary.get("ranges", [])), {})
        low = f"up to {digits(first['to'], 5)} and " if first.get("stability") == "unstable" and first["to"] < v.value else ""
        return [f"unstable {low}from {with_bar(v.value, v.uncertainty)} {v.unit}"]
    speed, every = study.get("spectrum/speed"), np.unique(study.get("spectrum/speed"))
    known = study.get("spectrum/stability")
    unstable = np.unique(speed[study.get("spectrum/log_decrement") < 0 if known is None else np.isin(known, ("unstable", "diverges"))])
    if not len(unstable):
        return []
    first = float(unstable[0] * factor)
    below = every[every < unstable[0]]
    if len(below):
        return [f"becomes unstable between {digits(float(below[-1] * factor), 5)} and {digits(first, 5)} {unit}"]
    return [f"unstable from the lowest speed, {digits(first, 5)} {unit}" if len(every) > 1 else f"unstable at {digits(first, 5)} {unit}"]


def unbalance_response(study):
    if not study.has("response/speed", "response/semi_major"):
        return []
    stability = study.summary.get("stability", "stable")
    said = [] if stability.startswith("stable") else [stability]
    known = [p for p in study.peaks if number(p, "semi_major") is not None and number(p, "speed") is not None and str(p.get("place")).startswith("node ")]
    found = [p for p in known if is_answer(p)]
    endless = [p for p in study.peaks if p.get("stability") == "undamped" and number(p, "speed") is not None]
    if endless:
        p = endless[0]
        said.append(f"undamped peak at {p['place']}, {digits(number(p, 'speed'), 4)} {p['speed'].get('unit', '')}: the amplitude grows without limit there")
    if not known:
        return said if endless else [*said, "no peak in the range"]
    if not found:
        return [*said, f"{len(known)} peaks, none of which is a motion of the machine"]
    p = max(found, key=lambda p: number(p, "semi_major"))
    factor = number(p, "amplification_factor")
    words = f"largest peak {person(number(p, 'semi_major'), 'm', 3)} at {p['place']}, {digits(number(p, 'speed'), 4)} {p['speed'].get('unit', '')}"
    return [*said, words + (f", amplification {factor:.3g}" if factor is not None else "")]


def branch(study):
    if not study.has("branch/parameter"):
        return []
    followed, out = Followed(study), []
    unit = study.attribute("parameter_unit", "")
    unit = "" if unit == "1" else unit
    ranges = study.summary.get("ranges", [])
    losing = [b for b in study.bifurcations if b.get("type") in NAMES and not b.get("others_unstable")]
    if ranges and losing:  # the one at which the first stretch ends
        losing.sort(key=lambda b: abs((b.get("value") or 0) - ranges[0]["to"]))
    verdict = study.summary.get("stability", "")
    if verdict.endswith(" throughout") and followed.ends:
        verdict = verdict.removesuffix("throughout") + "as far as followed"
    if verdict in ("loses stability", "undamped, then unstable") and losing:
        b = losing[0]
        kind = f", {b['criticality']}" if b.get("criticality") in ("supercritical", "subcritical") else ""
        verdict += f" at the {NAMES.get(b['type'], b['type'])} at {at(b)}{kind}"
    out.append(verdict)
    later = [r for r in ranges[1:] if r["stability"] == "stable"]
    if later and len(later) <= 4:
        parts = ", ".join(f"{digits(r['from'], 5)} to {digits(r['to'], 5)}" for r in later)
        out.append(f"stable {'again ' if ranges[0]['stability'] == 'stable' else ''}from {parts} {unit}".strip())
    counts = {}
    for b in study.bifurcations:
        counts[b.get("type")] = counts.get(b.get("type"), 0) + 1
    if len(study.bifurcations) > 1:
        out.append("in all " + ", ".join(f"{n} {NAMES.get(k, k)}" if n == 1 else f"{n} {NAMES.get(k, k).replace('point', 'points').replace('flip', 'flips')}" for k, n in counts.items()))
    return out + [f"ends: {e}" for e in followed.ends]


def motion(study):
    return [str(study.attribute("motion", "")).replace("_", " ")]


def locus(study):
    if not study.has("locus/parameter", "locus/second"):
        return []
    name = lambda key: study.attribute(key, "").rsplit(".", 1)[-1].replace("_", " ")  # noqa: E731
    spans = []
    for column, key in (("parameter", "parameter"), ("second", "second")):
        values, unit = study.get(f"locus/{column}"), study.attribute(f"{key}_unit", "1")
        spans.append(f"{name(key)} {digits(float(values.min()), 4)} to {digits(float(values.max()), 4)}" + (f" {WORDS.get(unit, unit)}" if unit != "1" else ""))
    kind = NAMES.get(study.attribute("bifurcation", ""), "bifurcation")
    points = [LOCUS_WORDS.get(c.get("type"), str(c.get("type"))) for c in study.summary.get("codimension_two", [])]
    counted = [p if points.count(p) == 1 else f"{p} ({points.count(p)} times)" for p in dict.fromkeys(points)]
    return [f"curve of a {kind}: {', '.join(spans)}"] + ([f"on it: {', '.join(counted)}"] if counted else [])


def run_up(study):
    found = [(v.value, k) for k, v in study.values.items() if k.endswith(".peak.amplitude") and v.value is not None]
    if not found:
        return []
    top, key = max(found)
    at = study.values.get(key.removesuffix("amplitude") + "speed")
    place = key.removesuffix(".peak.amplitude").replace("bearing.", "").replace("node.", "node ")
    return [f"largest vibration {person(top, 'm', 3)} at {place}" + (f", {digits(at.value, 4)} {at.unit}" if at else "")]


def sweep(study):
    return sweep_tables.brief(study)


KINDS = {"modes": modes, "unbalance_response": unbalance_response, "equilibrium_branch": branch, "cycle_branch": branch, "motion": motion,
         "locus": locus, "run_up": run_up, "sweep": sweep}


def of(study):
    """What a study found; empty if there is nothing to say in a sentence."""
    said = study.answer.sentences + [s for s in KINDS.get(study.kind, lambda _: [])(study) if s]
    if study.status not in ("", "completed") and not any(s.startswith("ends: ") for s in said):
        said.append(study.status)
    return "; ".join(said)
