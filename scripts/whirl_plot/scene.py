"""Shafts in space for ParaView: the sag, mode shapes and periodic motions as solids of revolution that move, with the bores and their pressures.

    scripts/scene results/modes [--shapes 6] [--phases 24] [--reach 0.1]

writes STUDY.scene.xdmf and STUDY.scene.h5 beside results.h5, for each study that has a sag, shapes, or motions of the whole shaft: those
are the cycles of a branch at the values of `at` and at its bifurcations. ParaView's time is the part of a turn of the mode, or of the period
of the cycle, that has passed. Cycles are drawn about their mean position. Deflections are drawn larger, by the factor in the name of the block: a reach of 0.1 makes the largest
one a tenth of the length of the shaft. Discs and added masses are part of the solid; a disc that the deck gives by its mass alone has a
size that goes with its mass.
"""
import argparse
import pathlib
import sys
from xml.sax.saxutils import quoteattr

import h5py
import numpy as np

from .machine import discs_of, right_radius
from .manifest import register
from .live_branches import axis_of
from .shapes import at_words, normalised, tables_of
from .style import MARKS
from .subject import Drawn, called, said_in_a_sentence
from .units import number

SIDES = 20


def profile(deck, z):
    """(z, radius, radius of the bore) of the rotor, twice at each place between which it is smooth: shaft, added masses and discs; a plain
    rod where the deck gives no segments."""
    segments = (deck or {}).get("rotor", {}).get("segments") or []
    if not isinstance(segments, list) or not segments:
        return np.array([z[0], z[-1]]), np.full(2, 0.02 * (z[-1] - z[0])), np.zeros(2)
    half = lambda s, *keys: max(number(s.get(key)) or 0.0 for key in keys) / 2  # noqa: E731
    ends = np.cumsum([0.0] + [number(s.get("length")) or 0.0 for s in segments]) + z[0]
    parts = []  # from, to, radii there, radii of the bore there
    for s, a, b in zip(segments, ends, ends[1:]):
        left, bore = half(s, "outer_mass_diameter", "outer_stiffness_diameter"), half(s, "inner_mass_diameter")
        parts.append((a, b, left, right_radius(s, "right_outer_diameter", left), bore, right_radius(s, "right_inner_diameter", bore)))
        if number(s.get("added_mass")):
            parts.append((a, b, *[half(s, "added_mass_outer_diameter")] * 2, 0, 0))
    for node, radius, thickness, _, offset in discs_of(deck, max(max(p[2:4]) for p in parts)):
        if 1 <= node <= len(ends):
            at, thickness = ends[node - 1] + offset, thickness or 0.012 * (ends[-1] - ends[0])
            parts.append((at - thickness / 2, at + thickness / 2, radius, radius, 0, 0))
    edges = np.unique([p[:2] for p in parts])
    rows = []
    for a, b in zip(edges, edges[1:]):
        here = [p for p in parts if p[0] <= a and b <= p[1]] or [(a, b, 0, 0, 0, 0)]
        rows += [(at, *(max(np.interp(at, p[:2], p[k:k + 2]) for p in here) for k in (2, 4))) for at in (a, b)]
    return np.array(rows).T


def solid(z, radius, bore, x, y):
    """Corners [bore or surface][angle][place][x, y, z] of a solid of revolution whose centres are at x, y."""
    angle = np.linspace(0, 2 * np.pi, SIDES + 1)
    out = np.zeros((2, SIDES + 1, len(z), 3), dtype=np.float32)
    for k, r in enumerate((bore, radius)):
        out[k, ..., 0], out[k, ..., 1], out[k, ..., 2] = x + r * np.cos(angle)[:, None], y + r * np.sin(angle)[:, None], z
    return out


