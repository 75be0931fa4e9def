#!/usr/bin/env python3
"""The module `whirl` on synthetic results, and the numbers behind the pictures: curves, clearances, peaks, multipliers."""
import contextlib
import os
import pathlib
import re
import sys
import tempfile
import types

import numpy as np
from matplotlib.axis import Axis

ROOT = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(pathlib.Path(__file__).parent), str(ROOT / "scripts")]
import synthetic  # noqa: E402

import whirl  # noqa: E402
from whirl_plot import bore, curves, locus, multipliers, response, style, tables, ticks, units  # noqa: E402


def refuses(what, *words):
    try:
        what()
    except (whirl.Error, KeyError) as error:
        assert all(w in str(error) for w in words), error
        return
    raise AssertionError(f"nothing refused {words}")


def module():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "x"
        synthetic.make(folder)
        results = whirl.read(folder)
        assert results["balanced"].kind == "equilibrium_branch"
        assert [s.name for s in results.studies][:3] == ["at service speed", "modes", "generator pair"], "the order of the deck"
        table = results.table("pair, G2.5")
        assert table.name == "branch" and table["y_max"].shape == (table.rows, 5) and table.places["y_max"] == synthetic.NAMES
        assert np.array_equal(table.flat()["y_max.B3"], table["y_max"][:, 2])
        assert table.array()["x_min"].shape == (table.rows, 5)
        try:
            import pandas  # noqa: F401
        except ImportError:
            pass
        else:
            assert list(table.frame()["y_max.B3"]) == list(table["y_max"][:, 2])
        assert results.values("at service speed")["mass.total"] == whirl.Quantity(42165.66, "kg")
        assert results.bifurcations("balanced")[0]["uncertainty"] == 12.0 and results.bifurcations()[0]["study"] == "balanced"
        orbit = results.orbits("pair, G2.5")[0]
        assert orbit.x.shape == (120, 5) and orbit.places == synthetic.NAMES
        assert set(results.fields("at service speed")["B3"]) == {"pad1", "pad2"}
        refuses(lambda: results["nothing"], "nothing", "balanced")
        refuses(lambda: results.table("balanced", "orbits"), "balanced", "orbits", "branch")
        refuses(lambda: table["speed_of_sound"], "speed_of_sound", "parameter")
        refuses(lambda: whirl.read(folder / "none"), "there is no")


def frames():
    """A frame has the units of its columns, also where a column's own name has dots as those of a sweep's table have."""
    class DataFrame(dict):  # of pandas, as far as it is used
        def __init__(self, columns):
            super().__init__(columns)
            self.attrs = {}

    table = whirl.table.Table("table", {"balanced.hopf.1": np.array([5000.0, 5100.0]), "x_max": np.ones((2, 2))},
                              {"balanced.hopf.1": "rpm", "x_max": "m"}, {}, {"x_max": ["B1", "B.2"]})
    real = sys.modules.get("pandas")
    sys.modules["pandas"] = types.SimpleNamespace(DataFrame=DataFrame)
    try:
        frame = table.frame()
    finally:
        sys.modules.pop("pandas") if real is None else sys.modules.update(pandas=real)
    assert list(frame) == ["balanced.hopf.1", "x_max.B1", "x_max.B.2"]
    assert frame.attrs["units"] == {"balanced.hopf.1": "rpm", "x_max.B1": "m", "x_max.B.2": "m"}


def command_lines():
    """What `run` hands to the program: a negative number replaces a value, a text with a sign is added to it."""
    with tempfile.TemporaryDirectory() as name:
        program = pathlib.Path(name) / "program"
        program.write_text("#!/bin/sh\nfor word in \"$@\"; do echo \"$word\"; done\nexit 2\n")
        program.chmod(0o755)
        os.environ["WHIRL_PROGRAM"] = str(program)
        try:
            whirl.run("d.yaml", set={"a": 1.5, "b": -2, "c": -0.25, "d": [-1, 2], "e": "-20 um", "f": True}, output=name)
        except whirl.RunError as error:
            words = error.log.splitlines()
        finally:
            del os.environ["WHIRL_PROGRAM"]
        assert [w for k, w in enumerate(words) if words[k - 1] == "--set"] == \
            ["a=1.5", "b=-2", "c=-0.25", "d=[-1, 2]", "e=-20 um", "f=true"], words


