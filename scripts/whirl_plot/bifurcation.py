"""Bifurcation diagrams: equilibria and cycles over a parameter, each bearing, stable solid and unstable dashed."""
import re

import numpy as np

from .bore import pads_of, reach
from .canvas import Line2D
from .curves import Branch
from .style import BAD, DASHED, GREY, INK, X, Y, branch_legend, grid_of, least_span, mark, mark_end, mark_service, parameter_label, save

RANGE_ENDS = ("completed", "", "end of the range")


UNSTABLE_OR_UNKNOWN = "unstable, or not known"


def words_of_dashes(unstable):
    """What a dashed line is: where multipliers were not found, their number is -1."""
    unknown, some = (unstable < 0).any(), (unstable > 0).any()
    return UNSTABLE_OR_UNKNOWN if unknown and some else "stability not known" if unknown else "unstable"


class Followed:
    """The branch of a study: its curves, where its bifurcations lie on it, and why it ends.

    A branch that left from a bifurcation begins there, and one that ran into a bifurcation ends there: those cycles stand first
    and last in `parameter`, `stable` and the columns that are known of them; `points` are without."""

    def __init__(self, study):
        self.study = study
        self.parameter = study.get("branch/parameter")
        self.points = len(self.parameter)
        unstable, stable = study.get("branch/unstable_count"), study.get("branch/stable")
        if stable is None:
            stable = unstable == 0 if unstable is not None else np.ones(len(self.parameter))
        self.stable = np.asarray(stable) > 0.5
        undamped = study.get("branch/undamped_count")
        undamped = np.zeros(len(self.parameter)) if undamped is None else np.asarray(undamped)
        self.solid = {(True,): "undamped", (False,): "stable"}.get(tuple(np.unique(undamped[self.stable] > 0)), "stable or undamped")
        unstable, step = unstable if unstable is not None else (~self.stable).astype(int), study.get("branch/step")
        self.dashed = words_of_dashes(unstable)
        filled = 0 < float(study.attribute("picture_tolerance", 0)) <= 0.02
        self.bare = self.curve = Branch(self.parameter, step, unstable, filled)
        self.bare_parameter, self.bare_stable = self.parameter, self.stable
        self.born, self.closed = (study.has(f"{end}/parameter") and self.points > 0 for end in ("birth", "closing"))
        step = np.abs(np.diff(self.parameter, prepend=self.parameter[0])) if step is None else step
        if self.born:
            self.parameter = np.concatenate([study.get("birth/parameter"), self.parameter])
            self.stable = np.concatenate([self.stable[:1], self.stable])
            step, unstable = np.concatenate([[0.0], step]), np.concatenate([unstable[:1], unstable])
        if self.closed:
            self.parameter = np.concatenate([self.parameter, study.get("closing/parameter")])
            self.stable = np.concatenate([self.stable, self.stable[-1:]])
            step, unstable = np.concatenate([step, [abs(self.parameter[-1] - self.parameter[-2])]]), np.concatenate([unstable, unstable[-1:]])
        if self.born or self.closed:
            self.curve = Branch(self.parameter, step, unstable, filled)
        kinds = study.get("bifurcations/type")
        values = [] if kinds is None or not len(kinds) else np.atleast_1d(study.get("bifurcations/parameter"))
        self.changes, known = self._changes()
        self.events = [(kind, value, known.get(k) or self._place(kind, value)) for k, (kind, value) in enumerate(zip(kinds if len(values) else [], values))]

    def _changes(self):
        """Where on the branch its stability changes, {segment: [(t, stable behind it)]}, and the places of bifurcations by number."""
        changes, places = {}, {}
        if not self.study.has("changes/after"):
            return changes, places
        columns = [np.atleast_1d(self.study.get(f"changes/{k}")) for k in ("after", "parameter", "unstable_before", "unstable_after", "fold", "bifurcation")]
        for after, value, before, behind, fold, number in zip(*columns):
            segment = int(after) + int(self.born)
            if not 0 <= segment < len(self.parameter) - 1:
                continue
            place = self.curve.place_in(segment, value, fold > 0)
            if number >= 0:
                places[int(number)] = place
            if (before > 0) != (behind > 0):
                changes.setdefault(segment, []).append((place[1], bool(behind == 0)))
        return {segment: sorted(found) for segment, found in changes.items()}, places

    def _place(self, kind, value):
        # Self-excited cycles begin at their Hopf point, which the branch may pass again.
        if kind == "hopf" and self.study.kind == "cycle_branch":
            return (0, 0.0) if self.born else None
        return self.curve.place(kind, value)

    @property
    def kinds(self):
        return [kind for kind, _, _ in self.events]

    @property
    def ends(self):
        """Why the branch ends, in a list; empty if it was followed to the end of its range."""
        status = self.study.attribute("end", "") or self.study.status
        if status in RANGE_ENDS or self.closed:
            return []
        reason = re.sub(r"^ended at [^:]*: ", "", status)
        return [reason if len(reason) < 70 else reason[:67] + "..."]

    def column(self, name):
        """A column of the table `branch` as [point][bearing], with the cycles at its ends if both are known that there are."""
        values = self.study.get(f"branch/{name}").reshape(self.points, -1)
        ends = [end for end, there in (("birth", self.born), ("closing", self.closed)) if there]
        if not all(self.study.has(f"{end}/{name}") for end in ends):
            return values
        outer = {end: self.study.get(f"{end}/{name}").reshape(1, -1) for end in ends}
        none = values[:0]
        return np.concatenate([outer.get("birth", none), values, outer.get("closing", none)])

    def curve_of(self, values):
        """The branch with or without the cycles at its ends, as the values are."""
        return self.curve if len(values) == len(self.parameter) else self.bare

    def along(self, values):
        """Parameter and stability of each of the values."""
        whole = len(values) == len(self.parameter)
        return (self.parameter, self.stable) if whole else (self.bare_parameter, self.bare_stable)

    def places_on(self, curve):
        """(kind, value, place) of the bifurcations on that one."""
        if curve is self.curve:
            return self.events
        first, last = int(self.born), self.points - 2 + int(self.born)
        return [(k, v, (p[0] - first, p[1]) if p and first <= p[0] <= last else None) for k, v, p in self.events]

    def draw(self, axis, values, colour, scale=1.0, linewidth=1.6, across=1.0):
        """One curve over the parameter (times `across`), solid where stable."""
        values = np.asarray(values, float) * scale
        curve = self.curve_of(values)
        changes = self.changes if curve is self.curve else {i - int(self.born): c for i, c in self.changes.items()}
        for x, y, solid in curve.stretches(values, self.along(values)[1], [p for _, _, p in self.places_on(curve)], changes):
            axis.plot(x * across, y, color=colour, linestyle="-" if solid else DASHED, linewidth=linewidth if solid else 0.8 * linewidth)
        straight = curve.straight(values)
        if len(values) == 1 or straight.any():  # what was computed, where no curve goes through it
            at = np.append(straight, False) | np.insert(straight, 0, False) if len(values) > 1 else [True]
            axis.plot(curve.parameter[at] * across, values[at], ".", color=colour, markersize=3.5 if len(values) > 1 else 6)

    def mark(self, axis, curves, scale=1.0, size=6, across=1.0):
        """Bifurcations and the early end of the branch, on each of the curves."""
        for values in curves:
            curve = self.curve_of(values)
            for kind, value, place in self.places_on(curve):
                if place is not None:
                    mark(axis, kind, value * across, curve.at(values, place) * scale, size)
            if self.ends:
                mark_end(axis, curve.parameter[-1] * across, values[-1] * scale, size)


