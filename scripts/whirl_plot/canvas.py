"""matplotlib in the look of all pictures, imported when the first one is drawn: what only reads results needs none of it, and it takes as
long as three pictures."""
import functools
import gc
import re


@functools.cache
def pyplot():
    gc.set_threshold(50_000, 50)  # figures are many small objects: counting their garbage takes a tenth of the time
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot

    from .style import COLOURS, GREY, INK, LIGHT
    matplotlib.rcParams.update({
        "figure.dpi": 110, "savefig.dpi": 150, "figure.constrained_layout.use": True,
        "font.size": 9.5, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
        "axes.labelsize": 9.5, "axes.labelcolor": INK, "axes.edgecolor": GREY, "axes.linewidth": 0.8,
        "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
        "grid.color": LIGHT, "grid.linewidth": 0.5, "xtick.color": INK, "ytick.color": INK,
        "xtick.labelsize": 8.5, "ytick.labelsize": 8.5, "legend.fontsize": 8.5, "legend.frameon": False,
        "lines.linewidth": 1.6, "lines.solid_capstyle": "round", "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
        # Texts stay texts and equal pictures equal files.
        "svg.fonttype": "none", "svg.hashsalt": "whirl", "path.simplify": True, "path.simplify_threshold": 0.15,
    })
    plain_decades()
    keep_ticks()
    return matplotlib.pyplot


def keep_ticks():
    """A spine that is asked for its place for the first time throws away the ticks of its axis, which have just been made; and an axis makes
    a minor tick to clip it, though it has no minor ticks."""
    from matplotlib.artist import Artist
    from matplotlib.axis import Axis
    from matplotlib.spines import Spine

    def clip(axis, path, transform=None):
        Artist.set_clip_path(axis, path, transform)
        for tick in (*vars(axis).get("majorTicks", ()), *vars(axis).get("minorTicks", ())):
            tick.set_clip_path(path, transform)

    def at_the_axes(spine):
        if spine._position is None:
            axis, spine.axis = spine.axis, None
            spine.set_position(("outward", 0.0))
            spine.axis = axis

    Spine._ensure_position_is_set, Axis.set_clip_path = at_the_axes, clip


def contours(axis, x, y, values, levels, colour, alpha):
    """Lines of equal values as one artist; matplotlib makes one for each level."""
    from contourpy import contour_generator
    from matplotlib.collections import LineCollection
    lines = contour_generator(x, y, values, corner_mask=False)
    axis.add_collection(LineCollection([line for level in levels for line in lines.lines(level)], colors=[colour], linewidths=0.5, alpha=alpha), autolim=False)


RAISED = str.maketrans("-\u22120123456789", "\u207b\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")


def plain_decades():
    """Powers of ten of logarithmic axes as letters of the font: a formula takes longer to set than all the rest of an axis."""
    from matplotlib import scale
    from matplotlib.ticker import LogFormatterSciNotation

    class Decades(LogFormatterSciNotation):
        def __call__(self, x, pos=None):
            text = super().__call__(x, pos)
            found = re.fullmatch(r"\$\\mathdefault\{(.*)\}\$", text)
            return text if not found else re.sub(r"\^\{([^}]*)\}", lambda m: m[1].translate(RAISED), found[1]).replace("\\times", "\u00d7").replace("-", "\u2212")

    scale.LogFormatterSciNotation = Decades


class Later:
    """`plt` of matplotlib, at its first use."""

    def __getattr__(self, name):
        return getattr(pyplot(), name)


plt = Later()


def Line2D(*points, **look):  # noqa: N802
    """A line of matplotlib, for legends."""
    from matplotlib.lines import Line2D as Line
    return Line(*points, **look)


def plain_numbers(axis):
    """Numbers such as 200, 500 and 1000 along a logarithmic axis of few decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 1e3 * low else (1,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.12g}"))
    axis.set_minor_formatter(NullFormatter())
