"""Unwrapped oil films: pressure, thickness, temperature and fill of every pad."""
import numpy as np

from .canvas import plt
from .style import GREY, ON_PRESSURE, PRESSURE, key, length_unit, save
from .thd_film import Unwrapped, cavity_of
from .thd_maps import angle_ticks, field, hatch_cavity
from .units import scale_of


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


def panel(figure, axis, pad, values, cmap, label, ink, jumps=False):
    """A field [around, along] of a pad. One that jumps is not interpolated between film and cavity, and has no contours in it."""
    theta, z = np.degrees(pad.theta), pad.z * 1e3
    if min(values.shape) > 1:
        field(figure, axis, pad, values.T, cmap, label, ink, jumps)
    else:
        key(axis, axis.pcolormesh(theta, z, values.T, cmap=cmap, shading="nearest", rasterized=True), label)
        axis.grid(False)
    hatch_cavity(axis, pad, GREY)
    if len(z) > 1:
        axis.set_xlim(theta[0], theta[-1])
        axis.set_ylim(z[0], z[-1])
    angle_ticks(axis, theta[0], theta[-1])
    axis.set_xlabel("\u03b8 [deg], from +x counter-clockwise; the shaft moves to the right \u2192", fontsize=8.5)
    axis.set_ylabel("z [mm]")


def draw(study):
    files = []
    for bearing, pads in pads_of(study).items():
        warm, partly = (all(study.has(f"{path}/{name}") for _, path in pads) for name in ("temperature", "fill"))
        columns = 2 + warm + partly
        figure, axes = plt.subplots(len(pads), columns, figsize=(5.6 * columns, 2.9 * len(pads) + 1.0), squeeze=False)
        known = [study.get(f"{path}/thickness").ravel() for _, path in pads if study.has(f"{path}/thickness")]
        scale, unit = length_unit(np.concatenate(known or [np.zeros(1)]))
        pascal, in_unit = scale_of("Pa", max(np.max(study.get(f"{path}/pressure")) for _, path in pads))
        ruptured = False
        for row, (name, path) in enumerate(pads):
            pressure, fill = study.get(f"{path}/pressure") * pascal, study.get(f"{path}/fill", None)
            pad = Unwrapped(study.get(f"{path}/theta"), study.get(f"{path}/z"), cavity_of(pressure.T, None if fill is None else fill.T))
            ruptured = ruptured or pad.cavity.any()
            theta, z = np.degrees(pad.theta), pad.z * 1e3
            left, right = axes[row][:2]
            panel(figure, left, pad, pressure, PRESSURE, f"pressure [{in_unit}]", ON_PRESSURE)
            i, j = np.unravel_index(np.argmax(pressure), pressure.shape)
            if pressure[i, j] > 0:
                left.plot(theta[i], z[j], "+", color="black", markersize=8)
            left.set_title(f"{name}: pressure, largest {pressure.max():.4g} {in_unit} at {theta[i] % 360:.1f} deg")
            if warm:
                celsius = study.get(f"{path}/temperature") - 273.15
                panel(figure, axes[row][2], pad, celsius, "inferno", "mean temperature [\u00b0C]", "white", jumps=True)
                i, j = np.unravel_index(np.argmax(celsius), celsius.shape)
                axes[row][2].set_title(f"{name}: temperature, highest {celsius.max():.4g} \u00b0C at {theta[i] % 360:.1f} deg")
            if partly:
                # An edge holds what would enter there; what is carried past it comes from inside.
                fill = np.where(pad.cavity.T, np.pad(fill[1:-1, 1:-1], 1, mode="edge"), fill) if pad.cavity.any() else fill
                panel(figure, axes[row][-1], pad, fill, "Blues", "share [1]", "white", jumps=True)
                axes[row][-1].set_title(f"{name}: share of the gap that is full, least {fill.min():.3g}")
            if not study.has(f"{path}/thickness"):
                right.set_visible(False)
                continue
            thickness = study.get(f"{path}/thickness") * scale
            panel(figure, right, pad, thickness, "viridis_r", f"thickness [{unit}]", "white")
            i, j = np.unravel_index(np.argmin(thickness), thickness.shape)
            if np.ptp(thickness[i]) < 1e-9 * thickness[i, j]:  # aligned: the whole line is thinnest
                j = len(z) // 2
            right.plot(theta[i], z[j], "+", color="white", markersize=8)
            right.set_title(f"{name}: film thickness, smallest {thickness.min():.4g} {unit} at {theta[i] % 360:.1f} deg")
        hatched = "; hatched: the film is ruptured, and the gap is not full" if partly else "; hatched: no pressure, the film is ruptured or its suction cut off"
        files += save(figure, study, f"film-{bearing}", f"bearing {bearing}, film unwrapped; + largest pressure and smallest thickness of the nodes" + hatched * bool(ruptured))
    return files
