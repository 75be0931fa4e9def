"""Sections through a film with its heat where lubricant comes in: at an orifice or a groove, and half-way to the next one."""
import numpy as np

from .canvas import plt
from .style import INK, key, length_unit, save, span_of
from .thd_cuts import at_speed, axial, edge, fill_film, parts, regions_in_words
from .thd_film import LABEL, Film, ring, stretches
from .thd_maps import angle_ticks

SOLID = "#e6e6e6"


def supplies(film):
    """What feeds the film and where, [rad, m] of each: orifices, else the middles of grooves."""
    if len(film.orifices):
        return "orifice", film.orifices
    middles = []
    for groove in np.unique(film.groove[film.groove > 0]):
        rows, columns = np.nonzero(film.groove == groove)
        middles.append((np.angle(np.exp(1j * film.theta[columns]).mean()), film.z[rows].mean()))
    return "groove", np.array(middles).reshape(-1, 2)


def cuts(film):
    """Nodes [column, column, row] at a supply where the film is thinnest, half-way to the next one in the direction of rotation, and at the
    supply along; words for it and for half-way. None without one."""
    kind, places = supplies(film)
    if not len(places) or not film.closed:
        return None
    turn, way = 2 * np.pi, -1 if (film.speed or 1) < 0 else 1
    nearest = lambda angle: int(np.argmin(np.abs((film.theta - angle + np.pi) % turn - np.pi)))  # noqa: E731
    gaps = [film.thickness[:, nearest(angle)].mean() for angle, _ in places]
    angle, z = places[int(np.argmin(gaps))]
    ahead = (way * (places[:, 0] - angle)) % turn
    ahead = ahead[(ahead > 1e-6) & (ahead < turn - 1e-6)]
    step = ahead.min() if len(ahead) else turn
    words = f"half-way to the next {kind}" if len(ahead) else f"opposite the {kind}"
    return nearest(angle), nearest(angle + way * step / 2), int(np.argmin(np.abs(film.z - z))), kind, words


def of_film(axis, film, region, at, thickness, values, limits, scale, orifices):
    """The film over the bush, [um]; values [across, node]. Above it the journal, below it what orifices open at."""
    for kind, places, piece in stretches(region, at, values):
        height = np.interp(places, at, thickness) * film.zeta[:, None] * scale
        mesh = fill_film(axis, kind, np.broadcast_to(places, height.shape), height, piece, limits)
    top = 1.2 * thickness.max() * scale
    axis.fill_between(at, thickness * scale, top, color=SOLID, linewidth=0)
    axis.fill_between(at, -0.1 * top, 0, color=SOLID, linewidth=0)
    for height in (0 * thickness, thickness * scale):
        edge(axis, at, height)
    if len(orifices):  # an empty line that is not clipped has no extent, and the layout collapses
        axis.plot(orifices, np.full(len(orifices), -0.05 * top), "^", color=INK, markersize=6, clip_on=False, label="orifice")
    axis.set_xlim(*span_of(at[0], at[-1]))
    axis.set_ylim(-0.1 * top, top)
    axis.grid(False)
    axis.text(0.99, 0.97, "journal", transform=axis.transAxes, ha="right", va="top", fontsize=8, color=INK)
    axis.text(0.03, 0.01, "bush", transform=axis.transAxes, ha="left", va="bottom", fontsize=8, color=INK)
    key(axis, mesh, LABEL)


def draw_film(study):
    """Temperature of the film alone, its thickness to scale: along the shaft at a supply and half-way to the next one, around it through the
    supply and at an end."""
    film = Film(study) if study.has("film/theta", "film/z", "film/temperature", "film/thickness", "film/pressure") else None
    found = film and cuts(film)
    if not found:
        return []
    supply, between, row, kind, words = found
    scale, unit = length_unit(film.thickness)
    figure, axes = plt.subplots(2, 2, figsize=(11.2, 6.6))
    columns, rows = [supply, between], [row, 0]
    limits = [(part.min(), part.max()) for part in (film.temperature[:, columns], film.temperature[rows])]
    angles, heights = np.degrees(film.orifices[:, 0]), film.orifices[:, 1]
    z, half = film.z * 1e3, film.step * 90 / np.pi
    for axis, i, where in zip(axes[0], columns, (f"at {'an' if kind == 'orifice' else 'a'} {kind}", words)):
        angle = np.degrees(film.theta[i]) % 360
        here = np.abs((angles - angle + 180) % 360 - 180) < half
        of_film(axis, film, film.region[:, i], z, film.thickness[:, i], film.temperature[:, i].T, limits[0], scale, heights[here] * 1e3)
        axis.set_title(f"along at {angle:.4g} deg, {where}")
        axis.set_xlabel("z [mm]")
    through = f"through the {kind}" + ("s" if len(supplies(film)[1]) > 1 else "")
    for axis, j, where in zip(axes[1], rows, (through, "the end of the film")):
        here = np.abs(heights - film.z[j]) < np.diff(film.z).max() / 2
        theta, values = ring(film.theta, film.temperature[j].T, True)
        _, region = ring(film.theta, film.region[j], True)
        _, thickness = ring(film.theta, film.thickness[j], True)
        low, high = np.degrees(theta[[0, -1]])
        open_at = np.unique([a + turn for a in angles[here] for turn in (-360, 0, 360) if low - 1e-6 < a + turn < high + 1e-6])
        of_film(axis, film, region, np.degrees(theta), thickness, values, limits[1], scale, open_at)
        axis.set_title(f"around at z = {z[j]:.3g} mm, {where}")
        axis.set_xlabel(f"\u03b8 [deg], from +x counter-clockwise; {film.rotation}", fontsize=8.5)
        angle_ticks(axis, low, high)
    for axis in axes.flat:
        axis.set_ylabel(f"height [{unit}]")
    regions = np.concatenate([film.region[:, columns].ravel(), film.region[rows].ravel()])
    return save(figure, study, "thd-film", f"sections through the film, height above the bush{at_speed(film)}; isotherms every {np.ptp(limits[0]) / 17:.2g} K above and "
                f"{np.ptp(limits[1]) / 17:.2g} K below" + ("; triangles: orifices" if len(film.orifices) else "") + regions_in_words(regions))


def draw_axial(study):
    """Bush, film and journal along the shaft at a supply, and below half-way to the next one (the film drawn thicker)."""
    film, bush, journal, limits = parts(study)
    found = film and cuts(film)
    if not (found and film.radius and bush and journal):
        return []
    supply, between, _, kind, words = found
    at, half = (np.degrees(film.theta[i]) % 360 for i in (supply, between))
    return axial(study, (film, bush, journal, limits), f"thd-axial-{kind}", (film.theta[supply], film.theta[between]),
                 f"above: at {at:.4g} deg, at {'an' if kind == 'orifice' else 'a'} {kind}, below: at {half:.4g} deg, {words}")
