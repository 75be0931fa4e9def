"""The look of all pictures, units of axes, and the marks that recur."""
import io
import re
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402
from cycler import cycler  # noqa: E402
from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: E402
from matplotlib.backends.backend_svg import FigureCanvasSVG  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

from .manifest import register  # noqa: E402
from .ticks import remembered  # noqa: E402

INK, GREY, LIGHT = "#222222", "#7a7a7a", "#d9d9d9"
# Each colour means one thing: the two directions, the studies of a run, damping and stability; over a parameter, viridis.
# Marks are ink: their shape says what they are.
Y, X = "#0b62a4", "#d1670c"
COLOURS = ["#7b3fa0", "#12868f", "#8a5a2b", "#c2477f", "#7d8a1f", "#4a5a78", "#a98a00", "#5e4fa2"]
GOOD, WARN, BAD = "#2a8c55", "#e69f00", "#c8102e"
UNDAMPED = "#3b6fb6"  # neither stable nor unstable
SHADE = "#f3f6f9"
DASHED = (0, (3.2, 1.8))
ROTATION = "rotation x \u2192 y, counter-clockwise with x right and y up"
formats = ["png", "svg"]  # of the pictures, set by use_style

# Label, marker and meaning of each bifurcation.
MARKS = {
    "fold": ("LP", "s", "limit point (fold)"),
    "cyclic_fold": ("LPC", "s", "limit point of cycles"),
    "hopf": ("HB", "o", "Hopf"),
    "flip": ("PD", "D", "period doubling (flip)"),
    "neimark_sacker": ("NS", "^", "Neimark-Sacker"),
    "branch_point": ("BP", "P", "branch point"),
}


