"""Campbell diagram: natural frequencies over speed, each mode followed, and its logarithmic decrement below."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from .style import BAD, GOOD, GREY, INK, ROTATION, WARN, levels, runs, save, speed_axis

LINES = {"forward": "-", "backward": (0, (4, 2)), "mixed": (0, (7, 1.6, 1.2, 1.6))}
LOW_DAMPING = 0.1  # logarithmic decrement that machines are asked to have at least


def colour_of(decrement):
    return BAD if decrement < 0 else WARN if decrement < LOW_DAMPING else GOOD


def modes_of(study):
    rows = {k: study.get(f"spectrum/{k}") for k in ("speed", "mode", "frequency", "log_decrement", "whirl")}
    for mode in np.unique(rows["mode"]):
        pick = np.nonzero(rows["mode"] == mode)[0]
        pick = pick[np.argsort(rows["speed"][pick], kind="stable")]
        whirl = rows["whirl"][pick] if rows["whirl"] is not None else np.full(len(pick), "forward")
        yield int(mode), rows["speed"][pick], rows["frequency"][pick], rows["log_decrement"][pick], whirl


def draw_lines(axis, x, y, decrement, whirl):
    """One polyline per stretch of one whirl and one class of damping, so that dashes run through."""
    worst = np.minimum(decrement[:-1], decrement[1:])
    for start, stop in runs(list(zip(whirl[:-1], map(colour_of, worst)))):
        axis.plot(x[start:stop + 1], y[start:stop + 1], color=colour_of(worst[start]), linestyle=LINES.get(whirl[start], "-"))


def label_modes(axis, x, ends):
    """Numbers of the modes at the right end, moved apart where they would overlap."""
    low, high = axis.get_ylim()
    gap, last = 0.035 * (high - low) * (2.2 if high < 2 else 1), -np.inf
    for mode, y in sorted(ends, key=lambda end: end[1]):
        if not low <= y <= high:
            continue
        last = max(y, last + gap)
        axis.annotate(str(mode), (x, last), xytext=(5, 0), textcoords="offset points", va="center", fontsize=7.5, color=GREY)


def draw(study):
    if not study.has("spectrum/speed") or len(np.unique(study.get("spectrum/speed"))) < 2:
        return []
    to_speed, speed_label, to_frequency, unit = speed_axis(study.attribute("speed_unit", "rad/s"))
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(8.2, 7.6), sharex=True, height_ratios=[2.2, 1])
    modes = list(modes_of(study))
    for mode, speed, frequency, decrement, whirl in modes:
        x, y = speed * to_speed, frequency * to_frequency
        draw_lines(top, x, y, decrement, whirl)
        draw_lines(bottom, x, decrement, decrement, whirl)
    all_speed = np.concatenate([m[1] for m in modes])
    all_frequency = np.concatenate([m[2] for m in modes])
    ends = np.array([all_speed.min(), all_speed.max()])
    top.plot(ends * to_speed, ends * to_frequency, color=INK, linewidth=1.0)
    limit = min(all_frequency.max() * 1.06, 3 * ends[1])
    side = ends[1] if ends[1] < 0.93 * limit else 0.9 * limit
    top.annotate("1\u00d7", (side * to_speed, side * to_frequency), xytext=(-8, 3), textcoords="offset points", color=INK,
                 fontsize=9, ha="right", va="bottom", bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.6})
    critical = np.atleast_1d(study.get("critical/speed", np.array([])))
    for speed, level in zip(critical, levels(critical, ends[1] - ends[0], 0.03)):
        top.plot(speed * to_speed, speed * to_frequency, "o", markersize=7, markerfacecolor="none", color=INK, zorder=5)
        top.annotate(f"{speed * to_speed:.0f}", (speed * to_speed, speed * to_frequency),
                     xytext=(7 + 24 * level, -4), textcoords="offset points", ha="left", va="top", fontsize=8, color=INK,
                     bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.6})
    top.set_xlim(ends[0] * to_speed, ends[1] * to_speed)
    top.set_ylim(0, limit * to_frequency)
    top.set_ylabel(f"natural frequency [{unit}]")
    top.set_title("Campbell diagram")
    handles = [Line2D([], [], color=GOOD, label=f"log. decrement \u2265 {LOW_DAMPING}"),
               Line2D([], [], color=WARN, label=f"0 to {LOW_DAMPING}"), Line2D([], [], color=BAD, label="unstable")]
    handles += [Line2D([], [], color=GREY, linestyle=s, label=w) for w, s in LINES.items()]
    handles += [Line2D([], [], color=INK, marker="o", markerfacecolor="none", linestyle="none", label="critical speed")]

    decrements = np.concatenate([m[3] for m in modes])
    inside = decrements[np.isfinite(decrements)]
    low, high = min(-0.1, inside.min() * 1.15), max(0.3, min(1.0, np.quantile(inside, 0.85)))
    bottom.axhspan(low, 0, color=BAD, alpha=0.07, linewidth=0)
    bottom.axhline(0, color=INK, linewidth=0.9)
    bottom.set_ylim(low, high)
    bottom.set_ylabel("logarithmic decrement")
    bottom.set_xlabel(speed_label)
    bottom.set_title("Damping (below zero: unstable)")
    label_modes(top, ends[1] * to_speed, [(m[0], m[2][-1] * to_frequency) for m in modes if m[1][-1] == ends[1]])
    label_modes(bottom, ends[1] * to_speed, [(m[0], m[3][-1]) for m in modes if m[1][-1] == ends[1]])
    return [save(figure, study, "campbell", ROTATION, handles, 7)]
