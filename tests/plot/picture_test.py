#!/usr/bin/env python3
"""What pictures show: the lines, marks and labels of figures drawn from made-up results whose right picture is known."""
import pathlib
import sys
import tempfile
import types

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import QuadMesh
from PIL import Image

ROOT = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(pathlib.Path(__file__).parent), str(ROOT / "scripts")]
import synthetic  # noqa: E402
from whirl_plot import (bearing_map, bifurcation, campbell, columns, curves, film as machine_film, live_sweep, locus, motion, multipliers, orbits, orders, shapes, streamlines as flow, style, sweep,  # noqa: E402
                        thd_compare, thd_cuts, thd_film, thd_maps, thd_sections)
from whirl_plot.canvas import plt as our_plt  # noqa: E402
from whirl_plot.ticks import together  # noqa: E402
from whirl_plot.subject import Drawn  # noqa: E402


class Figures(dict):
    """Figures by name of the picture, of functions that draw a subject."""

    def draw(self, module, function, subject):
        real, module.save = module.save, lambda figure, study, what, note="", handles=(), columns=6, of="": self.update({what: figure}) or []
        try:
            function(subject)
        finally:
            module.save = real
        return self


def results_with(folder, fill):
    """Results of synthetic.py that `fill` has changed."""
    synthetic.make(folder)
    with h5py.File(folder / "results.h5", "a") as root:
        fill(root)
    return Drawn(folder)


def lines_of(axis, colour=None):
    return [line.get_xydata() for line in axis.get_lines() if len(line.get_xdata()) > 1 and colour in (None, line.get_color())]


def field_of(axis):
    """The image of a map, without the key beside it."""
    return next(image for image in axis.get_images() if image.get_label() != "key")


def pixels_of(image):
    """Middles (x, y) of the pixels, row by row."""
    left, right, low, high = image.get_extent()
    rows, columns = image.get_array().shape
    x, y = ((np.arange(n) + 0.5) / n * (b - a) + a for n, a, b in ((columns, left, right), (rows, low, high)))
    return np.stack([g.ravel() for g in np.meshgrid(x, y)], axis=1)


def beams():
    """A beam between its nodes is the cubic of displacement and slope there."""
    z = np.array([0, 0.3, 1.0, 1.2])
    for factor in (1, 1 - 2j):
        s, y = curves.along_shaft(z, factor * (z**3 - z), factor * (3 * z**2 - 1))
        assert len(s) > 200 and np.allclose(y, factor * (s**3 - s), rtol=0, atol=1e-14)
    # Without slopes the spline through the nodes, which meets a function with straight ends as h^4.
    z = np.linspace(0, np.pi, 17)
    s, y = curves.along_shaft(z, np.sin(z))
    assert np.abs(y - np.sin(s)).max() < 2e-5
    assert np.array_equal(curves.along_shaft([1.0], [2.0])[1], [2.0])


def sag(folder):
    """A sagging shaft of four elements, with a horizontal line of rounding."""
    z = np.linspace(0, 0.8, 5)

    def fill(root):
        del root["studies/at service speed/nodes"], root["studies/at service speed/bearings/node"]
        synthetic.put(root["studies/at service speed"].create_group("nodes"), z=z, y=7e-5 * (z**2 - 0.8 * z), slope_y=7e-5 * (2 * z - 0.8),
                      x=1.2e-5 + 1e-20 * np.array([0, 1, 1, -1, -2.0]), slope_x=0 * z)

    with results_with(folder, fill) as results:
        vertical, horizontal = Figures().draw(shapes, shapes.draw_sag, results["at service speed"])["sag"].axes
    curve = max(lines_of(vertical, style.Y), key=len)
    assert len(curve) > 50 and np.allclose(curve[:, 1], 70 * (curve[:, 0]**2 - 0.8 * curve[:, 0]), atol=1e-9), "no polygon"
    assert np.ptp(horizontal.get_ylim()) > 0.2, "rounding fills the axis"


def mode_shapes(folder):
    """Bending of a shaft of two elements on a bearing at either end."""
    z = np.array([0, 0.5, 1.0])
    shape, slope = 1 - 4 * (z - 0.5)**2, -8 * (z - 0.5)

    def fill(root):
        group = root["studies/modes"]
        del group["shapes"], group["bearings"]
        synthetic.put(group.create_group("shapes"), speed=377.0, z=z, frequency=[80.0], **{
            f"{head}{d}_{part}": [values * size] for head, values in (("", shape), ("slope_", slope))
            for d, part, size in (("x", "real", 0.0), ("x", "imag", -0.6), ("y", "real", 1.0), ("y", "imag", 0.0))})
        synthetic.put(group.create_group("bearings"), name=["A", "B"], node=[1, 3])

    with results_with(folder, fill) as results:
        figures = Figures().draw(shapes, shapes.draw_modes, results["modes"])
    flat, space = figures["shapes"].axes[0], figures["shapes-3d"].axes[0]
    curve = max(lines_of(flat, style.Y), key=len)
    assert len(curve) > 50 and np.allclose(curve[:, 1], 1 - 4 * (curve[:, 0] - 0.5)**2, atol=1e-12), "no polygon"
    assert not any(line.get_clip_on() for line in space.get_lines()), "ellipses at the ends are cut off"
    bearings, = (line.get_data_3d() for line in space.get_lines() if len(line.get_data_3d()[0]) == 5)
    assert set(bearings[0][np.isfinite(bearings[0])]) == {0.0, 1.0}, "a bearing at either end"
    assert space.get_xlabel() == "z [m]" and space.get_zlabel() == "y [-]"


def eigenvalue(results):
    axes = Figures().draw(bifurcation, bifurcation.draw_equilibria, results["balanced"])["equilibria"].axes
    return next(a for a in axes if a.get_title(loc="left") == "least stable eigenvalue")


def growth(folder):
    """Hopf points lie at zero: the one of the curve on it, others where another eigenvalue crosses."""
    def fill(root):
        group = root["studies/balanced"]
        branch = {k: v[()] for k, v in group["branch"].items()}
        del group["branch"], group["bifurcations"]
        pick = np.arange(0, 70, 9)  # far from the Hopf point
        branch = {k: v[pick] for k, v in branch.items()}
        branch["unstable_count"] += 2 * (branch["parameter"] > 6300)
        synthetic.put(group.create_group("branch"), **branch)
        synthetic.put(group.create_group("bifurcations"), type=["hopf", "hopf"], parameter=[5025.0, 6300.0], uncertainty=[12.0, 9.0])

    with results_with(folder, fill) as results:
        axis = eigenvalue(results)
    marks = {(line.get_xdata()[0], line.get_ydata()[0]) for line in axis.get_lines() if line.get_marker() == "o"}
    assert marks == {(5025.0, 0.0), (6300.0, 0.0)}, marks
    stable, unstable = (c for c in lines_of(axis, style.INK))
    assert np.allclose(stable[-1], (5025, 0), atol=1e-9) and np.allclose(unstable[0], (5025, 0), atol=1e-9), "through zero"

    def undamped(root):
        branch = root["studies/balanced/branch"]
        branch["leading_real"][...] = 7e-14
        branch["stable"][...] = 1
        branch["unstable_count"][...] = 0
        branch["undamped_count"] = np.full(70, 2)
        del root["studies/balanced/bifurcations"]

    with results_with(folder, undamped) as results:
        axis = eigenvalue(results)
    assert np.all(lines_of(axis, style.INK)[0][:, 1] == 0) and np.ptp(axis.get_ylim()) >= 1