def over_period(samples, moments):
    """A periodic motion [time][place] about its mean at other moments [parts of the period], by its harmonics."""
    n = len(samples)
    order = np.arange(1, n // 2)
    return np.real(np.exp(2j * np.pi * moments[:, None] * order) @ np.fft.rfft(samples, axis=0)[order]) * 2 / n


def cycles_of(study):
    """(what it is, x, y) of each cycle whose whole shaft is known, [time][node]."""
    unit = axis_of(study)[1]
    for what, parameter, period, x, y in zip(*(study.get(f"shaft/{k}", []) for k in ("what", "parameter", "period", "x", "y"))):
        yield f"{'motion' if what == 'at' else MARKS.get(what, ('', '', what))[2]} at {parameter:.5g} {unit}".rstrip() + f", {1 / period:.4g} Hz", x, y


class Scene:
    """Blocks that are written to one file of data and named in one XDMF file."""

    def __init__(self, study, path):
        self.study, self.path, self.blocks = study, path, []
        self.data = h5py.File(path.with_suffix(".h5"), "w")

    def item(self, file, name, shape):
        dimensions = " ".join(map(str, shape))
        return f'<DataItem Dimensions="{dimensions}" NumberType="Float" Precision="{4 if file == self.data.filename else 8}" Format="HDF">' \
               f"{quoteattr(pathlib.Path(file).name + ':' + name)[1:-1]}</DataItem>"

    def grid(self, name, shape, geometry, fields):
        """A structured grid; fields are (name, item)."""
        kind = {2: "2DSMesh", 3: "3DSMesh"}[len(shape)]
        attributes = "".join(f'<Attribute Name={quoteattr(n)} AttributeType="Scalar" Center="Node">{item}</Attribute>' for n, item in fields)
        return f'<Grid Name={quoteattr(name)} GridType="Uniform"><Topology TopologyType="{kind}" Dimensions="{" ".join(map(str, shape))}"/>' \
               f'<Geometry GeometryType="XYZ">{geometry}</Geometry>{attributes}'

    def shaft(self, name, places, x, y, times, factor):
        """The shaft with centres x, y [time][place], drawn `factor` times as far from its axis."""
        z, radius, bore = profile(self.study.results.deck, places)
        key = f"{len(self.blocks)}"
        steps = []
        for k, time in enumerate(times):
            here = [np.interp(z, places, row[k]) for row in (x, y)]
            corners = solid(z, radius, bore, *(factor * row for row in here))
            distance = np.broadcast_to(np.hypot(*here).astype(np.float32), corners.shape[:3])
            for what, values in ((f"{key}/xyz{k}", corners), (f"{key}/distance{k}", distance)):
                self.data.create_dataset(what, data=values, compression=1, shuffle=True)
            items = [self.item(self.data.filename, f"{key}/{what}{k}", shape) for what, shape in (("xyz", corners.shape), ("distance", distance.shape))]
            steps.append(self.grid(name, distance.shape, items[0], [("distance from the axis", items[1])]) + f'<Time Value="{time:.9g}"/></Grid>')
        self.blocks.append((name, steps))

    def bores(self, times, moved):
        """The film pads with what results.h5 has of them, moved(z) = (x, y) away from where they are: to the shaft that is drawn larger."""
        def visit(path, group):
            if not isinstance(group, h5py.Group) or "node_xyz" not in group:
                return
            shape = group["node_xyz"].shape[:2]
            fields = [(f"{n} [{group[n].attrs.get('unit', '1')}]", self.item(group.file.filename, group[n].name, shape))
                      for n in ("pressure", "thickness") if n in group]
            name = path.removeprefix("films/").replace("/", " ")
            corners, key = group["node_xyz"][...].astype(np.float32), f"{len(self.blocks)}/xyz"
            corners[..., :2] += moved(corners[..., 2].mean())
            self.data[key] = corners
            grid = self.grid(name, shape, self.item(self.data.filename, key, corners.shape), fields)
            self.blocks.append((name, [f'{grid}<Time Value="{time:.9g}"/></Grid>' for time in times]))

        self.study.group.visititems(visit)

    def write(self):
        body = "".join(f'<Grid Name={quoteattr(name)} GridType="Collection" CollectionType="Temporal">{"".join(steps)}</Grid>\n' for name, steps in self.blocks)
        self.path.write_text('<?xml version="1.0" encoding="utf-8"?>\n<Xdmf Version="3.0"><Domain>\n'
                             f'<Grid Name="whirl" GridType="Collection" CollectionType="Spatial">\n{body}</Grid>\n</Domain></Xdmf>\n', encoding="utf-8")
        self.data.close()
        return [register(self.path), register(self.path.with_suffix(".h5"))]


def write(study, shapes=6, phases=24, reach=0.1):
    """The files of a study; none if it has neither a sag nor shapes nor motions of the whole shaft."""
    tables, cycles = list(tables_of(study)), list(cycles_of(study))
    if not tables and not cycles and not study.has("nodes/z", "nodes/y"):
        return []
    name = study.name.replace("/", "_").replace("\0", "_")  # as the program names files
    scene = Scene(study, pathlib.Path(study.results.directory) / f"{name}.scene.xdmf")
    turn = np.arange(phases + 1) / phases
    for speed, z, found in tables:
        factor = reach * np.ptp(z)
        for shape in found[:shapes]:
            x, y, _ = normalised(shape.x, shape.y)
            at, to_frequency, unit = at_words(study, speed)
            moving = [np.real(np.exp(2j * np.pi * turn)[:, None] * line) for line in (x, y)]
            scene.shaft(f"mode {shape.mode} {at}: {shape.frequency * to_frequency:.4g} {unit}", z, *moving, turn, factor)
    for what, x, y in cycles:
        z, (x, y) = study.get("shaft/z"), (over_period(v, turn) for v in (x, y))
        factor = reach * np.ptp(z) / (np.hypot(x, y).max() or 1.0)
        scene.shaft(f"{what}, drawn {factor:.3g} times", z, x, y, turn, factor)
    times, moved = turn if tables else [0.0], lambda z: np.zeros(2)
    if study.has("nodes/z", "nodes/y"):
        z, y = study.get("nodes/z"), study.get("nodes/y")
        x = study.get("nodes/x", np.zeros_like(y))
        largest = np.hypot(x, y).max()
        factor = reach * np.ptp(z) / largest if largest > 0 else 1.0
        moved = lambda at: (factor - 1) * np.array([np.interp(at, z, x), np.interp(at, z, y)])  # noqa: E731
        scene.shaft(f"sag, drawn {factor:.3g} times", z, np.tile(x, (len(times), 1)), np.tile(y, (len(times), 1)), times, factor)
    scene.bores(times, moved)
    return scene.write()


def main(arguments):
    parser = argparse.ArgumentParser(prog=called("scene"), description=__doc__.split("\n")[0])
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path, help="folder of a run, with its results.h5")
    parser.add_argument("--shapes", type=int, default=6, help="modes at each speed (6)")
    parser.add_argument("--phases", type=int, default=24, help="moments of a turn (24)")
    parser.add_argument("--reach", type=float, default=0.1, help="largest deflection as a part of the length of the shaft (0.1)")
    given = parser.parse_args(arguments)
    if given.shapes < 1 or given.phases < 1 or not given.reach > 0:
        parser.error("--shapes, --phases and --reach are positive")
    with said_in_a_sentence("scene"), Drawn(given.directory) as results:
        files = [file for study in results.studies for file in write(study, given.shapes, given.phases, given.reach)]
    if not files:
        print(f"scene: no study in {given.directory} has a sag, mode shapes or motions of a whole shaft", file=sys.stderr)
        return 1
    print("\n".join(map(str, files)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
