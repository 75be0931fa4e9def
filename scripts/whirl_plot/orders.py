"""Spectra over the course of a motion or a run-up: waterfalls, and amplitude and phase of orders of the speed."""
import numpy as np
from matplotlib.collections import LineCollection

from .canvas import Line2D, plt
from .style import COLOURS, GREY, INK, ROTATION, save, span_of, speed_axis
from .units import digits, scale_of

MOST = 6  # places on one picture


def places(study, table):
    """(index, name) of the places that differ: those of a rigid rotor's one node move alike."""
    names = [str(n) for n in np.atleast_1d(study.get(f"{table}/place"))]
    values = study.get(f"{table}/x" if table == "waterfall" else f"{table}/x_amplitude")
    kept = []
    for k in range(len(names)):
        if not any(np.array_equal(values[..., k], values[..., other]) for other in kept):
            kept.append(k)
    return [(k, names[k]) for k in kept[:MOST]]


def over(study, table):
    """What pieces are drawn over: the speed where it changes, else revolutions. Values, label, and speeds in rad/s."""
    unit = study.attribute("speed_unit", "rad/s")
    speed = study.get(f"{table}/speed")
    per_si = speed_axis(unit)[0]
    if np.ptp(speed) > 1e-9 * np.abs(speed).max():
        return speed, f"speed [{unit}]", speed / per_si
    return study.get(f"{table}/revolution"), "revolutions", speed / per_si


def draw_waterfall(study):
    """Spectra one behind the other, each at the height of its speed; orders of the speed as rays."""
    if not study.has("waterfall/y", "waterfall/order"):
        return []
    shown = places(study, "waterfall")
    at, label, speed = over(study, "waterfall")
    order, hertz = study.get("waterfall/order"), speed[:, None] * study.get("waterfall/order")[None, :] / (2 * np.pi)
    values = study.get("waterfall/y")
    figure, axes = plt.subplots(1, len(shown), figsize=(max(4.4, 3.6 * len(shown)), 5.2), squeeze=False, sharey=True)
    span = np.ptp(at) or 1.0
    for axis, (b, name) in zip(axes[0], shown):
        all_rows = values[:, 1:, b]
        factor, unit = scale_of("m" if study.get("places/name") is None else "1", float(all_rows.max()))
        height = 4.5 * span / len(at) / all_rows.max()
        for k in range(len(at) - 1, -1, -1):
            line = at[k] + height * all_rows[k]
            axis.fill_between(hertz[k, 1:], at[k], line, color="white", linewidth=0, zorder=len(at) - k)
            axis.plot(hertz[k, 1:], line, color=INK, linewidth=0.6, zorder=len(at) - k)
        rays = [np.column_stack([o * speed / (2 * np.pi), at]) for o in range(1, int(order[-1]) + 1)]
        axis.add_collection(LineCollection(rays, colors=COLOURS[0], linewidths=0.7, alpha=0.6, zorder=2 * len(at)))
        axis.set_xlim(*span_of(0, hertz[:, -1].max()))
        axis.set_xlabel("frequency [Hz]")
        axis.set_title(f"{name}, highest {digits(float(all_rows.max() * factor), 3)} {unit}")
    axes[0, 0].set_ylabel(label)
    handles = [Line2D([], [], color=COLOURS[0], linewidth=0.7, label="whole orders of the speed")]
    return save(figure, study, "waterfall", f"amplitudes of y, 0-peak, each panel by its highest; {ROTATION}", handles)


def draw_orders(study):
    """Amplitude of every order that was tracked, and the phase of those that are whole: the others' counts from where it began."""
    if not study.has("orders/x_amplitude", "orders/order"):
        return []
    shown = places(study, "orders")
    at, label, _ = over(study, "orders")
    order = np.atleast_1d(study.get("orders/order"))
    amplitude, phase = study.get("orders/y_amplitude"), study.get("orders/y_phase")
    factor, unit = scale_of("m" if study.get("places/name") is None else "1", float(amplitude[:, :, [b for b, _ in shown]].max()))
    figure, axes = plt.subplots(2, len(shown), figsize=(max(4.4, 3.4 * len(shown)), 5.4), squeeze=False, sharex=True,
                                gridspec_kw={"height_ratios": [2, 1]})
    for column, (b, name) in zip(axes.T, shown):
        for j, o in enumerate(order):
            column[0].plot(at, amplitude[:, j, b] * factor, color=COLOURS[j % len(COLOURS)], linewidth=1.2)
            if float(o).is_integer():
                turned = np.degrees(np.unwrap(phase[:, j, b]))
                turned -= 360 * np.round(turned.mean() / 360)
                column[1].plot(at, turned, color=COLOURS[j % len(COLOURS)], linewidth=1.2)
        column[0].set_title(name)
        column[0].set_ylim(bottom=0)
        column[1].axhline(0, color=GREY, linewidth=0.6)
        column[1].set_xlabel(label)
    axes[0, 0].set_ylabel(f"amplitude of y, 0-peak [{unit}]")
    axes[1, 0].set_ylabel("phase [deg]")
    handles = [Line2D([], [], color=COLOURS[j % len(COLOURS)], label=f"order {o:g}") for j, o in enumerate(order)]
    return save(figure, study, "orders", f"phase ahead of the order times the shaft angle, of whole orders; {ROTATION}", handles)
