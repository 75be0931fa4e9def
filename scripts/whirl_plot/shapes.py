"""Sag line of the shaft and mode shapes along it, flat and in space."""
import typing

import numpy as np

from .campbell import LINES, OVERDAMPED, with_either
from .canvas import Line2D, plt
from .curves import along_shaft
from .style import BAD, GREY, INK, LIGHT, ROTATION, X, Y, grid_of, least_span, length_unit, save, span_of, speed_axis, ticks_at


def bearing_places(study, z):
    """Axial positions and names of the bearings, as far as the study tells."""
    if study.has("bearings/z"):
        places = np.atleast_1d(study.get("bearings/z"))
    elif study.has("bearings/node"):
        node = np.atleast_1d(study.get("bearings/node")).astype(int) - 1
        if node.min() < 0 or node.max() >= len(z):
            return []
        places = z[node]
    else:
        known = (study.results.deck or {}).get("bearings") or {}
        nodes = [b.get("node") if isinstance(b, dict) else None for b in known.values()]
        return [(z[n - 1], name) for n, name in zip(nodes, known) if isinstance(n, int) and 1 <= n <= len(z)]
    return list(zip(places, study.bearings(len(places))))


def coupling_places(study, z):
    """Axial positions of the faces between rotors, from the deck's segments."""
    segments = (study.results.deck or {}).get("rotor", {}).get("segments") or []
    rotors = [str(s.get("rotor", "")) for s in segments] if isinstance(segments, list) else []
    if len(rotors) != len(z) - 1:
        return []
    return [(z[k], f"{a}\u2013{b}") for k, (a, b) in enumerate(zip(rotors, rotors[1:]), 1) if a != b]


def mark_bearings(axis, places, names=True):
    for z, name in places:
        axis.axvline(z, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=1)
        axis.plot(z, 0.0, marker="^", color=GREY, markersize=6, transform=axis.get_xaxis_transform(), clip_on=False, zorder=2)
        if names:
            axis.annotate(name, (z, 1.0), xycoords=axis.get_xaxis_transform(), ha="center", va="bottom", fontsize=7.5, color=GREY)


def mark_couplings(axis, places, names=True):
    for z, name in places:
        axis.axvline(z, color=GREY, linewidth=0.6, linestyle=":", zorder=1)
        axis.plot(z, 0.0, marker="d", color=GREY, markersize=5, markerfacecolor="white", transform=axis.get_xaxis_transform(),
                  clip_on=False, zorder=2)
        if names:
            axis.annotate(name, (z, 1.0), xycoords=axis.get_xaxis_transform(), xytext=(0, 9), textcoords="offset points", ha="center",
                          va="bottom", fontsize=7, color=GREY)


def is_straight(z, values):
    """Whether a line along the shaft is straight but for rounding."""
    if len(z) < 3 or not np.ptp(z):
        return True
    return np.abs(values - np.polyval(np.polyfit(z, values, 1), z)).max() <= max(1e-9 * np.abs(values).max(), 1e-13)


def draw_sag(study):
    if not study.has("nodes/z", "nodes/y"):
        return []
    z, x, y = study.get("nodes/z"), study.get("nodes/x", None), study.get("nodes/y")
    if is_straight(z, y) and (x is None or is_straight(z, x)) and study.get("nodes/moment") is None:
        return []  # a rigid rotor does not sag
    bearings, couplings = bearing_places(study, z), coupling_places(study, z)
    rows = [("y, vertical", y, along_shaft(z, y, study.get("nodes/slope_y")), Y)]
    if x is not None:
        rows.append(("x, horizontal", x, along_shaft(z, x, study.get("nodes/slope_x")), X))
    moment = study.get("nodes/moment")
    if moment is not None:
        rows.append(("bending moment [kN m]", moment / 1e3, (z, moment / 1e3), INK))
    reach = max(np.abs(values).max() for values in (y, x) if values is not None)
    figure, axes = plt.subplots(len(rows), 1, figsize=(9.6, 2.7 * len(rows) + 1.1), sharex=True, squeeze=False)
    for k, (axis, (words, values, (along, line), colour)) in enumerate(zip(axes[:, 0], rows)):
        scale, unit = length_unit(values) if "[" not in words else (1, "")
        axis.plot(along, line * scale, color=colour, linewidth=2.0)
        for place, _ in bearings:
            axis.plot(place, np.interp(place, along, line) * scale, "o", color=colour, markersize=5, markeredgecolor="white", zorder=4)
        mark_bearings(axis, bearings, k == 0)
        mark_couplings(axis, couplings, k == 0)
        axis.set_ylabel(f"{words} [{unit}]" if unit else words)
        axis.margins(x=0.01, y=0.1)
        if "[" not in words:
            least_span(axis, reach * scale)
    axes[-1, 0].set_xlabel("position along the shaft z [m]")
    what = study.group["nodes/y"].attrs.get("description", "") if "nodes/y" in study.group else ""
    rigid = "rigid supports" in str(what)
    note = "centre line of the aligned shaft on rigid supports" if rigid else "centre line of the shaft in space, elevations included"
    note += "; triangles: bearings" + ("; diamonds: couplings" if couplings else "") + ("; moment positive where it sags" if moment is not None else "")
    return save(figure, study, "sag", f"{note}; {ROTATION}" if x is not None else note)


