"""Journals inside their clearance: orbits of cycles, loci of equilibria, static positions."""
import matplotlib.pyplot as plt
import numpy as np

from .bifurcation import branch_of, events_of
from .style import COLOURS, GREY, INK, ROTATION, branch_legend, mark, parameter_label, place_on_branch, save


def lobes(study, b):
    """Circles that bound the journal centre: (x, y of the centre, radius, middle of the pad, arc of the pad) in m and rad.

    One pad at the bottom has its centre in the middle. Two lobes of radius c/(1-m) are moved inwards by m c/(1-m) along y
    and apart by the offset along x, the lower one to the right."""
    def of(name):
        values = study.get(f"bearings/{name}")
        return 0.0 if values is None else float(np.atleast_1d(values)[b])

    clearance, preload, offset, arc = of("clearance"), of("preload"), of("offset"), of("arc")
    if not clearance > 0:  # a linear film has none
        return []
    if not 0 < preload < 1 and not offset:
        return [(0.0, 0.0, clearance, 1.5 * np.pi, arc)]
    radius = clearance / (1 - preload)
    return [(side * offset / 2, side * preload * radius, radius, np.pi * (1 + side / 2), arc) for side in (1, -1)]


def outline(study, b):
    """Where the journal centre can be (m): inside all lobes, continued beyond the ends of their pads."""
    if study.has("bearings/outline_x", "bearings/outline_y"):
        return study.get("bearings/outline_x")[b], study.get("bearings/outline_y")[b]
    circles = lobes(study, b)
    if not circles:
        return None
    angle = np.linspace(0, 2 * np.pi, 721)
    c, s = np.cos(angle), np.sin(angle)
    reach = np.min([ox * c + oy * s + np.sqrt(r**2 - (ox * s - oy * c)**2) for ox, oy, r, _, _ in circles], axis=0)
    return reach * c, reach * s


def way_out(study, b, x, y):
    """In words, how far from the centre to the outline the journal is; the eccentricity ratio in a circular clearance."""
    edge = outline(study, b)
    if edge is None:
        return ""
    angle = np.arctan2(edge[1], edge[0]) % (2 * np.pi)
    order = np.argsort(angle)
    reach = np.interp(np.arctan2(y, x) % (2 * np.pi), angle[order], np.hypot(*edge)[order], period=2 * np.pi)
    return f"\n{np.hypot(x, y) / reach:.3f} of the clearance"


def draw_clearance(axis, study, b, points=()):
    """Pads as thick arcs, the clearance between them dotted; the panel holds it and `points` (x, y in um)."""
    edge = outline(study, b)
    if edge is None:
        return False
    x, y = edge[0] * 1e6, edge[1] * 1e6
    pads = [lobe for lobe in lobes(study, b) if lobe[4] > 0]
    axis.fill(x, y, color="#f3f6f9", zorder=0)
    axis.plot(x, y, color=GREY if pads else INK, linewidth=0.9 if pads else 1.2, linestyle=":" if pads else "-")
    for ox, oy, radius, middle, arc in pads:
        t = middle + np.linspace(-0.5, 0.5, 181) * arc
        px, py = ox + radius * np.cos(t), oy + radius * np.sin(t)
        # Only the part that the journal can reach; the other lobe is nearer elsewhere.
        reached = np.all([np.hypot(px - cx, py - cy) <= r * (1 + 1e-9) for cx, cy, r, _, _ in pads], axis=0)
        axis.plot(np.where(reached, px, np.nan) * 1e6, np.where(reached, py, np.nan) * 1e6, color=INK, linewidth=1.8)
    axis.plot(0, 0, "+", color=GREY, markersize=7)
    reach = 1.08 * max(np.abs(v).max() for v in (x, y, *points))
    axis.set_xlim(-reach, reach)
    axis.set_ylim(-reach, reach)
    return True


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


