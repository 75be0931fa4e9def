"""Campbell diagram: natural frequencies over speed, each mode followed, and its logarithmic decrement below."""
import numpy as np

from .canvas import Line2D, plt
from .style import BAD, GOOD, GREY, INK, LIGHT, ROTATION, UNDAMPED, WARN, levels, mark_service, runs, save, speed_axis

LINES = {"forward": "-", "backward": (0, (4, 2)), "mixed": (0, (7, 1.6, 1.2, 1.6)), "planar": (0, (1.2, 1.4)), "either": (0, (4, 1.4, 1.2, 1.4, 1.2, 1.4))}
EITHER = "either: equal modes, any combination of which is a mode"
LOW_DAMPING = 0.1  # logarithmic decrement that machines are asked to have at least
OVERDAMPED = 3.0  # log. decrement of modes that lose 95 % of their amplitude in a turn


def colour_of(decrement):
    return BAD if decrement < 0 else UNDAMPED if decrement == 0 else WARN if decrement < LOW_DAMPING else GOOD


def modes_of(study):
    """(number, speed, frequency, decrement, whirl) of each mode over the speeds at which it is there, ascending."""
    rows = {k: study.get(f"spectrum/{k}") for k in ("speed", "mode", "frequency", "log_decrement", "whirl")}
    for mode in np.unique(rows["mode"]):
        pick = np.nonzero(rows["mode"] == mode)[0]
        pick = pick[np.argsort(rows["speed"][pick], kind="stable")]
        whirl = rows["whirl"][pick] if rows["whirl"] is not None else np.full(len(pick), "forward")
        yield int(mode), rows["speed"][pick], rows["frequency"][pick], rows["log_decrement"][pick], whirl


def vibrates(study):
    """Whether there is a frequency over several speeds: a machine that only creeps has no Campbell diagram."""
    return study.has("spectrum/speed") and len(np.unique(study.get("spectrum/speed"))) > 1 and bool(np.any(study.get("spectrum/frequency") > 0))


def range_of(decrements):
    """What an axis of logarithmic decrements shows: most of them, and what grows."""
    inside = decrements[np.isfinite(decrements)]
    return (min(-0.1, inside.min() * 1.15), max(0.3, min(1.0, np.quantile(inside, 0.85)))) if len(inside) else (-0.1, 0.3)


def with_either(words, whirls):
    """The words below a picture, with those for equal modes where one of these is shown."""
    return f"{words}; {EITHER}" if any("either" in whirl for whirl in whirls) else words


def crowded_out(study):
    """(speed, highest frequency) where a study kept as many modes as it keeps anywhere: those above were left out there, as an
    overdamped mode that comes down pushes the highest off the list."""
    speed, frequency = study.get("spectrum/speed"), study.get("spectrum/frequency")
    every, count = np.unique(speed, return_counts=True)
    return {s: frequency[speed == s].max() for s in every[count == count.max()]}


def stretches(speed, frequency, every, full):
    """(start, stop) of the runs of speeds over which a mode is drawn: not over speeds at which it was not found, but for those
    where a full list ends below it."""
    index = np.searchsorted(every, speed)
    start = 0
    for k in range(1, len(index) + 1):
        if k < len(index):
            missing = every[index[k - 1] + 1:index[k]]
            between = np.interp(missing, speed[k - 1:k + 1], frequency[k - 1:k + 1])
            if all(full.get(s, np.inf) <= f for s, f in zip(missing, between)):
                continue
        yield start, k
        start = k


def senses(whirl):
    """The sense of a track between each speed and the next: where equal modes part, each has the one that it has from there on."""
    return [after if before == "either" else before for before, after in zip(whirl, whirl[1:])]


def ranges_of(study, mode):
    """(from, to, begins, ends) of the ranges of speed over which a mode grows; the last two say whether an end was located."""
    rows = [study.get(f"unstable/{k}") for k in ("mode", "from", "to", "begins", "ends")]
    return [] if any(row is None for row in rows) else [row[1:] for row in zip(*map(np.atleast_1d, rows)) if int(row[0]) == mode]


def with_borders(ranges, speed, frequency, decrement, whirl):
    """A track with the points put in where it was located to begin or to cease to grow, and whether a point is one of them."""
    border = np.zeros(len(speed), bool)
    for at in sorted({at for low, high, begins, ends in ranges for at, there in ((low, begins), (high, ends)) if there}):
        k = int(np.searchsorted(speed, at))
        if 0 < k < len(speed) and speed[k] != at and speed[k - 1] != at:
            speed, frequency, decrement, whirl, border = (np.insert(column, k, value) for column, value in (
                (speed, at), (frequency, np.interp(at, speed, frequency)), (decrement, 0.0), (whirl, whirl[k - 1]), (border, True)))
    return speed, frequency, decrement, whirl, border