def labels():
    """Coordinates of a picture are shortened, numbers in its words never."""
    svg = '<svg>\n  <path d="M 1.23456 2.5 L 3.999999,4.0001"/>\n  <!-- 1.23456 -->\n  <text x="0.123456">529.97726 rad/s</text>\n</svg>'
    short = style.shorter(svg)
    assert 'd="M 1.23 2.5 L 4,4"' in short and 'x="0.12"' in short, short
    assert ">529.97726 rad/s<" in short, short
    assert "1.1234 2.56789 (3.45678" in style.shorter("<text>1.1234 2.56789 (3.45678</text>"), "numbers behind spaces and brackets"


def palettes():
    """256 colours keep those of large areas and what differs most from all others, however small; fewer colours stay as they are."""
    ramp = np.full((64, 64, 4), 255, np.uint8)
    ramp[:32, :, 2] = np.arange(32)[:, None] * 4
    ramp[:32, :, 1] = np.arange(64)
    ramp[40, 40] = (200, 16, 46, 255)
    few = np.asarray(style.few_colours(ramp).convert("RGB"))
    assert len(np.unique(few.reshape(-1, 3), axis=0)) == 256 and tuple(few[40, 40]) == (200, 16, 46) and (few[50:] == 255).all()
    assert np.linalg.norm(few - ramp[..., :3].astype(float), axis=-1).max() < 10, "far from its colour"
    plain = ramp[30:]
    assert (np.asarray(style.few_colours(plain).convert("RGB")) == plain[..., :3]).all()


def ticks_once():
    """Pictures whose ticks are drawn together are those of matplotlib, byte by byte, whichever format comes first, with the same texts in a
    drawing, and are asked for their ticks once for each of two layouts and for each format."""
    def pictures(folder):
        figure, axes = style.plt.subplots(2, 2, sharex="col")
        axes[0, 0].plot([0, 3], [1e9 + 1, 1e9 + 4])  # with an offset above the title
        axes[1, 0].semilogy([0, 3], [1e-9, 3])
        axes[0, 1].set_aspect("equal")
        axes[0, 1].plot([-4, 4], [0, 90])
        figure.colorbar(axes[1, 1].pcolormesh(np.arange(6.0).reshape(2, 3)), ax=axes[1, 1], label="p [MPa]")
        for axis in axes.ravel():
            axis.set_title("one")
            axis.set_ylabel("y [m]")
        files = style.write(figure, folder / "ticks")
        style.plt.close(figure)
        return len(figure.axes), {file.name: file.read_bytes() for file in files}

    asked = []
    real, kept, rows = Axis._update_ticks, style.together, ticks.rows_of
    Axis._update_ticks, ticks.rows_of = (lambda axis, real=real: asked.append(axis) or real(axis)), (lambda axis: asked.append(axis) or rows(axis))
    style.use_style(("png", "svg"))
    try:
        with tempfile.TemporaryDirectory() as name:
            count, quick = pictures(pathlib.Path(name))
            few = len(asked)
            style.together = lambda: contextlib.nullcontext(lambda: None)
            style.use_style(("svg", "png"))
            _, slow = pictures(pathlib.Path(name))
    finally:
        Axis._update_ticks, style.together, ticks.rows_of = real, kept, rows
        style.use_style()
    texts = [sorted(re.findall(r">([^<>]+)</text>", made["ticks.svg"].decode())) for made in (quick, slow)]
    assert quick["ticks.png"] == slow["ticks.png"] and texts[0] == texts[1] and len(texts[0]) > 20, texts
    assert few <= 4 * 2 * count < len(asked) / 2, (few, len(asked))


