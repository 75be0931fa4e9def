"""Unbalance response: amplitude and phase over speed (Bode)."""
import numpy as np

from .canvas import Line2D, plt
from .margins import operating_in
from .style import BAD, DASHED, GREY, INK, X, Y, length_unit, mark_service, runs, save, span_of, speed_axis, ticks_at
from .units import digits, person

NOTE = ("linear response, amplitudes 0-peak; lag behind the shaft angle: x = |X| cos(angle \u2212 lag), the heavy side points along x "
        "at angle 0 and phase 0")


def peaks_at(study, place):
    """Peaks of a place in the list of the results: dicts as Study.peaks; `number` gives their numbers."""
    return [p for p in study.peaks if isinstance(p, dict) and p.get("place") == place]


def number(peak, name):
    """A value of a peak; None where it is not known."""
    value = (peak.get(name) or {}).get("value")
    return value if isinstance(value, (int, float)) else None


def is_answer(peak):
    """Whether the linear response is a motion with a peak there: about a stable equilibrium, with a film left in every bearing, and
    higher than beside it by more than the bar."""
    return peak.get("stability", "stable") == "stable" and not any(str(n).startswith(("no answer", "undetermined")) for n in peak.get("notes", []))


class Validity:
    """Where along the speeds the linear response is a motion of the machine."""

    def __init__(self, study, count):
        answer, unstable = study.get("response/answer"), study.get("response/unstable_count")
        self.answer = np.ones(count, bool) if answer is None else np.asarray(answer) > 0
        self.stable = np.ones(count, bool) if unstable is None else np.asarray(unstable) == 0

    def plot(self, axis, x, y, **look):
        """A line with gaps where the response is no answer, dashed about equilibria that are not known to be stable."""
        y = np.where(self.answer, y, np.nan)
        for start, stop in runs(list(self.stable)):
            # Stretches meet: unstable from the first unstable speed to the last; of a single one the lines to both sides.
            wide = self.stable[start] or stop - start == 1
            low, high = (max(0, start - 1), min(len(x), stop + 1)) if wide else (start, stop)
            axis.plot(x[low:high], y[low:high], **{**look, **({} if self.stable[start] else {"linestyle": DASHED, "label": "_"})})

    def shade(self, axis, x):
        half = np.concatenate([x[:1], (x[1:] + x[:-1]) / 2, x[-1:]])
        for start, stop in runs(list(self.stable)):
            if not self.stable[start]:
                # A single speed would have a band of no width.
                low, high = (half[start], half[stop]) if stop - start == 1 else (x[start], x[stop - 1])
                axis.axvspan(low, high, color=BAD, alpha=0.06, linewidth=0)


def draw_lag(axis, x, phase, colour, validity):
    """Lag in degrees within one turn: the unwrapped curve and its copies a turn away, as far as they are inside."""
    known = np.isfinite(phase)  # a speed without a response has none
    if not known.any():
        return
    lag = np.full(len(phase), np.nan)
    lag[known] = -np.degrees(np.unwrap(phase[known]))
    for turn in range(int(np.floor(np.nanmin(lag) / 360)), int(np.floor(np.nanmax(lag) / 360)) + 1):
        validity.plot(axis, x, lag - 360 * turn, color=colour, linewidth=1.2)
    axis.set_ylim(360, 0)
    ticks_at(axis.yaxis, range(0, 361, 90))