def campbell_lines(folder):
    """A list of modes that is full leaves out the highest where an overdamped one comes down: no gap, and no dot for that one. A mode
    that was not found has a gap."""
    speed = np.linspace(100, 600, 6)
    rows = []
    for k, w in enumerate(speed):
        rows += [(w, 1, 150.0, 0.2), (w, 2, 300.0, 0.2)]
        rows.append((w, 4, 170.0, 30.0) if k == 2 else (w, 3, 420.0 + k, 0.2))

    def fill(root, found=True):
        group = root["studies/modes"]
        del group["spectrum"]
        kept = [r for r in rows if found or r[:2] != (300.0, 2)]
        synthetic.put(group.create_group("spectrum"), whirl=["forward"] * len(kept),
                      **dict(zip(("speed", "mode", "frequency", "log_decrement"), zip(*kept))))

    def mode(folder, change, frequency):
        with results_with(folder, change) as results:
            figure = Figures().draw(campbell, campbell.draw, results["modes"])["campbell"]
            figure.canvas.draw()
            top = figure.axes[0]
            size = frequency / (2 * np.pi)
            return top, [line for line in top.get_lines() if np.abs(np.array(line.get_ydata()) - size).max() < 1 and line.get_color() == style.GOOD]

    top, third = mode(folder, fill, 422.0)
    assert len(third) == 1 and len(third[0].get_xdata()) == 5, "the highest mode is one line"
    assert not mode(folder, fill, 170.0)[1], "a dot for an overdamped mode"
    labels = {t.get_text(): top.transData.transform(t.xy) for t in top.texts if t.get_text() in ("1\u00d7", "2\u00d7")}
    assert len(labels) == 2
    for words, place in labels.items():
        for line in top.get_lines():
            if len(line.get_xdata()) > 1 and line.get_linestyle() != ":":
                x = np.linspace(*line.get_xdata()[[0, -1]], 400)
                curve = top.transData.transform(np.column_stack([x, np.interp(x, line.get_xdata(), line.get_ydata())]))
                assert np.hypot(*(curve - place).T).min() > 7, f"{words} stands on a line"  # pixels
    def at_rest(root):
        fill(root)
        whirl = root["studies/modes/spectrum/whirl"]
        whirl[0] = "either"
    top, first = mode(folder, at_rest, 150.0)
    assert len(first) == 1 and len(first[0].get_xdata()) == 6 and first[0].get_linestyle() == "-", "equal modes that part are one line of their later sense"
    second = mode(folder, lambda root: fill(root, False), 300.0)[1]
    assert sorted(len(line.get_xdata()) for line in second) == [2, 3], "a mode that was not found"


def border_of_stability():
    """Where a bearing becomes stable at every speed the limit goes to infinity as (S_0 - S)^(-1/2)."""
    class Map:
        load = np.concatenate([np.linspace(0.1, 6.8, 12), [7.5, 8.5]])

        def get(self, name):
            limit = np.sqrt(25 / np.maximum(7.0 - self.load, 1e-300))
            values = {"sommerfeld": self.load, "speed_limit": np.where(self.load < 7, limit, np.nan), "whirl_ratio": np.where(self.load < 7, 0.7 / limit, np.nan)}
            return values[name.removeprefix("locus/")]

    (s, limit), (_, ratio) = bearing_map.border(Map())
    assert len(s) > 60 and s[-1] == 6.8
    assert np.allclose(limit, np.sqrt(25 / (7 - s)), rtol=1e-10) and np.allclose(ratio, 0.7 / limit, rtol=1e-10)


def words(folder):
    """Loads in a unit that a person reads; no bar of infinity."""
    def fill(root):
        root["studies/at service speed/bearings/load"][0] = 70
        root["studies/period two/exponents/uncertainty"][1] = np.inf

    with results_with(folder, fill) as results:
        titles = [a.get_title(loc="left") for a in Figures().draw(orbits, orbits.draw_positions, results["at service speed"])["journals"].axes]
        axis = Figures().draw(motion, motion.draw, results["period two"])["motion"].axes[3]
    assert titles[0] == "B1: 70 N" and titles[2] == "B3: 213.4 kN", titles
    said = [t.get_text() for t in axis.get_legend().get_texts()]
    assert "\u00b1" in said[0] and "inf" not in said[1] and "bar" in said[1], said


def courses(folder):
    """Orders over the speed with their own heights and phases; the rows of a waterfall stand at their speeds."""
    with results_with(folder, lambda root: None) as results:
        study = results["through"]
        tracks = Figures().draw(orders, orders.draw_orders, study)["orders"].axes
        fall = Figures().draw(orders, orders.draw_waterfall, study)["waterfall"].axes
    top = [line.get_ydata() for line in tracks[0].get_lines()]
    assert np.isclose(top[1].max(), 10, rtol=1e-3) and np.isclose(top[0].max(), 6), [t.max() for t in top]  # um
    phase = next(axis for axis in tracks if axis.get_ylabel().startswith("phase")).get_lines()[0].get_ydata()
    assert -20 < phase[0] < 0 and -180 < phase[-1] < -160, phase
    assert "10" in fall[0].get_title(loc="left") and "5" in fall[1].get_title(loc="left")
    feet = sorted(line.get_ydata()[-1] for line in fall[0].get_lines())
    assert np.allclose(feet, np.linspace(50, 200, 31)), feet


def colours(folder):
    """A study has one colour in all pictures of a run."""
    with results_with(folder, lambda root: None) as results:
        together = Figures().draw(bifurcation, bifurcation.draw_together, results)["bifurcations"].axes[0]
        for name in ("pair, G2.5", "pair, G6.3"):
            study = results[name]
            alone = Figures().draw(bifurcation, bifurcation.draw_cycles, study)
            assert lines_of(alone["cycles-vertical"].axes[0], study.colour) and lines_of(alone["cycles-horizontal"].axes[0], study.colour)
            assert lines_of(together, study.colour)
        assert len({s.colour for s in results.studies if s.kind in ("cycle_branch", "bearing_map")}) == 4
        assert results["balanced"].colour == style.INK


def harmonics(folder):
    """Of cycles without unbalance: stems of the half-axes over the harmonics of the whirl; of forced ones no such picture."""
    pick = np.linspace(0, 139, 20).astype(int)

    def fill(root):
        group = root["studies/pair, G2.5"]
        group.attrs["unbalance"] = ""
        group["orbits/point"] = pick

    with results_with(folder, fill) as results:
        study = results["pair, G2.5"]
        axis = Figures().draw(orbits, orbits.draw_harmonics, study)["harmonics"].axes[2]
        assert not Figures().draw(orbits, orbits.draw_harmonics, results["pair, G6.3"])
        cycle = study.orbits[-1]
    at, size = lines_of(axis)[-1].T
    swing = np.ptp(cycle.y[:, 2]) / 2.2 * 1e6  # y = 1.1 swing sin(t + 0.3), x = swing (cos t + 0.1 cos 2 t)
    larger = np.linalg.svd([[1, 0], [1.1 * np.sin(0.3), 1.1 * np.cos(0.3)]])[1][0]
    # Stems stand side by side at their number; none below the frame.
    assert np.array_equal(np.round(at), [1, 2]) and np.allclose(size / swing, [larger, 0.1], rtol=1e-3), (at, size / swing)
    assert axis.get_xlim() == (0.5, 2.5) and size.min() > axis.get_ylim()[0]


