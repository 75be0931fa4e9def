"""How linear a rotor answers random forces: transfer functions with bounds beside the linear ones, coherence, the excitation."""
import numpy as np

from .canvas import Line2D, plt
from .style import DASHED, INK, SHADE, X, Y, length_unit, save, ticks_at
from .units import digits

PAIRS = ("xx", "xy", "yx", "yy")


def levels_of(study):
    """(group, colour, label) of each level of the forces, the weakest first."""
    force = np.atleast_1d(study.get("levels/force"))
    colours = [plt.cm.viridis(0.15)] if len(force) == 1 else list(plt.cm.viridis(np.linspace(0, 0.85, len(force))))
    peak = np.atleast_1d(study.get("levels/peak")) * 1e6
    return [(f"level_{k + 1}", colours[k], f"{f:g} N rms, peak {digits(float(p), 3)} \u00b5m") for k, (f, p) in enumerate(zip(force, peak))]


def shade_resonance(study, axis):
    axis.axvspan(study.attribute("resonance_from"), study.attribute("resonance_to"), color=SHADE, zorder=0)


def phase(angle, known):
    """In degrees, without lines across the border at 180 and where nothing is known."""
    degrees = np.where(known, np.degrees(angle), np.nan)
    degrees[1:][np.abs(np.diff(degrees)) > 180] = np.nan
    return degrees


def draw_transfer(study):
    """|H1| with its band and its phase; dashed: of the linearised film."""
    if not study.has("levels/force", "linear/frequency"):
        return []
    figure, grid = plt.subplots(2, 4, figsize=(13.2, 6.2), sharex=True)
    at = study.get("linear/frequency")
    largest = max(np.max(study.get(f"linear/g_{pair}")) for pair in PAIRS)
    for column, pair in enumerate(PAIRS):
        above, below = grid[0][column], grid[1][column]
        for group, colour, _ in levels_of(study):
            frequency, size, radius = (study.get(f"{group}/{k}") for k in ("frequency", f"h1_{pair}", f"h1_{pair}_radius"))
            above.fill_between(frequency, np.maximum(size - radius, 1e-30), size + radius, color=colour, alpha=0.25, linewidth=0)
            above.plot(frequency, size, color=colour, linewidth=1.1)
            known = radius < 0.5 * size  # the phase of what is no larger than its bound is any
            below.plot(frequency, phase(study.get(f"{group}/h1_{pair}_phase"), known), color=colour, linewidth=1.1, marker=".", markersize=2)
        above.plot(at, study.get(f"linear/g_{pair}"), color=INK, linestyle=DASHED, linewidth=1.2)
        below.plot(at, phase(study.get(f"linear/g_{pair}_phase"), True), color=INK, linestyle=DASHED, linewidth=1.2)
        above.set_xscale("log")
        above.set_yscale("log")
        above.set_ylim(1e-6 * largest, 3 * largest)
        below.set_ylim(-190, 190)
        ticks_at(below.yaxis, [-180, -90, 0, 90, 180])
        above.set_title(f"displacement {pair[0]} by force {pair[1]}")
        below.set_xlabel("frequency [Hz]")
        for axis in (above, below):
            shade_resonance(study, axis)
    grid[0][0].set_ylabel("|H1| [m/N]")
    grid[1][0].set_ylabel("phase [deg]")
    handles = [Line2D([], [], color=c, label=label) for _, c, label in levels_of(study)]
    about = {"unstable": ", about an unstable equilibrium", "undetermined": ", about an equilibrium that may be unstable"}
    handles.append(Line2D([], [], color=INK, linestyle=DASHED, label="linearised film" + about.get(study.summary.get("stability"), "")))
    note = (f"bands: the true value, with a probability of {study.attribute('probability'):g}; "
            f"{study.attribute('averages'):.1f} independent averages; shaded: resonance; speed {study.attribute('speed'):.6g} rad/s")
    return save(figure, study, "transfer", note, handles)


def draw_coherence(study):
    """Multiple coherence of each direction with its bounds, and the ordinary ones."""
    if not study.has("levels/force"):
        return []
    figure, grid = plt.subplots(2, 3, figsize=(12.4, 6.0), sharex=True)
    for row, i in enumerate("xy"):
        for group, colour, _ in levels_of(study):
            frequency, multiple, low, high = (study.get(f"{group}/{k}") for k in ("frequency", f"multiple_{i}", f"multiple_{i}_low", f"multiple_{i}_high"))
            grid[row][0].fill_between(frequency, low, high, color=colour, alpha=0.25, linewidth=0)
            grid[row][0].plot(frequency, multiple, color=colour, linewidth=1.1)
            for column, f in enumerate("xy"):
                grid[row][1 + column].plot(frequency, study.get(f"{group}/coherence_{i}{f}"), color=colour, linewidth=1.0)
        grid[row][0].set_title(f"{i} with both forces (multiple)")
        grid[row][0].axhline(0.95, color=INK, linewidth=0.8, linestyle=DASHED)
        for column, f in enumerate("xy"):
            grid[row][1 + column].set_title(f"{i} with force {f} alone (ordinary)")
        for axis in grid[row]:
            axis.set_xscale("log")
            axis.set_ylim(0, 1.02)
            shade_resonance(study, axis)
        grid[row][0].set_ylabel("coherence")
    for axis in grid[1]:
        axis.set_xlabel("frequency [Hz]")
    handles = [Line2D([], [], color=c, label=label) for _, c, label in levels_of(study)]
    note = (f"bands: the true value, with a probability of {study.attribute('probability'):g}; dashed: 0.95; shaded: resonance; "
            "ordinary coherences share what both forces explain together")
    return save(figure, study, "coherence", note, handles)


def draw_excitation(study):
    """Spectrum of the forces, and the beginning of the record."""
    if not study.has("excitation/frequency", "record/time"):
        return []
    figure, (spectrum, force, place) = plt.subplots(1, 3, figsize=(13.2, 3.9))
    frequency = study.get("excitation/frequency")
    for name, colour in (("x", X), ("y", Y)):
        spectrum.plot(frequency, study.get(f"excitation/density_{name}"), color=colour, linewidth=0.8, alpha=0.8)
    spectrum.plot(frequency, study.get("excitation/density"), color=INK, linestyle=DASHED, linewidth=1.3)
    spectrum.axvline(study.attribute("cutoff"), color=INK, linewidth=0.7)
    spectrum.set_xscale("log")
    spectrum.set_yscale("log")
    top = np.max(study.get("excitation/density"))
    spectrum.set_ylim(1e-5 * top, 4 * top)
    spectrum.set_xlabel("frequency [Hz]")
    spectrum.set_title("density of the forces [N\u00b2/Hz]")
    time = study.get("record/time")
    shown = time <= time[0] + 0.02
    factor, unit = length_unit(np.concatenate([study.get("record/x"), study.get("record/y")]))
    for name, colour in (("x", X), ("y", Y)):
        force.plot(time[shown] * 1e3, study.get(f"record/force_{name}")[shown], color=colour, linewidth=0.8)
        place.plot(time * 1e3, study.get(f"record/{name}") * factor, color=colour, linewidth=1.0)
    for axis, title in ((force, "forces [N]"), (place, f"displacement [{unit}]")):
        axis.set_title(f"{title}, the record's beginning")
        axis.set_xlabel("time [ms]")
    handles = [Line2D([], [], color=X, label="x"), Line2D([], [], color=Y, label="y"), Line2D([], [], color=INK, linestyle=DASHED, label="in closed form")]
    return save(figure, study, "excitation", "white noise through a low pass, whose cut-off frequency the line marks; the highest level", handles)
