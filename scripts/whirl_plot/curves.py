"""Smooth curves through computed points: cycles over a period, branches along their arclength."""
import functools

import numpy as np

SHARP, FAR = np.radians(100), 0.02  # turn of a picture between two stretches, and their length over that of the axes, for straight ones
DENSE = 16  # pieces that a stretch between two points is drawn in


def periodic(values, pieces=4):
    """The periodic cubic spline through equidistant samples [time, ...], at `pieces` times as many times, closed.

    The coefficients c of B-splines solve (c_{k-1} + 4 c_k + c_{k+1})/6 = values_k, a circulant system."""
    values = np.asarray(values, float)
    n = len(values)
    symbol = (4 + 2 * np.cos(2 * np.pi * np.arange(n) / n)) / 6
    c = np.fft.ifft(np.fft.fft(values, axis=0) / symbol.reshape((n,) + (1,) * (values.ndim - 1)), axis=0).real
    before, after, second = np.roll(c, 1, 0), np.roll(c, -1, 0), np.roll(c, -2, 0)
    t = np.arange(pieces).reshape((1, pieces) + (1,) * (values.ndim - 1)) / pieces
    weights = (1 - t)**3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6
    dense = sum(w * b[:, None] for w, b in zip(weights, (before, c, after, second)))
    dense = dense.reshape((n * pieces,) + values.shape[1:])
    return np.concatenate([dense, dense[:1]])


def slopes(s, values):
    """d values/ds at the points: of the parabola through each and its neighbours, but at most three times the smaller chord
    where both chords rise or both fall, so that a kink is not overshot (Fritsch and Carlson, 1980)."""
    h, chord = np.diff(s), np.diff(values) / np.diff(s)
    if len(h) == 1:
        return np.array([chord[0], chord[0]])
    inner = (h[1:] * chord[:-1] + h[:-1] * chord[1:]) / (h[1:] + h[:-1])
    both = chord[:-1] * chord[1:] >= 0
    limit = 3 * np.minimum(np.abs(chord[:-1]), np.abs(chord[1:]))
    inner = np.where(both, np.sign(inner) * np.minimum(np.abs(inner), limit), inner)
    ends = [chord[0] - (inner[0] - chord[0]), chord[-1] - (inner[-1] - chord[-1])]
    for k, c in ((0, chord[0]), (1, chord[-1])):
        ends[k] = 0.0 if ends[k] * c < 0 else np.sign(c) * min(abs(ends[k]), 3 * abs(c))
    return np.concatenate([ends[:1], inner, ends[1:]])


def hermite(s, values, slope, pieces):
    """(s, values) of the cubics that have `values` and `slope` at the points s, each in `pieces` parts."""
    h, t = np.diff(s)[:, None], np.arange(pieces) / pieces
    cubic = ((1 + 2 * t) * (1 - t)**2 * values[:-1, None] + t * (1 - t)**2 * h * slope[:-1, None]
             + t**2 * (3 - 2 * t) * values[1:, None] + t**2 * (t - 1) * h * slope[1:, None])
    return np.append(s[:-1, None] + h * t, s[-1]), np.append(cubic, values[-1])


def through(s, values, pieces=8):
    """(s, values) of the curve through points over an ascending s that overshoots no kink."""
    s, values = np.asarray(s, float), np.asarray(values, float)
    return (s, values) if len(s) < 3 else hermite(s, values, slopes(s, values), pieces)


def natural(s, values):
    """d values/ds at the points of the natural cubic spline through them."""
    h, n = np.diff(s), len(s)
    if n < 3:
        return np.full(n, (values[-1] - values[0]) / h[0] if n == 2 else 0, np.asarray(values).dtype)
    rows, chord = np.diag(np.full(n, 2.0)), np.diff(values) / h
    rows[0, 1] = rows[-1, -2] = 1
    right = np.concatenate([[3 * chord[0]], 3 * (h[1:] * chord[:-1] + h[:-1] * chord[1:]) / (h[1:] + h[:-1]), [3 * chord[-1]]])
    for k in range(1, n - 1):
        rows[k, k - 1], rows[k, k + 1] = h[k] / (h[k - 1] + h[k]), h[k - 1] / (h[k - 1] + h[k])
    return np.linalg.solve(rows, right)


