"""Sections through a film with its heat: profiles across the film, and bush, film and journal across and along the shaft."""
import numpy as np
from matplotlib import patheffects
from matplotlib.patches import FancyArrowPatch

from .canvas import contours, plt
from .style import DASHED, INK, LIGHT, key, save
from .thd_film import HEAT, LABEL, RUPTURED, ZERO, Film, closes, ring, stretches


def draw_profiles(study):
    """Temperature across the film at mid-length, at six angles."""
    if not study.has("film/theta", "film/temperature", "film/thickness"):
        return []
    film = Film(study)
    row = len(film.z) // 2
    figure, axis = plt.subplots(figsize=(10.5, 4.6))
    columns = np.unique(np.round(np.arange(6) * len(film.theta) / 6).astype(int))
    for n, i in enumerate(columns):
        ruptured, groove = film.cavity[row, i], film.groove[row, i]
        axis.plot(film.temperature[row, i], film.zeta, marker="o", linestyle=DASHED if ruptured else "-", markersize=3,
                  color=plt.get_cmap("viridis")(n / max(1, len(columns) - 1)),
                  label=f"{np.degrees(film.theta[i]):.0f} deg" + (", ruptured" if ruptured else ", groove" if groove else ""))
    axis.set_xlabel(LABEL)
    axis.set_ylabel("across the film: 0 bush, 1 journal")
    axis.set_ylim(0, 1)
    return save(figure, study, "thd-profiles", " ".join(filter(None, (f"at z = {film.z[row] * 1e3:.3g} mm", film.at_speed))), handles=axis.get_legend_handles_labels()[0])


def parts(study):
    """Film and solids, None where there is none, with the limits of temperature of all."""
    film = Film(study) if study.has("film/theta", "film/z", "film/temperature", "film/thickness", "film/pressure") else None
    bush = {k: study.get(f"bush/{k}") for k in ("temperature", "theta", "z", "r")} if study.has("bush/temperature") else None
    journal = {k: study.get(f"journal/{k}") for k in ("temperature", "z", "r")} if study.has("journal/temperature") else None
    for part in (bush, journal):
        if part:
            part["temperature"] = part["temperature"] - ZERO
    if journal and study.has("journal/theta"):
        journal["theta"] = study.get("journal/theta")
    if film and bush and "bush" in film.walls and bush["temperature"].shape[:2] == film.walls["bush"].shape:
        bush["r"] = np.insert(bush["r"], 0, film.radius)
        bush["temperature"] = np.insert(bush["temperature"], 0, film.walls["bush"], axis=2)
    for part, side in ((bush, -1), (journal, 0)):
        faces = study.get("bush/r_faces" if side else "journal/r_faces", None) if part else None
        if faces is not None and faces[side] != part["r"][side]:  # to its free surface, on the line through the last two cells
            at, next_one = (len(part["r"]), -2) if side else (0, 1)
            slope = (part["temperature"][..., side] - part["temperature"][..., next_one]) / (part["r"][side] - part["r"][next_one])
            surface = part["temperature"][..., side] + slope * (faces[side] - part["r"][side])
            part["temperature"] = np.insert(part["temperature"], at, surface, axis=-1)
            part["r"] = np.insert(part["r"], at, faces[side])
    known = [p["temperature"] for p in (bush, journal) if p] + ([film.temperature] if film else [])
    limits = (min(v.min() for v in known), max(v.max() for v in known)) if known else (0, 1)
    return film, bush, journal, limits


def fill(axis, x, y, values, limits, isotherms=True):
    low, high = limits
    mesh = axis.pcolormesh(x, y, values, cmap=HEAT, vmin=low, vmax=high, shading="gouraud", rasterized=True)
    levels = np.linspace(low, high, 18)
    levels = levels[(levels > values.min()) & (levels < values.max())]
    if len(levels) and isotherms:
        contours(axis, *np.broadcast_arrays(x, y, values), levels, "white", 0.7)
    return mesh


