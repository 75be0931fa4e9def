"""The machine as a drawing: profile of the shaft, added masses, bearings, couplings, planes of unbalance."""
import numpy as np
from matplotlib.patches import Polygon, Rectangle

from .canvas import Line2D, plt
from .style import BAD, COLOURS, GREY, INK, save, span_of
from .units import number, quantity

STEEL, ADDED = "#d5dbe2", "#aab4bf"


def planes_of(deck):
    """(node, names of the unbalances with a plane there)."""
    found = {}
    for name, unbalance in (deck.get("unbalance") or {}).items():
        for plane in unbalance.get("planes", []):
            found.setdefault(plane.get("node"), []).append(name)
    return {n: list(dict.fromkeys(names)) for n, names in found.items() if isinstance(n, int)}


def discs_of(deck, shaft):
    """(node, radius, thickness, whether the deck gives its size, offset of its centre) of each disc; one given by its mass alone is drawn as high as the
    cube root of it goes, up to three radii of the shaft."""
    found = deck.get("rotor", {}).get("discs") or []
    heaviest = max((number(d.get("mass")) or 0.0 for d in found), default=0.0)
    out = []
    for d in found:
        radius = (number(d.get("outer_diameter")) or 0.0) / 2
        mass = number(d.get("mass")) or 0.0
        if isinstance(d.get("node"), int):
            out.append((d["node"], radius or shaft * (1 + 2 * (mass / heaviest)**(1 / 3) if heaviest else 2), number(d.get("thickness")) or 0.0, radius > 0,
                        number(d.get("offset")) or 0.0))
    return out


def draw_bearings(axis, deck, place, low, high):
    """A triangle below and a pad on both sides of each journal, as long as the bearing; names above."""
    for name, bearing in (deck.get("bearings") or {}).items():
        at = place(bearing.get("node"))
        if at is None:
            continue
        geometry = bearing.get("geometry") or {}
        length, radius = number(geometry.get("length")) or 0, number(geometry.get("radius")) or 0
        if length and radius:
            for side in (1, -1):
                axis.add_artist(Rectangle((at - length / 2, side * radius if side > 0 else -radius - 0.12 * high), length, 0.12 * high,
                                         facecolor=COLOURS[1], edgecolor="none", zorder=4))
        axis.plot(at, low, marker="^", color=COLOURS[1], markersize=9, zorder=4)
        axis.plot([at, at], [low, -radius], color=COLOURS[1], linewidth=0.8, zorder=1)
        axis.annotate(name, (at, low), xytext=(0, -8), textcoords="offset points", ha="center", va="top", fontsize=8.5, color=INK)


MARKERS = {"seal": "D", "coupling": "o", "support": "^", "other": "s"}


def draw_elements(axis, deck, place, low, high):
    """A mark below the node of each element, by its role, with the name; a broken line to the other node where it has one."""
    beside = {}
    for name, element in (deck.get("elements") or {}).items():
        at, other = place(element.get("node")), place(element.get("to_node"))
        if at is None:
            continue
        row = beside[at] = beside.get(at, -1) + 1
        level = low * (0.72 - 0.1 * row)
        if other is not None:
            axis.plot([at, other], [level, level], color=COLOURS[2], linewidth=0.8, linestyle="--", zorder=4)
        axis.plot([at, at], [level, -0.2 * high], color=COLOURS[2], linewidth=0.6, zorder=1)
        axis.plot(at, level, marker=MARKERS.get(element.get("role"), "s"), color=COLOURS[2], markersize=5, linestyle="none", zorder=4)
        axis.annotate(name, (at, level), xytext=(4, -2), textcoords="offset points", ha="left", va="top", fontsize=7, color=INK)


def draw_loads(axis, deck, place, high):
    """An arrow along y on the node of each static load, with its size; what acts along x, out of the drawing, is a circle with a number."""
    for load in deck.get("loads") or []:
        at = place(load.get("node"))
        force = [number(f) or 0.0 for f in load.get("force") or [0, 0]]
        if at is None or not any(force[:2]):
            continue
        if force[0]:
            axis.plot(at, 0, marker="o", markersize=6, markerfacecolor="white", markeredgecolor=INK, zorder=8)
            axis.plot(at, 0, marker="." if force[0] > 0 else "x", markersize=4, color=INK, zorder=9)
            axis.annotate(f"{force[0]:.4g} N along x", (at, 0), xytext=(6, 4), textcoords="offset points", fontsize=7.5, color=INK, zorder=9)
        if not force[1]:
            continue
        size, down = abs(force[1]), force[1] < 0
        ends = (0.95 * high, 0.05 * high) if down else (-0.95 * high, -0.05 * high)
        axis.annotate("", (at, ends[1]), (at, ends[0]), arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.4}, zorder=8)
        axis.annotate(f"{size:.4g} N", (at, ends[0]), ha="center", va="bottom" if down else "top", fontsize=7.5, color=INK)


