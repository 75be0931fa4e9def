"""Curves of bifurcations in two parameters, with their points of codimension two."""
import re

import numpy as np
from matplotlib import pyplot as plt

from .style import INK, save

WORDS = {"meeting": "two meet", "meeting_over_second": "curve turns", "resonance_1_1": "1:1 resonance",
         "resonance_1_2": "1:2 resonance", "resonance_1_3": "1:3 resonance", "resonance_1_4": "1:4 resonance",
         "cusp": "cusp", "bogdanov_takens": "Bogdanov-Takens", "generalised_hopf": "generalised Hopf",
         "generalised_flip": "generalised flip", "fold_flip": "fold and flip", "fold_hopf": "fold and Hopf",
         "fold_neimark_sacker": "fold and Neimark-Sacker"}
NAMES = {"flip": "flips", "cyclic_fold": "cyclic folds", "neimark_sacker": "Neimark-Sacker points", "hopf": "Hopf points",
         "fold": "folds"}


def last(path):
    return path.rsplit(".", 1)[-1].replace("_", " ")


def described(study):
    """Name of the study and what its curve is of, unless the name says that already."""
    kind = NAMES.get(study.attribute("bifurcation"), "bifurcations")
    return study.name if kind.lower() in study.name.lower() else f"{study.name}: {kind}"


def covered(axis, place, sides, words):
    """How much of the curves lies under words beside a place, estimated from their length; words outside count a great deal."""
    low, span = (np.array([limits[0] for limits in (axis.get_xlim(), axis.get_ylim())]),
                 np.array([np.ptp(limits) for limits in (axis.get_xlim(), axis.get_ylim())]))
    size = np.array([0.012 * max(map(len, words)) + 0.01, 0.035 * len(words) + 0.01])
    near = (np.array(place) - low) / span + sides * np.array([0.01, 0.005])
    corners = np.sort([near, near + sides * size], axis=0)
    hits = 1e3 * float(np.any(corners[0] < 0) or np.any(corners[1] > 1))
    for line in axis.get_lines():
        curve = (line.get_xydata() - low) / span
        dense = np.concatenate([np.linspace(a, b, 20) for a, b in zip(curve[:-1], curve[1:])] or [curve])
        hits += np.count_nonzero(np.all((dense > corners[0]) & (dense < corners[1]), axis=1))
    return hits


def label(axis, points):
    """Marks the points; those that lie together share a label, which stands where it covers least."""
    (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
    groups = []
    for kind, x, y in points:
        word = WORDS.get(kind, kind.replace("_", " "))
        near = [g for g in groups if abs(g[0] - x) < 0.03 * (right - left) and abs(g[1] - y) < 0.03 * (high - low)]
        if not near:
            groups.append((x, y, [word]))
        elif word not in near[0][2]:
            near[0][2].append(word)
    for x, y, words in groups:
        sides = min(([1, -1], [1, 1], [-1, 1], [-1, -1]), key=lambda s: covered(axis, (x, y), np.array(s), words))
        axis.annotate(",\n".join(words), (x, y), textcoords="offset points", xytext=(8 * sides[0], 5 * sides[1]), fontsize=8,
                      color=INK, ha="left" if sides[0] > 0 else "right", va="bottom" if sides[1] > 0 else "top")
    for _, x, y in points:
        axis.plot([x], [y], "o", color=INK, markersize=5, zorder=5)


def draw_together(results):
    """All curves over the same pair of parameters in one picture."""
    studies = [s for s in results.studies if s.kind == "locus" and s.has("locus/parameter")]
    if not studies:
        return []
    pair = (studies[0].attribute("parameter"), last(studies[0].attribute("second", "")))
    studies = [s for s in studies if (s.attribute("parameter"), last(s.attribute("second", ""))) == pair]
    figure, axis = plt.subplots(figsize=(8, 5.5))
    points = []
    for study in studies:
        axis.plot(study.get("locus/parameter"), study.get("locus/second"), color=study.colour, label=described(study))
        kinds = study.get("codimension_two/type")
        if kinds is not None and len(kinds):
            points += zip(kinds, np.atleast_1d(study.get("codimension_two/parameter")),
                          np.atleast_1d(study.get("codimension_two/second")))
    axis.margins(x=0.04, y=0.08)
    label(axis, points)
    axis.set_xlabel(f"{last(studies[0].attribute('parameter'))} [{studies[0].attribute('parameter_unit')}]")
    unit = re.sub("^u(?=m$)", "\u00b5", studies[0].attribute("second_unit"))
    axis.set_ylabel(f"{last(studies[0].attribute('second'))} [{unit}]")
    return save(figure, results.whole("curves of bifurcations"), "loci", "where motions lose stability, over two parameters",
                [line for line in axis.get_lines() if not line.get_label().startswith("_")])
