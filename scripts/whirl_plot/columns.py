"""The tables of studies that have no pictures of their own: every column over the first one."""
import numpy as np

from .canvas import Line2D, plt
from .style import COLOURS, save

LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"))
PREFIXED = ("Pa", "N", "N m", "W", "m")


def scaled(unit, columns):
    """(factor, unit) that suits the largest number of the columns."""
    largest = max((np.abs(c[np.isfinite(c)]).max(initial=0) for c in columns), default=0)
    if unit not in PREFIXED or not largest:
        return 1, unit
    size, prefix = next((s for s in LARGE if largest >= s[0]), LARGE[-1])
    return 1 / size, prefix + unit


def drawable(study, name, table):
    """Columns of numbers in the order of the study, if the first column is an axis: it never falls."""
    order = [n for n in str(study.group[name].attrs.get("columns", "")).split() if n in table]
    names = [n for n in order if table[n].ndim == 1 and table[n].dtype.kind == "f"]
    return names if len(names) > 1 and table.rows > 2 and names[0] == order[0] and (np.diff(table[names[0]]) >= 0).all() else []


def draw(study):
    """A picture of each table, a panel for each unit."""
    files = []
    for name in study.tables:
        table = study.table(name)
        names = drawable(study, name, table)
        if not names:
            continue
        first, panels = names[0], {}
        for n in names[1:]:
            if np.ptp(table[n]) and table.units[n] not in ("", "1", table.units[first]):
                panels.setdefault(table.units[n], []).append(n)
        if not panels:
            continue
        figure, axes = plt.subplots(len(panels), 1, figsize=(8.6, 1.2 + 2.4 * len(panels)), sharex=True, squeeze=False)
        along, across = scaled(table.units[first], [table[first]])
        for axis, (unit, members) in zip(axes[:, 0], panels.items()):
            factor, shown = scaled(unit, [table[n] for n in members])
            for colour, n in zip(COLOURS, members):
                axis.plot(along * table[first], factor * table[n], color=colour)
            axis.axhline(0, color="black", linewidth=0.5)
            axis.set_ylabel(f"[{shown}]")
            axis.legend(handles=[Line2D([], [], color=c, label=n.replace("_", " ")) for c, n in zip(COLOURS, members)], loc="upper left", ncols=4)
        axes[-1, 0].set_xlabel(f"{first} [{across}]")
        files += save(figure, study, f"columns-{name}")
    return files
