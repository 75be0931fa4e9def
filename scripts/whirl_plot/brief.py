"""What each study found, in a sentence or two."""
from .bifurcation import Followed
from .locus import WORDS as LOCUS_WORDS
from .units import WORDS, digits, person, with_bar

NAMES = {"hopf": "Hopf point", "fold": "limit point", "cyclic_fold": "limit point of cycles", "flip": "flip", "neimark_sacker": "Neimark-Sacker point",
         "branch_point": "branch point"}


def at(b):
    unit = b.get("unit", "")
    return f"{with_bar(b.get('value'), b.get('uncertainty'))} {unit if unit != '1' else ''}".strip()


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


KINDS = {"equilibrium_branch": branch, "cycle_branch": branch, "motion": motion, "locus": locus, "run_up": run_up}


def of(study):
    """What a study found; empty if there is nothing to say in a sentence."""
    said = study.answer.sentences + [s for s in KINDS.get(study.kind, lambda _: [])(study) if s]
    if study.status not in ("", "completed") and not any(s.startswith("ends: ") for s in said):
        said.append(study.status)
    return "; ".join(said)
