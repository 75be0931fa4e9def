"""A film with its heat unwrapped: temperatures, pressure, thickness and flow, properties of its fluid, and heat flows. Cells of a groove
and of a cavity are set apart: fields jump at their borders, and nothing is interpolated across them."""
import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection, PolyCollection

from .canvas import contours, plt
from .style import GREY, INK, LIGHT, ON_PRESSURE, PRESSURE, key, length_unit, save, ticks_at
from .streamlines import streamlines
from .thd_film import HEAT, LABEL, RUPTURED, Film, ring

SIGNED = "RdBu_r"


def film_of(study):
    return Film(study) if study.has("film/theta", "film/z", "film/temperature", "film/pressure", "film/thickness") else None


def even(places):
    """Whether places stand at equal distances."""
    step = np.diff(places)
    return len(step) > 0 and np.ptp(step) < 1e-3 * np.abs(step).mean()


def with_halves(places):
    """The ends of an image whose pixels have their middles at the places."""
    half = (places[1] - places[0]) / 2
    return places[0] - half, places[-1] + half


def field(figure, axis, film, values, cmap, label, ink, jumps=True, known=None, white=0):
    """A field over the unwrapped film. One that jumps has no contours where the film is ruptured. Nodes that are not `known` are left
    blank. Colours of both signs are even about what is `white`."""
    jumps = jumps and film.region.any()
    known = None if known is None or known.all() else known
    low, high = values.min(), values.max()
    if known is not None:
        low, high = values[known].min(), values[known].max()
    span = high - low
    same = span <= 1e-9 * max(abs(low), abs(high))  # rounding is no shape
    levels = low + span * np.linspace(0.05, 0.95, 10)
    if same:
        low, high = low - 0.01 * abs(low), high + 0.01 * abs(high)
    if cmap == SIGNED:
        reach = max(white - low, high - white)
        low, high = white - reach, white + reach
    around, nodes = ring(film.theta, values, film.closed)
    around, along = np.degrees(around), film.z * 1e3
    colours = dict(cmap=cmap, vmin=low, vmax=high)
    if not jumps and known is None and even(around) and even(along):
        # Straight between the nodes, as an image: as many quadrilaterals take ten times as long.
        mesh = axis.imshow(nodes, extent=(*with_halves(around), *with_halves(along)), origin="lower", aspect="auto", interpolation="bilinear", **colours)
        axis.set(xlim=around[[0, -1]], ylim=along[[0, -1]])
        region, shown, middles = np.zeros(nodes.shape, int), nodes, (around, along)
    else:
        theta, z, shown, region = film.fine(values, jumps)
        theta, z = np.degrees(theta), z * 1e3
        if known is not None:
            _, _, share, _ = film.fine(known.astype(float), jumps)
            shown = np.ma.masked_where(share < 1, shown)
        mesh = axis.pcolorfast(theta, z, shown, **colours)
        middles = (theta[1:] + theta[:-1]) / 2, (z[1:] + z[:-1]) / 2
    parts = np.unique(region)
    for part in parts:
        inside = shown if len(parts) == 1 and not np.ma.is_masked(shown) else np.ma.masked_where(region != part, shown)
        if np.ma.getmaskarray(inside).all():
            continue
        here = levels[(levels > inside.min()) & (levels < inside.max())]
        if (part != RUPTURED or not jumps) and len(here) and not same:
            contours(axis, *middles, inside, here, ink, 0.6)
    axis.grid(False)
    key(axis, mesh, label)


def angle_ticks(axis, first, last):
    """Ticks of an angle in degrees, read within one turn."""
    step = next((s for s in (5, 10, 15, 30, 45) if (last - first) / s <= 9), 45)
    at = np.arange(np.ceil(first / step - 1e-9), last / step + 1e-9) * step
    ticks_at(axis.xaxis, at, [f"{a % 360:g}" for a in at])