def right_radius(segment, key, left):
    """Radius at the right end of a segment that may be tapered."""
    given = number(segment.get(key))
    return left if given is None else given / 2


def outline(axis, a, b, left, right, **how):
    """A segment from z = a to b with these radii at its ends."""
    axis.add_artist(Polygon([(a, -left), (b, -right), (b, right), (a, left)], closed=True, **how))


def draw_coupling(axis, a, b, radius):
    """Two halves with a gap between them, joined by a spring."""
    gap = (b - a) / 6
    for left, right in ((a, (a + b) / 2 - gap), ((a + b) / 2 + gap, b)):
        axis.add_artist(Rectangle((left, -radius), right - left, 2 * radius, facecolor=STEEL, edgecolor=GREY, linewidth=0.6, zorder=2))
    z = np.linspace((a + b) / 2 - gap, (a + b) / 2 + gap, 9)
    for side in (-0.6, 0.6):
        axis.plot(z, side * radius + 0.2 * radius * np.array([0, 0, 1, -1, 1, -1, 1, 0, 0]), color=COLOURS[0], linewidth=0.8, zorder=3)


def draw_shaft(results, deck, segments):
    lengths = [number(s.get("length")) or 0.0 for s in segments]
    z = np.concatenate([[0.0], np.cumsum(lengths)])
    outer = [max(number(s.get("outer_mass_diameter")) or 0.0, number(s.get("outer_stiffness_diameter")) or 0.0) / 2 for s in segments]
    added = [(number(s.get("added_mass_outer_diameter")) or 0.0) / 2 if (number(s.get("added_mass")) or 0) > 0 else 0.0 for s in segments]
    discs = discs_of(deck, max(*outer, *added))
    right = [right_radius(s, "right_outer_diameter", r) for s, r in zip(segments, outer)]
    coupled = {c.get("segment") for c in deck.get("rotor", {}).get("couplings") or []}
    high = max([*outer, *right, *added, *(radius for _, radius, *_ in discs), 1e-9])
    # Radii are drawn larger than lengths where the shaft is slender.
    width = 10.4 / (1.04 * z[-1])  # inches per metre of length
    stretch = min(4.0, max(1.0, 2.0 / (3.85 * high * width)))
    figure, axis = plt.subplots(figsize=(11.2, min(6.0, 3.85 * high * width * stretch) + 1.7))
    for k, (a, b, r, end, m, s) in enumerate(zip(z, z[1:], outer, right, added, segments), 1):
        inner = (number(s.get("inner_mass_diameter")) or 0.0) / 2
        bore = right_radius(s, "right_inner_diameter", inner)
        if k in coupled:
            draw_coupling(axis, a, b, r)
            continue
        if m > r:
            axis.add_artist(Rectangle((a, -m), b - a, 2 * m, facecolor=ADDED, edgecolor="none", zorder=1))
        outline(axis, a, b, r, end, facecolor=STEEL, edgecolor=GREY, linewidth=0.3, zorder=2)
        if inner or bore:
            outline(axis, a, b, inner, bore, facecolor="white", edgecolor=GREY, linewidth=0.3, zorder=3)
    for node, radius, thickness, _, offset in discs:
        if 1 <= node <= len(z):
            at, thickness = z[node - 1] + offset, thickness or 0.012 * z[-1]
            axis.add_artist(Rectangle((at - thickness / 2, -radius), thickness, 2 * radius, facecolor=ADDED, edgecolor=GREY, linewidth=0.4, zorder=2.5))
    axis.plot([z[0], z[-1]], [0, 0], color=INK, linewidth=0.6, linestyle=(0, (9, 2, 2, 2)), zorder=5)
    place = lambda node: z[node - 1] if isinstance(node, int) and 1 <= node <= len(z) else None  # noqa: E731
    draw_bearings(axis, deck, place, -1.45 * high, high)
    draw_elements(axis, deck, place, -1.45 * high, high)
    draw_loads(axis, deck, place, high)
    rotors = [str(s.get("rotor", "")) for s in segments]
    edges = [0, *[k for k in range(1, len(rotors)) if rotors[k] != rotors[k - 1]], len(rotors)]
    for a, b in zip(edges, edges[1:]):
        if rotors[a]:
            axis.annotate(rotors[a], (0.5 * (z[a] + z[b]), 1.58 * high), ha="center", va="bottom", fontsize=9, fontweight="bold", color=INK)
        if a:
            axis.plot([z[a], z[a]], [-1.2 * high, 1.5 * high], color=GREY, linewidth=0.8, linestyle=":", zorder=6)
    planes = planes_of(deck)
    for node in planes:
        at = place(node)
        if at is not None:
            axis.annotate("", (at, 1.02 * high), (at, 1.38 * high), arrowprops={"arrowstyle": "-|>", "color": BAD, "linewidth": 1.0}, zorder=7)
            axis.annotate(f"{node}", (at, 1.38 * high), ha="center", va="bottom", fontsize=7, color=BAD)
    axis.set_xlim(*span_of(z[0] - 0.02 * z[-1], 1.02 * z[-1]))
    axis.set_ylim(-2.0 * high, 1.85 * high)
    axis.set_aspect(stretch)
    axis.set_xlabel("z [m]")
    axis.set_ylabel("radius [m]")
    axis.grid(False)
    handles = [Line2D([], [], color=STEEL, linewidth=7, label="shaft"), Line2D([], [], color=COLOURS[1], marker="^", linestyle="none", label="bearing")]
    roles = list(dict.fromkeys(e.get("role", "other") for e in (deck.get("elements") or {}).values()))
    handles += [Line2D([], [], color=COLOURS[2], marker=MARKERS.get(r, "s"), markersize=5, linestyle="none", label=f"element: {r}") for r in roles]
    if deck.get("loads"):
        handles.append(Line2D([], [], color=INK, marker=r"$\downarrow$", linestyle="none", label="static load"))
    if any(m > r for m, r in zip(added, outer)) or discs:
        handles.insert(1, Line2D([], [], color=ADDED, linewidth=7, label="disc" if discs else "added mass"))
    if len(edges) > 2:
        handles.append(Line2D([], [], color=GREY, linestyle=":", label="coupling"))
    if planes:
        handles.append(Line2D([], [], color=BAD, marker="v", linestyle="none", label="plane of unbalance, with its node"))
    note = f"{len(segments)} element{'s' * (len(segments) > 1)}, nodes 1 to {len(z)} from left to right"
    if any(not known for *_, known, _ in discs):
        note += "; discs given by mass are drawn by its size, not to scale"
    if stretch > 1.05:
        note += f"; radii drawn {stretch:.1f} times larger than lengths"
    return save(figure, results.whole("the machine"), "machine", note, handles)


