"""Curves of bifurcations and limits in two parameters, with their points of codimension two."""
import numpy as np

from .canvas import Line2D, plt
from .curves import hermite
from .style import GREY, INK, runs, save
from .units import WORDS as WORDS_OF_UNITS

WORDS = {"meeting": "two meet", "meeting_over_second": "curve turns", "resonance_1_1": "1:1 resonance",
         "resonance_1_2": "1:2 resonance", "resonance_1_3": "1:3 resonance", "resonance_1_4": "1:4 resonance",
         "cusp": "cusp", "bogdanov_takens": "Bogdanov-Takens", "generalised_hopf": "generalised Hopf",
         "generalised_flip": "generalised flip", "fold_flip": "fold and flip", "fold_hopf": "fold and Hopf",
         "fold_neimark_sacker": "fold and Neimark-Sacker"}
NAMES = {"flip": "flips", "cyclic_fold": "cyclic folds", "neimark_sacker": "Neimark-Sacker points", "hopf": "Hopf points",
         "fold": "folds"}


def dotted_words(study):
    """What dots mean along the curve."""
    return "unstable cycle" if study.attribute("bifurcation") == "limit" else "no border: something else is unstable there already"


def last(path):
    return path.rsplit(".", 1)[-1].replace("_", " ")


def described(study):
    """Name of the study and what its curve is of, unless the name says that already."""
    if study.attribute("bifurcation") == "limit":
        unit = study.attribute("limit_unit")
        return f"{study.name}: {study.attribute('limit')} is {study.attribute('limit_value'):.6g} {WORDS_OF_UNITS.get(unit, unit) or ''}".rstrip()
    kind = NAMES.get(study.attribute("bifurcation"), "bifurcations")
    return study.name if kind.lower() in study.name.lower() else f"{study.name}: {kind}"


STEP = np.array([8.0, 5.0])  # points from a mark to its label


def box_of(axis, place, sides, steps, words):
    """Corners of words beside a place, in fractions of the axes."""
    low, span = (np.array([limits[0] for limits in (axis.get_xlim(), axis.get_ylim())]),
                 np.array([np.ptp(limits) for limits in (axis.get_xlim(), axis.get_ylim())]))
    points = 72 * axis.figure.get_size_inches() * (0.9, 0.72)
    size = np.array([4.0 * max(map(len, words)), 10.5 * len(words)]) / points
    near = (np.array(place) - low) / span + np.array(sides) * steps * STEP / points
    corners = np.sort([near, near + np.array(sides) * size], axis=0)
    if sides[1] == 0:
        corners[:, 1] += np.array([-0.5, 0.5]) * size[1]
    return corners


def dense_points(axis):
    """Points along all lines of the axes, close to each other, in fractions of the axes."""
    low, high = np.transpose([axis.get_xlim(), axis.get_ylim()])
    curves = [(line.get_xydata() - low) / (high - low) for line in axis.get_lines()]
    share = np.linspace(0, 1, 20)[:, None, None]
    return np.concatenate([np.zeros((0, 2)), *((c[:-1] + share * (c[1:] - c[:-1])).reshape(-1, 2) if len(c) > 1 else c for c in curves)])


def covered(dense, corners, steps, taken):
    """How much lies under a box: curves by their length, other labels and the world outside the axes a great deal, the way there
    a little."""
    hits = 1e6 * float(np.any(corners[0] < 0) or np.any(corners[1] > 1)) + 1e-3 * steps
    hits += 1e3 * sum(bool(np.all(corners[0] < other[1]) and np.all(other[0] < corners[1])) for other in taken)
    return hits + np.count_nonzero(np.all((dense > corners[0]) & (dense < corners[1]), axis=1))


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
    taken, dense = [], dense_points(axis)
    for x, y, words in groups:
        ways = [((sx, sy), n) for n in (1, 4, 8) for sx, sy in ((1, -1), (1, 1), (-1, 1), (-1, -1), (1, 0), (-1, 0))]
        sides, steps = min(ways, key=lambda w: covered(dense, box_of(axis, (x, y), *w, words), w[1], taken))
        taken.append(box_of(axis, (x, y), sides, steps, words))
        axis.annotate(",\n".join(words), (x, y), textcoords="offset points", xytext=STEP * sides * steps, fontsize=8,
                      color=INK, ha="left" if sides[0] > 0 else "right", va=("top", "center", "bottom")[sides[1] + 1],
                      arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.6, "shrinkA": 1, "shrinkB": 3} if steps > 1 else None)
    for _, x, y in points:
        axis.plot([x], [y], "o", color=INK, markersize=5, zorder=5)


