"""Streamlines of a field over a rectangle, evenly spaced. All lines are followed at once; that of matplotlib follows them one by one in
Python, which takes as long as the rest of a picture."""
import numpy as np

CELLS = 28  # across and up: in each passes at most one line
STEP = 1 / (3 * CELLS)  # of the width and the height
LONGEST, SHORTEST = 1.5, 0.12  # lengths of a line to both sides, and of one that is drawn, in widths


def bilinear(field, at):
    """The field [component, row, column] at places [x or y, place] in the unit square; NaN outside and beside nodes that have none."""
    count = np.array(field.shape[:0:-1])[:, None] - 1
    inside = np.all((at >= 0) & (at <= 1), axis=0)
    place = np.where(inside, at, 0) * count
    first = np.minimum(place.astype(int), count - 1)
    (s, t), (i, j) = place - first, first
    value = (1 - s) * (1 - t) * field[:, j, i] + s * (1 - t) * field[:, j, i + 1] + (1 - s) * t * field[:, j + 1, i] + s * t * field[:, j + 1, i + 1]
    return np.where(inside, value, np.nan)


def followed(field, seeds, way):
    """Places [step, x or y, seed] of the lines through the seeds, by the midpoint rule in steps of equal length; NaN behind their ends."""
    def step(at, length):
        ahead = bilinear(field, at)
        return at + way * length * ahead / np.hypot(*ahead)

    lines = [seeds]
    with np.errstate(invalid="ignore", divide="ignore"):
        for _ in range(int(LONGEST / STEP)):
            at = lines[-1]
            half = step(at, STEP / 2)
            ahead = bilinear(field, half)
            lines.append(at + way * STEP * ahead / np.hypot(*ahead))
            if not np.isfinite(lines[-1]).any():
                break
    return np.array(lines)


def streamlines(u, v):
    """Lines [(x, y), ...] in the unit square along (u, v) [row, column], both per width and height of the square."""
    field = np.array([u, v])
    side = (np.arange(CELLS) + 0.5) / CELLS
    seeds = np.array(np.meshgrid(side, side)).reshape(2, -1)
    # From the rim inwards: what comes in or goes out makes the longest lines.
    seeds = seeds[:, np.argsort(np.minimum(seeds, 1 - seeds).min(axis=0), kind="stable")]
    ways = [followed(field, seeds, way) for way in (1, -1)]
    free, found = np.ones(CELLS * CELLS, bool), []
    cells = [np.where(np.isfinite(w).all(axis=1), (np.clip(np.nan_to_num(w), 0, 1 - 1e-9) * CELLS).astype(int)[:, 0] * CELLS
                      + (np.clip(np.nan_to_num(w), 0, 1 - 1e-9) * CELLS).astype(int)[:, 1], -1) for w in ways]
    for k in range(seeds.shape[1]):
        if not free[cells[0][0, k]]:
            continue
        halves, own = [], set()
        for way, cell in zip(ways, cells):
            here = cell[:, k]
            entered = np.flatnonzero(np.diff(here, prepend=-2))  # the first step in each cell
            stop = len(here)
            for at in entered:
                c = int(here[at])
                if c < 0 or not free[c] or (c in own and at > 0):
                    stop = at
                    break
                own.add(c)
            halves.append(way[:stop, :, k])
        line = np.concatenate([halves[1][:0:-1], halves[0]])
        if len(line) * STEP > SHORTEST:
            free[list(own)] = False
            found.append(line.T)
    return found
