"""Unbalance response: amplitude and phase over speed (Bode)."""
import matplotlib.pyplot as plt
import numpy as np

from .style import COLOURS, INK, length_unit, save, speed_axis

NOTE = "linear response; amplitudes 0-peak; phase relative to the shaft angle"


def unwrapped(phase):
    """Degrees without jumps, starting between -180 and 180."""
    phase = np.degrees(np.unwrap(phase, axis=0))
    return phase - 360 * np.round(phase[0] / 360)


def draw_place(amplitude_axis, phase_axis, x, data, k, scale, unit, speed_unit, title):
    major = data["semi_major"][:, k] * scale
    amplitude_axis.fill_between(x, 0, major, color=COLOURS[0], alpha=0.07, linewidth=0)
    amplitude_axis.plot(x, major, color=INK, linewidth=1.8, label="semi-major axis")
    amplitude_axis.plot(x, data["x_amplitude"][:, k] * scale, color=COLOURS[1], linewidth=1.2, label="x, horizontal")
    amplitude_axis.plot(x, data["y_amplitude"][:, k] * scale, color=COLOURS[0], linewidth=1.2, label="y, vertical")
    top = int(np.argmax(major))
    if 0 < top < len(x) - 1:
        amplitude_axis.plot(x[top], major[top], "o", color=INK, markersize=4.5)
        right = x[top] > 0.5 * (x[-1] + x[0])
        amplitude_axis.annotate(f"{major[top]:.3g} {unit}\n{x[top]:.0f} {speed_unit}", (x[top], major[top]), fontsize=8,
                                xytext=(-7 if right else 7, 5), textcoords="offset points", va="top",
                                ha="right" if right else "left")
    amplitude_axis.set_ylim(0, 1.12 * max(major.max(), 1e-300))
    amplitude_axis.set_title(title)
    phase_axis.plot(x, unwrapped(data["x_phase"][:, k]), color=COLOURS[1], linewidth=1.2)
    phase_axis.plot(x, unwrapped(data["y_phase"][:, k]), color=COLOURS[0], linewidth=1.2)
    span = np.ptp(np.concatenate([line.get_ydata() for line in phase_axis.lines]))
    phase_axis.yaxis.set_major_locator(plt.MultipleLocator(90 if span < 600 else 180 if span < 1200 else 360))
    phase_axis.margins(y=0.08)


def draw_group(study, group, names, what, speed, speed_label):
    keys = ("x_amplitude", "x_phase", "y_amplitude", "y_phase", "semi_major")
    if not study.has(*(f"{group}/{k}" for k in keys)):
        return []
    data = {k: study.get(f"{group}/{k}").reshape(len(speed), -1) for k in keys}
    scale, unit = length_unit(data["semi_major"])
    files, count = [], data["semi_major"].shape[1]
    for number, part in enumerate(np.array_split(np.arange(count), -(-count // 5)), 1):
        figure, axes = plt.subplots(2, len(part), figsize=(max(7.2, 2.6 * len(part)), 5.8), sharex=True,
                                    sharey="row" if group == "bearings" else False, height_ratios=[1.5, 1], squeeze=False)
        for column, k in enumerate(part):
            draw_place(axes[0, column], axes[1, column], speed, data, k, scale, unit, speed_label.split("[")[1].rstrip("]"), names[k])
            axes[1, column].set_xlabel(speed_label)
            axes[1, column].set_xlim(speed[0], speed[-1])
        if group == "bearings":
            axes[0, 0].set_ylim(0, 1.12 * scale * data["semi_major"][:, list(part)].max())
        axes[0, 0].set_ylabel(f"amplitude, 0-peak [{unit}]")
        axes[1, 0].set_ylabel("phase [deg]")
        files.append(save(figure, study, what if count <= 5 else f"{what}{number}", NOTE,
                          axes[0, 0].get_legend_handles_labels()[0]))
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
