"""Journals inside their clearance: orbits of cycles, loci of equilibria, static positions."""
import numpy as np

from .bifurcation import Followed, legend
from .bore import distance_in_words, draw_clearance, lines_in_words, outline
from .canvas import Line2D, plt
from .curves import periodic
from .style import DASHED, GREY, INK, ROTATION, Y, grid_of, mark, mark_end, parameter_label, save, span_of, ticks_at
from .units import person


def turn_arrow(axis):
    axis.annotate("", xy=(0.885, 0.975), xytext=(0.975, 0.885), xycoords="axes fraction",
                  arrowprops={"arrowstyle": "->", "connectionstyle": "arc3,rad=0.45", "color": GREY, "linewidth": 1.0})


def finish(axis, name=None, unit="\u00b5m"):
    axis.set_aspect("equal", adjustable="box")
    for put, letter in ((axis.set_xlabel, "x"), (axis.set_ylabel, "y")):
        put(letter if unit == "1" else f"{letter} [{unit}]")
    if name:
        axis.set_title(name)


def square(axis, x, y):
    """Limits that hold the points in a square."""
    half = max(0.6 * max(np.ptp(x), np.ptp(y)), 1e-3)
    axis.set_xlim((x.max() + x.min()) / 2 - half, (x.max() + x.min()) / 2 + half)
    axis.set_ylim((y.max() + y.min()) / 2 - half, (y.max() + y.min()) / 2 + half)


def row_of_panels(rows, count):
    """A panel by itself fills the page instead of standing at one side of it."""
    size = (max(7.2, 2.75 * count), 2.55 * rows + 1.25) if rows * count > 1 else (5.8, 5.0)
    return plt.subplots(rows, count, figsize=size, squeeze=False)


def places_in_rows(count):
    """A panel for each of `count` places, at most four in a row: more would be too small to read on a page."""
    if count <= 4:
        figure, axes = row_of_panels(1, count)
        return figure, list(axes[0])
    return grid_of(count, 2.75, 2.9, 4)[:2]


def stability(study, orbits):
    """Of each orbit: stable, unstable, or None if the results do not say."""
    if all(o.stable is not None for o in orbits):
        return [o.stable for o in orbits]
    parameter, stable = study.get("branch/parameter"), study.get("branch/stable")
    if parameter is None or stable is None:
        return [None] * len(orbits)
    # Results without the number of the point: where a parameter occurs once.
    rows = [np.nonzero(parameter == o.parameter)[0] for o in orbits]
    return [bool(stable[r[0]] > 0.5) if len(r) == 1 and np.isfinite(stable[r[0]]) else None for r in rows]


def along_branch(study, orbits):
    """How far along the branch each orbit is; their number if the results do not say."""
    step = study.get("branch/step")
    if step is None or any(o.point is None for o in orbits):
        return np.arange(len(orbits), dtype=float)
    return np.cumsum(np.abs(step))[[o.point for o in orbits]]


def picked(study, shown=9):
    """Some orbits, evenly along the branch and not over the parameter, because beyond a fold the same speeds come again."""
    orbits = study.orbits
    along = along_branch(study, orbits)
    return [orbits[k] for k in np.unique([int(np.argmin(np.abs(along - s))) for s in np.linspace(along[0], along[-1], shown)])]


def shades_of(orbits):
    """A number from 0 to 0.9 for the colour of each orbit, and what it means: the parameter, or the way along a branch that turns, where a
    parameter comes again."""
    values = np.array([o.parameter for o in orbits], float)
    steps = np.diff(values)
    if len(values) > 1 and (np.all(steps > 0) or np.all(steps < 0)):
        return 0.9 * (values - values.min()) / np.ptp(values), True
    return np.linspace(0, 0.9, len(orbits)), False


