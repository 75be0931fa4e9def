"""The look of all pictures, units of axes, and the marks that recur."""
import io
import re
import struct
import textwrap
import zlib

import numpy as np

from whirl.answer import in_print

from .canvas import Line2D, plt
from .manifest import register
from .ticks import settled, together

INK, GREY, LIGHT = "#222222", "#7a7a7a", "#d9d9d9"
# Each colour means one thing: the two directions, the studies of a run, damping and stability; over a parameter, viridis.
# Marks are ink: their shape says what they are.
Y, X = "#0b62a4", "#d1670c"
COLOURS = ["#7b3fa0", "#12868f", "#8a5a2b", "#c2477f", "#7d8a1f", "#4a5a78", "#a98a00", "#5e4fa2"]
GOOD, WARN, BAD = "#2a8c55", "#e69f00", "#c8102e"
UNDAMPED = "#3b6fb6"  # neither stable nor unstable
SHADE = "#f3f6f9"
PRESSURE, ON_PRESSURE = "YlOrRd", "#5a1a00"  # the colours of a pressure, and of lines on them
DASHED = (0, (3.2, 1.8))
ROTATION = "rotation x \u2192 y, counter-clockwise with x right and y up"
formats = ["png"]  # of the pictures, set by use_style

# Label, marker and meaning of each bifurcation.
MARKS = {
    "fold": ("LP", "s", "limit point (fold)"),
    "cyclic_fold": ("LPC", "s", "limit point of cycles"),
    "hopf": ("HB", "o", "Hopf"),
    "flip": ("PD", "D", "period doubling (flip)"),
    "neimark_sacker": ("NS", "^", "Neimark-Sacker"),
    "branch_point": ("BP", "P", "branch point"),
}


def use_style(kinds=("png",)):
    """The formats of the pictures from now on."""
    formats[:] = kinds


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
    """Limits of an axis; a little apart where all is at one place but for rounding."""
    return (low, high) if high - low > 1e-5 * abs(low) else (low - (abs(low) or 1) / 20, low + (abs(low) or 1) / 20)


def least_span(axis, reference, share=0.02):
    """Widens a vertical axis that shows less than `share` of `reference`: rounding is no shape."""
    low, high = axis.get_ylim()
    wanted = share * abs(reference) or 1.0
    if high - low < wanted:
        axis.set_ylim((low + high - wanted) / 2, (low + high + wanted) / 2)
        axis.ticklabel_format(axis="y", useOffset=False)


def service_speed_of(subject):
    """The service speed that the deck states, in rad/s; None if it states none."""
    service = subject.results.summary.get("service_speed")
    value, unit = (service.get("value"), service.get("unit")) if isinstance(service, dict) else (None, "")
    factor = {"rpm": np.pi / 30, "Hz": 2 * np.pi, "rad/s": 1}.get(unit)
    return value * factor if factor and isinstance(value, (int, float)) else None


def service_speed_in(subject, unit):
    """The service speed in the unit of an axis of speeds; None if the deck states none, or the axis shows something else."""
    speed = service_speed_of(subject)
    factor = {"rpm": 30 / np.pi, "Hz": 0.5 / np.pi, "rad/s": 1}.get(unit)
    return None if speed is None or factor is None else speed * factor


def mark_service(axis, subject, unit):
    """A line at the service speed, where it lies on an axis of speeds in `unit`."""
    at = service_speed_in(subject, unit)
    if at is None:
        return
    low, high = axis.get_xlim()
    if low <= at <= high:
        axis.axvline(at, color=GREY, linewidth=0.9, linestyle=(0, (1, 2)), zorder=0.6)
        right = at < low + 0.1 * (high - low)
        axis.annotate("service speed", (at, 1), xycoords=axis.get_xaxis_transform(), xytext=(2 if right else -2, -2), textcoords="offset points", rotation=90,
                      ha="left" if right else "right", va="top", fontsize=6.5, color=GREY, zorder=0.7)


def parameter_label(study):
    unit = study.attribute("parameter_unit", "")
    name = study.attribute("parameter", "speed" if unit in ("rpm", "rad/s", "Hz") else "parameter").split(".")[-1].replace("_", " ")
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
        more = textwrap.wrap(f"Warning: {in_print(words)}", width)
        if shown and len(lines) + len(more) > most:
            break
        lines += more
        shown += 1
    left = len(warnings) - shown
    return lines + ([f"and {left} more warning{'s' if left > 1 else ''} in the report"] if left else [])