def without_twins(branches):
    """The branches without those that are one before run backwards: each of two flips gives birth to the branch that joins them.
    Drawn on each other their dashes would look like a line."""
    kept, seen = [], set()
    for branch in branches:
        ends = (round(branch.parameter[0], 6), round(branch.parameter[-1], 6)) if branch.born and branch.closed else None
        if ends is None or ends[::-1] not in seen:
            kept.append(branch)
            seen.add(ends)
    return kept


def legend(branches, more=()):
    kinds = list(dict.fromkeys(b.solid for b in branches if b.stable.any()))
    dashes = {b.dashed for b in branches if not b.stable.all()}
    return branch_legend([k for b in branches for k in b.kinds], more, [e for b in branches for e in b.ends],
                         kinds[0] if len(kinds) == 1 else "stable or undamped" if kinds else "stable",
                         dashes.pop() if len(dashes) == 1 else UNSTABLE_OR_UNKNOWN if dashes else "unstable")


def distinct(*tables):
    """Columns (bearings) of tables that do not move exactly like one before: two bearings at one node of a rigid rotor do."""
    def alike(b, c):
        return all(np.allclose(t[:, b], t[:, c], rtol=1e-9, atol=1e-9 * np.abs(t).max()) for t in tables)
    return [b for b in range(tables[0].shape[1]) if not any(alike(b, c) for c in range(b))]


