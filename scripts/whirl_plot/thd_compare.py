"""Beside a film with heat: films of one temperature that have one quantity in common with it, and what clearance and fluid
do over the temperature."""
import numpy as np

from .canvas import plt
from .style import COLOURS, GREY, INK, save, ticks_at
from .thd_film import LABEL, ZERO
from .units import person

SAME = {"load": "load", "power_loss": "power loss", "mass_flow": "flow"}


def draw_effective(study):
    """The temperatures of the films of one temperature, and how wrong each is in what it has not in common."""
    if not study.has("effective/same", "effective/temperature"):
        return []
    same = [name.decode() if isinstance(name, bytes) else str(name) for name in study.get("effective/same")]
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), gridspec_kw={"width_ratios": (2, 3)})
    places = np.arange(len(same))
    labels = [f"same {SAME[name]}" for name in same]
    celsius = study.get("effective/temperature") - ZERO
    left.plot(places, celsius, "D", color=INK, markersize=7)
    for k, t in enumerate(celsius):
        left.annotate(f"{t:.2f}", (k, t), textcoords="offset points", xytext=(9, -3), fontsize=8.5)
    if "temperature.mean" in study.values:
        mean = study.values["temperature.mean"].value - ZERO
        left.axhline(mean, color=GREY, linewidth=0.9)
        left.annotate("mean of the film with heat", (-0.45, mean), textcoords="offset points", xytext=(0, 4), fontsize=8.5, color=GREY)
    ticks_at(left.xaxis, places, labels)
    left.set_xlim(-0.5, len(same) - 0.3)
    left.set_ylabel("temperature of the film [\u00b0C]")
    left.ticklabel_format(axis="y", useOffset=False)
    width = 0.25
    for n, (name, label) in enumerate(SAME.items()):
        error = 100 * np.asarray(study.get(f"effective/{name}_error"))
        # A quantity that is held has no error to show.
        shown = [np.nan if held == name else e for held, e in zip(same, error)]
        bars = right.bar(places + (n - 1) * width, shown, width, color=COLOURS[n], label=label)
        right.bar_label(bars, labels=["" if np.isnan(e) else f"{e:+.2g}" for e in shown], fontsize=8)
    right.axhline(0, color=GREY, linewidth=0.7)
    ticks_at(right.xaxis, places, labels)
    right.set_xlim(-0.5, len(same) - 0.5)
    right.set_ylabel("error of the film of one temperature [%]")
    return save(figure, study, "thd-effective", "at the same place of the journal, in the same clearance", handles=right.get_legend_handles_labels()[0])


PROPERTIES = {"clearance": "clearance", "viscosity": "viscosity", "density": "density", "conductivity": "conductivity", "heat_capacity": "heat capacity",
              "prandtl": "Prandtl number", "heat_ratio": "ratio of specific heats"}


def unit_of(study, name):
    unit = str(study.group[f"properties/{name}"].attrs.get("unit", ""))
    return "" if unit == "1" else unit


def draw_properties(study):
    """Clearance and properties of the fluid over the temperature, over their values at the least one."""
    if not study.has("properties/temperature"):
        return []
    t = np.asarray(study.get("properties/temperature")) - ZERO
    order = np.argsort(t)
    figure, axis = plt.subplots(figsize=(10.5, 5.0))
    for n, (name, label) in enumerate(PROPERTIES.items()):
        if not study.has(f"properties/{name}"):
            continue
        values = np.asarray(study.get(f"properties/{name}"))[order]
        axis.plot(t[order], values / values[0], "-o", markersize=3.5, linewidth=2.4 if name == "clearance" else 1.4,
                  color=INK if name == "clearance" else COLOURS[n], label=f"{label}, {person(values[0], unit_of(study, name), 4)}")
    axis.axhline(1, color=GREY, linewidth=0.7)
    axis.set_xlabel(LABEL)
    axis.set_ylabel(f"over the value at {t.min():.5g} \u00b0C")
    return save(figure, study, "thd-properties", f"legend: value at {t.min():.5g} \u00b0C; bush, shaft and fluid have one temperature; density at ambient pressure",
                handles=axis.get_legend_handles_labels()[0], columns=3)
