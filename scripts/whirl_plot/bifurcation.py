"""Bifurcation diagrams: equilibria and cycles over a parameter, each bearing, stable solid and unstable dashed."""
import numpy as np
from matplotlib.lines import Line2D

from .style import (BAD, COLOURS, INK, branch_legend, draw_branch, grid_of, mark, parameter_label, place_on_branch, save)


def events_of(study):
    kinds = study.get("bifurcations/type")
    if kinds is None or not len(kinds):
        return []
    return list(zip(kinds, np.atleast_1d(study.get("bifurcations/parameter"))))


def branch_of(study):
    parameter = study.get("branch/parameter")
    unstable = study.get("branch/unstable_count")
    stable = study.get("branch/stable")
    if stable is None:
        stable = unstable == 0 if unstable is not None else np.ones(len(parameter))
    return parameter, np.asarray(stable) > 0.5, unstable


def heights(study, curves, kind, value):
    """Of each curve at a bifurcation. Self-excited cycles begin at their Hopf point, which the branch may pass again."""
    parameter, _, unstable = branch_of(study)
    if kind == "hopf" and study.kind == "cycle_branch":
        return [c[0] for c in curves]
    return place_on_branch(parameter, curves, unstable, kind, value)


def mark_events(axis, study, curves, scale, size=6):
    for kind, value in events_of(study):
        for height in heights(study, [c * scale for c in curves], kind, value):
            mark(axis, kind, value, height, size=size)


def distinct(*tables):
    """Columns (bearings) of tables that do not move exactly like one before: two bearings at one node of a rigid rotor do."""
    def alike(b, c):
        return all(np.allclose(t[:, b], t[:, c], rtol=1e-9, atol=1e-9 * np.abs(t).max()) for t in tables)
    return [b for b in range(tables[0].shape[1]) if not any(alike(b, c) for c in range(b))]


def draw_equilibria(study):
    if not study.has("branch/parameter", "branch/y"):
        return []
    parameter, stable, unstable = branch_of(study)
    x, y = (study.get(f"branch/{k}").reshape(len(parameter), -1) for k in "xy")
    names = study.bearings(x.shape[1])
    growth = study.get("branch/leading_real")
    shown = distinct(x, y)
    figure, axes, _ = grid_of(len(shown) + (growth is not None))
    scale, unit = study.measure(np.concatenate([x, y]))
    for axis, b in zip(axes, shown):
        draw_branch(axis, parameter, y[:, b] * scale, stable, COLOURS[0])
        draw_branch(axis, parameter, x[:, b] * scale, stable, COLOURS[1])
        mark_events(axis, study, [y[:, b], x[:, b]], scale)
        axis.set_title(names[b])
        axis.set_ylabel(f"position [{unit}]")
        axis.set_xlabel(parameter_label(study))
        axis.margins(y=0.12)
    if growth is not None:
        axis = axes[-1]
        axis.axhline(0, color=INK, linewidth=0.9)
        draw_branch(axis, parameter, growth, stable, BAD)
        mark_events(axis, study, [growth], 1)
        axis.set_title("least stable eigenvalue")
        axis.set_ylabel("real part [1/s]")
        axis.set_xlabel(parameter_label(study))
        axis.margins(y=0.12)
    directions = [Line2D([], [], color=COLOURS[0], label="y, vertical"), Line2D([], [], color=COLOURS[1], label="x, horizontal")]
    return [save(figure, study, "equilibria", study.shown,
                 branch_legend([k for k, _ in events_of(study)], directions))]


def draw_cycle_panel(axis, study, direction, b, scale, colour, size=6):
    parameter, stable, _ = branch_of(study)
    high, low = (study.get(f"branch/{direction}_{k}").reshape(len(parameter), -1)[:, b] for k in ("max", "min"))
    axis.fill_between(parameter, low * scale, high * scale, color=colour, alpha=0.06, linewidth=0)
    draw_branch(axis, parameter, high * scale, stable, colour)
    draw_branch(axis, parameter, low * scale, stable, colour)
    mark_events(axis, study, [high, low], scale, size)


