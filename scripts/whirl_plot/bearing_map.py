"""One bearing by itself: impedance, locus, stiffness, damping, stability and pressure; several bearings of a run together."""
import numpy as np

from .canvas import Line2D, plt
from .curves import through
from .style import GREY, INK, grid_of, save, ticks_at

ENTRIES = ("xx", "xy", "yx", "yy")
LOAD = r"Sommerfeld number $S = (c/R)^2 F/(\mu\Omega LD)$"
SCALE = r"$k^* = c\,(c/R)^2 K/(\mu\Omega LD)$,  $c^* = c\,(c/R)^2 C/(\mu LD)$"


def title_of(study):
    return study.name if study.name != "bearing_map" else study.attribute("bearing", study.name)


def between(e, phi, table, x, y):
    """A table over (eccentricity, angle from 0 to 2 pi) at places (x, y), linear in both."""
    r, t = np.hypot(x, y), np.arctan2(y, x) % (2 * np.pi)
    i, j = (np.clip(np.searchsorted(axis, v) - 1, 0, len(axis) - 2) for axis, v in ((e, r), (phi, t)))
    u, w = (r - e[i]) / (e[i + 1] - e[i]), (t - phi[j]) / (phi[j + 1] - phi[j])
    return (1 - u) * ((1 - w) * table[i, j] + w * table[i, j + 1]) + u * ((1 - w) * table[i + 1, j] + w * table[i + 1, j + 1])


def draw_impedance(study):
    """Size (contours) and direction (arrows) of the resistance to a squeeze velocity, over the journal's place."""
    if not study.has("impedance/W_along", "impedance/eccentricity"):
        return []
    e, phi = study.get("impedance/eccentricity"), study.get("impedance/angle")
    w, v = study.get("impedance/W_along"), study.get("impedance/W_across")
    size = np.hypot(w, v)
    figure, axes, _ = grid_of(1, width=8.4, height=4.6)
    axis = axes[0]
    upper = phi <= np.pi * (1 + 1e-12)  # mirrored below
    steps = np.outer(10.0 ** np.arange(-2, 5), (1, 2, 5)).ravel()
    steps = steps[(steps > np.nanmin(size)) & (steps < np.nanmax(size))]
    x, y = (np.outer(e, f(phi[upper])) for f in (np.cos, np.sin))
    lines = axis.contour(x, y, np.ma.masked_invalid(np.log10(size[:, upper])), np.log10(steps), colors=study.colour,
                         linewidths=np.where(np.isclose(np.log10(steps) % 1, 0), 1.4, 0.8))
    axis.clabel(lines, fmt=lambda level: f"{round(10**level, 3):g}", fontsize=7.5)
    places = np.linspace(-0.95, 0.95, 20)
    x, y = (g.ravel() for g in np.meshgrid(places, np.linspace(0.05, 0.95, 10)))
    inside = np.hypot(x, y) < e[-1]
    x, y = x[inside], y[inside]
    u, n = (-between(e, phi, a / size, x, y) for a in (w, v))
    axis.quiver(x, y, u / np.hypot(u, n), n / np.hypot(u, n), color=GREY, pivot="mid", scale=34, width=0.0022, headwidth=4)
    turn = np.linspace(0, np.pi, 181)
    axis.plot(np.cos(turn), np.sin(turn), color=INK, linewidth=1.1)
    axis.plot(e[-1] * np.cos(turn), e[-1] * np.sin(turn), color=GREY, linewidth=0.7, linestyle=":")
    axis.set_aspect("equal")
    axis.set_xlim(-1.04, 1.04)
    axis.set_ylim(-0.02, 1.04)
    axis.set_xlabel(r"$\varepsilon$ along the squeeze velocity $v_s$, which points to the right")
    axis.set_ylabel(r"$\varepsilon$ across it")
    handles = [Line2D([], [], color=study.colour, label=r"$|W|$"),
               Line2D([], [], color=GREY, marker=r"$\rightarrow$", linestyle="none", label=r"direction of the force $F^* = -v_s^*\,W$")]
    note = rf"$F^* = (c/R)^2 F/(\mu LD)$; computed up to $\varepsilon$ = {e[-1]:.3g}; the lower half is its mirror image"
    return save(figure, study, "impedance", note, handles)


