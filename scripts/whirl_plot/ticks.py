"""Ticks of finished figures, computed once.

For a picture matplotlib asks each axis up to ten times for them and for the extents of their labels."""
import contextlib

ASKED = ("_update_ticks", "_get_ticklabel_bboxes")


@contextlib.contextmanager
def settled():
    """Within, the second of the two rounds of matplotlib's constrained layout leaves axes in their place where what stands around them has
    the size of the first: their ticks are known then, and need not be found a third time for the drawing."""
    from matplotlib import _constrained_layout as layout
    from matplotlib.transforms import Bbox
    real, known = getattr(layout, "get_pos_and_bbox", None), {}

    def again(axes, renderer):
        place, outer = real(axes, renderer)
        if axes not in known:
            known[axes] = outer.get_points() - place.get_points()
            return place, outer
        as_before = place.get_points() + known[axes]
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
def remembered():
    """Within, an axis has the ticks and extents of the last time as long as its limits, its place and the resolution are the same.
    Only for figures of which nothing else changes. Gives a function that forgets them, for a format that measures text in its own way."""
    from matplotlib.axes._base import _AxesBase
    from matplotlib.axis import Axis, XAxis, YAxis
    real = {name: getattr(Axis, name) for name in ASKED if hasattr(Axis, name)}
    known = {}

    def once(name):
        def of(axis, *words, **more):
            if type(axis) not in (XAxis, YAxis):  # axes in space move otherwise
                return real[name](axis, *words, **more)
            state = (axis.figure.dpi, *axis.get_view_interval(), *(round(b, 3) for b in axis.axes.bbox.bounds))
            if known.get((name, axis), (None,))[0] != state:
                known[name, axis] = state, real[name](axis, *words, **more)
            return known[name, axis][1]
        return of

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

    title_position = _AxesBase._update_title_position
    try:
        _AxesBase._update_title_position = titled
        for name in real:
            setattr(Axis, name, once(name))
        yield known.clear
    finally:
        _AxesBase._update_title_position = title_position
        for name, method in real.items():
            setattr(Axis, name, method)