def smooth(x, y):
    """The curve through the points in their order, cubic over the length of the polygon on axes of equal spans."""
    x, y = (np.asarray(v, float) for v in (x, y))
    length = np.hypot(np.diff(x) / (np.ptp(x) or 1), np.diff(y) / (np.ptp(y) or 1))
    if len(x) < 3 or not np.all(length > 0):
        return x, y
    s = np.concatenate([[0], np.cumsum(length)])
    return tuple(hermite(s, v, np.gradient(v, s, edge_order=2), 8)[1] for v in (x, y))


def borders(study):
    """Pieces of the curve between neighbouring points, each with whether it is a border of stability: (x, y, border)."""
    x, y = study.get("locus/parameter"), study.get("locus/second")
    others = study.get("locus/others_unstable")
    border = np.ones(max(len(x) - 1, 0), bool) if others is None else (others[:-1] == 0) & (others[1:] == 0)
    return x, y, border


def pieces(study):
    """The smooth curve in pieces (x, y, whether it is a border of stability)."""
    x, y, border = borders(study)
    smoothed = smooth(x, y)
    parts = (len(smoothed[0]) - 1) // max(len(x) - 1, 1)
    return [(*(v[a * parts:b * parts + 1] for v in smoothed), bool(border[a])) for a, b in runs(list(border))] if len(border) else []


def draw_curve(axis, study):
    """The curve: a line where it is a border of stability or of stable cycles, thin dots elsewhere. Returns what these mean."""
    found = pieces(study)
    named = next((k for k, (*_, border) in enumerate(found) if border), 0)
    for k, (x, y, border) in enumerate(found):
        style = {"linestyle": "-"} if border else {"linestyle": ":", "linewidth": 1.0}
        axis.plot(x, y, color=study.colour, label=described(study) if k == named else "_", **style)
    return {dotted_words(study)} if any(not border for *_, border in found) else set()


def crossings(study):
    """A function of the second parameter: where the borders of a curve cross its line, (first parameter, unstable above it)."""
    x, y, border = borders(study)
    side, start = study.attribute("stable_side", ""), int(study.attribute("start", 0) or 0)
    if side not in ("above", "below") or len(x) < 2:
        return lambda level: []
    steps = np.sign(np.diff(y))
    # The unstable side stays left or right of the curve as one goes along it.
    way = steps[min(start, len(steps) - 1)] or steps[max(start - 1, 0)]
    low, high, usable = np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:]), border & (steps != 0)

    def at(level):
        here = np.flatnonzero(usable & (low <= level) & (level < high))
        return [(x[k] + (x[k + 1] - x[k]) * (level - y[k]) / (y[k + 1] - y[k]), (side == "below") == (steps[k] == way)) for k in here]

    return at