def finish(axis, title, ylabel, xlabel, margin=0.12):
    axis.set_title(title)
    axis.set_ylabel(ylabel)
    axis.set_xlabel(xlabel)
    axis.margins(y=margin)


def over_speed(axis, study):
    """Marks the service speed on an axis of the speed."""
    if study.attribute("parameter", "") == "speed":
        mark_service(axis, study, study.attribute("parameter_unit", ""))


def has_liner(study, b):
    """Whether a bearing has an elastic liner, which gives way: journals go beyond the wall of the deck."""
    known, names = (study.results.deck or {}).get("bearings") or {}, study.get("bearings/name")
    bearing = known.get(names[b]) if names is not None and b < len(names) else None
    return str(((bearing or {}).get("film") or {}).get("type", "")).startswith("compliant")


def mark_walls(axis, study, b, scale, direction="y", of=""):
    """Lines where the wall of the bore stands above and below the middle (y) or beside it (x), if a branch comes near; `of`: of which
    curve where both directions share the axis."""
    if not study.has("bearings/clearance") or study.has("places/name"):
        return
    angles = np.array([0.5, -0.5]) * np.pi if direction == "y" else np.array([0.0, 1.0]) * np.pi
    (low, high), pads = axis.get_ylim(), pads_of(study, b)
    for wall, sign in zip(reach(pads, angles) if pads else (), (1, -1)):
        at = sign * wall * scale
        if np.isfinite(at) and low - 0.15 * (high - low) <= at <= high + 0.15 * (high - low):
            below, above = axis.get_ylim()
            axis.set_ylim(min(below, at - 0.02 * (high - low)), max(above, at + 0.02 * (high - low)))
            axis.axhline(at, color=GREY, linewidth=0.9, zorder=0.6)
            axis.annotate(("undeformed wall" if has_liner(study, b) else "wall") + of, (1, at), xycoords=axis.get_yaxis_transform(), xytext=(-2, 1), textcoords="offset points", ha="right", va="bottom", fontsize=6.5,
                          color=GREY)


def damped(study):
    """Real part of the least stable eigenvalue at each point, zero where it is rounding."""
    growth, undamped, unstable = (study.get(f"branch/{k}") for k in ("leading_real", "undamped_count", "unstable_count"))
    return growth if growth is None or undamped is None or unstable is None else np.where((undamped > 0) & (unstable == 0), 0.0, growth)


def draw_growth(axis, branch, growth):
    """The real part of the least stable eigenvalue, through zero where that one crosses. Other marks are of eigenvalues behind it,
    which cross at zero as well."""
    crossings = [(kind, value, place) for kind, value, place in branch.events if place is not None and kind in ("hopf", "fold")]
    leading = {}
    if branch.points > 1:
        leading = {place[0]: place for _, _, place in crossings if branch.stable[place[0]] != branch.stable[place[0] + 1]}
    places = [leading[i] for i in sorted(leading)]
    curve, values, new = branch.bare.with_points(growth, places, [0.0] * len(places))
    for x, y, solid in curve.stretches(values, np.insert(branch.stable, [i + 1 for i in sorted(leading)], True) if new else branch.stable, []):
        axis.plot(x, y, color=INK, linestyle="-" if solid else DASHED, linewidth=1.6 if solid else 1.3)
    if branch.points == 1:
        axis.plot(curve.parameter, values, ".", color=INK)
    for kind, value, _ in crossings:
        mark(axis, kind, value, 0.0)
    if branch.ends:
        mark_end(axis, curve.parameter[-1], values[-1])