def along_shaft(z, values, slope=None, shown=240):
    """(z, values) of a shaft's line, real or complex: in each element the cubic of its displacement and slope at both nodes, which
    is how a beam bends between loads at its nodes. Results without slopes: the natural spline through the nodes."""
    z, values = np.asarray(z, float), np.asarray(values)
    if len(z) < 2:
        return z, values
    slope = natural(z, values) if slope is None else np.asarray(slope)
    return hermite(z, values, slope, max(2, -(-shown // (len(z) - 1))))


class Branch:
    """A branch through its points, cubic along the arclength: parameter and any number of curves over it."""

    def __init__(self, parameter, step=None, unstable=None, filled=False):
        self.filled = filled
        self.parameter = np.asarray(parameter, float)
        n = len(self.parameter)
        self.unstable = np.zeros(n, int) if unstable is None else np.asarray(unstable, int)
        length = np.asarray(step, float)[1:] if step is not None and len(step) == n else np.abs(np.diff(self.parameter))
        positive = length[np.isfinite(length) & (length > 0)]
        length = np.where(np.isfinite(length) & (length > 0), length, positive.min() if len(positive) else 1.0)
        self.s = np.concatenate([[0.0], np.cumsum(length)])
        self._own = self._prepare(self.parameter)

    def _prepare(self, values, straight=None):
        """Values, and the slopes of the cubics at the beginning and the end of each segment; those of `straight` ones are lines."""
        values = np.asarray(values, float)
        if len(values) < 2:
            return values, np.zeros(0), np.zeros(0)
        slope = slopes(self.s, values)
        begin, end = slope[:-1].copy(), slope[1:].copy()
        if straight is not None and straight.any():
            chord = np.diff(values) / np.diff(self.s)
            begin[straight], end[straight] = chord[straight], chord[straight]
        return values, begin, end

    def straight(self, values):
        """Segments in which too few points were computed for a curve: on both sides of a point at which the picture turns sharply between
        points that are far apart. Of branches that were filled where they bend there are none: as lines they are right to a percent."""
        values, n = np.asarray(values, float), len(self.parameter)
        if self.filled and n > 2:
            return np.zeros(n - 1, bool)
        if n < 3:
            return np.ones(max(0, n - 1), bool)
        size = np.array([np.ptp(self.parameter) or 1, max(np.ptp(values), 0.02 * np.abs(values).max()) or 1])
        step = np.stack([np.diff(self.parameter), np.diff(values)], axis=1) / size * (1.4, 1)
        length = np.hypot(*step.T)
        turn = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(step[:, 1], step[:, 0])))))
        coarse = (turn > SHARP) & (np.minimum(length[:-1], length[1:]) > FAR)
        return np.append(coarse, False) | np.insert(coarse, 0, False)

    @staticmethod
    def _cubic(prepared, s, i, t):
        values, begin, end = prepared
        h = s[i + 1] - s[i]
        return ((1 + 2 * t) * (1 - t)**2 * values[i] + t * (1 - t)**2 * h * begin[i]
                + t**2 * (3 - 2 * t) * values[i + 1] + t**2 * (t - 1) * h * end[i])

    def _segments(self, prepared):
        """The cubics [segment][part] of a curve, at DENSE + 1 points of each segment."""
        return self._cubic(prepared, self.s, np.arange(len(self.s) - 1)[:, None], np.linspace(0, 1, DENSE + 1))

    @functools.cached_property
    def _dense(self):
        return self._segments(self._own)

    def with_points(self, values, places, known):
        """The branch with further points at places (ascending, one a segment at most) where a curve has the values `known`: that
        branch, the curve through all, and the index of each new point."""
        s, parameter, unstable, values, new = self.s, self.parameter, self.unstable, np.asarray(values, float), []
        for number, ((i, t), value) in enumerate(zip(places, known)):
            k = i + 1 + number
            at = self.s[i] + t * (self.s[i + 1] - self.s[i])
            s, parameter = np.insert(s, k, at), np.insert(parameter, k, self.at(self.parameter, (i, t)))
            unstable, values = np.insert(unstable, k, min(self.unstable[i], self.unstable[i + 1])), np.insert(values, k, value)
            new.append(k)
        return Branch(parameter, np.diff(s, prepend=s[0]), unstable, self.filled), values, new

    def at(self, values, place):
        """A curve at a place (segment, t in [0, 1]) on the branch."""
        if len(self.parameter) == 1:
            return float(values[0])
        i, t = place
        if self.straight(values)[i]:
            return float(values[i] + self._along_line(i, t) * (values[i + 1] - values[i]))
        return float(self._cubic(self._prepare(values), self.s, i, t))

    def _along_line(self, i, t):
        """Where on the straight line of a segment the parameter is that its cubic has at t."""
        step = self.parameter[i + 1] - self.parameter[i]
        return float(np.clip((self._cubic(self._own, self.s, i, t) - self.parameter[i]) / step, 0, 1)) if step else t

    def place(self, kind, value):
        """Where on the branch a bifurcation is: (segment, t). A limit point where the branch turns nearest to `value`; others
        where it passes `value`, and changes stability if it passes more than once; None if it passes nowhere near."""
        n = len(self.parameter)
        if n < 2:
            return (0, 0.0)
        t, dense = np.linspace(0, 1, DENSE + 1), self._dense
        if kind in ("fold", "cyclic_fold"):
            flat = np.concatenate([dense[:, :-1].ravel(), dense[-1:, -1]])
            slope = np.sign(np.diff(flat))
            turns = np.nonzero(slope[:-1] * slope[1:] < 0)[0] + 1
            if len(turns):
                k = turns[np.argmin(np.abs(flat[turns] - value))]
                return (min(k // DENSE, n - 2), k % DENSE / DENSE if k // DENSE < n - 1 else 1.0)
        d = dense - value
        found = []
        for i, k in np.argwhere((d[:, :-1] * d[:, 1:] < 0) | (d[:, :-1] == 0)):
            before, after = d[i, k:k + 2]
            found.append((int(i), t[k] + (t[1] - t[0]) * (before / (before - after) if before != after else 0.0)))
        if dense[-1, -1] == value:
            found.append((n - 2, 1.0))
        if not found:
            near = np.abs(dense - value)
            i, k = np.unravel_index(np.argmin(near), near.shape)
            return (int(i), float(t[k])) if near[i, k] < 0.02 * max(np.ptp(self.parameter), 1e-300) else None
        changes = [f for f in found if self.unstable[f[0]] != self.unstable[f[0] + 1]]
        return (changes or found)[0]

    def place_in(self, segment, value, fold):
        """Where in a segment the parameter turns (`fold`), or comes nearest to `value`: (segment, t)."""
        t = np.linspace(0, 1, 8 * DENSE + 1)
        dense = self._cubic(self._own, self.s, segment, t)
        if fold:
            low = dense.min() < min(dense[0], dense[-1])
            return (segment, float(t[np.argmin(dense) if low else np.argmax(dense)]))
        return (segment, float(t[np.argmin(np.abs(dense - value))]))

    def stretches(self, values, stable, places, changes=None):
        """Pieces (parameter, curve, stable) of one style each. The style changes at the bifurcation between two points where
        one is known, else the whole segment goes with its less stable end. `changes` {segment: [(t, stable behind it)]} says more
        than `places`: several of them may lie between two points."""
        if len(self.parameter) < 2:
            return []
        stable = np.asarray(stable, bool)
        straight = self.straight(values)
        prepared, own = (self._prepare(v, straight) for v in (values, self.parameter))
        dense, across = self._segments(prepared), self._segments(own)
        cuts = dict(changes or {})
        for place in places:
            if place is not None and stable[place[0]] != stable[place[0] + 1]:
                cuts.setdefault(place[0], [(place[1], bool(stable[place[0] + 1]))])
        pieces = []

        def add(i, a, b, solid):
            if (a, b) == (0.0, 1.0):
                x, y = across[i], dense[i]
            else:
                t = np.linspace(a, b, DENSE + 1)
                x, y = self._cubic(own, self.s, i, t), self._cubic(prepared, self.s, i, t)
            if pieces and pieces[-1][2] == solid:
                pieces[-1][0].append(x[1:])
                pieces[-1][1].append(y[1:])
            else:
                pieces.append(([x], [y], solid))

        for i in range(len(self.parameter) - 1):
            if i in cuts:
                ends = [0.0, *(self._along_line(i, t) if straight[i] else t for t, _ in cuts[i]), 1.0]
                for a, b, solid in zip(ends[:-1], ends[1:], [bool(stable[i]), *(behind for _, behind in cuts[i])]):
                    add(i, a, b, solid)
            else:
                add(i, 0, 1, bool(stable[i] and stable[i + 1]))
        return [(np.concatenate(x), np.concatenate(y), solid) for x, y, solid in pieces]
