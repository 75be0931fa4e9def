"""Ticks of finished figures, measured and drawn together.

matplotlib makes five artists for each tick, and for a picture asks each axis up to ten times for its ticks and for the extents of their
labels. Here an axis has one tick, which stands for all of its kind."""
import contextlib

import numpy as np

LAYOUTS = {}  # text and look of a label -> its extent about its place and the lines that it consists of


class Labels:
    """The labels on one side of an axis."""

    def __init__(self, label, places, texts):
        self.label, self.places, self.texts = label, places, texts
        self.get_visible = label.get_visible

    def layouts(self, renderer):
        """(text, place in pixels, extent about it, lines) of each label."""
        label = self.label
        look = (label.get_fontproperties(), label.get_rotation(), label.get_horizontalalignment(), label.get_verticalalignment(), label.figure.dpi, type(renderer))
        for text, place in zip(self.texts, label.get_transform().transform(self.places)):
            if (text, look) not in LAYOUTS:
                label.set_text(text)
                extent, lines, _ = label._get_layout(renderer)
                LAYOUTS[text, look] = extent.get_points() if text else np.zeros((2, 2)), lines
            yield (text, place, *LAYOUTS[text, look])

    def get_window_extent(self, renderer):
        from matplotlib.transforms import Bbox
        corners = np.array([place + extent for _, place, extent, _ in self.layouts(renderer)])
        return Bbox([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))])

    def draw(self, renderer):
        gc, label = renderer.new_gc(), self.label
        gc.set_foreground(label.get_color())
        gc.set_alpha(label.get_alpha())
        for (text, place, _, lines), point in zip(self.layouts(renderer), self.places):
            if "$" in text:  # formulas
                label.set_text(text)
                label.set_position(point)
                label.draw(renderer)
                continue
            for words, _, dx, dy in lines if text else ():
                x, y = place + (dx, dy)
                y = renderer.get_canvas_width_height()[1] - y if renderer.flipy() else y
                renderer.draw_text(gc, x, y, words, label.get_fontproperties(), label.get_rotation())
        gc.restore()


class Row:
    """All major or all minor ticks of an axis."""

    def __init__(self, axis, tick, places, texts):
        self.tick, self.places, self.texts, self.upright = tick, places, texts, axis.axis_name == "y"
        self.label1, self.label2 = (Labels(label, self.points(side), texts) for label, side in ((tick.label1, 0), (tick.label2, 1)))

    def points(self, *across):
        """Points (x, y) at the sides `across` of the axes, for each tick."""
        points = np.column_stack([np.repeat(self.places, len(across)), np.tile(across, len(self.places))])
        return points[:, ::-1] if self.upright else points

    def draw(self, renderer):
        tick = self.tick
        for line, across in ((tick.gridline, (0, 1, np.nan)), (tick.tick1line, (0,)), (tick.tick2line, (1,))):
            if line.get_visible():
                line.set_data(*self.points(*across).T)
                line.draw(renderer)
        for labels in (self.label1, self.label2):
            if labels.get_visible():
                labels.draw(renderer)


def rows_of(axis):
    """What matplotlib would have a list of ticks for; ticks that were made one by one as they are."""
    transform, found = axis.get_transform(), []
    low, high = np.sort(transform.transform(axis.get_view_interval()))
    for kind, ticker, places in (("major", axis.major, axis.get_majorticklocs()), ("minor", axis.minor, axis.get_minorticklocs())):
        texts = ticker.formatter.format_ticks(places)
        ticker.formatter.set_locs(places)
        places = np.asarray(places, float)
        if not len(places):
            continue
        at = transform.transform(places)
        inside = np.flatnonzero((at >= low - 1e-10 * (high - low)) & (at <= high + 1e-10 * (high - low)))
        if not len(inside):
            continue
        made = getattr(axis, f"{kind}Ticks")
        if len(made) <= 2:  # what matplotlib makes by itself
            found.append(Row(axis, made[0], places[inside], [texts[k] for k in inside]))
            continue
        ticks = getattr(axis, f"get_{kind}_ticks")(len(places))
        for k in inside:
            ticks[k].update_position(places[k])
            ticks[k].set_label1(texts[k])
            ticks[k].set_label2(texts[k])
            found.append(ticks[k])
    return found