def semi_major(x, y):
    """Largest distance from the centre on the ellipse Re((x, y) e^{i t})."""
    return np.sqrt(0.5 * (np.abs(x)**2 + np.abs(y)**2 + np.abs(x**2 + y**2)))


def describe(shape):
    """Whirl and damping of a mode in words."""
    words = f", {shape.whirl}" if shape.whirl else ""
    return words + (f"\nlog. decrement {shape.decrement:.3g}" if np.isfinite(shape.decrement) else "\ndiverges" if shape.decrement == -np.inf else "")


def nodes_of(z, values):
    """Places where a line along the shaft crosses zero."""
    k = np.nonzero(values[:-1] * values[1:] < 0)[0]
    return z[k] + (z[k + 1] - z[k]) * values[k] / (values[k] - values[k + 1])


def normalised(x, y):
    """A shape turned to the moment when the node that moves most is farthest out, where it is one, and its envelope."""
    size = semi_major(x, y)
    top = int(np.argmax(size))
    turn = np.exp(-0.5j * np.angle(x[top]**2 + y[top]**2)) / size[top]
    x, y = x * turn, y * turn
    side = 1 if abs(y[top].real) < abs(x[top].real) else np.sign(y[top].real) or 1
    return side * x, side * y, size / size[top]


class Shape(typing.NamedTuple):
    """A mode at one speed: number, frequency [rad/s], x and y along the shaft (complex), and what is known of it."""

    mode: int
    frequency: float
    x: np.ndarray
    y: np.ndarray
    decrement: float
    whirl: str


def tables_of(study):
    """(speed, z, shapes) of each speed that shapes were kept at, as smooth as a beam bends."""
    if not study.has("shapes/x_real", "shapes/z"):
        return
    nodes = study.get("shapes/z")

    def line(direction):
        both = [[study.get(f"shapes/{head}{direction}_{part}") for part in ("real", "imag")] for head in ("", "slope_")]
        values, slope = (None if real is None else real + 1j * imag for real, imag in both)
        return [along_shaft(nodes, row, None if slope is None else slope[k]) for k, row in enumerate(values)]

    lines = {direction: line(direction) for direction in "xy"}
    x, y = ([values for _, values in lines[direction]] for direction in "xy")
    z = lines["x"][0][0]
    column = lambda name, default: np.broadcast_to(np.atleast_1d(study.get(f"shapes/{name}", default)), len(x))  # noqa: E731
    speed = column("speed", 0.0)
    shapes = [Shape(*row) for row in zip(column("mode", np.arange(1, len(x) + 1)), column("frequency", 0.0), x, y,
                                         column("log_decrement", np.nan), column("whirl", ""))]
    for value in dict.fromkeys(speed):
        yield value, z, [shape for shape, s in zip(shapes, speed) if s == value]


def draw_modes(study, shown=12):
    if len(np.atleast_1d(study.get("shapes/z", 0.0))) < 2:
        return []  # a rigid rotor has one node, and a point no shape
    files, found = [], list(tables_of(study))
    for speed, z, shapes in found:
        # What dies within a turn is no vibration; unless nothing else is there.
        drawn = [s for s in shapes if not s.decrement > OVERDAMPED] or shapes
        left = [str(s.mode) for s in shapes if s.decrement > OVERDAMPED] if len(drawn) < len(shapes) else []
        hidden = f"; not drawn: mode{'s' * (len(left) > 1)} {', '.join(left)}, log. decrement above {OVERDAMPED:g}" if left else ""
        shapes = drawn
        suffix = f"-{speed * speed_axis(study.attribute('speed_unit', 'rad/s'))[0]:.0f}" if len(found) > 1 else ""
        files += draw_flat(study, speed, z, shapes[:shown], suffix, hidden) + draw_in_space(study, speed, z, shapes[:shown], suffix)
    return files


def at_words(study, speed):
    """Speed in the unit of the deck; frequencies in Hz, as on the screen."""
    unit = study.attribute("speed_unit", "rad/s")
    return f"at speed {speed * speed_axis(unit)[0]:.0f} {unit}", 1 / (2 * np.pi), "Hz"


