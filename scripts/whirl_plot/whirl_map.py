"""Whirl map: which way every node of the shaft turns in each mode, over the speed and along the shaft."""
import numpy as np

from .campbell import modes_of, with_either
from .shapes import bearing_places
from .style import GREY, INK, grid_of, save, speed_axis

MOST = 12  # modes in one picture, those of lowest frequency


def is_plain(turning, whirl):
    """Whether all nodes of a mode turn alike at all speeds."""
    return np.all(whirl == "either") or np.ptp(turning[np.isfinite(turning)]) < 0.02 if np.isfinite(turning).any() else True


def draw(study):
    """A panel for each mode: z upwards over the speed, blue where the node turns backward, red where it turns forward."""
    if not study.has("whirl_map/turning", "spectrum/mode") or len(np.unique(study.get("spectrum/speed"))) < 3:  # two speeds are no course
        return []
    z, turning = study.get("whirl_map/z"), study.get("whirl_map/turning")
    number, at = study.get("spectrum/mode"), study.get("spectrum/speed")
    to_speed, speed_label, to_frequency, unit = speed_axis(study.attribute("speed_unit", "rad/s"))
    modes = sorted((m for m in modes_of(study) if len(m[1]) > 1), key=lambda m: m[2][-1])[:MOST]
    # On circles every node turns forward or backward all along: a plain rectangle, which the title says better.
    modes = [m for m in modes if not is_plain(turning[number == m[0]], m[4])]
    if not modes:
        return []
    figure, axes, _ = grid_of(len(modes), 3.0, 2.1)
    image = None
    for axis, (mode, speed, frequency, _, whirl) in zip(axes, modes):
        rows = np.nonzero(number == mode)[0]
        rows = rows[np.argsort(at[rows], kind="stable")]
        turns = np.where((whirl == "either")[:, None], np.nan, turning[rows])
        image = axis.pcolormesh(speed * to_speed, z, turns.T, cmap="RdBu_r", vmin=-1, vmax=1, shading="nearest", rasterized=True)
        for place, _ in bearing_places(study, z):
            axis.axhline(place, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)))
        word = whirl[-1] if whirl[0] == whirl[-1] else f"{whirl[0]} to {whirl[-1]}"
        axis.set_title(f"{mode}: {word}\n{frequency[0] * to_frequency:.4g} to {frequency[-1] * to_frequency:.4g} {unit}", fontsize=8)
        axis.grid(False)
    for axis in axes[-3:]:
        axis.set_xlabel(speed_label)
    axes[0].set_ylabel("z [m]", color=INK)
    figure.colorbar(image, ax=list(axes), label="backward circle \u2212 line \u2212 forward circle", shrink=0.8)
    words = "colour: 2ab/(a\u00b2+b\u00b2) of the node's ellipse with half-axes a and b, negative backward; broken lines: bearings"
    return save(figure, study, "whirl-map", with_either(words, [m[4] for m in modes]))