def responses_of_a_sweep(folder):
    """Linear responses are wide, nonlinear ones thin, and dashed means unstable as everywhere; the deck as it stands has a name."""
    def fill(root):
        group = synthetic.study(root, "whole shaft", "sweep")
        root["studies/generator pair"].attrs["unbalance"] = "gen_pair"
        variant = group.create_group("variants/whole")
        variant.attrs.update({"title": "whole", "order": 1})
        root.copy(root["studies/generator pair"], variant, "generator pair")

    with results_with(folder, fill) as results:
        (folder / "resolved.yaml").write_text("rotor: {reduction: {type: guyan}}\n")
        study = results["whole shaft"]
        study.summary = {"variants": [{"name": "whole", "changes": {"rotor.reduction": "{type: none}"}, "studies": []}]}
        labels = []
        real, sweep.save = sweep.save, lambda figure, study, what, note="", handles=(), columns=6, of="": labels.extend((h.get_label(), h) for h in handles) or [figure]
        try:
            figure = sweep.draw_response(study)[0]
        finally:
            sweep.save = real
        unstable = results["pair, G2.5"].get("branch/stable") < 0.5
    labels = dict(labels)
    assert {"reduction guyan (as given), linear", "whole, linear", "reduction guyan (as given), nonlinear", "nonlinear, unstable"} <= set(labels), list(labels)
    lines = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) > 1]
    wide = [line for line in lines if line.get_linewidth() > 3]
    assert len(wide) == 2 and all(line.get_linestyle() == "-" for line in wide)
    dashed = [line for line in lines if line.get_linestyle() == "--"]
    assert unstable.any() and len(dashed) >= 4 and all(line.get_linewidth() < 1.2 for line in dashed), "two branches, unstable in two stretches or more"


def branches_of_a_sweep(folder):
    """The title says whose branches they are, and with which unbalance; the note what their positions are, of equilibria too."""
    def fill(root):
        group = synthetic.study(root, "pedestals", "sweep")
        for k, title in enumerate(("weak", "strong")):
            variant = group.create_group(f"variants/{title}")
            variant.attrs.update({"title": title, "order": k + 1})
            for name in ("balanced", "pair, G2.5", "pair, G6.3"):
                root.copy(root[f"studies/{name}"], variant, name)
            variant["pair, G2.5"].attrs["unbalance"] = "gen_pair_g63"
            variant["pair, G6.3"].attrs["unbalance"] = title  # what the sweep varies is in no title
        root["studies/pair, G2.5"].attrs["unbalance"] = "gen_pair_g63"

    with results_with(folder, fill) as results:
        results["pedestals"].summary = {"variants": [{"name": n, "changes": {}, "studies": []} for n in ("weak", "strong")]}
        texts = {}
        real, style.write = style.write, lambda figure, stem: texts.update({stem.name: (
            figure.texts[1].get_text(), " ".join(figure.texts[-1].get_text().split()))}) or []
        try:
            sweep.draw_branches(results["pedestals"])
        finally:
            style.write = real
    where = "journal relative to the bearing centre, in clearances of each variant"
    assert texts == {"pedestals.balanced": ("pedestals: balanced", where),
                     "pedestals.pair__G6.3": ("pedestals: pair, G6.3", where + "; all points of a cycle lie between its two curves"),
                     "pedestals.pair__G2.5": ("pedestals: pair, G2.5, unbalance gen_pair_g63",
                                              where + "; all points of a cycle lie between its two curves")}, texts


def stability_factors(folder):
    """A panel for each speed; a circle for every mode of one variant, another mark for those of the next."""
    def fill(root):
        group = synthetic.study(root, "whole shaft", "sweep")
        for k, (title, shift) in enumerate((("reduced", 0), ("whole", 0.01))):
            variant = group.create_group(f"variants/{title}")
            variant.attrs.update({"title": title, "order": k + 1})
            factors = variant.create_group("factors")
            factors.attrs.update({"kind": "modes", "title": "factors", "status": "completed", "speed_unit": "rpm"})
            synthetic.put(factors.create_group("spectrum"), speed=np.repeat([376.991118, 471.238898], 3), mode=[1, 2, 3] * 2,
                          frequency=[80.0, 100, 0, 84, 104, 150], stability_factor=[0.9 + shift, 0.7, 0.0, 0.97, 0.72, 0.5])

    with results_with(folder, fill) as results:
        study = results["whole shaft"]
        study.summary = {"variants": [{"name": n, "changes": {}, "studies": []} for n in ("reduced", "whole")]}
        figure = Figures().draw(sweep, sweep.draw_stability_factors, study)["factors"]
    assert [a.get_title(loc="left") for a in figure.axes[:2]] == ["3600 rpm", "4500 rpm"]
    points = [[line for line in axis.get_lines() if line.get_linestyle() == "None"] for axis in figure.axes[:2]]
    assert [len(line.get_xdata()) for axis in points for line in axis] == [2, 2, 3, 3], "what does not vibrate is no mode of this picture"
    first, second = points[0]
    assert np.allclose(first.get_xdata(), np.array([80, 100]) * 30 / np.pi) and first.get_marker() != second.get_marker()
    assert np.allclose(second.get_ydata() - first.get_ydata(), [0.01, 0])


def coefficients(folder):
    """In a unit that a person reads, and a curve through the variants."""
    speed = np.linspace(600, 6000, 28)

    def fill(root):
        group = synthetic.study(root, "over speed", "sweep")
        synthetic.put(group.create_group("table"), **{"studies.1.static.speed": speed}, **{
            f"films.bearing.B1.{letter}.{c}": 1.6e10 * size * 600 / speed for letter in "KC" for c, size in zip(("xx", "xy", "yx", "yy"), (0.1, -0.1, -0.3, 1))})

    with results_with(folder, fill) as results:
        study = results["over speed"]
        study.summary = {"trends": [{"quantity": "studies.1.static.speed", "unit": "rpm"}]}
        axis = Figures().draw(sweep, sweep.draw_coefficients, study)["stiffness"].axes[0]
    curve = max(lines_of(axis, style.COLOURS[3]), key=len)
    assert axis.get_ylabel() == "stiffness [GN/m]" and axis.get_xlabel() == "speed [rpm]" and curve[0, 1] == 16.0
    # A polygon is 2 % too high in the middle of the first stretch.
    error = np.interp(700, *curve.T) / (16 * 600 / 700) - 1
    assert len(curve) > 100 and abs(error) < 0.01, error