def draw(study, shown=9):
    if not study.orbits:
        return []
    scale, unit = study.micro
    orbits = picked(study, shown)
    stable, names = stability(study, orbits), orbits[0].places
    smooth = [(periodic(o.x * scale), periodic(o.y * scale)) for o in orbits]
    known = study.has("bearings/clearance") or study.has("bearings/outline_x")
    rows = 2 if known else 1
    figure, axes = row_of_panels(rows, len(names))
    shades, by_parameter = shades_of(orbits)
    colours = plt.cm.viridis(shades)
    for b, name in enumerate(names):
        every = [np.concatenate([s[d][:, b] for s in smooth]) for d in (0, 1)]
        if known:
            draw_clearance(axes[0, b], study, b, every)
            turn_arrow(axes[0, b])
        for row in range(rows):
            axis = axes[row, b]
            for (x, y), colour, steady in zip(smooth, colours, stable):
                axis.plot(x[:, b], y[:, b], color=colour, linewidth=1.1, linestyle=DASHED if steady is False else "-")
                if row == rows - 1:
                    axis.plot(x[0, b], y[0, b], "o", markersize=2.8, color=colour)
            finish(axis, name if row == 0 else None, unit)
        square(axes[-1, b], *every)
    words = parameter_label(study).split(" [")[0]
    given = "" if study.attribute("parameter_unit", "1") == "1" else " " + study.attribute("parameter_unit")
    handles = [Line2D([], [], color=c, linestyle=DASHED if s is False else "-",
                      label=f"{o.parameter:.5g}{given}" + (", unstable" if s is False else "")) for o, c, s in zip(orbits, colours, stable)]
    first = f"above in the clearance; {lines_in_words(study, range(len(names)))}below enlarged; " if known else ""
    moment = "shaft angle 0" if study.attribute("unbalance", "") else "the phase chosen as zero"
    meaning = words if by_parameter else "way along the branch, which turns"
    note = f"{first}colours: {meaning}; dashed: unstable; dot: {moment}; {study.shown}"
    return save(figure, study, "orbits", f"{note}; {ROTATION}" if known and len(names) > 2 else note, handles, 5)


