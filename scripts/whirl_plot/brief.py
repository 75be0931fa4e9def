"""What each study found, in a sentence or two."""
import math

import numpy as np

from .bifurcation import Followed
from .response import peaks
from .style import speed_axis
from .units import digits, person, with_bar

NAMES = {"hopf": "Hopf point", "fold": "limit point", "cyclic_fold": "limit point of cycles", "flip": "flip", "neimark_sacker": "Neimark-Sacker point",
         "branch_point": "branch point"}


def at(b):
    unit = b.get("unit", "")
    return f"{with_bar(b.get('value'), b.get('uncertainty'))} {unit if unit != '1' else ''}".strip()


def static(study):
    values, out = study.values, []
    films = {k.split(".")[1]: v.value for k, v in values.items() if k.endswith(".min_thickness") and v.value is not None}
    if films:
        thinnest = min(films, key=films.get)
        out.append(f"thinnest film {person(films[thinnest], 'm', 3)} in {thinnest}")
    loads = {k.split(".", 1)[1]: v.value for k, v in values.items() if k.startswith("load.") and v.value is not None}
    if loads:
        heaviest = max(loads, key=loads.get)
        out.append(f"largest load {person(loads[heaviest], 'N', 4)} on {heaviest}")
    if "power_loss" in values and values["power_loss"].value:
        out.append(f"power loss {person(values['power_loss'].value, 'W', 4)}")
    return out


def modes(study):
    if not study.has("critical/speed", "critical/log_decrement"):
        return [f"{len(study.modes)} natural frequencies"] if study.modes and not study.has("spectrum/speed") else []
    factor, unit = speed_axis(study.attribute("speed_unit", "rad/s"))[0], study.attribute("speed_unit", "rad/s")
    known = [digits(float(s * factor), 4) for s, d in zip(np.atleast_1d(study.get("critical/speed")), np.atleast_1d(study.get("critical/log_decrement")))
             if 0 < d < math.pi / 2.5 or d <= 0]
    out = [f"critical speeds with an amplification above 2.5: {', '.join(known) or 'none'}" + (f" {unit}" if known else "")]
    unstable = study.get("spectrum/speed")[study.get("spectrum/log_decrement") < 0]
    if np.any(study.get("spectrum/log_decrement") == 0):
        out.append("undamped" if np.all(study.get("spectrum/log_decrement") == 0) else "some modes are undamped")
    if len(unstable):
        out.append(f"unstable from {digits(float(unstable.min() * factor), 4)} {unit}")
    return out


def unbalance_response(study):
    if not study.has("response/speed", "response/semi_major"):
        return []
    factor, unit = speed_axis(study.attribute("speed_unit", "rad/s"))[0], study.attribute("speed_unit", "rad/s")
    speed = study.get("response/speed")
    major = study.get("response/semi_major").reshape(len(speed), -1)
    found = [(top, where, amplification, node) for k, node in enumerate(np.atleast_1d(study.get("response/node"))) for where, top, amplification in peaks(speed, major[:, k])]
    if not found:
        return ["no peak in the range"]
    top, where, amplification, node = max(found)
    words = f"largest peak {person(float(top), 'm', 3)} at node {node}, {digits(float(where * factor), 4)} {unit}"
    return [words + (f", amplification {amplification:.3g}" if amplification else "")]


def branch(study):
    if not study.has("branch/parameter"):
        return []
    followed, out = Followed(study), []
    unit = study.attribute("parameter_unit", "")
    unit = "" if unit == "1" else unit
    losing = [b for b in study.bifurcations if b.get("type") in ("hopf", "flip", "neimark_sacker", "cyclic_fold", "fold")]
    if followed.stable.all():
        out.append("stable throughout" if followed.solid == "stable" else study.summary.get("stability", followed.solid))
    elif not followed.stable.any():
        out.append("unstable throughout")
    elif not followed.stable[0]:
        out.append("unstable where the branch starts")
    elif losing:
        b = losing[0]
        kind = f", {b['criticality']}" if b.get("criticality") in ("supercritical", "subcritical") else ""
        out.append(f"stable up to the {NAMES.get(b['type'], b['type'])} at {at(b)}{kind}")
    counts = {}
    for b in study.bifurcations:
        counts[b.get("type")] = counts.get(b.get("type"), 0) + 1
    if len(study.bifurcations) > 1:
        out.append("in all " + ", ".join(f"{n} {NAMES.get(k, k)}" if n == 1 else f"{n} {NAMES.get(k, k).replace('point', 'points').replace('flip', 'flips')}" for k, n in counts.items()))
    return out + [f"ends: {e}" for e in followed.ends]


def motion(study):
    return [str(study.attribute("motion", "")).replace("_", " ")]


KINDS = {"static": static, "modes": modes, "unbalance_response": unbalance_response, "equilibrium_branch": branch, "cycle_branch": branch, "motion": motion}


def of(study):
    """What a study found; empty if there is nothing to say in a sentence."""
    said = [s for s in KINDS.get(study.kind, lambda _: [])(study) if s]
    if study.status not in ("", "completed") and not any(s.startswith("ends: ") for s in said):
        said.append(study.status)
    return "; ".join(said)