def warnings_below(study, what, width):
    """The warnings of a study below the first of its pictures; below each other one how many there are and where they stand."""
    if not study.warnings:
        return []
    study.with_warnings = study.with_warnings or what
    if what == study.with_warnings:
        return warning_lines(study.warnings, width)
    return [f"{len(study.warnings)} warning{'s' if len(study.warnings) > 1 else ''}: see the first picture of this study, or the report"]


def fewer_ticks(figure):
    """Fewer numbers along x: below panels side by side, numbers of five digits run into each other. An axis over rounding, of a branch
    that ends where it begins, is widened."""
    from matplotlib.ticker import AutoLocator, MaxNLocator
    for axis in figure.axes:
        if axis.get_xscale() == "linear" and span_of(*axis.get_xlim()) != axis.get_xlim():
            axis.set_xlim(*span_of(*axis.get_xlim()))
        spec = getattr(axis, "get_subplotspec", lambda: None)()
        if spec is not None and spec.get_gridspec().ncols > 2 and type(axis.xaxis.get_major_locator()) is AutoLocator and max(map(abs, axis.get_xlim())) >= 5e4:
            axis.xaxis.set_major_locator(MaxNLocator(3))


def save(figure, study, what, note="", handles=(), columns=6, of=""):
    """Adds whose picture it is, the legend below, the conventions and the warnings of the study, and writes it; `of` is what is repeated
    in a sweep."""
    fewer_ticks(figure)
    height = figure.get_figheight()
    columns = columns_of([h.get_label() for h in handles], figure.get_figwidth(), columns)
    rows = -(-len(handles) // columns)
    lines = textwrap.wrap(note, max(40, int(17.5 * figure.get_figwidth())))
    warned = warnings_below(study, what, max(40, int(14.5 * figure.get_figwidth())))
    # A figure grows by what its note needs beyond one line, its legend beyond two, and by its warnings.
    lowest = 0.16 * len(warned)
    height += 0.15 * max(0, len(lines) - 1) + 0.215 * max(0, rows - 2) + lowest
    figure.set_figheight(height)
    below = lowest + 0.19 * bool(lines) + 0.15 * max(0, len(lines) - 1)
    head, foot = 0.58, 0.10 + below + 0.215 * rows  # inches
    figure.set_layout_engine("constrained", rect=(0, foot / height, 1, 1 - (head + foot) / height))
    room, size, least = max(40, int(9.6 * figure.get_figwidth())), 11.5, 8.5  # a long title is set smaller before it is cut
    title = textwrap.shorten(study.run_title, int(room * size / least), placeholder=" ...")
    figure.text(0.01, 1 - 0.2 / height, title, va="center", fontsize=min(size, size * room / max(1, len(title))), fontweight="bold", color=INK)
    subject = f"{study.name}: {of}" if of else study.name
    subtitle = subject if study.status in ("", "completed") else f"{subject} \u2014 {in_print(study.status)}"
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


PAGE = 1300  # pixels that a page shows in its width


def fineness(figure):
    """Pixels an inch: what is wider than a page need not have more of them than the page."""
    return min(plt.rcParams["savefig.dpi"], max(110, PAGE / figure.get_figwidth()))


def write(figure, stem):
    """The figure as `stem`.png, `stem`.svg or `stem`.pdf, as was asked. A PNG of lines on white has 256 colours, which is a third of the
    size of one of all; one of fields has all. Each is named in the run's manifest before it is written. Returns their paths.

    The layout is computed once, for all formats. Figure.savefig would compute it for each, and walk through all artists once more."""
    files = [register(stem.with_name(f"{stem.name}.{kind}")) for kind in formats]
    figure.set_facecolor("white")
    fine = fineness(figure)
    with together() as forget:
        figure.set_dpi(fine)
        with settled():
            figure.get_layout_engine().execute(figure)
        figure.set_layout_engine("none")
        for path in files:
            figure.set_dpi(fine)  # an SVG leaves its own
            PRINTED[path.suffix](figure, path)
            forget()
    return files


def print_png(figure, path):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    if has_field(figure):
        write_all_colours(pixels, path)
    else:
        few_colours(pixels).save(path, format="PNG", compress_level=3)


def has_field(figure):
    """Whether colours of a figure run into each other: 256 of them would show as steps."""
    from matplotlib.collections import QuadMesh
    from matplotlib.image import AxesImage
    return any(isinstance(artist, (QuadMesh, AxesImage)) and artist.axes.get_label() != "<colorbar>" for axis in figure.axes for artist in axis.get_children())


def write_all_colours(pixels, path):
    """A PNG of all colours: each pixel less the one to its left (the filter Sub of the standard), which Pillow would find by trying five
    filters on each row."""
    rows, columns = pixels.shape[:2]
    filtered = np.empty((rows, 1 + 3 * columns), np.uint8)
    filtered[:, 0], filtered[:, 1:4] = 1, pixels[:, 0, :3]
    filtered[:, 4:] = (pixels[:, 1:, :3] - pixels[:, :-1, :3]).reshape(rows, -1)
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(filtered.tobytes(), 2)), (b"IEND", b""))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks))