def draw_harmonics(study, highest=20):
    """Of some self-excited cycles: what the multiples of their whirl take part in them, bearing by bearing."""
    period, orbits = study.get("branch/period"), study.orbits
    if not orbits or period is None or study.attribute("unbalance", "") or any(o.point is None for o in orbits):
        return []
    scale, unit = study.micro
    word = "whirl" if study.in_space else "oscillation"
    along = along_branch(study, orbits)
    pick = np.unique([int(np.argmin(np.abs(along - s))) for s in np.linspace(along[0], along[-1], 4)[1:]])
    stable = stability(study, [orbits[k] for k in pick])
    names = orbits[0].places
    figure, axes = plt.subplots(1, len(names), figsize=(max(5.8, 2.6 * len(names)), 3.2), squeeze=False, sharey=True)
    colours, handles, stems = plt.cm.viridis(np.linspace(0.1, 0.85, len(pick))), [], []
    given = "" if study.attribute("parameter_unit", "1") == "1" else " " + study.attribute("parameter_unit")
    top, width = 0.0, 0.6 / len(pick)
    for place, (k, colour, steady) in enumerate(zip(pick, colours, stable)):
        o, hertz = orbits[k], 1 / period[orbits[k].point]
        parts = np.fft.fft((o.x + 1j * o.y) * scale, axis=0) / len(o.x)
        order = np.arange(1, min(highest, (len(o.x) - 1) // 2) + 1)
        half_axis = np.abs(parts[order]) + np.abs(parts[-order])
        top = max(top, half_axis.max())
        stems.append((order + (place - (len(pick) - 1) / 2) * width, half_axis, colour, steady))
        handles.append(Line2D([], [], color=colour, marker="o", markersize=3, linewidth=1.2, linestyle=DASHED if steady is False else "-",
                              label=f"{o.parameter:.5g}{given}, {word} {hertz:.4g} Hz" + (", unstable" if steady is False else "")))
    low = 1e-5 * top
    last = max(int(np.flatnonzero((half_axis > low).any(axis=1)).max(initial=0)) + 1 for _, half_axis, _, _ in stems)
    for at, half_axis, colour, steady in stems:
        for b, axis in enumerate(axes[0]):
            seen = half_axis[:, b] > low
            axis.vlines(at[seen], low, half_axis[seen, b], color=colour, linewidth=1.2, linestyle=DASHED if steady is False else "-")
            axis.plot(at[seen], half_axis[seen, b], "o", color=colour, markersize=3)
    for axis, name in zip(axes[0], names):
        axis.set_yscale("log")
        axis.set_ylim(low, 2 * top)
        axis.set_xlim(0.5, last + 0.5)
        ticks_at(axis.xaxis, np.arange(1, last + 1, -(-last // 8)))
        axis.set_xlabel(f"harmonic of the {word}")
        axis.set_title(name)
    axes[0, 0].set_ylabel(f"larger half-axis [{unit}]")
    return save(figure, study, "harmonics", f"harmonics of the {word} of each cycle, the larger half-axis of the ellipse of each (0-peak); {study.shown}", handles, 3)


def draw_locus(study):
    if not study.has("branch/x", "branch/y") or study.has("places/name"):
        return []
    branch = Followed(study)
    x, y = (branch.column(k) * 1e6 for k in "xy")
    # A path that stays where it is would be one dot.
    clearance = study.get("bearings/clearance", np.zeros(1))
    if max(np.ptp(x, axis=0).max(), np.ptp(y, axis=0).max()) <= 0.02 * max(np.abs(x).max(), np.abs(y).max(), 1e6 * np.max(clearance)):
        return []
    names = study.bearings(x.shape[1])
    figure, axes = places_in_rows(len(names))
    parameter = branch.parameter
    norm = plt.Normalize(*span_of(parameter.min(), parameter.max()))
    for b, (axis, name) in enumerate(zip(axes, names)):
        if not draw_clearance(axis, study, b, (x[:, b], y[:, b])):
            square(axis, x[:, b], y[:, b])
        turn_arrow(axis)
        axis.plot(x[:, b], y[:, b], color=GREY, linewidth=0.6)
        axis.scatter(x[:, b], y[:, b], c=parameter, cmap="viridis", s=np.where(branch.stable, 13, 5), linewidths=0, zorder=3)
        for kind, _, place in branch.events:
            if place is not None:
                mark(axis, kind, branch.curve.at(x[:, b], place), branch.curve.at(y[:, b], place))
        if branch.ends:
            mark_end(axis, x[-1, b], y[-1, b])
        finish(axis, name)
    colours = plt.cm.ScalarMappable(norm=norm, cmap="viridis")
    figure.colorbar(colours, ax=axes, shrink=0.7, pad=0.01, label=parameter_label(study)).outline.set_visible(False)
    return save(figure, study, "locus", f"{lines_in_words(study, range(len(names)))}equilibrium of the journal relative to the bearing centre; small dots unstable; {ROTATION}",
                legend([branch])[2:])


def draw_positions(study):
    if not study.has("bearings/x", "bearings/y"):
        return []
    x, y = (np.atleast_1d(study.get(f"bearings/{k}")) for k in "xy")
    names, load = study.bearings(len(x)), study.get("bearings/load")
    # Without a wall the place of a journal is a number, which the tables have.
    bores = [b for b in range(len(names)) if outline(study, b)]
    if not bores:
        return []
    figure, axes = places_in_rows(len(bores))
    for axis, b in zip(axes, bores):
        name = names[b]
        draw_clearance(axis, study, b, (x[b:b + 1] * 1e6, y[b:b + 1] * 1e6))
        turn_arrow(axis)
        axis.plot([0, x[b] * 1e6], [0, y[b] * 1e6], color=INK, linewidth=1.0)
        axis.plot(x[b] * 1e6, y[b] * 1e6, "o", color=Y, markersize=6, markeredgecolor="white")
        lines = "({:.1f}, {:.1f}) \u00b5m".format(*(round(v[b] * 1e6, 1) + 0.0 for v in (x, y)))  # no minus before zero
        if study.has("bearings/clearance"):
            lines += distance_in_words(study, b, x[b], y[b])
        finish(axis, name if load is None else f"{name}: {person(np.atleast_1d(load)[b], 'N', 4)}")
        axis.set_xlabel(f"x [\u00b5m]\n{lines}", fontsize=8)
    return save(figure, study, "journals", f"{lines_in_words(study, bores)}journal relative to the bearing centre; c: assembled clearance; "
                f"load of the journal on the bearing, positive down; {ROTATION}")