def draw_flat(study, speed, z, shapes, suffix, hidden=""):
    bearings = bearing_places(study, study.get("shapes/z"))
    at, to_frequency, unit = at_words(study, speed)
    figure, axes, grid = grid_of(len(shapes), height=1.95, sharex=True, sharey=True)
    for axis, shape in zip(axes, shapes):
        x, y, envelope = normalised(shape.x, shape.y)
        axis.fill_between(z, -envelope, envelope, color="#eef2f6", linewidth=0, zorder=0)
        axis.axhline(0, color=GREY, linewidth=0.6)
        for values, colour, label in ((y.real, Y, "y, vertical"), (x.real, X, "x, horizontal")):
            axis.plot(z, values, color=colour, linewidth=1.5, label=label)
        mark_bearings(axis, bearings, names=False)
        axis.set_title(f"{shape.mode}: {shape.frequency * to_frequency:.2f} {unit}{describe(shape)}", fontsize=8.5)
        axis.set_ylim(-1.08, 1.08)
        ticks_at(axis.yaxis, [-1, 0, 1])
        axis.set_xlim(*span_of(z[0], z[-1]))
    for column in range(grid.shape[1]):
        visible = [a for a in grid[:, column] if a.get_visible()]
        visible[-1].set_xlabel("z [m]")
        visible[-1].tick_params(labelbottom=True)
    words = with_either(f"{at}; shaded: largest excursion over a turn, scaled to 1 where it is largest; triangles: bearings{hidden}", [[s.whirl for s in shapes]])
    return save(figure, study, f"shapes{suffix}", words, axes[0].get_legend_handles_labels()[0])


def with_gaps(lines):
    """x, y, z of several lines as of one, not a number between them."""
    return [np.concatenate([np.append(line[k], np.nan) for line in lines])[:-1] for k in range(3)]


def draw_in_space(study, speed, z, shapes, suffix):
    """Ellipses along the shaft, the shaft at one moment, and where that line crosses the undeformed axis."""
    bearings = bearing_places(study, study.get("shapes/z"))
    at, to_frequency, unit = at_words(study, speed)
    columns = min(3, len(shapes))
    rows = -(-len(shapes) // columns)
    figure = plt.figure(figsize=(3.8 * columns, 2.6 * rows + 1.0))
    angle = np.exp(1j * np.linspace(0, 2 * np.pi, 41))
    rings = np.unique(np.linspace(0, len(z) - 1, 17).round().astype(int))
    for k, shape in enumerate(shapes):
        axis = figure.add_subplot(rows, columns, k + 1, projection="3d", computed_zorder=False)
        x, y, _ = normalised(shape.x, shape.y)
        # Forward where the ellipse is run through from x to y. All of a kind are one line with gaps, which is quicker than many.
        forward = (np.conj(x[rings]) * y[rings]).imag <= 0
        for sense, chosen in (("forward", rings[forward]), ("backward", rings[~forward])):
            if len(chosen):
                ellipses = [(np.full(len(angle), z[ring]), (x[ring] * angle).real, (y[ring] * angle).real) for ring in chosen]
                axis.plot(*with_gaps(ellipses), color=GREY, linestyle=LINES[sense], linewidth=0.8, clip_on=False)
        axis.plot(z, np.zeros_like(z), np.zeros_like(z), color=GREY, linewidth=0.7, clip_on=False)
        axis.plot(z, x.real, y.real, color=INK, linewidth=1.6, clip_on=False)
        if bearings:
            axis.plot(*with_gaps([((place, place), (0, 0), (-1, 1)) for place, _ in bearings]), color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), clip_on=False)
        # Node lines: where the shaft crosses the axis in the direction in which it moves most.
        main = y.real if np.ptp(y.real) >= np.ptp(x.real) else x.real
        crossings = nodes_of(z, main)
        axis.plot(crossings, np.zeros_like(crossings), np.zeros_like(crossings), "o", color=BAD, markersize=3.5, clip_on=False)
        for line in axis.get_lines():  # they may leave the box of the axes
            line.set_in_layout(False)
        axis.set_title(f"{shape.mode}: {shape.frequency * to_frequency:.2f} {unit}{describe(shape)}", fontsize=8, y=0.98)
        axis.set_box_aspect((3.0, 1, 1), zoom=1.3)
        axis.view_init(18, -62)
        axis.set(xlim=span_of(z[0], z[-1]), ylim=(-1, 1), zlim=(-1, 1), yticks=[-1, 0, 1], zticks=[-1, 0, 1])
        axis.tick_params(labelsize=6, pad=-3)
        axis.set_xlabel("z [m]", fontsize=7, labelpad=-6)
        axis.set_ylabel("x [-]", fontsize=7, labelpad=-10)
        axis.set_zlabel("y [-]", fontsize=7, labelpad=-10)
        axis.grid(False)
        for pane in (axis.xaxis, axis.yaxis, axis.zaxis):
            pane.pane.set_edgecolor(LIGHT)
            pane.pane.set_facecolor("white")
    handles = [Line2D([], [], color=INK, label="shaft at one moment"),
               Line2D([], [], color=GREY, linestyle=LINES["forward"], linewidth=0.8, label="orbit, forward"),
               Line2D([], [], color=GREY, linestyle=LINES["backward"], linewidth=0.8, label="orbit, backward"),
               Line2D([], [], color=BAD, marker="o", linestyle="none", markersize=4, label="node: crosses the axis"),
               Line2D([], [], color=GREY, linestyle=(0, (2, 2)), linewidth=0.8, label="bearing")]
    words = with_either(f"{at}; x to the back, y up; each scaled to its largest excursion", [[s.whirl for s in shapes]])
    return save(figure, study, f"shapes-3d{suffix}", words, handles)