def print_svg(figure, path):
    from matplotlib.backends.backend_svg import FigureCanvasSVG
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
    from PIL import Image
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


def key(axis, field, label, width=0.03, away=0.02):
    """The colours of a field beside its axes, with round numbers; a colour bar of matplotlib would be one more pair of axes, which takes as
    long to draw as the field itself."""
    from matplotlib.image import AxesImage
    from matplotlib.ticker import MaxNLocator
    low, high = field.get_clim()
    bar = AxesImage(axis, cmap=field.get_cmap(), extent=(1 + away, 1 + away + width, 0, 1), origin="lower", transform=axis.transAxes, clip_on=False, zorder=2)
    bar.set_data(np.linspace(low, high, 256)[:, None])
    bar.set_clim(low, high)
    bar.set_label("key")
    bar.set_in_layout(False)  # its extent would be taken for one in data; the numbers are farther out
    axis.add_artist(bar)
    bar.set_clip_path(None)
    ticks = MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(low, high)
    ticks = ticks[(ticks >= low) & (ticks <= high)] if high > low else np.array([low])
    step = np.ptp(ticks[:2]) or abs(low) or 1
    places = min(12, max(0, -int(np.floor(np.log10(step) + 1e-9))))
    for at in ticks:
        height = (at - low) / (high - low) if high > low else 0.5
        axis.text(1 + away + 1.25 * width, height, f"{at:.{places}f}".replace("-", "\u2212"), transform=axis.transAxes, fontsize=8, va="center", color=INK)
    long = max(len(f"{at:.{places}f}") for at in ticks)
    axis.annotate(label, (1 + away + 1.25 * width, 0.5), xycoords=axis.transAxes, xytext=(5.6 * long + 4, 0), textcoords="offset points", rotation=90, va="center",
                  fontsize=9, color=INK)


def mark_end(axis, x, y, size=6):
    """Where a branch stops before the end of its range."""
    axis.plot([x], [y], marker="X", color="white", markersize=size, markeredgecolor=INK, markeredgewidth=0.9,
              linestyle="none", zorder=7)


def branch_legend(kinds, more=(), ends=(), solid="stable", dashed="unstable"):
    """Handles for stable, unstable, the kinds of bifurcation that occur, and the ends of branches (name, reason)."""
    handles = list(more) + [Line2D([], [], color=GREY, label=solid),
                            Line2D([], [], color=GREY, linestyle=DASHED, linewidth=1.3, label=dashed)]
    for kind in dict.fromkeys(k for k in kinds if k in MARKS):
        short, marker, words = MARKS[kind]
        handles.append(Line2D([], [], color=INK, marker=marker, linestyle="none", markersize=6,
                              markeredgecolor="white", label=f"{short}  {words}"))
    for reason in dict.fromkeys(ends):
        handles.append(Line2D([], [], color="white", marker="X", markeredgecolor=INK, markeredgewidth=0.9, linestyle="none",
                              markersize=6, label=f"ends: {in_print(reason)}"))
    return handles


def ticks_at(axis, places, texts=None):
    """Ticks of an x or y axis at these places, with these texts. matplotlib's own functions make all artists of the ticks at once."""
    from matplotlib.ticker import FixedFormatter, FixedLocator
    axis.set_major_locator(FixedLocator(places))
    if texts is not None:
        axis.set_major_formatter(FixedFormatter(texts))


def grid_of(count, width=3.4, height=2.7, columns=3, **more):
    """A figure of `count` panels; those left over are empty."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(max(7.2, width * columns), height * rows + 1.0), squeeze=False, **more)
    for axis in axes.ravel()[count:]:
        axis.set_visible(False)
    return figure, list(axes.ravel()[:count]), axes
