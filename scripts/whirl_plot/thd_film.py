"""The film of a bearing with heat as its pictures see it: fields at nodes, and regions between which fields jump."""
import numpy as np

from .style import runs

HEAT = "inferno"
LABEL = "temperature [\u00b0C]"  # as on the screen
ZERO = 273.15  # K
FULL, RUPTURED = 0, 1  # regions of a film; those of grooves follow


def closes(theta):
    """Whether the first node is about a step behind the last one."""
    step = np.diff(theta).max()
    return abs(theta[0] + 2 * np.pi - theta[-1] - step) < 0.5 * step


def ring(theta, values, closed):
    """Angles and values [..., around] with the first behind the last, where the ring closes."""
    if not closed:
        return theta, values
    return np.append(theta, theta[0] + 2 * np.pi), np.concatenate((values, values[..., :1]), axis=-1)


def cavity_of(pressure, fill=None):
    """Nodes [along, around] of a pad where the film is ruptured: not full, or without pressure where nothing pulls. The edges, which have
    no pressure of their own, are as their neighbours."""
    inside = fill < 1 if fill is not None else (pressure <= 0) & (pressure.min() >= 0)
    if min(inside.shape) < 3:
        return np.zeros(inside.shape, bool)
    return np.pad(inside[1:-1, 1:-1], 1, mode="edge")