def smooth_curves():
    t = 2 * np.pi * np.arange(32) / 32
    dense = curves.periodic(np.stack([np.cos(t), np.sin(3 * t)], axis=1), 4)
    u = 2 * np.pi * np.arange(129) / 128
    assert dense.shape == (129, 2) and np.allclose(dense[::4][:32], np.stack([np.cos(t), np.sin(3 * t)], axis=1), atol=1e-14)
    # Error of a cubic spline: at most 5/384 h^4 max|f''''|, and it falls with h^4.
    h = 2 * np.pi / 32
    assert np.abs(dense[:, 0] - np.cos(u)).max() < h**4 / 384 * 1.05
    # A branch around a fold, p = 1 - s^2, y = s: the turning point lies between two points.
    s = np.linspace(-1, 0.9, 9)
    p = 1 - s**2
    branch = curves.Branch(p, np.concatenate([[0], np.diff(s)]), (s > 0).astype(int))
    place = branch.place("fold", 1.0)
    assert abs(branch.at(p, place) - 1) < 5e-3 and abs(branch.at(s, place)) < 0.07, (place, branch.at(s, place))
    # Its other side of stability is met where the parameter passes, not where the branch passes it first.
    value = 1 - 0.05**2
    assert abs(branch.at(s, branch.place("hopf", value)) - 0.05) < 0.1
    pieces = branch.stretches(s, s <= 0, [place])
    assert [solid for *_, solid in pieces] == [True, False] and abs(pieces[0][1][-1]) < 0.07, "the style changes at the mark"
    # Two changes between two stable points: the pieces between them are unstable.
    flat = curves.Branch(np.arange(4.0), np.ones(4))
    changes = {1: [(flat.place_in(1, v, False)[1], behind) for v, behind in ((1.25, False), (1.75, True))]}
    pieces = flat.stretches(np.arange(4.0), np.ones(4), [], changes)
    assert [solid for *_, solid in pieces] == [True, False, True] and abs(pieces[1][0][0] - 1.25) < 0.01 and abs(pieces[1][0][-1] - 1.75) < 0.01
    # No overshoot at a kink, no value outside a flat stretch.
    kink = np.array([0, 0, 0, 1, 2, 3.0])
    line = curves.Branch(np.arange(6.0), np.ones(6))
    y = np.concatenate([y for _, y, _ in line.stretches(kink, np.ones(6), [])])
    assert y.min() >= -1e-12 and y.max() <= 3 + 1e-12
    assert line.place("hopf", 9.0) is None, "a mark far from the branch is none"


class Curve:
    """A curve of bifurcations: speed = 1 + load, stable below it; no border above a load of 1.5."""

    def __init__(self, side):
        load = np.linspace(0.5, 2, 16)
        self.data = {"locus/parameter": 1 + load, "locus/second": load, "locus/others_unstable": np.where(load > 1.5, 2, 0)}
        self.side = side

    def get(self, name, default=None):
        return self.data.get(name, default)

    def attribute(self, name, default=""):
        return {"stable_side": self.side, "start": 15}.get(name, default)


class Limit(Curve):
    """Cycles of one amplitude: no border of anything."""
    name = "vibration"

    def attribute(self, name, default=""):
        return {"bifurcation": "limit", "limit": "0-peak amplitude in y at B2", "limit_value": 60.0, "limit_unit": "um", "larger_side": "above"}.get(name, default)


def borders_of_curves():
    for side in ("below", "above"):
        (where, above), = locus.crossings(Curve(side))(1.03)
        assert abs(where - 2.03) < 1e-9 and above == (side == "below"), (side, where, above)
        assert locus.crossings(Curve(side))(1.8) == [], "where something else is unstable already there is no border"
    assert locus.crossings(Limit(""))(1.03) == [], "a limit bounds no stability"
    assert locus.described(Limit("")) == "vibration: 0-peak amplitude in y at B2 is 60 \u00b5m", locus.described(Limit(""))
    assert locus.dotted_words(Limit("")) == "unstable cycle" and "no border" in locus.dotted_words(Curve("below"))


class Bearings:
    """The part of a study that tells of its bearings."""

    def __init__(self, **values):
        self.values = {f"bearings/{k}": np.atleast_1d(v) for k, v in values.items()}

    def has(self, *names):
        return all(n in self.values for n in names)

    def get(self, name, default=None):
        return self.values.get(name, default)


