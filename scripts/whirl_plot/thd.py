"""A film with its heat: unwrapped maps, profiles across the film, radial and axial sections through bush, film and journal,
and what a series of meshes or speeds shows."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

from .film import panel
from .style import GREY, INK, LIGHT, length_unit, parameter_label, save

HEAT = "inferno"
LABEL = "temperature [K]"


def ring(theta, values, closed):
    """Angles and values [..., around] with the first behind the last, where the ring closes."""
    if not closed:
        return theta, values
    return np.append(theta, theta[0] + 2 * np.pi), np.concatenate((values, values[..., :1]), axis=-1)


def closes(theta):
    """Whether the first node is about a step behind the last one."""
    step = np.diff(theta).max()
    return abs(theta[0] + 2 * np.pi - theta[-1] - step) < 0.5 * step


class Film:
    """Fields at the nodes, [along, around], and the temperature from the bush (zeta 0) to the journal (zeta 1)."""

    def __init__(self, study):
        self.theta, self.z = study.get("film/theta"), study.get("film/z")
        self.thickness, self.pressure = study.get("film/thickness"), study.get("film/pressure")
        self.radius = float(np.ravel(study.get("film/radius", 0))[0])
        self.temperature = study.get("film/temperature")
        layers = self.temperature.shape[2]
        self.zeta = (np.arange(layers) + 0.5) / layers
        self.walls = {name: study.get(f"film/{name}_wall") for name in ("bush", "journal") if study.has(f"film/{name}_wall")}
        for name, at in (("bush", 0), ("journal", 1)):
            if name in self.walls:
                side = 0 if at == 0 else len(self.zeta)
                self.zeta = np.insert(self.zeta, side, at)
                self.temperature = np.insert(self.temperature, side, self.walls[name], axis=2)

    @property
    def middle(self):
        """[along, around] between the walls."""
        return np.array([[np.interp(0.5, self.zeta, column) for column in row] for row in self.temperature])

    @property
    def cavity(self):
        """[along, around] where the film is ruptured: within its ends no pressure at all above the ambient's, as of liquids alone."""
        none = self.pressure == 0
        none[[0, -1]] = none[[1, -2]]
        return none if self.pressure.max() > 0 else np.zeros_like(none)

    def place(self):
        """Clearance and eccentricity [m] of the circle that the thickness is the gap of: h = c - x cos - y sin."""
        h = self.thickness.mean(axis=0)
        return np.linalg.lstsq(np.stack((np.ones_like(h), -np.cos(self.theta), -np.sin(self.theta)), axis=1), h, rcond=None)[0]