def maps_of(results):
    return [s for s in results.studies if s.kind == "bearing_map" and s.has("locus/sommerfeld")]


def legend_of(studies):
    return [Line2D([], [], color=s.colour, label=title_of(s)) for s in studies]


def load_axis(axis, largest):
    axis.set_xlim(0, largest)
    axis.set_xlabel(LOAD, fontsize=8.5)


def draw_locus(whole, studies, largest):
    figure, axes, _ = grid_of(2, width=4.8, height=4.0, columns=2)
    reach = 1.0
    for s in studies:
        load, e = s.get("locus/sommerfeld"), s.get("locus/eccentricity")
        axes[0].plot(load, e, color=s.colour)
        shown = load <= largest
        axes[1].plot(s.get("locus/x")[shown], s.get("locus/y")[shown], color=s.colour)
        reach = max(reach, e[shown].max(initial=0))
    load_axis(axes[0], largest)
    axes[0].set_ylim(0, 1.04 * reach)
    axes[0].set_ylabel(r"eccentricity $\varepsilon$ [clearances]")
    axes[0].set_title("eccentricity under a load")
    turn = np.linspace(-0.5 * np.pi, 0, 91)
    axes[1].plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=0.9)
    axes[1].set_aspect("equal")
    axes[1].set_xlim(0, 1.04 * max(1.0, max(s.get("locus/x").max() for s in studies)))
    axes[1].set_ylim(-1.04 * min(reach, 1.5), 0.02)
    axes[1].set_xlabel("x [clearances]")
    axes[1].set_ylabel("y [clearances]")
    axes[1].set_title("place of the journal")
    return save(figure, whole, "map-locus", "load along \u2212y, the shaft turns counter-clockwise; grey: undeformed wall", legend_of(studies))


def draw_entries(whole, studies, letter, words, what, largest):
    figure, axes, _ = grid_of(4, width=4.6, height=2.7, columns=2)
    for axis, entry in zip(axes, ENTRIES):
        inside = []
        for s in studies:
            load, value = s.get("locus/sommerfeld"), s.get(f"locus/{letter}_{entry}")
            axis.plot(load, value, color=s.colour)
            inside.append(value[load <= largest])
        inside = np.concatenate(inside)
        if len(inside):
            margin = 0.06 * (np.ptp(inside) or 1)
            axis.set_ylim(min(0, inside.min()) - margin, max(0, inside.max()) + margin)
        axis.axhline(0, color=INK, linewidth=0.7)
        load_axis(axis, largest)
        axis.set_ylabel(f"${letter}^*_{{{entry}}}$")
    ratio = sorted({float(s.group["locus"].attrs["frequency_ratio"]) for s in studies if not s.has("impedance/along")})
    note = SCALE + (rf"; liners at $\omega/\Omega$ = {', '.join(f'{r:g}' for r in ratio)}" if ratio else "")
    return save(figure, whole, f"map-{words}", note, legend_of(studies))


def border(study):
    """(S, Omega*) and (S, whirl ratio) at the border of stability, smooth over the load. Where the bearing becomes stable at every
    speed Omega* goes to infinity as (S_0 - S)^(-1/2) and the ratio to zero as (S_0 - S)^(1/2): 1/Omega*^2 and the squared ratio are
    smooth there, and the curves go through these."""
    load, limit, ratio = (study.get(f"locus/{k}") for k in ("sommerfeld", "speed_limit", "whirl_ratio"))
    known = np.isfinite(limit) & np.isfinite(ratio) & (limit > 0)
    if np.count_nonzero(known) < 3 or np.any(np.diff(load[known]) <= 0) or np.any(np.diff(np.nonzero(known)[0]) > 1):
        return (load, limit), (load, ratio)
    s, inverse = through(load[known], limit[known]**-2)
    square = through(load[known], ratio[known]**2)[1]
    return (s, inverse**-0.5), (s, np.sqrt(square))


