"""Ticks of finished figures, computed once.

For a picture matplotlib asks each axis up to ten times for them and for the extents of their labels."""
import contextlib

from matplotlib.axis import Axis, XAxis, YAxis

ASKED = ("_update_ticks", "_get_ticklabel_bboxes")


@contextlib.contextmanager
def remembered():
    """Within, an axis has the ticks and extents of the last time as long as its limits, its place and the resolution are the same.
    Only for figures of which nothing else changes. Gives a function that forgets them, for a format that measures text in its own way."""
    real = {name: getattr(Axis, name) for name in ASKED if hasattr(Axis, name)}
    known = {}

    def once(name):
        def of(axis, *words, **more):
            if type(axis) not in (XAxis, YAxis):  # axes in space move otherwise
                return real[name](axis, *words, **more)
            state = (axis.figure.dpi, *axis.get_view_interval(), *axis.axes.bbox.bounds)
            if known.get((name, axis), (None,))[0] != state:
                known[name, axis] = state, real[name](axis, *words, **more)
            return known[name, axis][1]
        return of

    try:
        for name in real:
            setattr(Axis, name, once(name))
        yield known.clear
    finally:
        for name, method in real.items():
            setattr(Axis, name, method)
