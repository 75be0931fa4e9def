"""Sections through a film with its heat where lubricant comes in: at an orifice or a groove, and half-way to the next one."""
import matplotlib.pyplot as plt
import numpy as np

from .style import INK, length_unit, save
from .thd_cuts import at_speed, axial, edge, fill_film, isotherms, parts, regions_in_words
from .thd_film import LABEL, Film, ring, stretches

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
    supply along; the kind of the supply. None without one."""
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
    return nearest(angle), nearest(angle + way * step / 2), int(np.argmin(np.abs(film.z - z))), kind


def of_film(axis, film, region, at, thickness, values, limits, scale):
    """The film over the bush, [um]; values [across, node]. Above it the journal."""
    for kind, places, piece in stretches(region, at, values):
        height = np.interp(places, at, thickness) * film.zeta[:, None] * scale
        mesh = fill_film(axis, kind, np.broadcast_to(places, height.shape), height, piece, limits)
    top = 1.12 * film.thickness.max() * scale
    axis.fill_between(at, thickness * scale, top, color=SOLID, linewidth=0)
    axis.fill_between(at, -0.08 * top, 0, color=SOLID, linewidth=0)
    for height in (0 * thickness, thickness * scale):
        edge(axis, at, height)
    axis.set_xlim(at[0], at[-1])
    axis.set_ylim(-0.08 * top, top)
    axis.grid(False)
    axis.text(0.99, 0.96, "journal", transform=axis.transAxes, ha="right", va="top", fontsize=8, color=INK)
    axis.text(0.99, 0.02, "bush", transform=axis.transAxes, ha="right", va="bottom", fontsize=8, color=INK)
    return mesh


def draw_film(study):
    """Temperature of the film alone, its thickness to scale: along the shaft at a supply and half-way to the next one, around it through the
    supply and at an end."""
    film = Film(study) if study.has("film/theta", "film/z", "film/temperature", "film/thickness", "film/pressure") else None
    found = film and cuts(film)
    if not found:
        return []
    supply, between, row, kind = found
    scale, unit = length_unit(film.thickness)
    z = film.z * 1e3
    lines = [(f"along at {np.degrees(film.theta[supply]) % 360:.4g} deg, at {'an' if kind == 'orifice' else 'a'} {kind}", supply),
             (f"along at {np.degrees(film.theta[between]) % 360:.4g} deg, half-way to the next {kind}", between)]
    rings = [(f"around at z = {z[row]:.3g} mm, through the {kind}s", row), (f"around at z = {z[0]:.3g} mm, the end of the film", 0)]
    here = [film.temperature[:, [supply, between]], film.temperature[[row, 0]]]
    limits = min(v.min() for v in here), max(v.max() for v in here)
    figure, axes = plt.subplots(2, 2, figsize=(11.2, 6.4))
    for axis, (title, i) in zip(axes[0], lines):
        mesh = of_film(axis, film, film.region[:, i], z, film.thickness[:, i], film.temperature[:, i].T, limits, scale)
        axis.set_title(title)
        axis.set_xlabel("z [mm]")
    for axis, (title, j) in zip(axes[1], rings):
        theta, values = ring(film.theta, film.temperature[j].T, True)
        mesh = of_film(axis, film, ring(film.theta, film.region[j], True)[1], np.degrees(theta), ring(film.theta, film.thickness[j], True)[1], values, limits, scale)
        axis.set_title(title)
        axis.set_xlabel(f"\u03b8 [deg], from +x counter-clockwise; {film.rotation}", fontsize=8.5)
        axis.set_xticks(np.arange(np.ceil(np.degrees(theta[0]) / 45 - 1e-9), np.degrees(theta[-1]) / 45 + 1e-9) * 45)
    for axis in axes.flat:
        axis.set_ylabel(f"above the bush [{unit}]")
    figure.colorbar(mesh, ax=axes, label=LABEL, pad=0.015).outline.set_visible(False)
    regions = np.concatenate([film.region[:, [supply, between]].ravel(), film.region[[row, 0]].ravel()])
    return save(figure, study, "thd-film", f"sections through the film{at_speed(film)}; {isotherms(limits)}{regions_in_words(regions)}")


def draw_axial(study):
    """Bush, film and journal along the shaft at a supply, and below half-way to the next one (the film drawn thicker)."""
    film, bush, journal, limits = parts(study)
    found = film and cuts(film)
    if not (found and film.radius and bush and journal):
        return []
    supply, between, _, kind = found
    at, half = (np.degrees(film.theta[i]) % 360 for i in (supply, between))
    return axial(study, (film, bush, journal, limits), f"thd-axial-{kind}", (film.theta[supply], film.theta[between]),
                 f"above: at {at:.4g} deg, at {'an' if kind == 'orifice' else 'a'} {kind}, below: at {half:.4g} deg, half-way to the next one")