def draw_stability(whole, studies, largest):
    """Omega* at the border of stability and the whirl there; nothing where a bearing is stable at every speed."""
    figure, axes, _ = grid_of(2, width=4.8, height=3.2, columns=2)
    for s in studies:
        for axis, (load, values) in zip(axes, border(s)):
            axis.plot(load, values, color=s.colour)
    for axis in axes:
        load_axis(axis, largest)
    axes[0].set_ylabel(r"$\Omega\sqrt{mc/F}$ at the border of stability")
    axes[0].set_title("Routh: a rigid rotor is stable below")
    axes[0].set_ylim(bottom=0)
    axes[1].set_ylabel(r"whirl frequency there, $\omega/\Omega$")
    axes[1].set_title("whirl at the border")
    axes[1].set_ylim(0, 0.6)
    return save(figure, whole, "map-stability", "lines end where a rigid rotor is stable at every speed", legend_of(studies))


def draw_pressure(whole, studies):
    shown = [s for s in studies if s.has("profiles/pressure")]
    if not shown:
        return []
    loads = sorted({float(x) for s in shown for x in s.get("profiles/sommerfeld")})
    figure, axes, _ = grid_of(2 * len(loads), width=4.8, height=2.9, columns=2)
    for row, load in enumerate(loads):
        for s in studies:
            if s not in shown or not np.any(np.isclose(s.get("profiles/sommerfeld"), load)):
                continue
            k = int(np.argmin(np.abs(s.get("profiles/sommerfeld") - load)))
            theta = np.degrees(s.get("profiles/theta")) % 360
            order = np.argsort(theta)
            for axis, key in zip(axes[2 * row:2 * row + 2], ("pressure", "thickness")):
                axis.plot(theta[order], s.get(f"profiles/{key}")[k][order], color=s.colour)
        for axis, label in zip(axes[2 * row:2 * row + 2], (r"$p^* = (c/R)^2 p/(6\mu\Omega)$", r"thickness $h/c$")):
            axis.set_title(f"S = {load:g}")
            axis.set_ylabel(label)
            axis.set_xlabel("\u03b8 [deg] from +x, counter-clockwise")
            axis.set_xlim(0, 360)
            ticks_at(axis.xaxis, range(0, 361, 60))
        axes[2 * row].axhline(0, color=INK, linewidth=0.7)
        axes[2 * row + 1].set_ylim(bottom=0)
    return save(figure, whole, "map-pressure", "in the mid-plane; pressure below zero stays in the film equation of a liner and is cut off in the force",
                legend_of(studies))


def draw_frequencies(study):
    """Stiffness and damping over the frequency of a small vibration, at a few loads."""
    if not study.has("frequencies/ratio"):
        return []
    ratio = study.get("frequencies/ratio")
    order = np.argsort(ratio)
    load = study.get("locus/sommerfeld")
    picks = sorted({int(np.argmin(np.abs(load - s))) for s in (0.1, 0.5, 1, 2.5, 5) if load[0] <= s <= load[-1]})
    colours = plt.cm.viridis(np.linspace(0, 0.95, len(picks)))
    figure, grid = plt.subplots(2, 4, figsize=(11.4, 5.6), sharex=True)
    for axes, letter in zip(grid, "kc"):
        for axis, entry in zip(axes, ENTRIES):
            table = study.get(f"frequencies/{letter}_{entry}")
            for i, colour in zip(picks, colours):
                axis.plot(ratio[order], table[i][order], color=colour, marker=".", markersize=3.5)
            axis.axhline(0, color=INK, linewidth=0.7)
            axis.set_xscale("log")
            axis.set_title(f"${letter}^*_{{{entry}}}$")
            if letter == "c":
                axis.set_xlabel(r"frequency $\omega/\Omega$")
    handles = [Line2D([], [], color=c, marker=".", label=f"S = {load[i]:.3g}") for i, c in zip(picks, colours)]
    return save(figure, study, "frequencies", SCALE, handles)


def draw_together(results):
    """All bearings of a run in each picture, up to the largest load that every one of them was followed to."""
    studies = maps_of(results)
    if not studies:
        return []
    # Closed forms carry any load near the wall: what is shown ends at S = 10.
    largest = min(10.0, max(s.get("locus/sommerfeld").max() for s in studies))
    whole = results.whole("bearings by themselves")
    return [*draw_locus(whole, studies, largest), *draw_entries(whole, studies, "k", "stiffness", "stiffness", largest),
            *draw_entries(whole, studies, "c", "damping", "damping", largest), *draw_stability(whole, studies, largest),
            *draw_pressure(whole, studies)]