def draw(study, shown=9):
    if not study.has("orbits/x", "orbits/y"):
        return []
    scale, unit = study.micro
    x, y, parameter = study.get("orbits/x") * scale, study.get("orbits/y") * scale, np.atleast_1d(study.get("orbits/parameter"))
    order = np.argsort(parameter, kind="stable")
    pick = order[np.unique(np.linspace(0, len(parameter) - 1, shown).round().astype(int))]
    names = study.bearings(x.shape[2])
    known = study.has("bearings/clearance") or study.has("bearings/outline_x")
    rows = 2 if known else 1
    # A panel by itself fills the page instead of standing at one side of it.
    size = (max(7.2, 2.75 * len(names)), 2.55 * rows + 0.9) if rows * len(names) > 1 else (5.6, 4.6)
    figure, axes = plt.subplots(rows, len(names), figsize=size, squeeze=False)
    norm = plt.Normalize(parameter.min(), parameter.max() if np.ptp(parameter) else parameter.min() + 1)
    for b, name in enumerate(names):
        if known:
            draw_clearance(axes[0, b], study, b, (x[pick][:, :, b], y[pick][:, :, b]))
            turn_arrow(axes[0, b])
        for row in range(rows):
            axis = axes[row, b]
            for k in pick:
                closed = np.r_[0:x.shape[1], 0]
                axis.plot(x[k, closed, b], y[k, closed, b], color=plt.cm.viridis(norm(parameter[k])), linewidth=1.0)
                if row == rows - 1:
                    axis.plot(x[k, 0, b], y[k, 0, b], "o", markersize=2.6, color=plt.cm.viridis(norm(parameter[k])))
            finish(axis, name if row == 0 else None, unit)
        square(axes[-1, b], x[pick][:, :, b].ravel(), y[pick][:, :, b].ravel())
    colours = plt.cm.ScalarMappable(norm=norm, cmap="viridis")
    figure.colorbar(colours, ax=axes, shrink=0.7, pad=0.01, label=parameter_label(study)).outline.set_visible(False)
    first = "above in the clearance, pads thick; below enlarged; " if known else ""
    return [save(figure, study, "orbits", f"{first}dot: shaft angle 0; {study.shown}; {ROTATION}" if known else f"{first}dot: phase 0; {study.shown}")]


def draw_locus(study):
    if not study.has("branch/x", "branch/y") or study.has("places/name"):
        return []
    parameter, stable, unstable = branch_of(study)
    x, y = (study.get(f"branch/{k}").reshape(len(parameter), -1) * 1e6 for k in "xy")
    names = study.bearings(x.shape[1])
    figure, axes = plt.subplots(1, len(names), figsize=(max(7.2, 2.75 * len(names)), 3.45), squeeze=False)
    norm = plt.Normalize(parameter.min(), parameter.max() if np.ptp(parameter) else parameter.min() + 1)
    for b, (axis, name) in enumerate(zip(axes[0], names)):
        if not draw_clearance(axis, study, b):
            square(axis, x[:, b], y[:, b])
        turn_arrow(axis)
        axis.plot(x[:, b], y[:, b], color=GREY, linewidth=0.6)
        axis.scatter(x[:, b], y[:, b], c=parameter, cmap="viridis", s=np.where(stable, 13, 5), linewidths=0, zorder=3)
        for kind, value in events_of(study):
            mark(axis, kind, *place_on_branch(parameter, [x[:, b], y[:, b]], unstable, kind, value))
        finish(axis, name)
    colours = plt.cm.ScalarMappable(norm=norm, cmap="viridis")
    figure.colorbar(colours, ax=axes, shrink=0.7, pad=0.01, label=parameter_label(study)).outline.set_visible(False)
    return [save(figure, study, "locus", f"pads thick; equilibrium of the journal relative to the bearing centre; small dots unstable; {ROTATION}",
                 branch_legend([k for k, _ in events_of(study)])[2:])]


def draw_positions(study):
    if not study.has("bearings/x", "bearings/y"):
        return []
    x, y = (np.atleast_1d(study.get(f"bearings/{k}")) for k in "xy")
    names = study.bearings(len(x))
    load = study.get("bearings/load")
    figure, axes = plt.subplots(1, len(names), figsize=(max(7.2, 2.6 * len(names)), 3.55), squeeze=False)
    for b, (axis, name) in enumerate(zip(axes[0], names)):
        if not draw_clearance(axis, study, b):
            square(axis, np.array([0, x[b] * 1e6]), np.array([0, y[b] * 1e6]))
        turn_arrow(axis)
        axis.plot([0, x[b] * 1e6], [0, y[b] * 1e6], color=COLOURS[0], linewidth=1.0)
        axis.plot(x[b] * 1e6, y[b] * 1e6, "o", color=COLOURS[0], markersize=6, markeredgecolor="white")
        lines = f"x {x[b] * 1e6:.1f} \u00b5m, y {y[b] * 1e6:.1f} \u00b5m"
        if study.has("bearings/clearance"):
            lines += way_out(study, b, x[b], y[b])
        finish(axis, name if load is None else f"{name}: {np.atleast_1d(load)[b] / 1e3:.2f} kN")
        axis.set_xlabel(f"x [\u00b5m]\n{lines}", fontsize=8.5)
    return [save(figure, study, "journals", f"pads thick; journal relative to the bearing centre; load of the journal on the bearing, positive down; {ROTATION}")]
