"""A film with its heat: what its iterations, a series of meshes, and one of speeds show."""
import numpy as np

from .canvas import plt
from .style import GREY, INK, parameter_label, save
from .thd_film import LABEL, ZERO


def draw_iterations(study):
    """The greatest change of a temperature in each round of flow and heat."""
    if not study.has("iterations/residual"):
        return []
    residual = np.atleast_2d(np.transpose(study.get("iterations/residual")))
    names = [str(n) for n in study.get("iterations/field", np.arange(len(residual)))]
    figure, axis = plt.subplots(figsize=(10.5, 4.2))
    for name, values in zip(names, residual):
        axis.semilogy(np.arange(len(values)), np.where(values > 0, values, np.nan), "-o", markersize=4, label=name)
    axis.set_xlabel("iteration")
    axis.set_ylabel("greatest change in a round [K]")
    return save(figure, study, "thd-iterations", handles=axis.get_legend_handles_labels()[0])


def decades(axis, values):
    """Whole decades around the positive values."""
    known = values[values > 0]
    if len(known):
        axis.set_ylim(10 ** np.floor(np.log10(known.min())), 10 ** (np.floor(np.log10(known.max())) + 1))


def draw_meshes(study):
    """Least, mean and largest temperature and what the enthalpy budget leaves, over the number of cells."""
    if not study.has("meshes/cells", "meshes/temperature.mean") or len(study.get("meshes/cells")) < 3:
        return []
    cells = study.get("meshes/cells")
    figure, axes = plt.subplots(1, 3, figsize=(11.2, 4.0))
    shown = [("least and largest", [("minimum", "#3b6fb6"), ("maximum", "#c0392b")]), ("mean by volume", [("mean", INK)])]
    for axis, (title, curves) in zip(axes, shown):
        for name, colour in curves:
            axis.semilogx(cells, study.get(f"meshes/temperature.{name}") - ZERO, "-o", markersize=4, color=colour, label=name)
        axis.set_title(title)
        axis.set_ylabel(LABEL)
        axis.ticklabel_format(axis="y", useOffset=False)
    if study.has("meshes/energy_residual"):
        left_over = np.abs(study.get("meshes/energy_residual"))
        axes[2].loglog(cells, np.where(left_over > 0, left_over, np.nan), "-o", markersize=4, color=INK)
        decades(axes[2], left_over)
        axes[2].set_title("residual of the enthalpy budget")
        axes[2].set_ylabel("[W]")
    else:
        axes[2].set_visible(False)
    for axis in axes:
        axis.set_xlabel("cells of the film")
    return save(figure, study, "thd-meshes", handles=axes[0].get_legend_handles_labels()[0])


# What heats the film, and where the heat goes. The power loss is the sum of the first two.
BUDGET = {"dissipation": ("dissipation", "#c0392b", "-"), "expansion": ("work of pressure", "#3b6fb6", "-"), "power_loss": ("power loss, what both leave", INK, "-"),
          "heat_bush": ("heat to the bush", "#8a5a2b", "--"), "heat_journal": ("heat to the journal", "#7b3fa0", "--"),
          "enthalpy": ("enthalpy carried off", "#12868f", "--")}


def draw_budget(study):
    """The terms of the enthalpy budget over the parameter, and what they leave."""
    found = [k for k in BUDGET if study.has(f"budget/{k}")]
    if not found or not study.has("budget/parameter") or len(study.get("budget/parameter")) < 2:
        return []
    over = study.get("budget/parameter")
    figure, (axis, below) = plt.subplots(2, 1, figsize=(10.5, 6.4), sharex=True, gridspec_kw={"height_ratios": (3, 1)})
    for name in found:
        label, colour, line = BUDGET[name]
        axis.plot(over, study.get(f"budget/{name}"), line, marker="o", markersize=3.5, color=colour, label=label)
    axis.axhline(0, color=GREY, linewidth=0.7)
    axis.set_ylabel("heat flow [W]")
    if study.has("budget/residual"):
        left = np.abs(study.get("budget/residual"))
        below.semilogy(over, np.where(left > 0, left, np.nan), "-o", markersize=3.5, color=INK)
        decades(below, left)
        below.set_ylabel("residual [W]")
    else:
        below.set_visible(False)
    below.set_xlabel(parameter_label(study))
    return save(figure, study, "thd-budget", handles=axis.get_legend_handles_labels()[0])