class Unwrapped:
    """Nodes [along, around] of a film and the regions between which fields jump."""

    def __init__(self, theta, z, cavity, groove=None):
        self.theta, self.z, self.cavity = theta, z, cavity
        self.groove = np.zeros(cavity.shape, int) if groove is None else groove
        self.region = np.where(self.groove > 0, RUPTURED + self.groove, np.where(cavity, RUPTURED, FULL))

    @property
    def closed(self):
        return closes(self.theta)

    @property
    def step(self):
        """rad between nodes."""
        return np.diff(self.theta).max()

    def fine(self, values, jumps=True):
        """Angles [rad] and z [m] of the edges of fine cells, values in them, and their regions: a node's field goes to the faces of its
        cell, where it meets another region, and is interpolated between nodes of one region. No value is new. What does not jump has
        one region."""
        closed = self.closed
        theta, values = ring(self.theta, values, closed)
        _, region = ring(self.theta, self.region if jumps else np.zeros_like(self.region), closed)
        per_cell = [2 * max(1, -(-size // (2 * (count - 1)))) for size, count in ((200, len(self.z)), (400, len(theta)))]
        places = [(np.arange((count - 1) * m) + 0.5) / m for m, count in zip(per_cell, values.shape)]
        first = [p.astype(int) for p in places]
        share = [p - f for p, f in zip(places, first)]
        own = region[np.ix_(*(np.round(p).astype(int) for p in places))]
        total, weight = np.zeros(own.shape), np.zeros(own.shape)
        for dj in (0, 1):
            for di in (0, 1):
                at = np.ix_(first[0] + dj, first[1] + di)
                w = np.outer(*(np.abs(1 - d - s) for d, s in zip((dj, di), share))) * (region[at] == own)
                total += w * values[at]
                weight += w
        edges = [np.interp(np.arange((count - 1) * m + 1) / m, np.arange(count), nodes)
                 for m, count, nodes in zip(per_cell, values.shape, (self.z, theta))]
        return edges[1], edges[0], total / weight, own

    def strips(self, mask):
        """Rectangles (rad, rad, m, m) that the cells of nodes in `mask` fill: those side by side in a row as one, and rows that are alike."""
        z = np.concatenate((self.z[:1], (self.z[1:] + self.z[:-1]) / 2, self.z[-1:]))
        theta, mask = ring(self.theta, mask, self.closed)
        edges = np.concatenate((theta[:1], (theta[1:] + theta[:-1]) / 2, theta[-1:]))
        found, open_ones = [], {}  # by their ends: the rectangle that goes on if the next row has the same one
        for j, row in enumerate(mask):
            here = {(start, stop): open_ones.get((start, stop), z[j]) for start, stop in runs(list(row)) if row[start]}
            found += [(edges[a], edges[b], bottom, z[j]) for (a, b), bottom in open_ones.items() if (a, b) not in here]
            open_ones = here
        return found + [(edges[a], edges[b], bottom, z[-1]) for (a, b), bottom in open_ones.items()]

    def border(self, mask):
        """Segments [[(rad, m), (rad, m)]] between the cells of nodes in `mask` and others, and the film's ends."""
        n, found = len(self.theta), []
        z = np.concatenate((self.z[:1], (self.z[1:] + self.z[:-1]) / 2, self.z[-1:]))
        low, high = self.theta[0], self.theta[0] + 2 * np.pi if self.closed else self.theta[-1]
        for i in range(n if self.closed else n - 1):
            for j in np.flatnonzero(mask[:, i] != mask[:, (i + 1) % n]):
                at = self.theta[i] + self.step / 2
                found.append([(at, z[j]), (at, z[j + 1])])
        padded = np.pad(mask, ((1, 1), (0, 0)))
        for i in range(n):
            spans = [(max(low, self.theta[i] - self.step / 2), min(high, self.theta[i] + self.step / 2))]
            if self.closed and i == 0:
                spans.append((high - self.step / 2, high))
            for j in np.flatnonzero(padded[1:, i] != padded[:-1, i]):
                found += [[(a, z[j]), (b, z[j])] for a, b in spans]
        return found


class Film(Unwrapped):
    """Fields at the nodes, [along, around], and the temperature [degC] from the bush (zeta 0) to the journal (zeta 1)."""

    def __init__(self, study):
        self.thickness, self.pressure = study.get("film/thickness"), study.get("film/pressure")
        self.radius = float(np.ravel(study.get("film/radius", 0))[0])
        self.speed = study.get("film/speed")
        self.speed = None if self.speed is None else float(np.ravel(self.speed)[0])
        self.temperature = study.get("film/temperature") - ZERO
        layers = self.temperature.shape[2]
        self.zeta = (np.arange(layers) + 0.5) / layers
        self.walls = {name: study.get(f"film/{name}_wall") - ZERO for name in ("bush", "journal") if study.has(f"film/{name}_wall")}
        for name, at in (("bush", 0), ("journal", 1)):
            if name in self.walls:
                side = 0 if at == 0 else len(self.zeta)
                self.zeta = np.insert(self.zeta, side, at)
                self.temperature = np.insert(self.temperature, side, self.walls[name], axis=2)
        nowhere = np.zeros(self.thickness.shape)
        super().__init__(study.get("film/theta"), study.get("film/z"), study.get("film/ruptured", nowhere) > 0,
                         np.round(study.get("film/groove", nowhere)).astype(int))
        self.conserves_mass = study.has("film/fill")
        self.orifices = np.stack((study.get("orifices/theta"), study.get("orifices/z")), axis=1) if study.has("orifices/theta", "orifices/z") else np.zeros((0, 2))

    @property
    def flow_known(self):
        """Whether nodes know what flows there: not where the film is ruptured, unless it conserves its mass."""
        return np.ones(self.cavity.shape, bool) if self.conserves_mass else ~self.cavity

    @property
    def middle(self):
        """degC [along, around] between the walls."""
        return np.array([[np.interp(0.5, self.zeta, column) for column in row] for row in self.temperature])

    @property
    def areas(self):
        """m^2 [along, around], of the cells around the nodes: half of one at an end."""
        ends = np.concatenate((self.z[:1], (self.z[1:] + self.z[:-1]) / 2, self.z[-1:]))
        widths = np.full(len(self.theta), self.radius * self.step)
        if not self.closed:
            widths[[0, -1]] /= 2
        return np.diff(ends)[:, None] * widths

    @property
    def rotation(self):
        """The way of the shaft in an unwrapped map."""
        if self.speed == 0:
            return "the shaft stands"
        return "\u2190 the shaft moves to the left" if (self.speed or 1) < 0 else "the shaft moves to the right \u2192"

    @property
    def at_speed(self):
        return "" if self.speed is None else "at standstill" if self.speed == 0 else f"at {self.speed:.5g} rad/s"

    def place(self):
        """Clearance and eccentricity [m] of the circle that the thickness is the gap of: h = c - x cos - y sin."""
        h = self.thickness.mean(axis=0)
        return np.linalg.lstsq(np.stack((np.ones_like(h), -np.cos(self.theta), -np.sin(self.theta)), axis=1), h, rcond=None)[0]


def stretches(region, at, values, ends=None):
    """Pieces of a line of nodes [.., node] within which nothing jumps: (region, places, values) of each. A piece goes half-way to the next
    one, where it has the value of its last node; the first and the last end at `ends`, if these are given, else at their nodes."""
    for start, stop in runs(list(region)):
        places, piece = at[start:stop], values[..., start:stop]
        for side, is_end in ((0, start == 0), (-1, stop == len(at))):
            if not is_end:
                edge = (at[start - 1] + at[start]) / 2 if side == 0 else (at[stop - 1] + at[stop]) / 2
            elif ends is not None:
                edge = ends[side]
            else:
                continue
            where = 0 if side == 0 else len(places)
            places, piece = np.insert(places, where, edge), np.insert(piece, where, piece[..., side], axis=-1)
        yield region[start], places, piece