def draw_cycles(study):
    if not study.has("branch/parameter", "branch/y_max"):
        return []
    parameter, _, _ = branch_of(study)
    tables = [study.get(f"branch/{d}_{k}").reshape(len(parameter), -1) for d in "xy" for k in ("max", "min")
              if study.has(f"branch/{d}_{k}")]
    shown, names = distinct(*tables), study.bearings(tables[0].shape[1])
    files = []
    for direction, words in (("y", "vertical"), ("x", "horizontal")):
        if not study.has(f"branch/{direction}_max"):
            continue
        figure, axes, _ = grid_of(len(shown))
        scale, unit = study.measure(np.concatenate([study.get(f"branch/{direction}_max"), study.get(f"branch/{direction}_min")]))
        for axis, b in zip(axes, shown):
            draw_cycle_panel(axis, study, direction, b, scale, COLOURS[0] if direction == "y" else COLOURS[1])
            axis.set_title(names[b])
            axis.set_ylabel(f"{direction}, max and min [{unit}]")
            axis.set_xlabel(parameter_label(study))
            axis.margins(y=0.12)
        note = f"largest and smallest {direction} ({words}) over one cycle: {study.shown}"
        unbalance = study.attribute("unbalance")
        files.append(save(figure, study, f"cycles-{words}", f"{note}; unbalance {unbalance}" if unbalance else note,
                          branch_legend([k for k, _ in events_of(study)])))
    return files


def draw_frequency(study):
    """Of self-excited cycles over the running speed: how far from half the speed the whirl is."""
    if not study.has("branch/parameter", "branch/period") or study.attribute("unbalance", "") or study.attribute("parameter") != "speed":
        return []
    parameter, stable, _ = branch_of(study)
    to_si = {"rpm": np.pi / 30, "Hz": 2 * np.pi, "rad/s": 1}.get(study.attribute("parameter_unit"))
    if to_si is None:
        return []
    ratio = 2 * np.pi / (study.get("branch/period") * parameter * to_si)
    figure, (axis,), _ = grid_of(1, width=4.6, height=3.2)
    draw_branch(axis, parameter, ratio, stable, COLOURS[0])
    mark_events(axis, study, [ratio], 1)
    axis.axhline(0.5, color=INK, linewidth=0.8, linestyle=":")
    axis.set_title("whirl frequency")
    axis.set_ylabel("whirl frequency / running speed")
    axis.set_xlabel(parameter_label(study))
    axis.margins(y=0.22)
    return [save(figure, study, "frequency", "self-excited cycles; dotted: half the running speed", branch_legend([k for k, _ in events_of(study)]))]


def draw_together(results):
    """All branches of a run over the same parameter in one picture: the vertical motion of each journal."""
    studies = [s for s in results.studies
               if (s.kind == "cycle_branch" and s.has("branch/parameter", "branch/y_max"))
               or (s.kind == "equilibrium_branch" and s.has("branch/parameter", "branch/y"))]
    label = parameter_label(studies[0]) if studies else ""
    studies = [s for s in studies if parameter_label(s) == label]
    if len(studies) < 2 or all(s.kind == "equilibrium_branch" for s in studies):
        return []
    field = {"cycle_branch": "branch/y_max", "equilibrium_branch": "branch/y"}
    tables = [s.get(field[s.kind]).reshape(len(s.get("branch/parameter")), -1) for s in studies]
    count = min(t.shape[1] for t in tables)
    names, shown = studies[0].bearings(count), distinct(*(t[:, :count] for t in tables))
    scale, unit = studies[0].measure(np.concatenate([t[:, :count].ravel() for t in tables]))
    figure, axes, _ = grid_of(len(shown))
    handles = []
    for s, study in enumerate(studies):
        colour = INK if study.kind == "equilibrium_branch" else COLOURS[s % len(COLOURS)]
        handles.append(Line2D([], [], color=colour, label=study.name))
        for axis, b in zip(axes, shown):
            if study.kind == "equilibrium_branch":
                parameter, stable, _ = branch_of(study)
                draw_branch(axis, parameter, tables[s][:, b] * scale, stable, colour, linewidth=1.3)
                mark_events(axis, study, [tables[s][:, b]], scale, 5)
            else:
                draw_cycle_panel(axis, study, "y", b, scale, colour, 5)
    for axis, b in zip(axes, shown):
        axis.set_title(names[b])
        axis.set_ylabel(f"y, max and min [{unit}]")
        axis.set_xlabel(label)
        axis.margins(y=0.12)
    return [save(figure, results.whole("all branches"), "bifurcations", f"y (vertical): {studies[0].shown}",
                 branch_legend([k for s in studies for k, _ in events_of(s)], handles))]