def regions(axis, studies):
    """Shades where each motion is unstable, row by row between its borders, and names what is born there."""
    groups = {}
    for study in studies:
        if study.attribute("stable_side", ""):
            groups.setdefault(study.attribute("of", ""), []).append(study)
    (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
    x, y = np.linspace(left, right, 400), np.linspace(low, high, 300)
    free = np.ones((len(y), len(x)), bool)  # every motion is known to be stable there
    names = []
    for of, curves in groups.items():
        mask, at = np.zeros((len(y), len(x)), bool), [crossings(s) for s in curves]
        for row, level in enumerate(y):
            found = sorted(c for of_curve in at for c in of_curve(level))
            if not found:
                free[row] = False
                continue
            begin = None if found[0][1] else left
            for where, above in found:
                if above and begin is None:
                    begin = where
                elif not above and begin is not None:
                    mask[row] |= (x >= begin) & (x <= where)
                    begin = None
            if begin is not None:
                mask[row] |= x >= begin
        if not mask.any():
            continue
        free &= ~mask
        colour = curves[0].colour
        axis.contourf(x, y, mask.astype(float), levels=[0.5, 1.5], colors=[colour], alpha=0.10, zorder=0)
        names.append((mask, f"{of}: {curves[0].attribute('born', '') or 'unstable'}", colour))
    if free.any() and names:
        names.append((free, "stable", INK))
    for k, (mask, words, colour) in enumerate(names):
        others = np.zeros_like(mask) if words == "stable" else np.any([m for j, (m, _, _) in enumerate(names) if j != k], axis=0)
        row, column = widest(mask & ~others)
        # Where its own part is narrower than the name, the name stands in the whole region.
        if np.count_nonzero((mask & ~others)[row]) < 4.8 * len(words):
            row, column = widest(mask)
        axis.text(x[column], y[row], words, color=colour, fontsize=9, ha="center", va="center", style="italic", zorder=1)


def widest(mask):
    """The place in a region (row, column) that lies farthest from its edge, with more room across than upward."""
    depth = np.zeros(mask.shape)
    rest = mask.copy()
    rest[[0, -1]] = rest[:, [0, -1]] = False
    while rest.any():
        depth += rest
        smaller = rest.copy()
        for shift in ((1, 0), (-1, 0), (0, 3), (0, -3)):
            moved = np.roll(rest, shift, (0, 1))
            if shift[1] > 0:
                moved[:, :shift[1]] = False
            elif shift[1] < 0:
                moved[:, shift[1]:] = False
            smaller &= moved
        rest = smaller
    return np.unravel_index(np.argmax(depth), depth.shape)


def bars_of(study):
    """(x, y, bar of x, bar of y) where bars were computed, zero in the parameter in which it is longer: a curve has none along itself."""
    names = ("parameter", "second", "parameter_uncertainty", "second_uncertainty", "uncertainty_computed")
    columns = [study.get(f"locus/{name}") for name in names]
    if any(c is None for c in columns):
        return []
    x, y, across, upward, computed = columns
    spans, found = (np.ptp(x) or 1, np.ptp(y) or 1), []
    for k in np.flatnonzero(computed):
        lengths = np.nan_to_num([across[k] / spans[0], upward[k] / spans[1]], nan=np.inf)
        if np.isfinite(lengths.min()):
            found.append((x[k], y[k], *((across[k], 0) if lengths[0] <= lengths[1] else (0, upward[k]))))
    return found


def of_one_pair(results):
    """The curves over the two parameters of the first curve."""
    studies = [s for s in results.studies if s.kind == "locus" and s.has("locus/parameter")]
    pair = lambda s: (s.attribute("parameter"), last(s.attribute("second", "")))  # noqa: E731
    return [s for s in studies if pair(s) == pair(studies[0])]


def name_and_unit(study, key):
    """Of the parameter or the second parameter."""
    unit = study.attribute(f"{key}_unit")
    return last(study.attribute(key)), WORDS_OF_UNITS.get(unit, unit) or ""


def draw_together(results):
    """All curves over the same pair of parameters in one picture."""
    studies = of_one_pair(results)
    if not studies:
        return []
    figure, axis = plt.subplots(figsize=(8, 5.5))
    points = []
    dotted = set()
    for study in studies:
        dotted |= draw_curve(axis, study)
        for x, y, across, upward in bars_of(study):
            axis.errorbar(x, y, **({"xerr": across} if across else {"yerr": upward}), fmt="none", ecolor=study.colour, elinewidth=1.2)
        kinds = study.get("codimension_two/type")
        if kinds is not None and len(kinds):
            points += zip(kinds, np.atleast_1d(study.get("codimension_two/parameter")),
                          np.atleast_1d(study.get("codimension_two/second")))
    axis.margins(x=0.04, y=0.08)
    regions(axis, studies)
    label(axis, points)
    for put, key in ((axis.set_xlabel, "parameter"), (axis.set_ylabel, "second")):
        name, unit = name_and_unit(studies[0], key)
        put(name + (f" [{unit}]" if unit else ""))
    limits = [s.attribute("bifurcation") == "limit" for s in studies]
    about = [words for words, there in (("where motions lose stability", not all(limits)), ("where cycles have a given size or period", any(limits))) if there]
    return save(figure, results.whole("curves of bifurcations" + " and limits" * any(limits)), "loci", ", ".join([*about, "over two parameters"]),
                [line for line in axis.get_lines() if not line.get_label().startswith("_")]
                + [Line2D([], [], color=GREY, linestyle=":", linewidth=1.0, label=words) for words in sorted(dotted)])