def draw_place(study, amplitude_axis, phase_axis, x, data, k, scale, unit, speed_unit, place, validity):
    major = np.where(validity.answer, data["semi_major"][:, k] * scale, np.nan)
    validity.plot(amplitude_axis, x, major, color=INK, linewidth=1.8, label="semi-major axis")
    validity.plot(amplitude_axis, x, data["y_amplitude"][:, k] * scale, color=Y, linewidth=1.2, label="y, vertical")
    validity.plot(amplitude_axis, x, data["x_amplitude"][:, k] * scale, color=X, linewidth=1.2, label="x, horizontal")
    title = place
    known = [(number(p, "semi_major"), p) for p in peaks_at(study, place) if number(p, "speed") is not None and number(p, "semi_major") is not None]
    for top, p in known:
        if is_answer(p):
            amplitude_axis.plot(number(p, "speed"), top * scale, "o", color=INK, markersize=3)
    if known:
        # Peaks that are no motion are named only where there is no other.
        top, p = max(known, key=lambda entry: (is_answer(entry[1]), entry[0]))
        factor = number(p, "amplification_factor")
        # Above the axes it covers nothing.
        title += f"\n{person(top, 'm', 3)} at {number(p, 'speed'):.0f} {speed_unit}" + (f", AF {digits(factor, 3)}" if factor is not None else "")
        if not is_answer(p):
            title += ", unstable" if p.get("stability") == "unstable" else ", no answer" if any(str(n).startswith("no answer") for n in p.get("notes", [])) else ", undetermined"
    highest = np.nanmax(major) if np.isfinite(major).any() else 0
    amplitude_axis.set_ylim(0, 1.08 * max(highest, 1e-300))
    amplitude_axis.set_title(title, fontsize=9)
    draw_lag(phase_axis, x, data["x_phase"][:, k], X, validity)
    draw_lag(phase_axis, x, data["y_phase"][:, k], Y, validity)


def draw_operating(axis, operating, x):
    """A line at the operating speed, a band over a range of them."""
    if operating is None:
        return
    low, high = operating
    if low == high and x[0] <= low <= x[-1]:
        axis.axvline(low, color=GREY, linewidth=1.0, linestyle=":")
    elif low != high:
        axis.axvspan(max(low, x[0]), min(high, x[-1]), color=GREY, alpha=0.15, linewidth=0)


def draw_group(study, group, names, what, speed, speed_label):
    keys = ("x_amplitude", "x_phase", "y_amplitude", "y_phase", "semi_major")
    if not study.has(*(f"{group}/{k}" for k in keys)):
        return []
    data = {k: study.get(f"{group}/{k}").reshape(len(speed), -1) for k in keys}
    scale, unit = length_unit(data["semi_major"])
    from matplotlib.patches import Patch
    files, count = [], data["semi_major"].shape[1]
    operating, validity = operating_in(study), Validity(study, len(speed))
    for count_of_files, part in enumerate(np.array_split(np.arange(count), -(-count // 5)), 1):
        figure, axes = plt.subplots(2, len(part), figsize=(max(7.2, 2.7 * len(part)), 6.0), sharex=True,
                                    sharey="row" if group == "bearings" else False, height_ratios=[1.5, 1], squeeze=False)
        for column, k in enumerate(part):
            draw_place(study, axes[0, column], axes[1, column], speed, data, k, scale, unit, speed_label.split("[")[1].rstrip("]"), names[k], validity)
            axes[1, column].set_xlabel(speed_label)
            axes[1, column].set_xlim(*span_of(speed[0], speed[-1]))
        for axis in axes.ravel():
            draw_operating(axis, operating, speed)
            if operating is None:
                mark_service(axis, study, study.attribute("speed_unit", "rad/s"))
            validity.shade(axis, speed)
        if group == "bearings" and validity.answer.any():
            axes[0, 0].set_ylim(0, 1.08 * scale * data["semi_major"][validity.answer][:, list(part)].max())
        handles = [Line2D([], [], color=c, linewidth=w, label=words) for c, w, words in ((INK, 1.8, "semi-major axis"), (Y, 1.2, "y, vertical"), (X, 1.2, "x, horizontal"))]
        if not validity.stable.all():
            handles += [Line2D([], [], color=INK, linestyle=DASHED, label="no stable equilibrium: no vibration settles there"), Patch(color=BAD, alpha=0.12, label="unstable")]
        if operating is not None:
            handles.append(Line2D([], [], color=GREY, linestyle=":", label="operating speed") if operating[0] == operating[1] else Patch(color=GREY, alpha=0.25, label="operating speeds"))
        axes[0, 0].set_ylabel(f"amplitude, 0-peak [{unit}]")
        axes[1, 0].set_ylabel("lag [deg]")
        files += save(figure, study, what if count <= 5 else f"{what}{count_of_files}", NOTE, handles)
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
