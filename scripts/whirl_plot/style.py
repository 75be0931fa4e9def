"""The look of all pictures, units of axes, and the marks that recur."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402
from cycler import cycler  # noqa: E402

from .manifest import register  # noqa: E402

INK, GREY, LIGHT = "#222222", "#7a7a7a", "#d9d9d9"
COLOURS = ["#0b62a4", "#d1670c", "#2a8c55", "#8e4b9e", "#b8860b", "#12868f", "#a83250", "#5b6770"]
GOOD, WARN, BAD = "#0b62a4", "#e69f00", "#c8102e"
DASHED = (0, (3.2, 1.8))
ROTATION = "rotation x \u2192 y, counter-clockwise with x right and y up"

# Label, marker and colour of each bifurcation.
MARKS = {
    "fold": ("LP", "s", "#222222", "limit point (fold)"),
    "cyclic_fold": ("LPC", "s", "#222222", "limit point of cycles"),
    "hopf": ("HB", "o", "#c8102e", "Hopf"),
    "flip": ("PD", "D", "#8e4b9e", "period doubling (flip)"),
    "neimark_sacker": ("NS", "^", "#c8102e", "Neimark-Sacker"),
    "branch_point": ("BP", "P", "#2a8c55", "branch point"),
}


def use_style():
    plt.rcParams.update({
        "figure.dpi": 110, "savefig.dpi": 170, "figure.constrained_layout.use": True,
        "font.size": 9.5, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
        "axes.labelsize": 9.5, "axes.labelcolor": INK, "axes.edgecolor": GREY, "axes.linewidth": 0.8,
        "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
        "grid.color": LIGHT, "grid.linewidth": 0.5, "xtick.color": INK, "ytick.color": INK,
        "xtick.labelsize": 8.5, "ytick.labelsize": 8.5, "legend.fontsize": 8.5, "legend.frameon": False,
        "lines.linewidth": 1.6, "lines.solid_capstyle": "round", "axes.prop_cycle": cycler(color=COLOURS),
    })


def length_unit(values):
    """Factor and name of the unit in which lengths (m) read best."""
    top = np.nanmax(np.abs(values)) if np.size(values) and np.any(np.isfinite(values)) else 0
    return (1e6, "\u00b5m") if top < 2e-3 else (1e3, "mm") if top < 2 else (1, "m")


def speed_axis(unit):
    """Factors from rad/s and labels of speeds and of frequencies that belong together: rpm with Hz, rad/s with rad/s."""
    if unit == "rpm":
        return 30 / np.pi, "speed [rpm]", 1 / (2 * np.pi), "Hz"
    if unit == "Hz":
        return 1 / (2 * np.pi), "speed [Hz]", 1 / (2 * np.pi), "Hz"
    return 1, "speed [rad/s]", 1, "rad/s"


def parameter_label(study):
    unit = study.attribute("parameter_unit", "")
    name = study.attribute("parameter", "speed" if unit in ("rpm", "rad/s", "Hz") else "parameter")
    return f"{name} [{unit}]" if unit and unit != "1" else name


def save(figure, study, what, note="", handles=(), columns=6):
    """Adds whose picture it is, the legend below and the conventions, and writes it."""
    height = figure.get_figheight()
    longest = max((len(h.get_label()) for h in handles), default=0)
    entry = max(1.7, 0.5 + 0.07 * longest)  # inches
    columns = min(columns, max(2, int(figure.get_figwidth() / entry)))
    head, foot = 0.58, 0.10 + 0.19 * bool(note) + 0.215 * -(-len(handles) // columns)  # inches
    figure.set_layout_engine("constrained", rect=(0, foot / height, 1, 1 - (head + foot) / height))
    figure.text(0.01, 1 - 0.2 / height, study.run_title, va="center", fontsize=11.5, fontweight="bold", color=INK)
    subtitle = study.name if study.status in ("", "completed") else f"{study.name} \u2014 {study.status}"
    figure.text(0.01, 1 - 0.42 / height, subtitle, va="center", fontsize=9.5, color=GREY)
    if handles:
        figure.legend(handles=list(handles), loc="lower left", ncol=columns, borderpad=0.2, borderaxespad=0, columnspacing=1.4,
                      handlelength=2.2, labelspacing=0.35, bbox_to_anchor=(0.005, (0.05 + 0.19 * bool(note)) / height))
    figure.text(0.99, 0.13 / height, note, ha="right", va="center", fontsize=7.5, color=GREY)
    path = study.file(what)
    write(figure, path)
    plt.close(figure)
    return path


def write(figure, path):
    """As a PNG of 256 colours, a third of the size of one of all: lines on white need no more."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", facecolor="white")
    few_colours(Image.open(drawn).convert("RGB")).save(register(path), format="PNG", optimize=True)