def draw_equilibria(study):
    if not study.has("branch/parameter", "branch/y"):
        return []
    branch = Followed(study)
    x, y = branch.column("x"), branch.column("y")
    names, growth, shown = study.bearings(x.shape[1]), damped(study), distinct(x, y)
    if growth is not None and not np.any(x) and not np.any(y):
        shown = []  # nothing but the origin, without gravity and films
    figure, axes, _ = grid_of(len(shown) + (growth is not None))
    for axis, b in zip(axes, shown):
        scale, unit = study.measure(np.concatenate([x[:, b], y[:, b]]))
        branch.draw(axis, y[:, b], Y, scale)
        branch.draw(axis, x[:, b], X, scale)
        branch.mark(axis, [y[:, b], x[:, b]], scale)
        finish(axis, names[b], f"position [{unit}]", parameter_label(study))
        least_span(axis, scale * max(np.abs(x[:, b]).max(), np.abs(y[:, b]).max()))
        mark_walls(axis, study, b, scale, of=" for y")
        over_speed(axis, study)
    if growth is not None:
        axis = axes[-1]
        axis.axhline(0, color=BAD, linewidth=0.9)
        draw_growth(axis, branch, growth)
        finish(axis, "least stable eigenvalue", "real part [1/s]", parameter_label(study))
        least_span(axis, np.abs(growth).max())
        over_speed(axis, study)
    directions = [Line2D([], [], color=c, label=w if study.in_space else w[0]) for c, w in ((Y, "y, vertical"), (X, "x, horizontal"))] if shown else []
    behind = growth is not None and sum(kind in ("hopf", "fold") for kind in branch.kinds) > 1
    return save(figure, study, "equilibria", (study.shown if shown else "the journals stay at their centres") + ("; marks at zero: an eigenvalue crosses, perhaps not the least stable one" if behind else ""),
                legend([branch], directions))


def draw_extremes(axis, branch, direction, b, scale, colour, size=6, linewidth=1.6):
    high, low = (branch.column(f"{direction}_{k}")[:, b] for k in ("max", "min"))
    branch.draw(axis, high, colour, scale, linewidth)
    branch.draw(axis, low, colour, scale, linewidth)
    branch.mark(axis, [high, low], scale, size)


def draw_cycles(study):
    if not study.has("branch/parameter", "branch/y_max"):
        return []
    branch = Followed(study)
    tables = [branch.column(f"{d}_{k}") for d in "xy" for k in ("max", "min") if study.has(f"branch/{d}_{k}")]
    shown, names = distinct(*tables), study.bearings(tables[0].shape[1])
    files = []
    for direction, words in (("y", "vertical"), ("x", "horizontal")):
        if not study.has(f"branch/{direction}_max"):
            continue
        figure, axes, _ = grid_of(len(shown))
        scale, unit = study.measure(np.concatenate([branch.column(f"{direction}_max"), branch.column(f"{direction}_min")]))
        for axis, b in zip(axes, shown):
            draw_extremes(axis, branch, direction, b, scale, study.colour)
            finish(axis, names[b], f"{direction}, max and min [{unit}]", parameter_label(study))
            mark_walls(axis, study, b, scale, direction)
            over_speed(axis, study)
        meant = f"{direction} ({words})" if study.in_space else direction
        note = f"largest and smallest {meant} over one cycle: {study.shown}"
        unbalance = study.attribute("unbalance")
        files += save(figure, study, f"cycles-{words}", f"{note}; unbalance {unbalance}" if unbalance else note, legend([branch]))
    return files + draw_nodes(study, branch)


