"""Unbalance response: amplitude and phase over speed (Bode)."""
import matplotlib.pyplot as plt
import numpy as np

from .style import INK, X, Y, length_unit, save, speed_axis

NOTE = ("linear response, amplitudes 0-peak; lag behind the shaft angle: x = |X| cos(angle \u2212 lag), the heavy side points along x "
        "at angle 0 and phase 0")


def peaks(speed, height):
    """Peaks of a sampled curve as (speed, height, amplification factor): by the parabola through the highest sample and its
    neighbours; N/(N2 - N1) at 0.707 of the height (API 684), None where the curve does not come down so far on both sides."""
    found = []
    for k in range(1, len(speed) - 1):
        if not (height[k] > height[k - 1] and height[k] >= height[k + 1]):
            continue
        # Newton's form of the parabola through three unequally spaced points.
        a = (height[k] - height[k - 1]) / (speed[k] - speed[k - 1])
        c = ((height[k + 1] - height[k]) / (speed[k + 1] - speed[k]) - a) / (speed[k + 1] - speed[k - 1])
        at = 0.5 * (speed[k - 1] + speed[k] - a / c)
        top = height[k - 1] + a * (at - speed[k - 1]) + c * (at - speed[k - 1]) * (at - speed[k])
        sides = []
        for step in (-1, 1):
            i = k
            while 0 <= i + step < len(speed) and height[i] > top / np.sqrt(2):
                i += step
            if height[i] > top / np.sqrt(2):
                break
            w = (height[i - step] - top / np.sqrt(2)) / (height[i - step] - height[i])
            sides.append(speed[i - step] + w * (speed[i] - speed[i - step]))
        found.append((at, top, at / (sides[1] - sides[0]) if len(sides) == 2 else None))
    return found


def draw_lag(axis, x, phase, colour):
    """Lag in degrees within one turn: the unwrapped curve and its copies a turn away, as far as they are inside."""
    lag = -np.degrees(np.unwrap(phase))
    for turn in range(int(np.floor(lag.min() / 360)), int(np.floor(lag.max() / 360)) + 1):
        axis.plot(x, lag - 360 * turn, color=colour, linewidth=1.2)
    axis.set_ylim(360, 0)
    axis.set_yticks(range(0, 361, 90))


def draw_place(amplitude_axis, phase_axis, x, data, k, scale, unit, speed_unit, title):
    major = data["semi_major"][:, k] * scale
    amplitude_axis.plot(x, major, color=INK, linewidth=1.8, label="semi-major axis")
    amplitude_axis.plot(x, data["y_amplitude"][:, k] * scale, color=Y, linewidth=1.2, label="y, vertical")
    amplitude_axis.plot(x, data["x_amplitude"][:, k] * scale, color=X, linewidth=1.2, label="x, horizontal")
    known = peaks(x, major)
    if known:
        at, top, factor = max(known, key=lambda p: p[1])
        amplitude_axis.plot(at, top, "o", color=INK, markersize=4.5)
        # Above the axes it covers nothing.
        title += f"\n{top:.3g} {unit} at {at:.0f} {speed_unit}" + (f", AF {factor:.1f}" if factor else "")
    amplitude_axis.set_ylim(0, 1.08 * max(major.max(), 1e-300))
    amplitude_axis.set_title(title, fontsize=9)
    draw_lag(phase_axis, x, data["x_phase"][:, k], X)
    draw_lag(phase_axis, x, data["y_phase"][:, k], Y)


def draw_group(study, group, names, what, speed, speed_label):
    keys = ("x_amplitude", "x_phase", "y_amplitude", "y_phase", "semi_major")
    if not study.has(*(f"{group}/{k}" for k in keys)):
        return []
    data = {k: study.get(f"{group}/{k}").reshape(len(speed), -1) for k in keys}
    scale, unit = length_unit(data["semi_major"])
    files, count = [], data["semi_major"].shape[1]
    operating = study.values.get("operating_speed")
    for number, part in enumerate(np.array_split(np.arange(count), -(-count // 5)), 1):
        figure, axes = plt.subplots(2, len(part), figsize=(max(7.2, 2.7 * len(part)), 6.0), sharex=True,
                                    sharey="row" if group == "bearings" else False, height_ratios=[1.5, 1], squeeze=False)
        for column, k in enumerate(part):
            draw_place(axes[0, column], axes[1, column], speed, data, k, scale, unit, speed_label.split("[")[1].rstrip("]"), names[k])
            axes[1, column].set_xlabel(speed_label)
            axes[1, column].set_xlim(speed[0], speed[-1])
        if operating is not None and operating.value is not None:
            for axis in axes.ravel():
                axis.axvline(operating.value, color=INK, linewidth=0.7, linestyle=":")
        if group == "bearings":
            axes[0, 0].set_ylim(0, 1.08 * scale * data["semi_major"][:, list(part)].max())
        axes[0, 0].set_ylabel(f"amplitude, 0-peak [{unit}]")
        axes[1, 0].set_ylabel("lag [deg]")
        files += save(figure, study, what if count <= 5 else f"{what}{number}", NOTE, axes[0, 0].get_legend_handles_labels()[0])
    return files


def draw(study):
    if not study.has("response/speed"):
        return []
    factor, label, _, _ = speed_axis(study.attribute("speed_unit", "rad/s"))
    speed = study.get("response/speed") * factor
    nodes = np.atleast_1d(study.get("response/node", np.array([], int)))
    files = draw_group(study, "response", [f"node {n}" for n in nodes], "response", speed, label)
    if study.has("bearings/semi_major"):
        count = study.get("bearings/semi_major").reshape(len(speed), -1).shape[1]
        files += draw_group(study, "bearings", [f"{n}, journal" for n in study.bearings(count)], "response-bearings", speed, label)
    return files
