"""What reductions of a shaft cost: errors over the number of freedoms, orbits beside those of the whole shaft, matrices."""
import numpy as np
from matplotlib.ticker import MaxNLocator

from .canvas import Line2D, plt
from .style import COLOURS, GREY, INK, save

WORDS = {"modal_supported": "modes on springs", "modal_free": "modes of the free shaft", "craig_bampton": "Craig-Bampton", "craig_bampton_state": "Craig-Bampton, state space"}


def words(method):
    return WORDS.get(method, method)


def broken(method):
    """The same for a narrow column."""
    return words(method).replace(", ", ",\n")


def names(study, path):
    return [n.decode() if isinstance(n, bytes) else str(n) for n in np.atleast_1d(study.get(path))]


def draw_errors(study):
    """Errors of every mode over the freedoms, a column for each reduction; below those of the eigenvectors."""
    if not study.has("errors/method", "errors/freedoms", "errors/frequency", "errors/vector"):
        return []
    methods, freedoms = names(study, "errors/method"), np.atleast_1d(study.get("errors/freedoms"))
    rows = (("frequency", "error of the frequency"), ("vector", "distance of the eigenvector"), ("diagonal", r"$|R_{kk}|$"))
    figure, axes = plt.subplots(len(rows), len(methods), figsize=(2.9 * len(methods) + 0.8, 8.4), squeeze=False, sharex=True, sharey="row")
    for row, (name, label) in enumerate(rows):
        errors = np.reshape(study.get(f"errors/{name}"), (len(methods), len(freedoms), -1))
        for column, method in enumerate(methods):
            axis = axes[row, column]
            for k in range(errors.shape[2]):
                axis.plot(freedoms, np.maximum(errors[column, :, k], 1e-16), "-o", markersize=2.2, linewidth=0.9, color=plt.cm.viridis(k / max(1, errors.shape[2] - 1)))
            axis.plot(freedoms, errors[column].max(axis=1), color=INK, linewidth=1.8)
            if row == 0:
                axis.set_title(words(method), fontsize=9)
        axes[row, 0].set_yscale("log")  # the axes of a row share it
        axes[row, 0].set_ylabel(label)
    for axis in axes[-1]:
        axis.set_xlabel("freedoms")
    count = errors.shape[2]
    handles = [Line2D([], [], color=INK, linewidth=1.8, label="largest"), Line2D([], [], color=plt.cm.viridis(0.0), label="mode 1"),
               Line2D([], [], color=plt.cm.viridis(1.0), label=f"mode {count}")]
    return save(figure, study, "reduction-errors", "against the whole shaft; vectors of length one in the energy norm; R = I - W'NV*", handles=handles)


def draw_orbits(study):
    """The orbit of the whole shaft, and those of the reduced ones over it."""
    if not study.has("orbits/x", "orbits/reduced_x", "errors/method"):
        return []
    methods, freedoms = names(study, "errors/method"), np.atleast_1d(study.get("orbits/freedoms"))
    x, y = study.get("orbits/x"), study.get("orbits/y")
    unit, scale = max(((u, s) for u, s in (("nm", 1e9), ("µm", 1e6), ("mm", 1e3)) if s * np.hypot(x, y).max() >= 1), key=lambda c: -c[1], default=("nm", 1e9))
    x, y = scale * x, scale * y
    shape = (len(methods), len(freedoms), -1)
    rx, ry, errors = (np.reshape(study.get(f"orbits/{n}"), shape) for n in ("reduced_x", "reduced_y", "error"))
    figure, axes = plt.subplots(len(freedoms), len(methods), figsize=(2.3 * len(methods) + 0.8, 3.3 * len(freedoms) + 0.4), squeeze=False, sharex=True, sharey=True)
    for column, method in enumerate(methods):
        for row, kept in enumerate(freedoms):
            axis = axes[row, column]
            axis.plot(x, y, color=GREY, linewidth=2.6)
            axis.plot(scale * rx[column, row], scale * ry[column, row], color=COLOURS[column % len(COLOURS)], linewidth=0.9)
            axis.set_aspect("equal")
            axis.xaxis.set_major_locator(MaxNLocator(3))
            axis.set_title(f"{broken(method)}\n{kept:.0f} freedoms, error {100 * errors[column, row, 0]:.2g} %", fontsize=7.5)
    for axis in axes[-1]:
        axis.set_xlabel(f"x [{unit}]")
    for axis in axes[:, 0]:
        axis.set_ylabel(f"y [{unit}]")
    handles = [Line2D([], [], color=GREY, linewidth=2.6, label="whole shaft"), Line2D([], [], color=INK, linewidth=0.9, label="reduced (coloured)")]
    group = study.group["orbits"].attrs
    note = f"node {group['node']}, {group['speed']:.6g} rad/s, from rest; error: largest distance over the size of the orbit"
    return save(figure, study, "reduction-orbits", note, handles=handles)


def image(figure, axis, values, title):
    """Orders of magnitude of a matrix; zeros are left white."""
    size = np.abs(np.asarray(values, dtype=float))
    with np.errstate(divide="ignore"):
        orders = np.where(size > 0, np.log10(size), np.nan)
    top = np.nanmax(orders) if np.isfinite(orders).any() else 0
    shown = axis.imshow(orders, cmap="viridis", vmin=max(np.nanmin(orders), top - 18) if np.isfinite(orders).any() else -1, vmax=top, interpolation="nearest")
    axis.set_title(title, fontsize=8.5)
    axis.grid(False)
    for along in (axis.xaxis, axis.yaxis):
        along.set_major_locator(MaxNLocator(5, integer=True))
    axis.tick_params(labelsize=6.5)
    figure.colorbar(shown, ax=axis, shrink=0.8)


def draw_maps(study):
    """Magnitudes of the reduced matrices, of R and of the gyroscopic coupling of real modes."""
    if not study.has("errors/method", "maps/coupling/free"):
        return []
    methods = names(study, "errors/method")
    rows = [[("V'GV, modes on springs", study.get("maps/coupling/supported")), ("V'GV, free modes", study.get("maps/coupling/free"))]]
    for method in methods:
        found = [name for name in ("M", "K", "G", "N", "P", "R") if study.has(f"maps/{method}/{name}")]
        rows.append([(f"{name}, {words(method)}", study.get(f"maps/{method}/{name}")) for name in found])
    columns = max(len(row) for row in rows)
    figure, axes = plt.subplots(len(rows), columns, figsize=(3.0 * columns, 2.75 * len(rows) + 0.4), squeeze=False)
    for line, row in zip(axes, rows):
        for axis, (title, values) in zip(line, row):
            image(figure, axis, values, title)
        for axis in line[len(row):]:
            axis.axis("off")
    group = study.group["maps"].attrs
    note = f"log10 of absolute entries in SI, zeros white; {group['freedoms']} freedoms, {group['speed']:.6g} rad/s; (x, y) adjacent, in state space two states a freedom"
    return save(figure, study, "reduction-maps", note)
