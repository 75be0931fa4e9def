"""The clearance of a bearing: its pads, where the journal can be, and how far it is from the wall."""
import numpy as np

from .style import GREY, INK, SHADE


def pads_of(study, b):
    """Pads as (x, y of the centre, radius, middle, arc), in m and rad: film thickness at theta inside the pad is
    radius - (x_journal - x) cos(theta) - (y_journal - y) sin(theta).

    One pad has its middle at the bottom. Two lobes of radius c/(1-m) are moved inwards by m c/(1-m) along y and apart by the
    offset along x, the lower one to the right. An arc of zero is a whole bore."""
    def of(name, default=0.0):
        values = study.get(f"bearings/{name}")
        return default if values is None else np.atleast_1d(values)[b]

    clearance, preload, offset, arc = (float(of(k)) for k in ("clearance", "preload", "offset", "arc"))
    if not clearance > 0:  # a linear film has none
        return []
    bore = of("bore", "lemon_bore" if 0 < preload < 1 or offset else "partial_arc")
    if bore != "lemon_bore":
        return [(0.0, 0.0, clearance, 1.5 * np.pi, arc if bore == "partial_arc" and 0 < arc < 2 * np.pi else 2 * np.pi)]
    radius = clearance / (1 - preload)
    return [(side * offset / 2, side * preload * radius, radius, np.pi * (1 + side / 2), arc) for side in (1, -1)]


def reach(pads, angle, count=1441):
    """Distance from the bearing's centre to the wall in the directions `angle`: where the film of the nearest place of any pad
    becomes zero, at `count` places of a pad. Infinite where no pad lies ahead."""
    found = np.full(np.shape(angle), np.inf)
    for ox, oy, radius, middle, arc in pads:
        theta = middle + np.linspace(-0.5, 0.5, count) * arc
        ahead = np.cos(np.asarray(angle)[..., None] - theta)
        gap = radius + ox * np.cos(theta) + oy * np.sin(theta)
        with np.errstate(divide="ignore"):
            found = np.minimum(found, np.min(np.where(ahead > 1e-9, gap / np.maximum(ahead, 1e-9), np.inf), axis=-1))
    return found


def distance_in_words(study, b, x, y):
    """The eccentricity per assembled clearance, and, where the bore is no circle, the way to the wall that it makes."""
    pads = pads_of(study, b)
    if not pads:
        return ""
    e = np.hypot(x, y)
    ratio = e / float(np.atleast_1d(study.get("bearings/clearance"))[b])
    words = f"\n|e|/c = {ratio:.3f}"
    wall = float(reach(pads, np.array([np.arctan2(y, x)]))[0])
    if len(pads) > 1:
        words += f"\n{e / wall:.3f} of the way to the wall"
    return words


def shade(axis, x, y):
    """The inside of a closed curve. Axes that looked for its extent would take as long as all the rest; who calls this sets the limits."""
    from matplotlib.patches import Polygon
    axis.add_artist(Polygon(np.column_stack([x, y]), color=SHADE, linewidth=0, zorder=0))


def outline(study, b):
    """Lines (x, y in m, colour, width, dash 0 solid or 2 dotted) of a bore: first how far the journal can go, closed, then its pads."""
    if study.has("bearings/outline_x", "bearings/outline_y"):
        return [(*(study.get(f"bearings/outline_{k}")[b] for k in "xy"), INK, 1.2, 0)]
    pads = pads_of(study, b)
    if not pads:
        return []
    angle = np.linspace(0, 2 * np.pi, 361)
    # A pad at the bottom leaves the top open: the dotted line goes on as the circle of its radius.
    circle = np.min([ox * np.cos(angle) + oy * np.sin(angle) + np.sqrt(np.maximum(r**2 - (ox * np.sin(angle) - oy * np.cos(angle))**2, 0))
                     for ox, oy, r, _, _ in pads], axis=0)
    wall = reach(pads, angle, 361)
    radius = np.minimum(wall, circle) if len(pads) == 1 else np.minimum(wall, 1.3 * circle)
    whole = all(arc >= 2 * np.pi for *_, arc in pads)
    found = [(radius * np.cos(angle), radius * np.sin(angle), INK if whole else GREY, 1.2 if whole else 0.9, 0 if whole else 2)]
    for ox, oy, r, middle, arc in pads if not whole else []:
        t = middle + np.linspace(-0.5, 0.5, 361) * arc
        px, py = ox + r * np.cos(t), oy + r * np.sin(t)
        # Only the part that the journal can reach; another pad is nearer elsewhere.
        reached = np.hypot(px, py) <= reach(pads, np.arctan2(py, px), 361) * (1 + 1e-6)
        found.append((np.where(reached, px, np.nan), np.where(reached, py, np.nan), INK, 1.8, 0))
    return found


def lines_in_words(study, bearings):
    """What thick and dotted lines of these clearances mean; a whole bore has neither."""
    return "pads thick, no wall where dotted; " * any(dash for b in bearings for *_, dash in outline(study, b))


def draw_clearance(axis, study, b, points=()):
    """Pads as thick arcs; dotted between them how far the journal could go; the panel holds it and `points` (x, y in um)."""
    lines = outline(study, b)
    if not lines:
        return False
    x, y = (values * 1e6 for values in lines[0][:2])
    shade(axis, x, y)
    for px, py, colour, width, dash in lines:
        axis.plot(px * 1e6, py * 1e6, color=colour, linewidth=width, linestyle=":" if dash else "-")
    axis.plot(0, 0, "+", color=GREY, markersize=7)
    side = 1.08 * max(np.nanmax(np.abs(v)) for v in (x, y, *points))
    axis.set_xlim(-side, side)
    axis.set_ylim(-side, side)
    return True