def few_colours(image):
    """In 256 colours: the 32 of the largest areas as they are, maximum coverage of the rest, which keeps the hue of thin lines
    and small marks."""
    pixels = np.asarray(image).astype(np.int64) @ (1 << 16, 1 << 8, 1)
    codes, place, count = np.unique(pixels.ravel(), return_inverse=True, return_counts=True)
    colours = np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=1)
    frequent = colours[np.argsort(-count, kind="stable")[:32]]
    rest = image.quantize(256 - len(frequent), method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).getpalette()
    palette = np.concatenate([frequent, np.reshape(rest, (-1, 3))])[:256]
    nearest = np.concatenate([np.argmin(((part[:, None] - palette)**2).sum(axis=2), axis=1)
                              for part in np.array_split(colours, 1 + len(colours) // 4096)])
    few = Image.fromarray(nearest[place].reshape(pixels.shape).astype(np.uint8), mode="P")
    few.putpalette(palette.astype(np.uint8).tobytes())
    return few


def runs(keys):
    """(start, stop) of each stretch of equal keys."""
    start = 0
    for i in range(1, len(keys) + 1):
        if i == len(keys) or keys[i] != keys[start]:
            yield start, i
            start = i


def draw_branch(axis, x, y, stable, colour, **more):
    """A curve that is solid where stable and dashed where not; each segment goes with its less stable end."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    solid = np.asarray(stable, bool)
    segment = solid[:-1] & solid[1:]
    width = more.pop("linewidth", 1.6)
    for start, stop in runs(segment):
        axis.plot(x[start:stop + 1], y[start:stop + 1], color=colour, linestyle="-" if segment[start] else DASHED,
                  linewidth=width if segment[start] else 0.8 * width, **more)
    if len(x) == 1:
        axis.plot(x, y, ".", color=colour)


def place_on_branch(parameter, curves, unstable, kind, value):
    """The height of each curve at a bifurcation: where the branch passes `value`, and changes stability if it does so
    more than once; at its turning point for a limit point."""
    parameter = np.asarray(parameter, float)
    if len(parameter) < 2:
        return [c[0] for c in curves]
    if kind in ("fold", "cyclic_fold"):
        slope = np.sign(np.diff(parameter))
        turns = np.nonzero(slope[:-1] * slope[1:] < 0)[0] + 1
        if len(turns):
            i = turns[np.argmin(np.abs(parameter[turns] - value))]
            return [c[i] for c in curves]
    low, high = np.minimum(parameter[:-1], parameter[1:]), np.maximum(parameter[:-1], parameter[1:])
    tolerance = 1e-9 * max(1.0, np.max(np.abs(parameter)))
    inside = np.nonzero((low - tolerance <= value) & (value <= high + tolerance))[0]
    if not len(inside):
        i = int(np.argmin(np.abs(parameter - value)))
        return [c[i] for c in curves]
    if unstable is not None:
        changes = [i for i in inside if unstable[i] != unstable[i + 1]]
        inside = changes or inside
    i = inside[0]
    step = parameter[i + 1] - parameter[i]
    s = (value - parameter[i]) / step if step else 0.5
    return [c[i] + s * (c[i + 1] - c[i]) for c in curves]


def levels(values, span, width=0.075):
    """For each label at `values` on an axis of length `span`, how many lines it has to go up to clear those before it."""
    taken, result = [], [0] * len(values)
    for i in np.argsort(values, kind="stable"):
        near = {level for x, level in taken if abs(x - values[i]) < width * span}
        result[i] = next(level for level in range(len(values) + 1) if level not in near)
        taken.append((values[i], result[i]))
    return result


def mark(axis, kind, x, y, size=6):
    """The legend says what marks mean: words beside them would cover curves."""
    _, marker, colour, _ = MARKS.get(kind, (kind, "x", INK, kind))
    axis.plot([x], [y], marker=marker, color=colour, markersize=size, markeredgecolor="white", markeredgewidth=0.8,
              linestyle="none", zorder=6)


def branch_legend(kinds, more=()):
    """Handles for stable, unstable and the kinds of bifurcation that occur."""
    from matplotlib.lines import Line2D
    handles = list(more) + [Line2D([], [], color=GREY, label="stable"),
                            Line2D([], [], color=GREY, linestyle=DASHED, linewidth=1.3, label="unstable")]
    seen = []
    for kind in kinds:
        if kind in MARKS and kind not in seen:
            seen.append(kind)
            short, marker, colour, words = MARKS[kind]
            handles.append(Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=6,
                                  markeredgecolor="white", label=f"{short}  {words}"))
    return handles


def grid_of(count, width=3.4, height=2.7, columns=3, **more):
    """A figure of `count` panels; those left over are empty."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(max(7.2, width * columns), height * rows + 1.0), squeeze=False, **more)
    for axis in axes.ravel()[count:]:
        axis.set_visible(False)
    return figure, list(axes.ravel()[:count]), axes