def hatch_cavity(axis, film, colour=LIGHT):
    if film.cavity.any():
        strips = np.array(film.strips(film.cavity)) * (180 / np.pi, 180 / np.pi, 1e3, 1e3)
        corners = strips[:, [[0, 2], [1, 2], [1, 3], [0, 3]]]
        axis.add_collection(PolyCollection(corners, hatch="////", facecolor="none", edgecolor=colour, linewidth=0), autolim=False)


def is_lowest(axis):
    """Whether no panel stands below in the same column."""
    place = axis.get_subplotspec()
    return not any(other.get_visible() and other.get_subplotspec().colspan.start == place.colspan.start
                   and other.get_subplotspec().rowspan.start > place.rowspan.start for other in axis.figure.axes)


def mark_regions(axis, film):
    """Hatches the cells around the nodes where the film is ruptured, outlines those that grooves feed, marks orifices, and says
    which way the shaft moves."""
    if is_lowest(axis):
        axis.set_xlabel(f"\u03b8 [deg], from +x counter-clockwise; {film.rotation}", fontsize=8.5)
    if axis.get_subplotspec().is_first_col():
        axis.set_ylabel("z [mm]")
    first, last = np.degrees(ring(film.theta, film.theta, film.closed)[0][[0, -1]])
    axis.set_xlim(first, last)
    angle_ticks(axis, first, last)
    axis.set_ylim(film.z[0] * 1e3, film.z[-1] * 1e3)
    hatch_cavity(axis, film)
    if len(film.orifices):
        theta, z = film.orifices.T
        theta = np.concatenate([theta + turn for turn in (-2 * np.pi, 0, 2 * np.pi)])
        places, z = np.degrees(theta), np.tile(z, 3) * 1e3
        inside = (places > first - 1e-6) & (places < last + 1e-6)  # one at the seam is on both sides
        axis.plot(places[inside], z[inside], "o", markersize=4.5, markerfacecolor="none", markeredgecolor=INK, markeredgewidth=1.1, label="orifice",
                  clip_on=False, zorder=4, path_effects=[patheffects.Stroke(linewidth=2.6, foreground="white"), patheffects.Normal()])
    for groove in np.unique(film.groove[film.groove > 0]):
        border = np.array(film.border(film.groove == groove)) * (180 / np.pi, 1e3)
        for colour, width, label in (("white", 2.8, "_halo"), (INK, 1.3, "groove")):  # all of the halo first: these are many short lines
            axis.add_collection(LineCollection(border, colors=colour, linewidths=width, capstyle="round", label=label, zorder=3), autolim=False)


def regions_in_words(film):
    words = "; outlined: cells that a groove feeds" if film.groove.any() else ""
    words += "; circles: orifices" if len(film.orifices) else ""
    if film.cavity.any() and film.conserves_mass:
        return words + "; hatched: the film is ruptured, and the gap is not full"
    return words + ("; hatched: the film is ruptured, and what is drawn there is not of a full film" if film.cavity.any() else "")