@contextlib.contextmanager
def settled():
    """Within, the second of the two rounds of matplotlib's constrained layout leaves axes in their place where what stands around them has
    the size of the first."""
    from matplotlib import _constrained_layout as layout
    from matplotlib.transforms import Bbox
    real, known = getattr(layout, "get_pos_and_bbox", None), {}

    def again(axes, renderer):
        plain = axes.get_aspect() == "auto" and axes.get_axes_locator() is None and axes.name == "rectilinear"
        told = [(axis.major.formatter.get_offset(), [tick.texts if isinstance(tick, Row) else tick.label1.get_text() for tick in axis._update_ticks()]) for axis in (axes.xaxis, axes.yaxis)] if plain else None
        if plain and axes in known and told == known[axes][0]:  # what stands around the axes has not changed
            place = axes.get_position(original=True)
            return place, Bbox(place.get_points() + known[axes][1])
        place, outer = real(axes, renderer)
        if axes not in known:
            known[axes] = told, outer.get_points() - place.get_points()
            return place, outer
        as_before = place.get_points() + known[axes][1]
        pixel = 1 / axes.figure.bbox.size
        return place, Bbox(as_before) if (abs(as_before - outer.get_points()) < pixel).all() else outer

    try:
        if real is not None:
            layout.get_pos_and_bbox = again
        yield
    finally:
        if real is not None:
            layout.get_pos_and_bbox = real


@contextlib.contextmanager
def together():
    """Within, the ticks of an axis are rows, which stay the same as long as its limits, its place and the resolution are the same. Only for
    figures of which nothing else changes. Gives a function that forgets them, for a format that measures text in its own way."""
    from matplotlib.axes._base import _AxesBase
    from matplotlib.axis import Axis, XAxis, YAxis
    update_ticks, extents, title_position = Axis._update_ticks, Axis._get_ticklabel_bboxes, _AxesBase._update_title_position
    known = {}

    def state_of(axis):
        return (axis.figure.dpi, *axis.get_view_interval(), *(round(b, 3) for b in axis.axes.bbox.bounds))

    def rows(axis):
        if type(axis) not in (XAxis, YAxis):  # axes in space move otherwise
            return update_ticks(axis)
        state = state_of(axis)
        if known.get(axis, (None,))[0] != state:
            known[axis] = [state, rows_of(axis), None]
        return known[axis][1]

    def extents_of(axis, ticks, renderer=None):
        if axis not in known or known[axis][1] is not ticks:
            return extents(axis, ticks, renderer)
        known[axis][2] = known[axis][2] or extents(axis, ticks, renderer)
        return known[axis][2]

    def titled(axes, renderer):
        # Titles move for ticks at the top and for a power of ten over the axis alone.
        titles = [title for title in (axes.title, axes._left_title, axes._right_title) if title.get_text()]
        if not titles:
            return
        if getattr(axes, "name", "") != "rectilinear" or axes.xaxis.get_ticks_position() != "bottom" or axes.yaxis.get_offset_text().get_text() \
                or axes.xaxis.get_label_position() != "bottom" or axes._twinned_axes.get_siblings(axes) != [axes]:
            title_position(axes, renderer)
        elif axes._autotitlepos is not False:
            for title in titles:
                title.set_position((title.get_position()[0], 1.0))

    try:
        Axis._update_ticks, Axis._get_ticklabel_bboxes, _AxesBase._update_title_position = rows, extents_of, titled
        yield known.clear
    finally:
        Axis._update_ticks, Axis._get_ticklabel_bboxes, _AxesBase._update_title_position = update_ticks, extents, title_position