def use_style(kinds=("png", "svg")):
    formats[:] = kinds
    plt.rcParams.update({
        "figure.dpi": 110, "savefig.dpi": 170, "figure.constrained_layout.use": True,
        "font.size": 9.5, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
        "axes.labelsize": 9.5, "axes.labelcolor": INK, "axes.edgecolor": GREY, "axes.linewidth": 0.8,
        "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
        "grid.color": LIGHT, "grid.linewidth": 0.5, "xtick.color": INK, "ytick.color": INK,
        "xtick.labelsize": 8.5, "ytick.labelsize": 8.5, "legend.fontsize": 8.5, "legend.frameon": False,
        "lines.linewidth": 1.6, "lines.solid_capstyle": "round", "axes.prop_cycle": cycler(color=COLOURS),
        # Texts stay texts and equal pictures equal files.
        "svg.fonttype": "none", "svg.hashsalt": "whirl", "path.simplify": True, "path.simplify_threshold": 0.15,
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


def span_of(low, high):
    """Limits of an axis; a little apart where all is at one place."""
    return (low, high) if high > low else (low - (abs(low) or 1) / 20, low + (abs(low) or 1) / 20)


def least_span(axis, reference, share=0.02):
    """Widens a vertical axis that shows less than `share` of `reference`: rounding is no shape."""
    low, high = axis.get_ylim()
    wanted = share * abs(reference) or 1.0
    if high - low < wanted:
        axis.set_ylim((low + high - wanted) / 2, (low + high + wanted) / 2)
        axis.ticklabel_format(axis="y", useOffset=False)


def parameter_label(study):
    unit = study.attribute("parameter_unit", "")
    name = study.attribute("parameter", "speed" if unit in ("rpm", "rad/s", "Hz") else "parameter")
    return f"{name} [{unit}]" if unit and unit != "1" else name


def columns_of(labels, width, most):
    """As many columns of a legend as fit into `width` inches; it is filled column by column, each as wide as its longest label."""
    for columns in range(min(most, len(labels)), 1, -1):
        if sum(0.6 + 0.068 * max(map(len, column)) for column in np.array_split(np.array(labels, object), columns)) <= width:
            return columns
    return 1


def warning_lines(warnings, width, most=3):
    """The warnings of a study as lines of `width` characters, the last of which counts those that found no place."""
    lines, shown = [], 0
    for words in warnings:
        more = textwrap.wrap(f"Warning: {words}", width)
        if shown and len(lines) + len(more) > most:
            break
        lines += more
        shown += 1
    left = len(warnings) - shown
    return lines + ([f"and {left} more warning{'s' if left > 1 else ''} in the report"] if left else [])


def save(figure, study, what, note="", handles=(), columns=6, of=""):
    """Adds whose picture it is, the legend below, the conventions and the warnings of the study, and writes it; `of` is what is repeated
    in a sweep."""
    height = figure.get_figheight()
    columns = columns_of([h.get_label() for h in handles], figure.get_figwidth(), columns)
    rows = -(-len(handles) // columns)
    lines = textwrap.wrap(note, max(40, int(17.5 * figure.get_figwidth())))
    warned = warning_lines(study.warnings, max(40, int(14.5 * figure.get_figwidth())))
    # A figure grows by what its note needs beyond one line, its legend beyond two, and by its warnings.
    lowest = 0.16 * len(warned)
    height += 0.15 * max(0, len(lines) - 1) + 0.215 * max(0, rows - 2) + lowest
    figure.set_figheight(height)
    below = lowest + 0.19 * bool(lines) + 0.15 * max(0, len(lines) - 1)
    head, foot = 0.58, 0.10 + below + 0.215 * rows  # inches
    figure.set_layout_engine("constrained", rect=(0, foot / height, 1, 1 - (head + foot) / height))
    figure.text(0.01, 1 - 0.2 / height, study.run_title, va="center", fontsize=11.5, fontweight="bold", color=INK)
    subject = f"{study.name}: {of}" if of else study.name
    subtitle = subject if study.status in ("", "completed") else f"{subject} \u2014 {study.status}"
    figure.text(0.01, 1 - 0.42 / height, textwrap.shorten(subtitle, max(40, int(14 * figure.get_figwidth())), placeholder=" ..."), va="center", fontsize=9.5, color=GREY)
    if handles:
        figure.legend(handles=list(handles), loc="lower left", ncol=columns, borderpad=0.2, borderaxespad=0, columnspacing=1.4,
                      handlelength=2.2, labelspacing=0.35, bbox_to_anchor=(0.005, (0.05 + below) / height))
    figure.text(0.99, (0.07 + lowest) / height, "\n".join(lines), ha="right", va="bottom", fontsize=7.5, color=GREY)
    if warned:
        figure.text(0.01, 0.05 / height, "\n".join(warned), ha="left", va="bottom", fontsize=8, color=BAD)
    stem = study.file(what)
    files = write(figure, stem)
    plt.close(figure)
    return files


def write(figure, stem):
    """The figure as `stem`.png of 256 colours, a third of the size of one of all (lines on white need no more), and as
    `stem`.svg. Each is named in the run's manifest before it is written. Returns their paths.

    The layout is computed once, for all formats. Figure.savefig would compute it for each, and walk through all artists once more."""
    files = [register(stem.with_name(f"{stem.name}.{kind}")) for kind in formats]
    figure.set_facecolor("white")
    with remembered() as forget:
        figure.set_dpi(plt.rcParams["savefig.dpi"])
        figure.get_layout_engine().execute(figure)
        figure.set_layout_engine("none")
        for path in files:
            figure.set_dpi(plt.rcParams["savefig.dpi"])  # an SVG leaves its own
            PRINTED[path.suffix](figure, path)
            forget()
    return files


def print_png(figure, path):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    few_colours(np.asarray(canvas.buffer_rgba())).save(path, format="PNG")


def print_svg(figure, path):
    figure.set_dpi(90)  # of what is no line: the coloured fields
    text = io.StringIO()
    FigureCanvasSVG(figure).print_svg(text, metadata={"Date": None})
    path.write_text(shorter(text.getvalue()), encoding="utf-8")


def print_pdf(figure, path):
    figure.savefig(path, format="pdf", metadata={"CreationDate": None})


PRINTED = {".png": print_png, ".svg": print_svg, ".pdf": print_pdf}


def shorter(svg):
    """Coordinates to a hundredth of a point, which no eye sees, and no indentation."""
    number = re.compile(r"(?<=[ ML\n\"(,])-?\d+\.\d{3,}")
    # Inside tags only: labels are text between them, and their numbers stay as they are.
    svg = re.sub(r"<(?!!)[^>]*>", lambda tag: number.sub(lambda m: f"{float(m[0]):.2f}".rstrip("0").rstrip("."), tag[0]), svg)
    return re.sub(r"\n *", "\n", svg)


def few_colours(pixels):
    """Opaque RGBA [row][column] as an image of 256 colours: the 128 of the largest areas as they are; then, one by one, the colour that is
    farthest from all of these, which keeps the hue of thin lines and small marks."""
    codes = np.ascontiguousarray(pixels).view(np.uint32).ravel()
    # Most pixels have the colour of the one to their left, so runs of equal pixels are sorted, not pixels.
    starts = np.flatnonzero(np.concatenate([[True], codes[1:] != codes[:-1]]))
    lengths = np.diff(starts, append=len(codes))
    values, place = np.unique(codes[starts], return_inverse=True)
    colours = values.view(np.uint8).reshape(-1, 4)[:, :3].astype(np.float32)
    frequent = np.argsort(-np.bincount(place, lengths), kind="stable")[:128]
    # Squares of lengths are whole numbers below 2^24, which float32 holds.
    size = (colours**2).sum(axis=1)
    palette, nearest, least = [], np.zeros(len(colours), np.uint8), np.full(len(colours), np.inf, np.float32)
    while len(palette) < 256 and least.max() > 0:
        one = frequent[len(palette)] if len(palette) < len(frequent) else np.argmax(least)
        square = size - 2 * (colours @ colours[one]) + size[one]
        closer = square < least
        nearest[closer], least[closer] = len(palette), square[closer]
        palette.append(one)
    few = Image.fromarray(np.repeat(nearest[place], lengths).reshape(pixels.shape[:2]), mode="P")
    few.putpalette(colours[palette].astype(np.uint8).tobytes())
    return few


def runs(keys):
    """(start, stop) of each stretch of equal keys."""
    start = 0
    for i in range(1, len(keys) + 1):
        if i == len(keys) or keys[i] != keys[start]:
            yield start, i
            start = i


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
    marker = MARKS.get(kind, (kind, "x", kind))[1]
    axis.plot([x], [y], marker=marker, color=INK, markersize=size, markeredgecolor="white", markeredgewidth=0.8,
              linestyle="none", zorder=6)


def mark_end(axis, x, y, size=6):
    """Where a branch stops before the end of its range."""
    axis.plot([x], [y], marker="X", color="white", markersize=size, markeredgecolor=INK, markeredgewidth=0.9,
              linestyle="none", zorder=7)


def branch_legend(kinds, more=(), ends=(), solid="stable"):
    """Handles for stable, unstable, the kinds of bifurcation that occur, and the ends of branches (name, reason)."""
    handles = list(more) + [Line2D([], [], color=GREY, label=solid),
                            Line2D([], [], color=GREY, linestyle=DASHED, linewidth=1.3, label="unstable")]
    for kind in dict.fromkeys(k for k in kinds if k in MARKS):
        short, marker, words = MARKS[kind]
        handles.append(Line2D([], [], color=INK, marker=marker, linestyle="none", markersize=6,
                              markeredgecolor="white", label=f"{short}  {words}"))
    for reason in dict.fromkeys(ends):
        handles.append(Line2D([], [], color="white", marker="X", markeredgecolor=INK, markeredgewidth=0.9, linestyle="none",
                              markersize=6, label=f"ends: {reason}"))
    return handles


def grid_of(count, width=3.4, height=2.7, columns=3, **more):
    """A figure of `count` panels; those left over are empty."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(max(7.2, width * columns), height * rows + 1.0), squeeze=False, **more)
    for axis in axes.ravel()[count:]:
        axis.set_visible(False)
    return figure, list(axes.ravel()[:count]), axes