def at_rest(folder):
    """What a sweep of journals at rest found, over the factor that was varied; what it left alone has no panel."""
    factor, clearance = np.array([1.5, 0.5, 1.0]), 80e-6

    def fill(root):
        group = synthetic.study(root, "clearance", "sweep")
        for order, x in enumerate(factor):
            variant = group.create_group(f"variants/{order}")
            variant.attrs.update({"title": f"clearance x{x:g}", "order": order + 1})
            root.copy(root["studies/at service speed"], variant, "place")
            variant["place"].attrs["title"] = "place"
        synthetic.put(group.create_group("table"), **{"bearings.*.geometry.clearance": factor})

    def column(name, unit, values):
        return {"name": f"place.{name}", "unit": unit, "values": list(values), "uncertainties": [None, 0.0, 0.1 * abs(values[2])]}

    with results_with(folder, fill) as results:
        study = results["clearance"]
        # Petroff: without load the film is as thick as the clearance, and the loss is inverse to it.
        columns = [column(f"bearing.{b}.{name}", unit, size * values) for b, size in (("A.1", 1), ("B", 2)) for name, unit, values in
                   (("min_thickness", "m", clearance * factor), ("power_loss", "W", 1500 / factor))]
        study.summary = {"variants": [{"name": f"clearance x{x:g}", "changes": {}} for x in factor], "columns": columns + [column("load.B", "N", 50 + 0 * factor)],
                         "trends": [{"quantity": "bearings.*.geometry.clearance", "unit": "1", "beside": ""}]}
        axes = Figures().draw(sweep, sweep.draw_at_rest, study)["place"].axes
        chart = live_sweep.sweep(study, "place")
    assert [axis.get_ylabel() for axis in axes] == ["thinnest film [\u00b5m]", "power loss [kW]"], [axis.get_ylabel() for axis in axes]
    assert all(axis.get_xlabel() == "clearance, factor on the deck's value" for axis in axes)
    thin, loss = (lines_of(axis, style.COLOURS[1])[0] for axis in axes)
    assert np.allclose(thin, [[0.5, 80], [1.0, 160], [1.5, 240]]) and np.allclose(loss, [[0.5, 6], [1.0, 3], [1.5, 2]]), (thin, loss)
    dots = [line for line in chart["lines"] if line.get("dots")]
    assert [(line["n"], line["y"], line.get("p", 0)) for line in dots[1:3]] == [("B", [80, 160, 240], 0), ("A.1", [3, 1.5, 1], 1)], dots


def loci(folder):
    """Curves of bifurcations are curves, labels stand on none of them, and bars where they were computed: in the parameter that the
    curve does not run along."""
    turn = np.linspace(-0.5, 0.5, 12)
    computed, across, upward = np.zeros(12), np.full(12, 9.0), np.full(12, 0.3)
    computed[[0, 5, 11]] = 1
    upward[5] = np.nan
    across[11] = np.nan

    def fill(root):
        group = synthetic.study(root, "flips", "locus", bifurcation="flip", parameter="speed", parameter_unit="rad/s",
                                second="bearings.half.film.compliance", second_unit="1")
        synthetic.put(group.create_group("locus"), parameter=690 - 900 * turn**2, second=1 + 2 * turn,
                      parameter_uncertainty=across, second_uncertainty=upward, uncertainty_computed=computed)
        synthetic.put(group.create_group("codimension_two"), type=["meeting_over_second"], parameter=[690.0], second=[1.0])

    with results_with(folder, fill) as results:
        figure = Figures().draw(locus, locus.draw_together, results)["loci"]
        colour = results["flips"].colour
    figure.canvas.draw()
    axis = figure.axes[0]
    assert axis.get_ylabel() == "compliance"
    curve, = lines_of(axis, colour)
    extents = [np.ptp(piece, axis=0) for bars in axis.collections for piece in bars.get_segments()]
    assert np.allclose(sorted(map(tuple, extents)), [(0, 0.6), (18, 0), (18, 0)]), extents
    assert len(curve) > 80 and np.abs(690 - 225 * (curve[:, 1] - 1)**2 - curve[:, 0]).max() < 1, "a parabola"
    box = axis.texts[0].get_window_extent()
    assert not any(box.contains(*place) for place in axis.transData.transform(curve)), "the label covers the curve"
    assert axis.get_window_extent().fully_contains(box.x0, box.y0) and axis.get_window_extent().fully_contains(box.x1, box.y1)


def sections(folder):
    """Of a bore of 15 mm, clearance 20 um, eccentricity 0.5 towards 0 deg, whose film is drawn 100 times as thick."""
    plt.close("all")  # of the pictures before
    with results_with(folder, lambda root: None) as results:
        figures = Figures()
        figures.draw(thd_maps, thd_maps.draw_maps, results["hot"])
        for function in (thd_cuts.draw_radial, thd_cuts.draw_axial):
            figures.draw(thd_cuts, function, results["hot"])
    meshes = [c for c in figures["thd-radial"].axes[0].collections if isinstance(c, QuadMesh)]
    assert len(meshes) == 3
    bush, film, journal = (m.get_coordinates() for m in meshes)
    radius = lambda corners, centre=0: np.hypot(corners[..., 0] - centre, corners[..., 1])  # noqa: E731
    assert np.allclose(radius(bush)[0], 17), "the bush begins at its wall and stands off by the clearance"
    assert np.allclose(radius(film)[0], 17), "the film begins there"
    assert np.allclose(radius(bush)[-1], 27) and np.allclose(radius(journal, 1)[0], 5), "both solids reach their free surfaces"
    gap = radius(film)[0] - radius(film)[-1]
    assert np.isclose(gap.min(), 1) and np.isclose(gap.max(), 3)
    assert np.allclose(radius(journal, 1)[-1], 15), "the journal lies 1 mm to the right"
    assert np.abs(radius(film[-1], 1) - 15).max() < 0.05, "where the film ends"
    for mesh in meshes:
        assert mesh.get_clim() == meshes[0].get_clim(), "one scale of temperature"
        assert np.allclose(mesh.get_coordinates()[:, 0], mesh.get_coordinates()[:, -1]), "closed"
    meshes = [c.get_coordinates() for c in figures["thd-axial"].axes[0].collections if isinstance(c, QuadMesh)]
    assert len(meshes) == 6, "film, bush and journal, above and below"
    film, bush, journal = meshes[:3]
    assert np.isclose(film[0, 0, 1], 16) and np.isclose(film[0, -1, 1], 15) and np.isclose(bush[0, 0, 1], 16) and np.isclose(journal[0, -1, 1], 15)
    titles = [a.get_title("left") for a in figures["thd-maps"].axes if a.get_title("left")]
    assert len(titles) == 4 and not any("journal" in t for t in titles), "a wall of one temperature around is no map"
    assert titles[1] == "pressure: 0.1 to 0.4 MPa"


def beside(folder):
    """Films of one temperature beside a film with heat: what is held has no bar, and properties are over those at the least temperature."""
    plt.close("all")
    with results_with(folder, lambda root: None) as results:
        figures = Figures()
        for function in (thd_compare.draw_effective, thd_compare.draw_properties):
            figures.draw(thd_compare, function, results["hot"])
    bars = [[bar.get_height() for bar in group] for group in figures["thd-effective"].axes[1].containers]
    assert np.allclose(bars, [[np.nan, 1.2], [-3, np.nan], [0.4, -0.2]], equal_nan=True), bars
    curves = [line.get_ydata() for line in figures["thd-properties"].axes[0].lines if len(line.get_xdata()) == 6]
    assert len(curves) == 3 and all(values[0] == 1 for values in curves)
    assert np.allclose(curves[0], (1 + 6.5e-3 * (np.linspace(250, 500, 6) - 275)) / (1 - 6.5e-3 * 25)) and np.isclose(curves[2][-1], 0.5)