def clearances():
    lemon = bore.pads_of(Bearings(clearance=1e-4, preload=0.5, offset=0.0, arc=np.radians(160), bore="lemon_bore"), 0)
    down, side, rim = (float(bore.reach(lemon, np.array([a]))[0]) for a in (-np.pi / 2, 0.0, np.radians(-10)))
    assert abs(down / 1e-4 - 1) < 1e-6, "the assembled clearance under the journal"
    # Circles of radius 2 c about (0, +-c) meet at y = 0 where x^2 = 4 c^2 - c^2.
    assert abs(side / 1e-4 - np.sqrt(3)) < 1e-5, side
    assert abs(rim / 1e-4 - (np.sqrt(3 + np.sin(np.radians(10))**2) - np.sin(np.radians(10)))) < 1e-5, rim
    # Of short pads the ends decide, 60 degrees off: (c_p - m c_p sin 60)/cos 60.
    short = bore.pads_of(Bearings(clearance=1e-4, preload=0.5, offset=0.0, arc=np.radians(60), bore="lemon_bore"), 0)
    assert abs(bore.reach(short, np.array([0.0]))[0] / 1e-4 - (2 - np.sin(np.pi / 3)) / 0.5) < 1e-5
    # The wall is where the film of the nearest pad is zero, in every direction.
    for angle in np.linspace(0, 6.2, 40):
        r = float(bore.reach(lemon, np.array([angle]))[0])
        theta = [m + np.linspace(-0.5, 0.5, 1441) * arc for *_, m, arc in lemon]
        film = min(np.min(radius - (r * np.cos(angle) - ox) * np.cos(t) - (r * np.sin(angle) - oy) * np.sin(t))
                   for t, (ox, oy, radius, _, _) in zip(theta, lemon))
        assert abs(film) < 1e-12, (angle, film)
    bored = bore.pads_of(Bearings(clearance=1e-4, preload=0.0, offset=0.0, arc=0.0, bore="cylindrical"), 0)
    assert np.allclose(bore.reach(bored, np.linspace(0, 6, 7)), 1e-4, rtol=1e-5)
    arc = bore.pads_of(Bearings(clearance=1e-4, preload=0.0, offset=0.0, arc=np.radians(60), bore="partial_arc"), 0)
    assert np.isinf(bore.reach(arc, np.array([np.pi / 2]))[0]) and abs(bore.reach(arc, np.array([-np.pi / 2]))[0] - 1e-4) < 1e-10