def figure_of(count):
    """A figure of panels two in a row; those left over are empty."""
    rows, columns = -(-count // 2), min(count, 2)
    figure, axes = plt.subplots(rows, columns, figsize=(11.2 if columns == 2 else 7.2, 2.6 * rows + 1.0), squeeze=False,
                                sharex=True, sharey=True)
    for axis in axes.flat[count:]:
        axis.set_visible(False)
    for axis in axes.flat[max(0, count - columns):count]:
        axis.tick_params(labelbottom=True)
    return figure, axes.flat


def range_of(values, unit):
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return f"{low} {unit}".rstrip() if low == high else f"{low} to {high} {unit}".rstrip()


def draw_maps(study):
    film = film_of(study)
    if not film:
        return []
    scale, unit = length_unit(film.thickness)
    maps = [("temperature in the middle of the film", film.middle, HEAT, LABEL, "white", True),
            ("pressure", film.pressure / 1e6, PRESSURE, "pressure [MPa]", ON_PRESSURE, False),
            ("film thickness", film.thickness * scale, "viridis_r", f"thickness [{unit}]", "white", False)]
    if study.has("film/pressure_isothermal"):
        change = (film.pressure - study.get("film/pressure_isothermal")) / 1e3
        if np.ptp(change) > 1e-9 * np.ptp(film.pressure):
            maps.insert(2, ("pressure less that at one temperature", change, SIGNED, "difference [kPa]", GREY, False))
    # The wall of a rotating journal is the same all around.
    maps += [(f"wall of the {name}", values, HEAT, LABEL, "white", True) for name, values in film.walls.items()
             if np.ptp(values, axis=1).max() > 1e-6 * np.ptp(film.temperature)]
    if film.conserves_mass:
        maps.append(("share of the gap that is full", study.get("film/fill"), "Blues", "share [1]", "white", True))
    figure, axes = figure_of(len(maps))
    flow = film.radius and study.has("film/flow_around", "film/flow_along")
    for axis, (title, values, colours, label, ink, jumps) in zip(axes, maps):
        field(figure, axis, film, values, colours, label, ink, jumps)
        axis.set_title(f"{title}: {range_of(values, label.split('[')[1][:-1].replace('1', ''))}")
        if title == "pressure" and flow:
            streams(axis, film, *at_nodes(film, study.get("film/flow_around"), study.get("film/flow_along")), film.flow_known)
        mark_regions(axis, film)
    return save(figure, study, "thd-maps", " ".join(filter(None, ("film unwrapped", film.at_speed))) + (", with lines of mass flow" if flow else "") + regions_in_words(film))


def at_nodes(film, around, along):
    """Flows at faces (around: from a node to the next one, along: from the node before) as means at nodes."""
    around = (around + np.roll(around, 1, axis=1)) / 2 if film.closed else around
    return around, np.concatenate(((along[:-1] + along[1:]) / 2, along[-1:]))


def streams(axis, film, around, along, known):
    """Lines along a vector [.., at nodes, m times anything] over a map in degrees and millimetres. They end at nodes that are not `known`."""
    known = np.where(known, 1.0, np.nan)
    theta, around = ring(film.theta, around * known, film.closed)
    _, along = ring(film.theta, along * known, film.closed)
    span, length = theta[-1] - theta[0], film.z[-1] - film.z[0]
    lines = [(np.degrees(theta[0] + span * x), 1e3 * (film.z[0] + length * y)) for x, y in streamlines(around / (film.radius * span), along / length)]
    axis.add_collection(LineCollection([np.column_stack(line) for line in lines], colors=GREY, linewidths=0.6, label="_streamlines"), autolim=False)
    middles = np.array([[values[len(values) // 2 + k] for values in line for k in (0, 1)] for line in lines]).reshape(-1, 4)
    way = np.diff(middles.reshape(-1, 2, 2), axis=2)[..., 0]
    way /= np.maximum(np.hypot(*way.T), 1e-300)[:, None]
    axis.quiver(middles[:, 0], middles[:, 2], *way.T, angles="xy", units="inches", scale_units="inches", scale=20, width=0.01, headwidth=5, headlength=5, headaxislength=4.5,
                pivot="mid", color=GREY)


def draw_velocity(study):
    """How fast the fluid moves half-way between bush and journal, around and along, with its streamlines. Where a film is ruptured and does
    not conserve its mass it knows no flow: nothing is drawn there."""
    film = film_of(study)
    if not film or not film.radius or not study.has("film/velocity_around", "film/velocity_along"):
        return []
    around, along = study.get("film/velocity_around"), study.get("film/velocity_along")
    known = film.flow_known
    figure, axes = plt.subplots(2, 1, figsize=(9.2, 6.4), sharex=True)
    drag = 0.5 * (film.speed or 0) * film.radius
    for axis, (title, values, white) in zip(axes, (("circumferential velocity", around, drag), ("axial velocity", along, 0))):
        field(figure, axis, film, values, SIGNED, "velocity [m/s]", GREY, known=known, white=white)
        axis.set_title(f"{title}: {range_of(values[known], 'm/s')}")
        mark_regions(axis, film)
    streams(axes[1], film, around, along, known)
    words = regions_in_words(film) if known.all() else regions_in_words(film).split("; hatched")[0] + "; hatched: the film is ruptured, and its flow is not known"
    white = "; white: none" if drag == 0 else f"; white: what drag alone gives, {drag:.4g} m/s above and none below"
    return save(figure, study, "thd-velocity", " ".join(filter(None, ("half-way between bush and journal, unwrapped,", film.at_speed)))
                + ", below with streamlines; positive: to larger angles and larger z" + white + words)


FLUID = {"viscosity": "viscosity", "density": "density", "conductivity": "conductivity", "heat_capacity": "heat capacity"}


def draw_fluid(study):
    """Mean properties across the film; those that are the same everywhere are numbers below."""
    film, known = film_of(study), [name for name in FLUID if study.has(f"film/{name}")]
    if not film or not known:
        return []
    fields, same = [], []
    for name in known:
        values, unit = study.get(f"film/{name}"), str(study.group[f"film/{name}"].attrs.get("unit", "")).replace("^3", "\u00b3")
        if unit == "Pa s":
            factor, unit = (1e3, "mPa s") if values.max() >= 1e-3 else (1e6, "\u00b5Pa s")
            values = values * factor
        if np.ptp(values) > 1e-6 * np.abs(values).max():
            fields.append((FLUID[name], values, unit))
        else:
            same.append(f"{FLUID[name]} {values.mean():.4g} {unit}")
    if not fields:
        return []
    figure, axes = figure_of(len(fields))
    for axis, (title, values, unit) in zip(axes, fields):
        field(figure, axis, film, values, "cividis", f"{title} [{unit}]", "white")
        axis.set_title(f"{title}: {range_of(values, unit)}")
        mark_regions(axis, film)
    return save(figure, study, "thd-fluid", " ".join(filter(None, ("mean across the film, unwrapped,", film.at_speed)))
                + (f"; the same everywhere: {', '.join(same)}" if same else "") + regions_in_words(film))


FLOWS = {"heat_bush": "heat to the bush", "heat_journal": "heat to the journal", "dissipation": "dissipation", "expansion": "work of pressure",
         "heat": "both together"}


def draw_heat(study):
    """What the film gives to bush and journal and what heats it, per area, with the sum over the film."""
    film = film_of(study)
    found = {name: study.get(f"film/{name}") for name in FLOWS if study.has(f"film/{name}")}
    if not film or not film.radius or not found:
        return []
    if {"dissipation", "expansion"} <= found.keys():
        found["heat"] = found["dissipation"] + found["expansion"]
    most = max(np.abs(values).max() for values in found.values())
    none = [FLOWS[name] for name, values in found.items() if np.abs(values).max() <= 1e-9 * most]
    found = {name: values for name, values in found.items() if FLOWS[name] not in none}
    if not found:
        return []
    factor, unit = (1e-6, "MW/m\u00b2") if most >= 1e6 else (1e-3, "kW/m\u00b2") if most >= 1e3 else (1, "W/m\u00b2")
    figure, axes = figure_of(len(found))
    for axis, (name, values) in zip(axes, found.items()):
        signed = values.min() < 0
        field(figure, axis, film, values * factor, SIGNED if signed else "YlOrRd", f"heat flow [{unit}]", GREY if signed else "#5a1a00")
        axis.set_title(f"{FLOWS[name]}: {range_of(values * factor, unit)}, {np.sum(values * film.areas):.4g} W in all")
        mark_regions(axis, film)
    return save(figure, study, "thd-heat", " ".join(filter(None, ("per area of the film, unwrapped,", film.at_speed)))
                + "; positive: out of the film to a wall, or into the film by friction and pressure"
                + (f"; none: {', '.join(none)}" if none else "") + regions_in_words(film))
