"""Unwrapped oil films: pressure and thickness of every pad."""
import matplotlib.pyplot as plt
import numpy as np

from .style import BAD, GREY, INK, length_unit, save


def pads_of(study):
    """Bearing -> [(pad name, group path)], pads in the order of their numbers."""
    films = study.group.get("films")
    found = {}
    for bearing in films or {}:
        pads = [p for p in films[bearing] if "theta" in films[bearing][p] and "pressure" in films[bearing][p]]
        pads.sort(key=lambda p: (len(p), p))
        if pads:
            found[bearing] = [(p, f"films/{bearing}/{p}") for p in pads]
    return found


def panel(figure, axis, theta, z, values, cmap, label, ink):
    mesh = axis.pcolormesh(theta, z, values.T, cmap=cmap, shading="gouraud" if min(values.shape) > 1 else "nearest", rasterized=True)
    if np.ptp(values) > 0 and min(values.shape) > 1:
        levels = values.min() + np.ptp(values) * np.linspace(0.05, 0.95, 10)
        axis.contour(theta, z, values.T, levels, colors=ink, linewidths=0.5, alpha=0.6)
    axis.grid(False)
    bar = figure.colorbar(mesh, ax=axis, pad=0.015, label=label)
    bar.outline.set_visible(False)
    axis.set_xlabel("\u03b8 [deg], from +x counter-clockwise; the shaft moves to the right \u2192", fontsize=8.5)
    axis.set_ylabel("z [mm]")


def draw(study):
    files = []
    for bearing, pads in pads_of(study).items():
        warm = all(study.has(f"{path}/temperature") for _, path in pads)
        columns = 3 if warm else 2
        figure, axes = plt.subplots(len(pads), columns, figsize=(5.6 * columns, 2.9 * len(pads) + 1.0), squeeze=False)
        known = [study.get(f"{path}/thickness").ravel() for _, path in pads if study.has(f"{path}/thickness")]
        scale, unit = length_unit(np.concatenate(known or [np.zeros(1)]))
        for row, (name, path) in enumerate(pads):
            theta, z = np.degrees(study.get(f"{path}/theta")), study.get(f"{path}/z") * 1e3
            pressure = study.get(f"{path}/pressure") / 1e6
            left, right = axes[row][:2]
            panel(figure, left, theta, z, pressure, "YlOrRd", "pressure [MPa]", "#5a1a00")
            i, j = np.unravel_index(np.argmax(pressure), pressure.shape)
            if pressure[i, j] > 0:
                left.plot(theta[i], z[j], "+", color="black", markersize=8)
            left.set_title(f"{name}: pressure, largest {pressure.max():.4g} MPa at {theta[i]:.1f} deg")
            if warm:
                celsius, last = study.get(f"{path}/temperature") - 273.15, axes[row][2]
                panel(figure, last, theta, z, celsius, "inferno", "mean temperature [\u00b0C]", "white")
                i, j = np.unravel_index(np.argmax(celsius), celsius.shape)
                last.set_title(f"{name}: temperature, highest {celsius.max():.4g} \u00b0C at {theta[i]:.1f} deg")
            if not study.has(f"{path}/thickness"):
                right.set_visible(False)
                continue
            thickness = study.get(f"{path}/thickness") * scale
            panel(figure, right, theta, z, thickness, "viridis_r", f"thickness [{unit}]", "white")
            i, j = np.unravel_index(np.argmin(thickness), thickness.shape)
            if np.ptp(thickness[i]) < 1e-9 * thickness[i, j]:  # aligned: the whole line is thinnest
                j = len(z) // 2
            right.plot(theta[i], z[j], "+", color="white", markersize=8)
            right.set_title(f"{name}: film thickness, smallest {thickness.min():.4g} {unit} at {theta[i]:.1f} deg")
        files += save(figure, study, f"film-{bearing}", f"bearing {bearing}, film unwrapped; + largest pressure, smallest thickness")
    return files