def facts():
    both = multipliers.both_of_pairs(np.array([[0.9 + 0.1j, -0.5, 0.0], [0.8 + 0.2j, 0.8 - 0.2j, 0.1]]))
    assert sorted(both[0][np.isfinite(both[0])], key=lambda z: (z.real, z.imag)) == [-0.5, 0.9 - 0.1j, 0.9 + 0.1j]
    assert np.count_nonzero(np.isfinite(both[1])) == 3, "no pair twice"
    # A gap where there is no answer, dashed where no equilibrium is stable; both stretches meet at the first one that is not.
    class Told:
        def get(self, name):
            return {"response/answer": np.array([1, 1, 0, 1, 1, 1]), "response/unstable_count": np.array([0, 0, 0, 0, 2, -1])}[name]
    figure, axis = response.plt.subplots()
    response.Validity(Told(), 6).plot(axis, np.arange(6.0), np.arange(6.0), color="k")
    solid, dashed = axis.lines
    response.plt.close(figure)
    assert solid.get_linestyle() == "-" and np.array_equal(solid.get_ydata(), [0, 1, np.nan, 3, 4], equal_nan=True), solid.get_ydata()
    assert dashed.get_linestyle() == "--" and np.array_equal(dashed.get_ydata(), [4, 5]), (dashed.get_linestyle(), dashed.get_ydata())
    # A single unstable speed is shaded half-way to both sides; an unstable end, to the end.
    for counts, bands in (([0, 1, 0, 0, 2, 2], [(0.5, 1.5), (4, 5)]), ([1, 0, 0, 0, 0, 1], [(0, 0.5), (4.5, 5)])):
        figure, axis = response.plt.subplots()
        told = response.Validity(type("Counts", (), {"get": lambda _, name, counts=counts: np.array(counts) if name.endswith("count") else None})(), 6)
        told.shade(axis, np.arange(6.0))
        shaded = [p.get_extents().transformed(axis.transData.inverted()).intervalx for p in axis.patches]
        assert np.allclose(shaded, bands), (counts, shaded)
        response.plt.close(figure)
    assert response.is_answer({}) and not response.is_answer({"stability": "undetermined"}) and not response.is_answer({"notes": ["no answer: B1"]})
    # A track turns red where it was located to grow, else at the first speed at which it grows.
    from whirl_plot import campbell
    class Growing:
        def get(self, name):
            return {"mode": [1, 1, 2], "from": [2.2, 4.0, 0.1], "to": [2.9, 4.0, 4.0], "begins": [1, 0, 1], "ends": [0, 0, 0]}[name.split("/")[1]]
    track = np.arange(5.0), np.arange(5.0), np.array([0.3, 0.2, 0.2, -0.1, 0.2]), np.array(["forward"] * 5)
    ranges = campbell.ranges_of(Growing(), 1)
    at, _, damped, sense, border = campbell.with_borders(ranges, *track)
    assert list(at) == [0, 1, 2, 2.2, 3, 4] and list(np.nonzero(border)[0]) == [3] and len(sense) == 6, (at, border)
    def red(at, damped, border, ranges):
        return [campbell.colour_of(d) == campbell.BAD for d in campbell.between(at, damped, border, ranges)]
    assert red(at, damped, border, ranges) == [False, False, False, True, False]
    assert not any(red(track[0], track[2], np.zeros(5, bool), []))
    # It grows between two neighbouring speeds only, at both of which it is damped.
    ranges = [(1.2, 1.7, 1, 1)]
    at, _, damped, _, border = campbell.with_borders(ranges, *track[:2], np.full(5, 0.2), track[3])
    assert list(at) == [0, 1, 1.2, 1.7, 2, 3, 4] and list(np.nonzero(border)[0]) == [2, 3], (at, border)
    assert red(at, damped, border, ranges) == [False, False, True, False, False, False]
    # Between two such ranges it is damped, with no point of its own there.
    ranges.append((1.8, 1.9, 1, 1))
    at, _, damped, _, border = campbell.with_borders(ranges, *track[:2], np.full(5, 0.2), track[3])
    assert red(at, damped, border, ranges) == [False, False, True, False, True, False, False, False]
    assert campbell.between(at, damped, border, ranges)[3] > 0, "not undamped"
    # Limits at one place would be warned of on the screen.
    from whirl_plot.style import span_of
    assert span_of(1.0, 2.0) == (1.0, 2.0) and all(a < b for a, b in (span_of(0.0, 0.0), span_of(-3.0, -3.0), span_of(2.0, 2.0)))
    assert not response.is_answer({"notes": ["undetermined: it stands 0.1 um above"]})
    from whirl_plot.tables import stiffness_of
    assert stiffness_of({"stiffness": ["6e6 N/m", "1 N/m", "0 N/m", "6e6 N/m"], "cross_coupling": "2500000 N/m"}) == ["6000000 N/m", "2500001 N/m", "-2500000 N/m", "6000000 N/m"]
    assert stiffness_of({"cross_coupling": "5 N/m"}) == ["0 N/m", "5 N/m", "-5 N/m", "0 N/m"] and stiffness_of({"stiffness": ["1 N/m"]}) == ["1 N/m"]
    assert units.with_bar(5021.412, 6.93) == "5021.4 \u00b1 6.9" and units.with_bar(2.7353, 1.9e-11) == "2.7353"
    assert units.person(1.8e-4, "m") == "180 \u00b5m" and units.person(2.134e5, "N") == "213.4 kN" and units.quantity("0.0067 Pa s") == "6.7 mPa s"
    assert units.quantity("3600 rpm") == "3600 rpm" and units.quantity("none") == "none"


for check in (module, frames, command_lines, labels, palettes, ticks_once, smooth_curves, borders_of_curves, clearances, facts):
    check()
print("the module and the numbers behind the pictures are right")