def draw_rigid(results, deck, rotor):
    """A rigid rotor has no profile: its mass between its bearings, which all move alike."""
    bearings = deck.get("bearings") or {}
    figure, axis = plt.subplots(figsize=(7.2, 3.0))
    axis.add_artist(Rectangle((-2, -0.12), 4, 0.24, facecolor=STEEL, edgecolor=GREY, linewidth=0.5))
    axis.add_artist(Rectangle((-0.5, -0.7), 1.0, 1.4, facecolor=STEEL, edgecolor=GREY, linewidth=0.8))
    axis.annotate(f"mass {quantity(rotor.get('mass', ''))}", (0, 0.1), ha="center", va="center", fontsize=9)
    if number(rotor.get("load")):
        axis.annotate("", (0, -1.25), (0, -0.7), arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.2})
        axis.annotate(f"load {quantity(rotor.get('load'))}", (0.1, -1.1), ha="left", va="center", fontsize=9)
    left = len(bearings) // 2  # beside the mass, not below it
    places = [*np.linspace(-1.65, -0.9, left), *np.linspace(1.65, 0.9, len(bearings) - left)[::-1]]
    wide = min(0.5, 0.65 / max(1, len(bearings) - left - 1))
    for at, name in zip(places, bearings):
        for side in (1, -1):
            axis.add_artist(Rectangle((at - wide / 2, 0.16 if side > 0 else -0.3), wide, 0.14, facecolor=COLOURS[1], edgecolor="none"))
        axis.plot(at, -0.55, marker="^", color=COLOURS[1], markersize=10)
        axis.annotate(name, (at, -0.7), ha="center", va="top", fontsize=9)
    axis.plot([-2.2, 2.2], [0, 0], color=INK, linewidth=0.6, linestyle=(0, (9, 2, 2, 2)))
    axis.set_xlim(-2.4, 2.4)
    axis.set_ylim(-1.35, 0.95)
    axis.set_aspect("equal")
    axis.axis("off")
    return save(figure, results.whole("the machine, schematic"), "machine", "a rigid rotor that does not tilt: not to scale")


def draw(results):
    deck = results.deck
    rotor = deck.get("rotor") if isinstance(deck, dict) else None
    if not isinstance(rotor, dict):
        return []
    segments = rotor.get("segments")
    if isinstance(segments, list) and segments:
        return draw_shaft(results, deck, segments)
    return draw_rigid(results, deck, rotor) if rotor.get("type") == "rigid" else []