def between(speed, decrement, border, ranges):
    """Decrement that colours the line from each point to the next: the smaller one, below zero where the middle lies in a range over which
    the mode grows. Where none was located, a track grows between two of its speeds that grow."""
    a, b, middle = decrement[:-1], decrement[1:], (speed[:-1] + speed[1:]) / 2
    worst = np.minimum(a, b)
    worst = np.where((a < 0) != (b < 0), np.maximum(a, b), worst)
    # Beside a located border, where the decrement is zero, a track is damped.
    worst = np.where(border[:-1] | border[1:], np.maximum(np.maximum(a, b), np.finfo(float).tiny), worst)
    grows = np.any([(low < middle) & (middle < high) for low, high, *_ in ranges], axis=0) if ranges else np.zeros(len(middle), bool)
    return np.where(grows, -1.0, worst)


def draw_lines(axis, x, y, decrement, whirl, worst):
    """One polyline per stretch of one whirl and one class of damping, so that dashes run through."""
    if len(x) == 1:
        if not decrement[0] > OVERDAMPED:  # what does not vibrate needs no dot of its own
            axis.plot(x, y, ".", color=colour_of(decrement[0]), markersize=3)
        return
    sense = senses(whirl)
    for start, stop in runs(list(zip(sense, map(colour_of, worst), worst > OVERDAMPED))):
        heavy = worst[start] > OVERDAMPED
        axis.plot(x[start:stop + 1], y[start:stop + 1], color=LIGHT if heavy else colour_of(worst[start]),
                  linewidth=1.0 if heavy else 1.6, linestyle=LINES.get(sense[start], "-"), zorder=1.5 if heavy else 2)


def label_modes(axis, x, ends):
    """Numbers of the modes outside the right end, moved apart where they would overlap; those beyond the axis have none."""
    low, high = axis.get_ylim()
    gap, last = 0.035 * (high - low) * (2.2 if high < 2 else 1), -np.inf
    for mode, y in sorted(ends, key=lambda end: end[1]):
        if not low <= y <= high:
            continue
        last = max(y, last + gap)
        axis.annotate(str(mode), (x, last), xytext=(5, 0), textcoords="offset points", va="center", fontsize=7.5, color=GREY)


def free_place(axis, modes, ends, limit, times):
    """(speed, frequency) beside the line `times` x speed where its label is farthest from all modes and lines."""
    inches = axis.figure.get_size_inches() * axis.get_position().size
    scale = inches / np.array([ends[1] - ends[0], limit])

    def dense(speed, frequency):
        s = np.linspace(speed[0], speed[-1], 200)
        return np.column_stack([s - ends[0], np.interp(s, speed, frequency)]) * scale

    curves = np.concatenate([dense(m[1], m[2]) for m in modes] + [dense(ends, other * ends) for other in (1, 2)])
    along = np.array([1.0, times]) * scale
    normal = np.array([-along[1], along[0]]) / np.hypot(*along)
    line = np.linspace(ends[0], min(ends[1], limit / times), 82)[1:-1]
    places = np.column_stack([line - ends[0], times * line]) * scale + 0.16 * normal
    inside = np.all((places > 0.15) & (places < inches - 0.1), axis=1)
    if not inside.any():
        return line[-1], times * line[-1]
    clear = np.array([np.hypot(*(curves - place).T).min() for place in places])
    best = places[int(np.argmax(np.where(inside, clear, -1)))] / scale
    return best[0] + ends[0], best[1]


def draw_damping(axis, modes, end, to_speed):
    """What the panel of the decrements shows beside its lines."""
    low, high = range_of(np.concatenate([m[3] for m in modes]))
    axis.axhspan(low, 0, color=BAD, alpha=0.07, linewidth=0)
    axis.axhline(0, color=INK, linewidth=0.9)
    axis.set_ylim(low, high)
    axis.set_ylabel("logarithmic decrement")
    hidden = sum(1 for m in modes if np.all(m[3] > high))
    axis.set_title("Damping, unstable below zero" + (f"; {hidden} mode{'s are' if hidden > 1 else ' is'} damped more than shown" if hidden else ""))
    label_modes(axis, end * to_speed, [(m[0], m[3][-1]) for m in modes if m[1][-1] == end])


