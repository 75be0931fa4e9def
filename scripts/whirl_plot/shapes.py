"""Sag line of the shaft and mode shapes along it."""
import matplotlib.pyplot as plt
import numpy as np

from .style import COLOURS, GREY, INK, ROTATION, grid_of, length_unit, save, speed_axis


def bearing_places(study, z):
    """Axial positions and names of the bearings, as far as the study tells."""
    if study.has("bearings/z"):
        places = np.atleast_1d(study.get("bearings/z"))
    elif study.has("bearings/node"):
        node = np.atleast_1d(study.get("bearings/node")).astype(int) - 1
        if node.min() < 0 or node.max() >= len(z):
            return []
        places = z[node]
    else:
        return []
    return list(zip(places, study.bearings(len(places))))


def mark_bearings(axis, places, names=True):
    for z, name in places:
        axis.axvline(z, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=1)
        axis.plot(z, 0.0, marker="^", color=GREY, markersize=6, transform=axis.get_xaxis_transform(), clip_on=False, zorder=2)
        if names:
            axis.annotate(name, (z, 1.0), xycoords=axis.get_xaxis_transform(), ha="center", va="bottom", fontsize=7.5, color=GREY)


def draw_sag(study):
    if not study.has("nodes/z", "nodes/y"):
        return []
    z, x, y = study.get("nodes/z"), study.get("nodes/x", None), study.get("nodes/y")
    places = bearing_places(study, z)
    rows = 2 if x is not None else 1
    figure, axes = plt.subplots(rows, 1, figsize=(9.6, 2.7 * rows + 1.0), sharex=True, squeeze=False)
    for axis, values, words, colour in zip(axes[:, 0], (y, x), ("y, vertical", "x, horizontal"), COLOURS):
        scale, unit = length_unit(values)
        axis.plot(z, values * scale, color=colour, linewidth=2.0)
        mark_bearings(axis, places)
        axis.set_ylabel(f"{words} [{unit}]")
        axis.margins(x=0.01, y=0.1)
    axes[-1, 0].set_xlabel("position along the shaft z [m]")
    return [save(figure, study, "sag", f"centre line of the shaft in space, elevations included; {ROTATION}")]


def semi_major(x, y):
    """Largest distance from the centre on the ellipse Re((x, y) e^{i t})."""
    return np.sqrt(0.5 * (np.abs(x)**2 + np.abs(y)**2 + np.abs(x**2 + y**2)))


def describe(study, frequency, speed):
    """Whirl and damping of the mode of this frequency at this speed, from the spectrum."""
    if not study.has("spectrum/speed", "spectrum/frequency"):
        return ""
    speeds, frequencies = study.get("spectrum/speed"), study.get("spectrum/frequency")
    here = np.nonzero(np.abs(speeds - speeds[np.argmin(np.abs(speeds - speed))]) < 1e-9 * (1 + abs(speed)))[0]
    row = here[np.argmin(np.abs(frequencies[here] - frequency))]
    whirl, decrement = study.get("spectrum/whirl"), study.get("spectrum/log_decrement")
    words = f", {whirl[row]}" if whirl is not None else ""
    return words + (f"\nlog. decrement {decrement[row]:.3g}" if decrement is not None else "")


def draw_modes(study, shown=12):
    if not study.has("shapes/x_real", "shapes/z"):
        return []
    z = study.get("shapes/z")
    x = study.get("shapes/x_real") + 1j * study.get("shapes/x_imag")
    y = study.get("shapes/y_real") + 1j * study.get("shapes/y_imag")
    frequency = np.atleast_1d(study.get("shapes/frequency", np.zeros(len(x))))
    speed = np.broadcast_to(np.atleast_1d(study.get("shapes/speed", 0.0)), len(x))
    to_speed, speed_label, to_frequency, unit = speed_axis(study.attribute("speed_unit", "rad/s"))
    count = min(shown, len(x))
    figure, axes, grid = grid_of(count, height=1.95, sharex=True, sharey=True)
    for k, axis in enumerate(axes):
        size = semi_major(x[k], y[k])
        top = int(np.argmax(size))
        # Seen at the moment when the node that moves most is farthest out.
        turn = np.exp(-0.5j * np.angle(x[k, top]**2 + y[k, top]**2)) / size[top]
        xs, ys, envelope = (x[k] * turn).real, (y[k] * turn).real, size / size[top]
        side = 1 if abs(ys[top]) < abs(xs[top]) else np.sign(ys[top]) or 1
        axis.fill_between(z, -envelope, envelope, color="#eef2f6", linewidth=0, zorder=0)
        axis.axhline(0, color=GREY, linewidth=0.6)
        axis.plot(z, side * ys, color=COLOURS[0], linewidth=1.5, label="y, vertical")
        axis.plot(z, side * xs, color=COLOURS[1], linewidth=1.5, label="x, horizontal")
        mark_bearings(axis, bearing_places(study, z), names=False)
        axis.set_title(f"{frequency[k] * to_frequency:.2f} {unit}{describe(study, frequency[k], speed[k])}", fontsize=8.5)
        axis.set_ylim(-1.08, 1.08)
        axis.set_yticks([-1, 0, 1])
        axis.set_xlim(z[0], z[-1])
    for column in range(grid.shape[1]):
        visible = [a for a in grid[:, column] if a.get_visible()]
        visible[-1].set_xlabel("z [m]")
        visible[-1].tick_params(labelbottom=True)
    at = f"{speed_label.split(' [')[0]} {speed[0] * to_speed:.0f} {study.attribute('speed_unit', 'rad/s')}"
    return [save(figure, study, "shapes", f"at {at}; shaded: largest excursion over a turn; scaled to 1 where it is largest",
                 axes[0].get_legend_handles_labels()[0])]