def draw_nodes(study, branch):
    """Amplitudes of the shaft at the nodes that the deck asked for, 0-peak."""
    if not study.has("nodes/amplitude", "nodes/node"):
        return []
    nodes = np.atleast_1d(study.get("nodes/node"))
    tables = {k: study.get(f"nodes/{k}").reshape(branch.points, -1) for k in ("amplitude", "x", "y")}
    scale, unit = study.measure(tables["amplitude"])
    figure, axes, _ = grid_of(len(nodes))
    for k, (axis, node) in enumerate(zip(axes, nodes)):
        for name, colour in (("amplitude", INK), ("x", X), ("y", Y)):
            branch.draw(axis, tables[name][:, k], colour, scale)
        branch.mark(axis, [tables["amplitude"][:, k]], scale)
        finish(axis, f"node {node}, shaft", f"amplitude, 0-peak [{unit}]", parameter_label(study))
        axis.set_ylim(bottom=0)
        over_speed(axis, study)
    handles = [Line2D([], [], color=c, label=w) for c, w in ((INK, "largest distance from the mean"), (Y, "y, vertical"), (X, "x, horizontal"))]
    return save(figure, study, "nodes", "x, y: half of the travel of the shaft in space", legend([branch], handles))


def draw_frequency(study):
    """Of self-excited cycles over the running speed: how far from half the speed the whirl is."""
    if not study.has("branch/parameter", "branch/period") or study.attribute("unbalance", "") or study.attribute("parameter") != "speed":
        return []
    to_si = {"rpm": np.pi / 30, "Hz": 2 * np.pi, "rad/s": 1}.get(study.attribute("parameter_unit"))
    if to_si is None:
        return []
    branch = Followed(study)
    period = branch.column("period")[:, 0]
    ratio = 2 * np.pi / (period * branch.along(period)[0] * to_si)
    figure, (axis,), _ = grid_of(1, width=4.6, height=3.2)
    branch.draw(axis, ratio, study.colour)
    branch.mark(axis, [ratio])
    finish(axis, "whirl frequency", "whirl frequency / running speed", parameter_label(study), 0.22)
    low, high = axis.get_ylim()
    near = low - (high - low) <= 0.5 <= high + (high - low)
    if near:  # farther away it would flatten the curve
        axis.axhline(0.5, color=INK, linewidth=0.8, linestyle=":")
    return save(figure, study, "frequency", "self-excited cycles" + ("; dotted: half the running speed" if near else ""), legend([branch]))


def draw_together(results):
    """All branches of a run over the same parameter in one picture: the vertical motion of each journal."""
    studies = [s for s in results.studies
               if (s.kind == "cycle_branch" and s.has("branch/parameter", "branch/y_max"))
               or (s.kind == "equilibrium_branch" and s.has("branch/parameter", "branch/y"))]
    label = parameter_label(studies[0]) if studies else ""
    studies = [s for s in studies if parameter_label(s) == label]
    if len(studies) < 2 or all(s.kind == "equilibrium_branch" for s in studies):
        return []  # one branch by itself has this picture already
    branches = without_twins([Followed(s) for s in studies])
    tables = [b.column("y_max" if b.study.kind == "cycle_branch" else "y") for b in branches]
    count = min(t.shape[1] for t in tables)
    names, shown = studies[0].bearings(count), distinct(*(t[:, :count] for t in tables))
    scale, unit = studies[0].measure(np.concatenate([t[:, :count].ravel() for t in tables]))
    figure, axes, _ = grid_of(len(shown))
    handles = []
    for branch, table in zip(branches, tables):
        equilibria = branch.study.kind == "equilibrium_branch"
        colour = branch.study.colour
        handles.append(Line2D([], [], color=colour, label=branch.study.name))
        for axis, b in zip(axes, shown):
            if equilibria:
                branch.draw(axis, table[:, b], colour, scale, 1.3)
                branch.mark(axis, [table[:, b]], scale, 5)
            else:
                draw_extremes(axis, branch, "y", b, scale, colour, 5)
    for axis, b in zip(axes, shown):
        finish(axis, names[b], f"y, max and min [{unit}]", label)
        mark_walls(axis, studies[0], b, scale)
        over_speed(axis, studies[0])
    return save(figure, results.whole("all branches"), "bifurcations",
                ("y (vertical): " if studies[0].in_space else "y: ") + studies[0].shown, legend(branches, handles))