def draw_maps(study):
    if not study.has("film/theta", "film/z", "film/temperature", "film/pressure", "film/thickness"):
        return []
    film = Film(study)
    scale, unit = length_unit(film.thickness)
    maps = [("temperature in the middle of the film", film.middle, HEAT, LABEL, "white"), ("pressure", film.pressure / 1e6, "YlOrRd", "pressure [MPa]", "#5a1a00"),
            ("film thickness", film.thickness * scale, "viridis_r", f"thickness [{unit}]", "white")]
    # The wall of a rotating journal is the same all around.
    maps += [(f"wall of the {name}", values, HEAT, LABEL, "white") for name, values in film.walls.items() if np.ptp(values, axis=1).max() > 1e-6 * np.ptp(film.temperature)]
    figure, axes = plt.subplots(-(-len(maps) // 2), 2, figsize=(11.2, 2.9 * -(-len(maps) // 2) + 1.0), squeeze=False)
    for axis, (title, values, colours, label, ink) in zip(axes.flat, maps):
        theta, shown = ring(film.theta, values, closes(film.theta))
        panel(figure, axis, np.degrees(theta), film.z * 1e3, shown.T, colours, label, ink)
        axis.set_title(f"{title}: {values.min():.5g} to {values.max():.5g} {label.split('[')[1][:-1]}")
        if title == "pressure" and study.has("film/flow_around", "film/flow_along"):
            streams(axis, film, study.get("film/flow_around"), study.get("film/flow_along"))
        mark_cavity(axis, film)
    for axis in axes.flat[len(maps):]:
        axis.set_visible(False)
    return save(figure, study, "thd-maps", "film unwrapped" + (", with lines of mass flow" if film.radius and study.has("film/flow_around") else "")
                + ("; hatched: the film is ruptured, and what is drawn there is not of a full film" if film.cavity.any() else ""))


def mark_cavity(axis, film):
    """Hatches the cells around the nodes where the film is ruptured, cell by cell: nothing is drawn between them and the film."""
    if not film.cavity.any():
        return
    step = np.diff(film.theta).max()
    edges = np.degrees(np.append(film.theta - step / 2, film.theta[-1] + step / 2))
    z = film.z * 1e3
    rows = np.concatenate((z[:1], (z[1:] + z[:-1]) / 2, z[-1:]))
    limits = axis.get_xlim(), axis.get_ylim()
    shown = np.ma.masked_where(~film.cavity, np.ones(film.cavity.shape))
    pieces = [(edges, shown)]
    if closes(film.theta):  # half of the first node's cell lies at the other end of the map
        pieces.append((edges[:2] + 360, shown[:, :1]))
    for at, values in pieces:
        cells = axis.pcolor(at, rows, values, hatch="////", edgecolor=LIGHT, linewidth=0, cmap=ListedColormap(["none"]))
        cells.set_facecolor("none")
    axis.set_xlim(limits[0])
    axis.set_ylim(limits[1])


def streams(axis, film, around, along):
    """Lines of mass flow over a map, from kg/(m s) at nodes: in degrees and millimetres."""
    # Flows around are those between a node and the next one.
    around = (around + np.roll(around, 1, axis=1)) / 2 if closes(film.theta) else around
    theta, around = ring(film.theta, around, closes(film.theta))
    _, along = ring(film.theta, along, closes(film.theta))
    theta = np.degrees(np.linspace(theta[0], theta[-1], len(theta)))
    z = np.linspace(film.z[0], film.z[-1], len(film.z)) * 1e3
    limits = axis.get_xlim(), axis.get_ylim()
    axis.streamplot(theta, z, np.degrees(around / film.radius), along * 1e3, color=GREY, linewidth=0.6, density=0.8, arrowsize=0.6)
    axis.set_xlim(limits[0])
    axis.set_ylim(limits[1])


def draw_profiles(study):
    """Temperature across the film at mid-length, at six angles."""
    if not study.has("film/theta", "film/temperature", "film/thickness"):
        return []
    film = Film(study)
    row = len(film.z) // 2
    figure, axis = plt.subplots(figsize=(10.5, 4.6))
    columns = np.unique(np.round(np.arange(6) * len(film.theta) / 6).astype(int))
    for n, i in enumerate(columns):
        axis.plot(film.temperature[row, i], film.zeta, "-o", markersize=3, color=plt.get_cmap("viridis")(n / max(1, len(columns) - 1)),
                  label=f"{np.degrees(film.theta[i]):.0f} deg")
    axis.set_xlabel(LABEL)
    axis.set_ylabel("across the film: 0 bush, 1 journal")
    axis.set_ylim(0, 1)
    return save(figure, study, "thd-profiles", f"at z = {film.z[row] * 1e3:.3g} mm", handles=axis.get_legend_handles_labels()[0])


def parts(study):
    """Film and solids, None where there is none, with the limits of temperature of all."""
    film = Film(study) if study.has("film/theta", "film/z", "film/temperature", "film/thickness", "film/pressure") else None
    bush = {k: study.get(f"bush/{k}") for k in ("temperature", "theta", "z", "r")} if study.has("bush/temperature") else None
    journal = {k: study.get(f"journal/{k}") for k in ("temperature", "z", "r")} if study.has("journal/temperature") else None
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


def fill(axis, x, y, values, limits):
    low, high = limits
    mesh = axis.pcolormesh(x, y, values, cmap=HEAT, vmin=low, vmax=high, shading="gouraud", rasterized=True)
    levels = np.linspace(low, high, 18)
    levels = levels[(levels > values.min()) & (levels < values.max())]
    if len(levels):
        axis.contour(x, y, values, levels, colors="white", linewidths=0.5, alpha=0.7)
    return mesh


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
    theta, values = ring(film.theta, film.temperature[row].T, closes(film.theta))
    _, h = ring(film.theta, film.thickness[row], closes(film.theta))
    r = 1e3 * (wall + clearance - factor * h * film.zeta[:, None])
    mesh = fill(axis, r * np.cos(theta), r * np.sin(theta), values, limits)
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
    axis.set_aspect("equal")
    axis.set_xlabel("x [mm]")
    axis.set_ylabel("y [mm]")
    figure.colorbar(mesh, ax=axis, label=LABEL).outline.set_visible(False)
    return save(figure, study, "thd-radial", f"section at z = {film.z[row] * 1e3:.3g} mm; the film is drawn {factor:.0f} times as thick; isotherms every "
                f"{np.ptp(limits) / 17:.2g} K")


def draw_axial(study):
    """Bush, film and journal along the shaft where the film is thinnest, and opposite (the film drawn thicker)."""
    film, bush, journal, limits = parts(study)
    if not (film and film.radius and bush and journal):
        return []
    wall = film.radius
    factor, _, _, _ = magnified(film, wall)
    thinnest = int(np.argmin(film.thickness.mean(axis=0)))
    figure, axis = plt.subplots(figsize=(10.5, 6.4))
    for side in (1, -1):
        angle = film.theta[thinnest] + (0 if side > 0 else np.pi)
        away = lambda theta: np.abs((theta - angle + np.pi) % (2 * np.pi) - np.pi)  # noqa: E731
        i = int(np.argmin(away(film.theta)))
        gap = factor * film.thickness[:, i]
        shift = gap.max()
        if side > 0 or away(film.theta)[i] < 0.2:
            r = wall + shift - gap[:, None] * film.zeta
            fill(axis, np.broadcast_to(film.z[:, None] * 1e3, r.shape), side * r * 1e3, film.temperature[:, i], limits)
            for wet in (0, -1):
                edge(axis, film.z * 1e3, side * r[:, wet] * 1e3)
        k = int(np.argmin(away(bush["theta"])))
        if side > 0 or away(bush["theta"])[k] < 0.2:
            z, r = np.meshgrid(bush["z"] * 1e3, (bush["r"] + shift) * side * 1e3, indexing="ij")
            fill(axis, z, r, bush["temperature"][:, k], limits)
        inside = journal["temperature"]
        if inside.ndim == 3:
            inside = inside[:, int(np.argmin(away(journal["theta"])))]
        z, r = np.meshgrid(journal["z"] * 1e3, journal["r"] * side * 1e3, indexing="ij")
        mesh = fill(axis, z, r, inside, limits)
    axis.set_aspect("equal")
    axis.set_xlabel("z [mm]")
    axis.set_ylabel("r [mm]")
    figure.colorbar(mesh, ax=axis, label=LABEL).outline.set_visible(False)
    return save(figure, study, "thd-axial", f"above: at {np.degrees(film.theta[thinnest]):.0f} deg, where the film is thinnest, below: opposite; the film is drawn "
                f"{factor:.0f} times as thick; isotherms every {np.ptp(limits) / 17:.2g} K")


def draw_iterations(study):
    """The greatest change of a temperature in each round of flow and heat."""
    if not study.has("iterations/residual"):
        return []
    residual = np.atleast_2d(np.transpose(study.get("iterations/residual")))
    names = [str(n) for n in study.get("iterations/field", np.arange(len(residual)))]
    figure, axis = plt.subplots(figsize=(10.5, 4.2))
    for name, values in zip(names, residual):
        axis.semilogy(np.arange(len(values)), np.where(values > 0, values, np.nan), "-o", markersize=4, label=name)
    axis.set_xlabel("iteration")
    axis.set_ylabel("greatest change in a round [K]")
    return save(figure, study, "thd-iterations", handles=axis.get_legend_handles_labels()[0])


def decades(axis, values):
    """Whole decades around the positive values."""
    known = values[values > 0]
    if len(known):
        axis.set_ylim(10 ** np.floor(np.log10(known.min())), 10 ** (np.floor(np.log10(known.max())) + 1))


def draw_meshes(study):
    """Least, mean and largest temperature and what the enthalpy budget leaves, over the number of cells."""
    if not study.has("meshes/cells", "meshes/temperature.mean") or len(study.get("meshes/cells")) < 3:
        return []
    cells = study.get("meshes/cells")
    figure, axes = plt.subplots(1, 3, figsize=(11.2, 4.0))
    shown = [("least and largest", [("minimum", "#3b6fb6"), ("maximum", "#c0392b")]), ("mean by volume", [("mean", INK)])]
    for axis, (title, curves) in zip(axes, shown):
        for name, colour in curves:
            axis.semilogx(cells, study.get(f"meshes/temperature.{name}"), "-o", markersize=4, color=colour, label=name)
        axis.set_title(title)
        axis.set_ylabel(LABEL)
        axis.ticklabel_format(axis="y", useOffset=False)
    if study.has("meshes/energy_residual"):
        left_over = np.abs(study.get("meshes/energy_residual"))
        axes[2].loglog(cells, np.where(left_over > 0, left_over, np.nan), "-o", markersize=4, color=INK)
        decades(axes[2], left_over)
        axes[2].set_title("residual of the enthalpy budget")
        axes[2].set_ylabel("[W]")
    else:
        axes[2].set_visible(False)
    for axis in axes:
        axis.set_xlabel("cells of the film")
    return save(figure, study, "thd-meshes", handles=axes[0].get_legend_handles_labels()[0])


# What heats the film, and where the heat goes. The power loss is the sum of the first two.
BUDGET = {"dissipation": ("dissipation", "#c0392b", "-"), "expansion": ("work of pressure", "#3b6fb6", "-"), "power_loss": ("power loss, what both leave", INK, "-"),
          "heat_bush": ("heat to the bush", "#8a5a2b", "--"), "heat_journal": ("heat to the journal", "#7b3fa0", "--"),
          "enthalpy": ("enthalpy carried off", "#12868f", "--")}


def draw_budget(study):
    """The terms of the enthalpy budget over the parameter, and what they leave."""
    found = [k for k in BUDGET if study.has(f"budget/{k}")]
    if not found or not study.has("budget/parameter") or len(study.get("budget/parameter")) < 2:
        return []
    over = study.get("budget/parameter")
    figure, (axis, below) = plt.subplots(2, 1, figsize=(10.5, 6.4), sharex=True, gridspec_kw={"height_ratios": (3, 1)})
    for name in found:
        label, colour, line = BUDGET[name]
        axis.plot(over, study.get(f"budget/{name}"), line, marker="o", markersize=3.5, color=colour, label=label)
    axis.axhline(0, color=GREY, linewidth=0.7)
    axis.set_ylabel("heat flow [W]")
    if study.has("budget/residual"):
        left = np.abs(study.get("budget/residual"))
        below.semilogy(over, np.where(left > 0, left, np.nan), "-o", markersize=3.5, color=INK)
        decades(below, left)
        below.set_ylabel("residual [W]")
    else:
        below.set_visible(False)
    below.set_xlabel(parameter_label(study))
    return save(figure, study, "thd-budget", handles=axis.get_legend_handles_labels()[0])