def draw(study):
    if not vibrates(study):
        return []
    to_speed, speed_label, to_frequency, unit = speed_axis(study.attribute("speed_unit", "rad/s"))
    modes = list(modes_of(study))
    damped_at_all = any(np.any(m[3] != 0) for m in modes)
    figure, axes = plt.subplots(1 + damped_at_all, 1, figsize=(8.6, 8.2 if damped_at_all else 6.0), sharex=True, squeeze=False,
                                height_ratios=[2.2, 1][:1 + damped_at_all])
    top, bottom = axes[0, 0], axes[1, 0] if damped_at_all else None
    every, full = np.unique(study.get("spectrum/speed")), crowded_out(study)
    for mode, speed, frequency, decrement, whirl in modes:
        for a, b in stretches(speed, frequency, every, full):
            ranges = ranges_of(study, mode)
            at, height, damped, sense, border = with_borders(ranges, *(column[a:b] for column in (speed, frequency, decrement, whirl)))
            worst = between(at, damped, border, ranges)
            draw_lines(top, at * to_speed, height * to_frequency, damped, sense, worst)
            if bottom:
                draw_lines(bottom, at * to_speed, damped, damped, sense, worst)
    all_frequency = np.concatenate([m[2] for m in modes])
    ends = np.array([every[0], every[-1]])
    limit = min(all_frequency.max() * 1.06, 3 * ends[1])
    for times in (1, 2):
        top.plot(ends * to_speed, times * ends * to_frequency, color=INK, linewidth=1.0 if times == 1 else 0.7)
        side, height = free_place(top, modes, ends, limit, times)
        top.annotate(f"{times}\u00d7", (side * to_speed, height * to_frequency), color=INK, fontsize=9, ha="center", va="center")
    crossed = np.atleast_1d(study.get("critical/speed", np.array([])))
    damping = study.get("critical/log_decrement")
    # By API 684 an amplification factor pi/delta below 2.5 is no critical speed.
    heavy = np.zeros(len(crossed), bool) if damping is None else np.pi / np.maximum(np.atleast_1d(damping), 1e-9) < 2.5
    for speed in crossed[heavy]:
        top.plot(speed * to_speed, speed * to_frequency, "o", markersize=4, markerfacecolor="none", color=GREY, zorder=5)
    critical = crossed[~heavy]
    for speed in critical:
        top.plot(speed * to_speed, speed * to_frequency, "o", markersize=7, markerfacecolor="none", color=INK, zorder=5)
    # Their speeds above the axes, where they cover nothing.
    for speed, level in zip(critical, levels(critical, ends[1] - ends[0], 0.045)):
        top.annotate(f"{speed * to_speed:.0f}", (speed * to_speed, 1.0), xycoords=top.get_xaxis_transform(), xytext=(0, 2 + 9 * level),
                     textcoords="offset points", ha="center", va="bottom", fontsize=7.5, color=INK)
        top.axvline(speed * to_speed, ymax=speed / limit, color=INK, linewidth=0.4, linestyle=":")
    top.set_xlim(ends[0] * to_speed, ends[1] * to_speed)
    top.set_ylim(0, limit * to_frequency)
    top.set_ylabel(f"natural frequency [{unit}]")
    top.set_title("Campbell diagram, critical speeds above" if len(critical) else "Campbell diagram",
                  pad=6 + (12 + 9 * max(levels(critical, ends[1] - ends[0], 0.045), default=0)) * bool(len(critical)))
    handles = [Line2D([], [], color=GOOD, label=f"log. decrement \u2265 {LOW_DAMPING}"),
               Line2D([], [], color=WARN, label=f"0 to {LOW_DAMPING}"), Line2D([], [], color=BAD, label="unstable")]
    if not damped_at_all:
        handles = []
    if any(np.any(m[3] == 0) for m in modes):
        handles.append(Line2D([], [], color=UNDAMPED, label="undamped"))
    if any(np.any(m[3] > OVERDAMPED) for m in modes):
        handles.append(Line2D([], [], color=LIGHT, label=f"above {OVERDAMPED:.0f}"))
    occurring = {w for m in modes for w in senses(m[4])}
    handles += [Line2D([], [], color=GREY, linestyle=s, label=w) for w, s in LINES.items() if w in occurring]
    if len(critical):
        handles += [Line2D([], [], color=INK, marker="o", markerfacecolor="none", linestyle="none", label="critical speed")]
    if heavy.any():
        handles += [Line2D([], [], color=GREY, marker="o", markersize=4, markerfacecolor="none", linestyle="none", label="crossed, but AF < 2.5")]

    label_modes(top, ends[1] * to_speed, [(m[0], m[2][-1] * to_frequency) for m in modes if m[1][-1] == ends[1] and m[3][-1] <= OVERDAMPED])
    if bottom:
        draw_damping(bottom, modes, ends[1], to_speed)
    axes[-1, 0].set_xlabel(speed_label)
    for axis in axes[:, 0]:
        mark_service(axis, study, study.attribute("speed_unit", "rad/s"))
    words = with_either(f"numbers at the right: modes; sense of whirl by kinetic energy; {ROTATION}", [occurring])
    return save(figure, study, "campbell", words, handles, 7)
