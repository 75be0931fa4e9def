"""A film of gas: load, flow and losses over the eccentricity, isobars, meshes, maps of a design, rarefaction."""
import numpy as np
from matplotlib.ticker import MaxNLocator

from .canvas import plt
from .style import BAD, COLOURS, GREY, INK, ON_PRESSURE, PRESSURE, grid_of, least_span, save, ticks_at
from .thd_maps import angle_ticks
from .units import digits


def from_zero(axis):
    """A vertical axis from 0, with as much room above the curves as there is of an axis that they fill."""
    axis.set_ylim(0, 1.05 * max((np.nanmax(line.get_ydata(), initial=0) for line in axis.lines), default=0) or 1)


CURVES = (("load", 1, "load [N]"), ("attitude", 180 / np.pi, "attitude angle [deg]"), ("min_thickness", 1e6, "thinnest film [\u00b5m]"), ("max_pressure", 1e-6, "largest pressure [MPa, absolute]"),
          ("power_loss", 1, "power loss [W]"), ("knudsen", 1, "Knudsen number"), ("normal_flow", 1, "flow [l/min, normal]"))


def draw_curves(study):
    """What the film carries, takes and loses over the eccentricity, a curve for each speed."""
    if not study.has("curves/speed", "curves/eccentricity", "curves/load") or len(study.get("curves/eccentricity")) < 2:
        return []
    e, speeds = study.get("curves/eccentricity"), study.get("curves/speed")
    shown = [c for c in CURVES if study.has(f"curves/{c[0]}") and np.any(study.get(f"curves/{c[0]}") != 0)]  # a film without a supply has no flow
    figure, axes, _ = grid_of(len(shown), 2.8, 2.6, -(-len(shown) // 2))
    for axis, (name, factor, label) in zip(axes, shown):
        values = study.get(f"curves/{name}")
        if name == "power_loss" and np.nanmax(values) < 0.1:
            factor, label = 1e3, label.replace("[W]", "[mW]")
        for k, speed in enumerate(speeds):
            axis.plot(e, factor * values[k], "-o" if len(e) > 2 else "o", markersize=3.5, color=COLOURS[k % len(COLOURS)], label=f"{speed:.4g} rad/s")
        axis.set_ylabel(label)
        axis.set_xlabel("eccentricity, in clearances")
        if name == "attitude":
            least_span(axis, 1, 2)
        else:
            from_zero(axis)
    return save(figure, study, "gas-curves", "journal held in the given direction; attitude from the load, with the rotation", handles=axes[0].get_legend_handles_labels()[0])


def draw_isobars(study):
    """Pressure over the unwrapped film at the last eccentricity, first and last speed."""
    if not study.has("fields/pressure", "fields/theta", "fields/z"):
        return []
    theta, z, p = np.degrees(study.get("fields/theta")), 1e3 * study.get("fields/z"), 1e-6 * study.get("fields/pressure")
    speeds, e = study.get("curves/speed"), study.get("curves/eccentricity")
    known = [k for k in range(len(speeds)) if np.isfinite(p[k]).all()]
    if not known:
        return []
    shown = known if len(known) == 1 else [known[0], known[-1]]
    figure, axes = plt.subplots(len(shown), 1, figsize=(9.6, 2.9 * len(shown)), squeeze=False, sharex=True)
    levels = np.linspace(p[shown].min(), p[shown].max(), 22)
    places = max(2, -int(np.floor(np.log10(np.ptp(levels) / 10 or 1))))  # neighbouring isobars have different labels
    for axis, k in zip(axes[:, 0], shown):
        filled = axis.contourf(theta, z, p[k].T, levels, cmap=PRESSURE)
        lines = axis.contour(theta, z, p[k].T, levels[1:-1:2], colors=ON_PRESSURE, linewidths=0.6)
        axis.clabel(lines, fmt=f"%.{places}f", fontsize=6.5)
        axis.set_title(f"{speeds[k]:.4g} rad/s", fontsize=9)
        axis.set_ylabel("z [mm]")
        angle_ticks(axis, theta[0], theta[-1])
        figure.colorbar(filled, ax=axis, label="pressure [MPa, absolute]", pad=0.015, ticks=MaxNLocator(5))
    axes[-1, 0].set_xlabel(r"$\theta$ from $+x$, with the rotation [deg]")
    return save(figure, study, "gas-isobars", f"eccentricity {e[-1]:.3g} clearances; linear between nodes" + "; the dip in the jet behind an orifice is not modelled" * np.any(study.get("curves/mass_flow", 0.0) != 0))


def draw_meshes(study):
    """Load over the mesh, with the pressure at the rim of the orifices and with that of the nodes."""
    if not study.has("meshes/load", "meshes/around", "meshes/load_of_node_source") or len(study.get("meshes/load")) < 2:
        return []
    n, rim, node = (study.get(f"meshes/{k}") for k in ("around", "load", "load_of_node_source"))
    figure, axis = plt.subplots(figsize=(7.2, 4.0))
    joined = len(n) > 2  # two points are no course
    at = np.arange(len(n))
    axis.plot(at, rim, "-o" if joined else "o", color=INK, markersize=4, label="pressure at the rim of the orifice")
    axis.plot(at, node, "--s" if joined else "s", color=BAD, markersize=4, label="pressure of the node: never converges")
    axis.margins(x=0.15)
    ticks_at(axis.xaxis, at, [f"{a:.0f} x {b:.0f}" for a, b in zip(n, study.get("meshes/along"))])
    axis.set_xlabel("cells around and along")
    axis.set_ylabel("load [N]")
    return save(figure, study, "gas-meshes", handles=axis.get_legend_handles_labels()[0])


def draw_map(study):
    """Load and flow over clearance and diameter of the orifices."""
    if not study.has("map/load", "map/clearance", "map/diameter"):
        return []
    c, d = 1e6 * study.get("map/clearance"), 1e3 * study.get("map/diameter")
    figure, axes = plt.subplots(1, 2, figsize=(10.4, 3.9))
    for axis, (name, factor, label) in zip(axes, (("load", 1, "load [N]"), ("mass_flow", 1e6, "flow [mg/s]"))):
        values = factor * study.get(f"map/{name}")
        for k, diameter in enumerate(d):
            axis.plot(c, values[:, k], "-o", markersize=3.5, color=COLOURS[k % len(COLOURS)], label=f"{diameter:.3g} mm")
        axis.set_xlabel("clearance [µm]")
        axis.set_ylabel(label)
        from_zero(axis)
    return save(figure, study, "gas-map", f"at an eccentricity of {study.group['map'].attrs['eccentricity']:.3g} clearances; colours: diameter of the orifices",
                handles=axes[0].get_legend_handles_labels()[0])


def draw_knudsen(results):
    """How thin a film must be for a Knudsen number, over the pressure, and the least film of each study of that gas."""
    left = [s for s in results.studies if s.kind == "gas_bearing" and s.has("knudsen/pressure")]
    files = []
    while left:
        of = left[0]
        same = [s for s in left if all(np.array_equal(s.get(f"knudsen/{k}"), of.get(f"knudsen/{k}")) for k in ("pressure", "transition"))]
        left = [s for s in left if s not in same]
        files += draw_gas(results, same, "gas-knudsen" + f"-{len(files) + 1}" * bool(files))
    return files


def draw_gas(results, studies, what):
    study = studies[0]
    p = 1e-6 * study.get("knudsen/pressure")
    figure, axis = plt.subplots(figsize=(7.2, 4.2))
    for (name, label), colour in zip((("slip_begins", "Kn = 0.01: slip begins to show"), ("transition", "Kn = 0.1: slip has to be counted"), ("free_molecules", "Kn = 10: free molecules")), COLOURS):
        axis.loglog(p, 1e6 * study.get(f"knudsen/{name}"), color=colour, label=label)
    for s, line in zip(studies, ("--", ":", "-.", "-") * len(studies)):
        least = 1e6 * np.nanmin(s.get("curves/min_thickness"))
        axis.axhline(least, color=GREY, linestyle=line, label=f"thinnest film of the study '{s.name}', {digits(float(least), 3)} µm")
    axis.set_xlabel("pressure [MPa, absolute]")
    axis.set_ylabel("film thickness [µm]")
    return save(figure, results.whole("rarefaction of the gas"), what, "", handles=axis.get_legend_handles_labels()[0], columns=2)