def fill_film(axis, region, x, y, values, limits):
    """One stretch of the film: hatched without isotherms where it is ruptured, outlined in a groove."""
    mesh = fill(axis, x, y, values, limits, isotherms=region != RUPTURED)
    around = [np.concatenate((a[0], a[1:, -1], a[-1, -2::-1], a[-2::-1, 0])) for a in (x, y)]
    if region == RUPTURED:
        axis.fill(*around, facecolor="none", edgecolor=LIGHT, hatch="////", linewidth=0)
    elif region > RUPTURED:
        axis.plot(*around, color=INK, linewidth=1.3, label="groove", zorder=4,
                  path_effects=[patheffects.Stroke(linewidth=2.8, foreground="white"), patheffects.Normal()])
    return mesh


def regions_in_words(regions):
    return ("; hatched: the film is ruptured" if (regions == RUPTURED).any() else "") + ("; outlined: groove" if (regions > RUPTURED).any() else "")


def turns(axis, radius, way):
    """An arrow outside of everything, the way the shaft turns."""
    begin, end = np.radians([35, 55])[::int(way)]
    ends = [(radius * np.cos(a), radius * np.sin(a)) for a in (begin, end)]
    arrow = FancyArrowPatch(*ends, connectionstyle=f"arc3,rad={0.09 * way}", arrowstyle="-|>", mutation_scale=14, color=INK, linewidth=1.4, label="rotation")
    axis.add_patch(arrow)
    axis.annotate("\u03c9", (radius * 1.05 * np.cos(np.pi / 4), radius * 1.05 * np.sin(np.pi / 4)), ha="center", va="center", color=INK)


def at_speed(film):
    return f", {film.at_speed}" if film.at_speed else ""


def edge(axis, x, y):
    """Where film and solid meet."""
    axis.plot(x, y, color=INK, linewidth=0.8)


def magnified(film, radius):
    """How many times thicker the film is drawn, and its clearance and the journal's place then [m]."""
    c, x, y = film.place()
    factor = 0.15 * radius / c
    step = 10 ** np.floor(np.log10(factor))
    factor = max(1, np.floor(factor / step) * step)
    return factor, factor * c, factor * x, factor * y


def draw_radial(study):
    """Bush, film and journal across the shaft, a quarter of the film's length from its end (the film drawn thicker)."""
    film, bush, journal, limits = parts(study)
    if not (film and film.radius and bush and journal):
        return []
    row = int(np.argmin(np.abs(film.z - (0.75 * film.z[0] + 0.25 * film.z[-1]))))
    wall = film.radius
    factor, clearance, x0, y0 = magnified(film, wall)
    at = int(np.argmin(np.abs(journal["z"] - film.z[row])))
    here = [bush["temperature"][row], film.temperature[row], journal["temperature"][at]]
    limits = min(v.min() for v in here), max(v.max() for v in here)
    figure, axis = plt.subplots(figsize=(9.6, 8.0))
    theta, values = ring(bush["theta"], bush["temperature"][row].T, closes(bush["theta"]))
    r = 1e3 * (bush["r"] + clearance)[:, None]
    fill(axis, r * np.cos(theta), r * np.sin(theta), values, limits)
    theta, values = ring(film.theta, film.temperature[row].T, film.closed)
    _, h = ring(film.theta, film.thickness[row], film.closed)
    _, region = ring(film.theta, film.region[row], film.closed)
    radii = lambda at: 1e3 * (wall + clearance - factor * np.interp(at, theta, h) * film.zeta[:, None])  # noqa: E731
    for kind, angles, piece in stretches(region, theta, values):
        r = radii(angles)
        mesh = fill_film(axis, kind, r * np.cos(angles), r * np.sin(angles), piece, limits)
    r = radii(theta)
    for side in (0, -1):
        edge(axis, r[side] * np.cos(theta), r[side] * np.sin(theta))
    turn = np.linspace(0, 2 * np.pi, 181)
    inside = journal["temperature"][at]
    if inside.ndim == 2:
        turn, inside = ring(journal["theta"], inside.T, True)
    else:
        inside = inside[:, None] * np.ones(len(turn))
    r = 1e3 * journal["r"][:, None]
    fill(axis, 1e3 * x0 + r * np.cos(turn), 1e3 * y0 + r * np.sin(turn), inside, limits)
    if film.speed != 0:
        turns(axis, 1.08e3 * (bush["r"][-1] + clearance), np.sign(film.speed or 1))
    axis.set_aspect("equal")
    axis.set_xlabel("x [mm]")
    axis.set_ylabel("y [mm]")
    key(axis, mesh, LABEL)
    return save(figure, study, "thd-radial", f"section at z = {film.z[row] * 1e3:.3g} mm{at_speed(film)}; the film is drawn {factor:.0f} times as thick; "
                f"{isotherms(limits)}" + regions_in_words(region))


