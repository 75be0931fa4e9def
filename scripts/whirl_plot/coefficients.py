"""Stiffness and damping of one film: over the frequency of the motion, or over the speed."""
import matplotlib.pyplot as plt
import numpy as np

from .style import COLOURS, save

TRANSLATIONS, TILTS = ("x", "y"), ("tilt_x", "tilt_y")


def name(i, j):
    return i + j if len(i + j) == 2 else f"{i}_{j}"


def entries(study):
    """Names of the entries of each block that a study has, by title."""
    blocks = {"of displacements": [name(i, j) for i in TRANSLATIONS for j in TRANSLATIONS], "of slopes": [name(i, j) for i in TILTS for j in TILTS]}
    return {title: names for title, names in blocks.items() if study.has(*[f"coefficients/k_{n}" for n in names])}


def against(study):
    """What the curves go over, its name, whether its axis is logarithmic, and which part of [speed][frequency] that is."""
    speeds, ratios = study.get("coefficients/speed"), study.get("coefficients/ratio")
    if len(ratios) > 1:
        return ratios, r"frequency of the motion over that of the shaft, $\omega/\Omega$", len(ratios) > 2 and ratios.max() > 8 * ratios.min(), (0, slice(None))
    return speeds, "speed [rad/s]", False, (slice(None), 0)


def draw(study):
    """All entries of K and B with their error bars; of more than one speed at several frequencies those of the first."""
    if not study.has("coefficients/k_xx", "coefficients/speed", "coefficients/ratio") or not entries(study):
        return []
    over, label, logarithmic, part = against(study)
    if len(over) < 2:
        return []
    order = np.argsort(over)
    blocks = entries(study)
    figure, axes = plt.subplots(len(blocks), 2, figsize=(10.8, 3.5 * len(blocks)), squeeze=False, sharex=True)
    for row, (title, names) in zip(axes, blocks.items()):
        for axis, (letter, what) in zip(row, (("k", "stiffness"), ("b", "damping"))):
            for n, colour in zip(names, COLOURS):
                values = study.get(f"coefficients/{letter}_{n}")[part][order]
                bars = study.get(f"coefficients/{letter}_{n}_uncertainty")[part][order] if study.has(f"coefficients/{letter}_{n}_uncertainty") else None
                axis.errorbar(over[order], values, bars, color=colour, marker="o", markersize=3.5, linewidth=1.2, capsize=2,
                              label=n.replace("tilt_", "").replace("_", "") if title == "of displacements" else n.replace("tilt_", "").replace("_", " by "))
            unit = study.group[f"coefficients/{letter}_{names[0]}"].attrs["unit"]
            axis.set_ylabel(f"{what} [{unit}]")
            axis.set_title(f"{what} {title}", fontsize=9)
            axis.axhline(0, color="0.7", linewidth=0.6, zorder=0)
            if logarithmic:
                axis.set_xscale("log")
            axis.legend(fontsize=7.5, ncols=2)
    for axis in axes[-1]:
        axis.set_xlabel(label)
    speeds = study.get("coefficients/speed")
    note = f"force against motion, row by column; bars: estimated error from the film mesh{f'; at {speeds[0]:.4g} rad/s' if part[0] == 0 else ''}"
    return save(figure, study, "coefficients", note)