def with_groove_and_cavity(root):
    """An oil film ruptured from 300 over 0 to 60 deg, across the whole length, whose groove from 105 to 135 deg ends before the ends. The film
    is at 350 K, the groove at 320 K, the cavity at 310 K."""
    film = root["studies/hot/film"]
    theta, z = np.degrees(film["theta"][:]), film["z"][:]
    cavity = ((theta > 298) | (theta < 62))[None, :] & np.ones((17, 1), bool)
    groove = ((theta > 104) & (theta < 136))[None, :] & (np.abs(z) < 0.0125)[:, None]
    film["pressure"][...] = np.where(cavity, 0, 1e6 * (1 - (z / 0.015)**2)[:, None] * (2 + np.cos(np.radians(theta))))
    film["temperature"][...] = np.where(cavity, 310, np.where(groove, 320, 350 + 1e3 * z[:, None]))[..., None] + np.zeros(8)
    film["bush_wall"][...] = film["journal_wall"][...] = film["temperature"][..., 0]
    synthetic.put(film, ruptured=cavity.astype(float), groove=groove.astype(float))


def region_at(film, theta, z):
    """Of the node whose cell holds points [deg, mm]."""
    i = np.round((np.radians(theta) - film.theta[0]) / film.step).astype(int) % len(film.theta)
    j = np.clip(np.round((z * 1e-3 - film.z[0]) / (film.z[1] - film.z[0])).astype(int), 0, len(film.z) - 1)
    return film.region[j, i]