def isotherms(limits):
    return f"isotherms every {np.ptp(limits) / 17:.2g} K"


def axial(study, of, what, angles, words):
    """Bush, film and journal along the shaft at two angles [rad], the first above, the second below the axis."""
    film, bush, journal, limits = of
    wall = film.radius
    factor, _, _, _ = magnified(film, wall)
    figure, axis = plt.subplots(figsize=(10.5, 6.4))
    shown = []
    for side, angle in zip((1, -1), angles):
        away = lambda theta: np.abs((theta - angle + np.pi) % (2 * np.pi) - np.pi)  # noqa: E731, B023
        i = int(np.argmin(away(film.theta)))
        gap = factor * film.thickness[:, i]
        shift = gap.max()
        if away(film.theta)[i] < 0.2:
            shown.append(film.region[:, i])
            radii = lambda at: side * 1e3 * (wall + shift - np.interp(at, film.z, gap)[:, None] * film.zeta)  # noqa: E731, B023
            for kind, places, piece in stretches(film.region[:, i], film.z, film.temperature[:, i].T):
                r = radii(places)
                fill_film(axis, kind, np.broadcast_to(places[:, None] * 1e3, r.shape), r, piece.T, limits)
            for wet in (0, -1):
                edge(axis, film.z * 1e3, radii(film.z)[:, wet])
        k = int(np.argmin(away(bush["theta"])))
        if away(bush["theta"])[k] < 0.2:
            z, r = np.meshgrid(bush["z"] * 1e3, (bush["r"] + shift) * side * 1e3, indexing="ij")
            fill(axis, z, r, bush["temperature"][:, k], limits)
        inside = journal["temperature"]
        if inside.ndim == 3:
            inside = inside[:, int(np.argmin(away(journal["theta"])))]
        z, r = np.meshgrid(journal["z"] * 1e3, journal["r"] * side * 1e3, indexing="ij")
        mesh = fill(axis, z, r, inside, limits)
    axis.set_aspect("equal")
    low, high = axis.dataLim.get_points()
    figure.set_figwidth(min(10.5, max(6.4, 5.2 * (high[0] - low[0]) / (high[1] - low[1]) + 1.6)))  # a short bearing needs no wide page
    axis.set_xlabel("z [mm]")
    axis.set_ylabel("r [mm]")
    key(axis, mesh, LABEL)
    return save(figure, study, what, f"{words}{at_speed(film)}; the film is drawn {factor:.0f} times as thick; {isotherms(limits)}"
                + regions_in_words(np.concatenate(shown)))


def draw_axial(study):
    """Bush, film and journal along the shaft where the film is thinnest, and opposite (the film drawn thicker)."""
    of = film, bush, journal, _ = parts(study)
    if not (film and film.radius and bush and journal):
        return []
    angle = film.theta[int(np.argmin(film.thickness.mean(axis=0)))]
    return axial(study, of, "thd-axial", (angle, angle + np.pi), f"above: at {np.degrees(angle):.0f} deg, where the film is thinnest, below: opposite")