def refined():
    """A field between nodes: linear inside of a region, up to its border, and nothing of one region in another."""
    film = object.__new__(thd_film.Film)
    for closed in (True, False):
        film.theta = np.linspace(0.3, 0.3 + 2 * np.pi, 24, endpoint=False) if closed else np.linspace(0.3, 2, 12)
        n = len(film.theta)
        film.z = np.linspace(-0.02, 0.02, 9)
        film.region = np.zeros((9, n), int)
        film.region[2:7, 4:7] = 2
        film.region[:, 0] = 1
        values = np.where(film.region == 2, 5.0, 100 + 1e3 * film.z[:, None] + np.arange(n))
        theta, z, fine, region = film.fine(values)
        assert fine.shape == (len(z) - 1, len(theta) - 1) and np.isclose(theta[0], film.theta[0]) and np.isclose(z[-1], 0.02)
        assert np.isclose(theta[-1] - theta[0], 2 * np.pi if closed else 1.7)
        full, nodes = fine[region == 0], values[film.region == 0]
        assert np.allclose(fine[region == 2], 5) and full.min() > nodes.min() - 1e-9 and full.max() < nodes.max() + 1e-9
        places = ((theta[1:] + theta[:-1]) / 2 - film.theta[0]) / film.step
        inside = (places > 7) & (places < min(n - 1, 22))
        exact = 100 + 1e3 * ((z[1:] + z[:-1]) / 2)[:, None] + places[inside]
        assert np.allclose(fine[:, inside], exact, rtol=0, atol=1e-9), "linear"
        first = np.flatnonzero((region[len(z) // 2] == 2))[0]
        assert np.isclose(theta[first], film.theta[0] + 3.5 * film.step), "a region begins at the face of its first cell"
        smooth = film.fine(values, jumps=False)
        assert (smooth[3] == 0).all() and ((smooth[2] > 6) & (smooth[2] < 90)).any(), "what does not jump is drawn through"
        length = sum(abs(b[0] - a[0]) * 0.015 + abs(b[1] - a[1]) for a, b in film.border(film.region == 2))
        assert np.isclose(length, 2 * (3 * film.step * 0.015 + 5 * 0.005)), "the border goes around"
        length = sum(b[0] - a[0] for a, b in film.border(film.region == 1))
        assert np.isclose(length, 2 * (1 if closed else 0.5) * film.step), "also where the map is cut open"


def ruptured(folder):
    """A groove and a cavity in maps and cuts: hatched and outlined; no contour, isotherm or line of flow where there is none, and no
    temperature between those of two regions."""
    plt.close("all")
    with results_with(folder, lambda root: None) as results:
        figures = Figures().draw(thd_maps, thd_maps.draw_maps, results["hot"])
    assert not any(c.get_hatch() or c.get_label() == "groove" for a in figures["thd-maps"].axes for c in a.collections)
    with results_with(folder, with_groove_and_cavity) as results:
        film = thd_film.Film(results["hot"])
        figures = Figures()
        for module, function in ((thd_maps, thd_maps.draw_maps), (thd_maps, thd_maps.draw_heat), (thd_cuts, thd_cuts.draw_radial), (thd_cuts, thd_cuts.draw_axial),
                                 (thd_cuts, thd_cuts.draw_profiles)):
            figures.draw(module, function, results["hot"])
    warm, pressed = figures["thd-maps"].axes[:2]
    hatched = [c for c in warm.collections if c.get_hatch()]
    corners = [p.vertices[:4] for p in hatched[0].get_paths()]
    area = sum(np.ptp(c[:, 0]) * np.ptp(c[:, 1]) for c in corners)
    assert len(corners) == 2 and np.isclose(area, 17 * 7.5 * 30), "whole cells, also at the seam"
    assert {tuple(np.round(np.sort(c[[0, 1], 0]), 9)) for c in corners} == {(0, 63.75), (296.25, 360)}
    outline, = (c for c in warm.collections if c.get_label() == "groove")
    corners = np.concatenate(outline.get_segments())
    assert np.allclose((corners.min(axis=0), corners.max(axis=0)), ((101.25, -12.1875), (138.75, 12.1875))), "cells, not nodes"
    mesh = field_of(warm)
    drawn = np.asarray(mesh.get_array()).ravel() + thd_film.ZERO  # K
    assert set(np.round(drawn[drawn < 334])) == {310, 320} and drawn[drawn > 321].min() >= 335 - 1e-9, "nothing between regions"
    contours = [p for c in warm.collections if c not in (*hatched, outline, mesh) and c.get_label() != "_halo" for p in c.get_paths() if len(p.vertices)]
    assert contours
    for path in contours:
        assert (region_at(film, *path.vertices.T) == thd_film.FULL).all(), "a contour through the groove or the cavity"
    lines = [c for c in pressed.collections if c.get_label() == "_streamlines"]
    points = np.concatenate(lines[0].get_segments())
    assert (region_at(film, *points.T) != thd_film.RUPTURED).all(), "a line of flow in the cavity"
    radial, = [a for a in figures["thd-radial"].axes if a.get_xlabel()]
    angles = [np.degrees(np.arctan2(*p.get_xy().T[::-1])) for p in radial.patches if p.get_hatch()]
    assert np.allclose([(a.min(), a.max()) for a in angles], [(0, 63.75), (-63.75, 0)]), "to the faces of its last cells"
    assert [line.get_label() for line in radial.lines].count("groove") == 1
    pieces = [c for c in radial.collections if isinstance(c, QuadMesh)][1:-1]
    assert len(pieces) == 5 and {float(np.ptp(np.asarray(p.get_array()))) for p in pieces} == {0}, "ruptured, full, groove, full, ruptured"
    axial = figures["thd-axial"].axes[0]
    assert sum(bool(p.get_hatch()) for p in axial.patches) == 1, "the thinnest film is ruptured, the widest is not"
    labels = [line.get_label() for line in figures["thd-profiles"].axes[0].lines]
    assert labels == ["0 deg, ruptured", "60 deg, ruptured", "120 deg, groove", "180 deg", "240 deg", "300 deg, ruptured"], labels


def heat_flows(folder):
    """Per area with the sum over the film; properties that change as maps; the way of the shaft."""
    plt.close("all")
    figures = Figures()
    for speed, words in ((1e4, "moves to the right"), (0, "the shaft stands"), (-5, "moves to the left")):
        def change(root, speed=speed):
            root["studies/hot/film/speed"][...] = speed
        with results_with(folder, change) as results:
            figures.draw(thd_maps, thd_maps.draw_heat, results["hot"])
            figures.draw(thd_maps, thd_maps.draw_fluid, results["hot"])
            figures.draw(thd_cuts, thd_cuts.draw_radial, results["hot"])
        assert any(words in a.get_xlabel() for a in figures["thd-heat"].axes)
        arrows = [p for p in figures["thd-radial"].axes[0].patches if p.get_label() == "rotation"]
        assert len(arrows) == (speed != 0)
        if speed:
            (ax, ay), (bx, by) = arrows[0]._posA_posB
            assert (ax * by - ay * bx) * speed > 0, "the arrow turns as the shaft does"
    titles = [a.get_title("left") for a in figures["thd-heat"].axes if a.get_title("left")]
    assert titles[0] == f"heat to the bush: 20 kW/m\u00b2, {2e4 * 2 * np.pi * 0.015 * 0.03:.4g} W in all", titles
    assert [t.split(":")[0] for t in titles] == ["heat to the bush", "heat to the journal", "dissipation"]
    with results_with(folder, lambda root: synthetic.put(root["studies/hot/film"], expansion=-1e4 * np.ones((17, 48)))) as results:
        gas = Figures().draw(thd_maps, thd_maps.draw_heat, results["hot"])["thd-heat"]
    last = [a.get_title("left") for a in gas.axes if a.get_title("left")][-1]
    assert last.startswith("both together: 16.67 to 70 kW/m\u00b2"), last
    signed = field_of(figures["thd-heat"].axes[1])
    low, high = signed.get_clim()
    assert low == -high and 7.9 < high <= 8, "white is no heat flow"
    titles = [a.get_title("left") for a in figures["thd-fluid"].axes if a.get_title("left")]
    assert [t.split(":")[0] for t in titles] == ["viscosity", "density"] and titles[0].endswith("\u00b5Pa s"), titles


def streamlines(axis):
    lines = [c for c in axis.collections if c.get_label() == "_streamlines"]
    return np.concatenate(lines[0].get_segments())


def velocities(folder):
    """White is what drag alone gives; orifices are marked on both sides of the seam; nothing is drawn in a cavity that knows no flow, and one
    that conserves its mass is drawn through."""
    plt.close("all")
    with results_with(folder, lambda root: None) as results:
        above, below = Figures().draw(thd_maps, thd_maps.draw_velocity, results["hot"])["thd-velocity"].axes[:2]
    for axis, white, reach in ((above, 75, 40), (below, 0, 30)):
        mesh = field_of(axis)
        assert np.allclose(mesh.get_clim(), (white - reach, white + reach)), mesh.get_clim()
        marks, = (line.get_xydata() for line in axis.get_lines() if line.get_label() == "orifice")
        assert np.allclose(np.sort(marks[:, 0]), 45 * np.arange(9)) and not marks[:, 1].any(), marks
    points = streamlines(below)
    assert np.ptp(points[:, 0]) > 300 and abs(points[:, 1]).max() > 10
    for keeps in (False, True):
        def fill(root, keeps=keeps):
            with_groove_and_cavity(root)
            if keeps:
                synthetic.put(root["studies/hot/film"], fill=1 - 0.5 * root["studies/hot/film/ruptured"][:])
        with results_with(folder, fill) as results:
            film = thd_film.Film(results["hot"])
            above, below = Figures().draw(thd_maps, thd_maps.draw_velocity, results["hot"])["thd-velocity"].axes[:2]
        for axis in (above, below):
            mesh = field_of(axis)
            drawn, middles = np.ma.asarray(mesh.get_array()), pixels_of(mesh)
            blank = np.broadcast_to(np.ma.getmaskarray(drawn), drawn.shape).ravel()
            assert (blank == ((region_at(film, *middles.T) == thd_film.RUPTURED) & (not keeps))).all(), "blank in the cavity alone"
        assert (region_at(film, *streamlines(below).T) == thd_film.RUPTURED).any() == keeps, "lines end at a cavity"


def film_sections(folder):
    """Through the film where it is fed and half-way to the next place, with the thickness to scale; isotherms and colours between the walls."""
    plt.close("all")
    feeds = {"orifice": (lambda root: None, "along at 0 deg, at an orifice", "along at 22.5 deg, half-way to the next orifice", 10),
             "groove": (lambda root: (with_groove_and_cavity(root), root["studies/hot"].pop("orifices")), "along at 120 deg, at a groove", "along at 300 deg, opposite the groove", 25)}
    for kind, (change, first, second, thickness) in feeds.items():
        with results_with(folder, change) as results:
            figures = Figures().draw(thd_sections, thd_sections.draw_film, results["hot"])
            figures.draw(thd_cuts, thd_sections.draw_axial, results["hot"])  # saved by the function that all axial sections share
        axes = figures["thd-film"].axes[:4]
        titles = [a.get_title("left") for a in axes]
        # 22.5 deg lies on a node of 48.
        assert titles[:2] == [first, second], titles
        assert titles[2].startswith(f"around at z = 0 mm, through the {kind}") and "end of the film" in titles[3], titles
        for axis, wanted in zip(axes, (thickness, None, 30, 30)):
            meshes = [c for c in axis.collections if isinstance(c, QuadMesh)]
            corners = np.concatenate([m.get_coordinates().reshape(-1, 2) for m in meshes])
            assert corners[:, 1].min() == 0 and (wanted is None or np.isclose(corners[:, 1].max(), wanted)), corners[:, 1].max()
            if axis in axes[2:]:
                gap = 20 - 10 * np.cos(np.radians(corners[:, 0]))
                assert (corners[:, 1] <= gap + 0.05).all(), "nothing beyond the journal's surface"
            hatched = [p for p in axis.patches if p.get_hatch()]
            assert bool(hatched) == (kind == "groove" and (axis in axes[1:])), "a cavity around 0 deg, to 300 deg"
        arrows = [np.sort(line.get_xdata()) for a in axes for line in a.get_lines() if line.get_label() == "orifice"]
        if kind == "orifice":
            assert len(arrows) == 2 and np.allclose(arrows[0], 0) and np.allclose(arrows[1], 45 * np.arange(9)), arrows
        else:
            assert not arrows
        assert f"thd-axial-{kind}" in figures
        meshes = [c for c in figures[f"thd-axial-{kind}"].axes[0].collections if isinstance(c, QuadMesh)]
        assert len(meshes) == (6 if kind == "orifice" else 8), "film, bush and journal, above and below; the film of a groove in three"


def films_of_machines(folder):
    """Where a pad has no pressure or is not full it is hatched; what jumps there is not interpolated, and has no contours."""
    plt.close("all")

    def fill(root):
        pad = root["studies/at service speed/films/B1/pad1"]
        theta, z = np.degrees(pad["theta"][:]), pad["z"][:]
        empty = (theta > -80.5)[:, None] & np.ones(len(z), bool)
        pad["pressure"][...] = np.where(empty, 0, 1e6 * np.cos(np.radians(3 * (theta + 100)))[:, None] * (1.1 - (z / 0.1)**2))
        synthetic.put(pad, fill=np.where(empty, 0.4, 1.0), temperature=np.where(empty, 320, 350 + theta[:, None] / 10))

    with results_with(folder, fill) as results:
        figures = Figures().draw(machine_film, machine_film.draw, results["at service speed"])
    axes = [a for a in figures["film-B1"].axes if a.get_title() or a.get_title("left")]
    assert len(axes) == 4
    for axis in axes:
        hatched, = (c for c in axis.collections if c.get_hatch())
        corners = np.concatenate([p.vertices[:4] for p in hatched.get_paths()])
        assert np.allclose((corners[:, 0].min(), corners[:, 0].max()), (-80.5, -60)), "to the faces of its cells"
    for axis, values in ((axes[2], (320 - 273.15, None)), (axes[3], (0.4, 1.0))):
        mesh = field_of(axis)
        drawn = np.unique(np.round(np.ma.compressed(mesh.get_array()), 6))
        if values[1] is None:
            assert np.isclose(drawn[0], values[0]) and drawn[1] > 338 - 273.15, "nothing between film and cavity"
        else:
            assert np.allclose(drawn, values), drawn
        contours = [p.vertices for c in axis.collections if c is not mesh and not c.get_hatch() for p in c.get_paths() if len(p.vertices)]
        assert all(v[:, 0].max() <= -80.5 + 1e-6 for v in contours), "a contour in the cavity"
    # A film that may pull is full.
    with results_with(folder, lambda root: root["studies/at service speed/films/B1/pad1/pressure"].write_direct(
            np.ascontiguousarray(root["studies/at service speed/films/B1/pad1/pressure"][:] - 1e5))) as results:
        figures = Figures().draw(machine_film, machine_film.draw, results["at service speed"])
    assert not any(c.get_hatch() for a in figures["film-B1"].axes for c in a.collections)


def legends():
    """As many columns as fit: a long label takes only its own."""
    assert style.columns_of(["a", "b", "c"], 8, 6) == 3 and style.columns_of([], 8, 6) == 1
    assert style.columns_of(["stable", "unstable", "x" * 60, "y"], 7.2, 6) == 3 and style.columns_of(["x" * 60] * 2, 7.2, 6) == 1


def turning_branches():
    """Colours are the parameter where it rises or falls, else the way along the branch; none is yellow."""
    orbit = lambda p: types.SimpleNamespace(parameter=p)  # noqa: E731
    shades, by_parameter = orbits.shades_of([orbit(p) for p in (1.0, 2.0, 9.0)])
    assert by_parameter and np.isclose(shades[1], 0.9 / 8), "an eighth of the way"
    shades, by_parameter = orbits.shades_of([orbit(p) for p in (1.0, 9.0, 2.0)])
    assert not by_parameter and np.isclose(shades[1], 0.45) and max(plt.cm.viridis(shades)[:, 0]) < 0.8


def sharp_points():
    """No curve through one computed point between two others: lines, and every point is seen; the curve goes on where points suffice."""
    at = np.array([0, 1, 2, 3, 4, 5, 6, 7, 8.0])
    peak = np.array([0, 0.1, 0.2, 0.3, 3.0, 0.3, 0.2, 0.1, 0])
    branch = curves.Branch(at)
    assert list(np.flatnonzero(branch.straight(peak))) == [3, 4]
    (x, y, solid), = branch.stretches(peak, np.ones(9, bool), [])
    assert np.allclose(np.interp([3.25, 3.5, 4.5], x, y), [0.975, 1.65, 1.65]) and np.isclose(branch.at(peak, (3, 0.5)), 1.65)
    smooth = np.sin(np.linspace(0, np.pi, 9))
    assert not branch.straight(smooth).any()
    assert not curves.Branch(at, filled=True).straight(peak).any(), "the program has put points where the picture bends"


def courses_of_multipliers():
    """Each goes on at its nearest one of the next cycle, whatever the order of the columns; a jump joins nothing."""
    values = np.array([[0.9, -0.5], [-0.55, 0.95], [1.02, -0.6], [-5.0, 1.05]], complex)
    found = set(zip(*multipliers.joined(values)))
    assert found == {(0, 0, 1), (0, 1, 0), (1, 0, 1), (1, 1, 0), (2, 0, 1)}, found
    parameter = np.array([1.0, 2, 3, 4])
    assert multipliers.where_crossed("flip", 2, parameter, values) == -1 and multipliers.where_crossed("cyclic_fold", 2, parameter, values) == 1
    pair = np.array([[0.6 + 0.7j, 0.6 - 0.7j], [0.6 + 0.9j, 0.6 - 0.9j]])
    at = multipliers.where_crossed("neimark_sacker", 1.5, parameter[:2], pair)
    assert np.isclose(abs(at), 1) and at.imag > 0.7


def same_bifurcations():
    """A trend joins bifurcations by side and frequency, not by number."""
    event = lambda value, side, rate=None: {"value": value, "stable_side": side, "whirl_frequency_rad_s": rate}  # noqa: E731
    before = [event(100, "below", 50.0), event(300, "above", 50.0)]
    after = [event(40, "below", 12.0), event(110, "below", 51.0), event(310, "above", 49.0)]
    assert sorted(sweep.pairs_of(before, after)) == [(0, 1), (1, 2)]
    assert sweep.pairs_of([event(1, "below")], [event(2, "below")]) == [(0, 0)] and not sweep.pairs_of([event(1, "below")], [event(2, "below", 3.0)])


def names_of_variants():
    """Numbers of six digits, and a legend that names at most sixteen variants of a scale, the first and the last among them."""
    assert sweep.short("speed 106.12244898 rad/s") == "speed 106.122 rad/s" and sweep.short("clearance 80 um, x 1.5") == "clearance 80 \u00b5m, x 1.5"
    labels = [h.get_label() for h in sweep.legend([(f"speed {k}", "#123456", {}) for k in range(50)])]
    assert len(labels) == 16 and labels[0] == "speed 0" and labels[-1] == "speed 49", labels


def without_meaning(folder):
    """No picture of a straight line, of a path that stays where it is, or of a motion that was drawn before."""
    def fill(root):
        nodes = root["studies/at service speed/nodes"]
        z = nodes["z"][:]
        nodes["y"][...] = 3e-5 + 1e-6 * z
        if "x" in nodes:
            nodes["x"][...] = 0
        if "moment" in nodes:
            del nodes["moment"]
        branch = root["studies/balanced/branch"]
        for k in "xy":
            branch[k][...] = 1e-5
        root.copy(root["studies/period two"], root["studies"], "again")
        root["studies/again"].attrs["title"] = "again"

    with results_with(folder, fill) as results:
        assert not Figures().draw(shapes, shapes.draw_sag, results["at service speed"])
        assert not Figures().draw(orbits, orbits.draw_locus, results["balanced"])
        names = [s.name for s in results.studies if s.kind == "motion"]
        assert len(names) == 2
        figures = [Figures().draw(motion, motion.draw, results[n]) for n in names]
        histories = [Figures().draw(motion, motion.draw_history, results[n]) for n in names]
    assert sorted(map(len, figures)) == sorted(map(len, histories)) == [0, 1]


def ticks_drawn_together():
    """The pixels are those of ticks drawn one by one: linear, logarithmic with minor ticks, with names, at the top, switched off, with a power of ten."""
    def pixels(one_by_one):
        figure, axes = our_plt.subplots(2, 2, figsize=(7, 5))
        (a, b), (c, d) = axes
        a.plot([0, 1e6], [-3e-7, 2e-7])
        a.set_xlabel("x [m]")
        b.loglog([2, 3e4], [1e-5, 0.3])
        b.set_ylabel("y")
        style.ticks_at(c.xaxis, [0, 45, 90, 135], ["0", "a quarter", "", "more"])
        c.plot([0, 135], [0, 1])
        c.xaxis.tick_top()
        d.plot([5, 6], [7, 8])
        d.tick_params(labelbottom=False)
        d.grid(False)
        figure.get_layout_engine().execute(figure)
        if one_by_one:
            figure.canvas.draw()
        else:
            with together():
                figure.canvas.draw()
        return np.asarray(figure.canvas.buffer_rgba()).copy()

    expected, found = pixels(True), pixels(False)
    assert np.array_equal(found, expected), np.argwhere(np.any(found != expected, axis=2))[:5]

    figure, axis = our_plt.subplots()
    with together():
        figure.get_layout_engine().execute(figure)
        figure.canvas.draw()
    assert len(axis.xaxis.majorTicks) == 1, f"{len(axis.xaxis.majorTicks)} ticks were made"


def walls():
    """A branch that comes near the wall on both sides: both walls are inside the frame."""
    real = bifurcation.pads_of, bifurcation.reach
    bifurcation.pads_of, bifurcation.reach = (lambda *_: ["a pad"]), (lambda *_: (25e-6, 26e-6))
    figure, axis = our_plt.subplots()
    axis.set_ylim(-24, 23)
    try:
        bifurcation.mark_walls(axis, types.SimpleNamespace(has=lambda name: name == "bearings/clearance", get=lambda *_: None, results=types.SimpleNamespace(deck={})), 0, 1e6)
    finally:
        bifurcation.pads_of, bifurcation.reach = real
    low, high = axis.get_ylim()
    assert low < -26 and high > 25, (low, high)


def flow_lines():
    """Lines about a centre are circles, evenly spaced; of a uniform flow they are straight; no line beside nodes without a flow."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 60), np.linspace(-0.5, 0.5, 40))
    lines = flow.streamlines(-y, x)
    radii = [np.hypot(*(line - 0.5)) for line in lines]
    assert len(lines) > 10 and max(np.ptp(r) for r in radii) < 2e-3, max(np.ptp(r) for r in radii)
    middles = np.sort([r.mean() for r in radii])
    assert np.diff(middles[middles < 0.4]).max() < 4 / flow.CELLS, "a gap between lines"
    cells = [set(map(tuple, (line.T * flow.CELLS).astype(int).tolist())) for line in lines]
    assert sum(map(len, cells)) == len(set().union(*cells)), "two lines in a cell"
    hole = np.where((x < 0) & (y < 0), np.nan, 1.0)
    lines = flow.streamlines(hole, 0.5 * hole)
    assert all(np.allclose(np.diff(line[1]) / np.diff(line[0]), 0.5) for line in lines) and max(np.ptp(line[0]) for line in lines) > 0.4
    assert not any(((line[0] < 0.49) & (line[1] < 0.48)).any() for line in lines)


def keys_and_files():
    """Numbers beside a key are where they say, whatever the step; a picture of all colours holds each pixel as it is."""
    for low, high in ((352.5, 364.5), (0, 3.7), (-1e-3, 4e-3), (95, 106), (5, 5)):
        figure, axis = our_plt.subplots()
        style.key(axis, axis.imshow(np.array([[low, high]]), vmin=low, vmax=high), "T [K]")
        told = [(float(t.get_text().replace("\u2212", "-")), t.get_position()[1]) for t in axis.texts if t.get_text() != "T [K]"]
        assert len(told) >= (3 if high > low else 1) and all(np.isclose(value, low + at * (high - low), rtol=0, atol=1e-3 * (high - low)) for value, at in told if high > low), (low, high, told)
        plt.close(figure)
    pixels = np.random.default_rng(1).integers(0, 256, (37, 53, 4), dtype=np.uint8)
    with tempfile.TemporaryDirectory() as name:
        file = pathlib.Path(name) / "x.png"
        style.write_all_colours(pixels, file)
        with Image.open(file) as image:
            assert image.mode == "RGB" and np.array_equal(np.asarray(image), pixels[..., :3])


def tables(folder):
    """A kind of study without pictures of its own shows the columns of its tables over the first one, a panel for each unit."""
    z, moment, stress = [0.0, 1.0, 1.0, 2.0], [0.0, 5e3, 5e3, 0.0], [0.0, 3e6, 4e6, 0.0]

    def fill(root):
        group = synthetic.study(root, "bent", "of tomorrow").create_group("shaft")
        group.attrs["columns"] = "z moment stress node"
        synthetic.put(group, z=z, moment=moment, stress=stress, node=[1.0, 2.0, 2.0, 3.0])
        for name, unit in (("z", "m"), ("moment", "N m"), ("stress", "Pa"), ("node", "1")):
            group[name].attrs["unit"] = unit
        other = root["studies/bent"].create_group("unbalance")
        other.attrs["columns"] = "unbalance amount"
        synthetic.put(other, unbalance=["a", "b", "c"], amount=[1.0, 2.0, 3.0])

    with results_with(folder, fill) as results:
        (figure,) = Figures().draw(columns, columns.draw, results["bent"]).values()
        assert list(results["bent"].table()) == ["moment", "node", "stress", "z"], "the table that it is about"
    assert [axis.get_ylabel() for axis in figure.axes] == ["[kN m]", "[MPa]"] and figure.axes[-1].get_xlabel() == "z [m]"
    for axis, values in zip(figure.axes, (np.array(moment) / 1e3, np.array(stress) / 1e6)):
        np.testing.assert_allclose(lines_of(axis, style.COLOURS[0])[0], np.stack([z, values], axis=1))


style.use_style()
ticks_drawn_together()
walls()
flow_lines()
keys_and_files()
beams()
turning_branches()
sharp_points()
courses_of_multipliers()
same_bifurcations()
names_of_variants()
refined()
legends()
border_of_stability()
for check in (sag, mode_shapes, growth, campbell_lines, words, courses, colours, harmonics, responses_of_a_sweep, branches_of_a_sweep, stability_factors,
              coefficients, at_rest, loci, sections, beside, ruptured, heat_flows, velocities, film_sections, films_of_machines, without_meaning, tables):
    with tempfile.TemporaryDirectory() as name:
        check(pathlib.Path(name) / "x")
    plt.close("all")
print("pictures show what there is")
