#!/usr/bin/env python3
"""The charts of a report without a browser: their data are those of the results, every curve fits its panel, and the page has its pictures
where the library is missing."""
import contextlib
import json
import pathlib
import re
import sys
import tempfile

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import command  # noqa: E402
import synthetic  # noqa: E402
from whirl_plot import campbell, live, live_modes, live_motion, style  # noqa: E402
from whirl_plot.subject import Drawn  # noqa: E402

RPM = 30 / np.pi
CHARTS = {"modes.campbell", "modes.shapes-3d", "generator_pair.response", "generator_pair.response-bearings", "balanced.equilibria", "pair_G2.5.cycles-vertical",
          "pair_G2.5.cycles-horizontal", "pair_G2.5.orbits", "pair_G6.3.cycles-vertical", "pair_G6.3.cycles-horizontal", "pair_G6.3.orbits", "period_two.history", "period_two.motion", "bifurcations", "disc.response-node.7.x",
          "pair_G2.5.multipliers", "pair_G6.3.multipliers", "undamped.critical-speeds", "loci", "clearances.trends", "clearances.balanced"}


@contextlib.contextmanager
def with_library(text):
    """Pages hold this text in place of the library, none if it is None."""
    real, live.library = live.library, lambda: text
    try:
        yield
    finally:
        live.library = real


def close(found, values, tolerance=1e-5):
    found = np.array([np.nan if v is None else v for v in found], float)
    return np.allclose(found, values, rtol=tolerance, atol=tolerance * np.nanmax(np.abs(values)), equal_nan=True)


def named(chart, name, panel=0, option=None, **more):
    return [c for c in chart["lines"] if c.get("n") == name and c.get("p", 0) == panel and c.get("o") == option and all(c.get(k) == v for k, v in more.items())]


def whole(chart, what):
    """Every curve belongs to a panel and to what can be chosen; its columns are equally long and hold numbers."""
    if chart.get("kind") == "shapes":
        assert chart["modes"] and all(len(v) == len(chart["z"]) for m in chart["modes"] for d in "xy" for v in m[d]), what
        return
    assert chart["panels"] and all(len(p["x"]) == len(p["y"]) == 2 for p in chart["panels"]), what
    options = len(chart.get("choose", {"of": [0]})["of"])
    for c in chart["lines"]:
        columns = [c["x"], c["y"], *(v for *_, v in c.get("more", [])), *(c[k] for k in ("t", "at") if k in c)]
        assert len({len(v) for v in columns}) == 1 and c.get("p", 0) < len(chart["panels"]) and c.get("o", 0) < options, (what, c.get("n"))
        assert len(c.get("s", "")) in (0, len(c["x"]), len(c["x"]) - 1) and all(int(k, 36) < len(chart["styles"]) for k in c.get("s", "")), (what, c.get("n"))
        assert all(v is None or np.isfinite(v) for v in [*c["x"], *c["y"]]) and re.fullmatch("#[0-9a-f]{6}", c["c"]), (what, c.get("n"))
    shown = {c.get("p", 0) for c in chart["lines"]}
    assert shown == set(range(len(chart["panels"]))), (what, shown)


def charts_of(page):
    """Name of the picture -> its chart, of all figures of a page that have both."""
    found = {}
    for figure in re.findall(r"<figure>(.*?)</figure>", page, re.DOTALL):
        data = re.search(r"<div class=live><script type='application/json'>(.*?)</script></div>", figure, re.DOTALL)
        if data:
            found[re.search(r"<img alt='([^']*)'", figure)[1]] = json.loads(data[1])
    return found


def oscillator(root):
    """A transfer function whose phase passes 180 degrees, over a logarithmic frequency."""
    group = synthetic.study(root, "disc", "frequency_response", frequency_unit="rad/s").create_group("response")
    frequency = np.geomspace(10, 1000, 41)
    group["frequency"] = frequency
    table = group.create_group("machine/node.7.x.from.node.7.y")
    synthetic.put(table, amplitude=1e-6 / np.abs(1e4 - frequency**2 + 10j * frequency), phase=np.mod(np.linspace(2, 4, 41) + np.pi, 2 * np.pi) - np.pi)
    table["amplitude"].attrs["unit"] = "m/N"
    group["machine"].attrs["frequency"] = np.nan


def maps(root):
    """Critical speeds and a curve of bifurcations with bars, one of them no border; modes with bars."""
    k = np.geomspace(1e6, 1e9, 7)
    speeds = np.sqrt(k / 1e4)[:, None] * [1, 3]
    synthetic.put(synthetic.study(root, "undamped", "critical_speed_map").create_group("map"), stiffness=k, forward=1.1 * speeds, backward=speeds,
                  forward_uncertainty=1e-4 * speeds, backward_uncertainty=np.where(speeds > 20, 1e-4 * speeds, np.nan))
    g = synthetic.study(root, "flips", "locus", parameter="speed", parameter_unit="rpm", second="bearings.B1.clearance", second_unit="um", bifurcation="flip", of="pair, G6.3", start=2)
    x, y = np.array([4000, 4200, 4300, 4250.0]), np.array([100, 110, 120, 130.0])
    synthetic.put(g.create_group("locus"), parameter=x, second=y, others_unstable=[0, 0, 0, 2], parameter_uncertainty=[1.23456, 1, np.nan, 2], second_uncertainty=[0.5, 0.4, 0.3, 0.2],
                  uncertainty_computed=[1.0, 0, 1, 0])
    synthetic.put(g.create_group("codimension_two"), type=["resonance_1_2"], parameter=[4222.2], second=[111.11], parameter_uncertainty=[0.35], second_uncertainty=[np.nan])
    spectrum = root["studies/modes/spectrum"]
    synthetic.put(spectrum, frequency_uncertainty=1e-3 * spectrum["frequency"][()], log_decrement_uncertainty=np.full(len(spectrum["speed"]), 2e-4))


def values_of_maps(charts, results):
    chart, table = charts["undamped.critical-speeds"], results["undamped"]
    forward, backward = named(chart, "no. 2")
    assert close(forward["y"], table.get("map/forward")[:, 1] * RPM) and close(forward["b"], table.get("map/forward_uncertainty")[:, 1] * RPM, 1e-2)
    assert named(chart, "no. 1")[1]["b"][0] is None and chart["panels"][0]["log"] and chart["panels"][0]["logx"] and chart["styles"][int(backward["s"][0])]["t"] == "backward whirl"
    # A value is cut two digits behind the first one of its bar, not before.
    assert live.rounded([123456.789, 2.0, 1.0], 6, [0.0123, np.nan, 0]) == [123456.789, 2, 1] and live.rounded([1234.56789], 6, [3.0]) == [1234.57]

    chart = charts["loci"]
    points, = [c for c in named(chart, "flips") if c.get("bare")]
    assert points["t"][0] == "flips: speed 4000.0 \u00b1 1.2 rpm, clearance 100.00 \u00b1 0.50 \u00b5m" and "no border" in points["t"][3] and "no border" not in points["t"][1], points["t"]
    assert {c.get("d") for c in named(chart, "flips") if c.get("quiet") and not c.get("w")} == {None, 2}, "borders and others look alike"
    mark, = named(chart, "points of codimension two")
    assert mark["t"] == ["1:2 resonance: speed 4222.20 \u00b1 0.35 rpm, clearance 111.11 \u00b5m"], mark["t"]

    chart, study = charts["pair_G6.3.multipliers"], results["pair, G6.3"]
    sizes = [[abs(v) for v in row] for row in study.multipliers]
    drawn = [(at, size) for c in named(chart, "modulus") for at, size in zip(c["at"], c["y"])]
    assert len(drawn) == 4 * 140 and all(min(abs(size - s) for s in sizes[at]) < 1e-4 for at, size in drawn), "a modulus that no multiplier has"
    unstable = [(at, s == "1") for c in named(chart, "modulus") for at, s in zip(c["at"], c["s"])]
    assert all(any(grown for point, grown in unstable if point == k) == (max(sizes[k]) > 1) for k in range(140)), "unstable multipliers"
    plane = [c for c in named(chart, "modulus", 1) if c["f"] == 0]
    assert len(plane) == 1 and np.allclose(sorted(np.hypot(plane[0]["x"], plane[0]["y"])), sorted(v for v in sizes[0] if v), atol=1e-4), plane
    assert [words for _, words in chart["panels"][0]["places"]].count("PD") == 2

    chart = charts["clearances.trends"]
    texts = [t for c in chart["lines"] for t in c.get("t", [])]
    assert sorted(texts) == ["as given: 5025 \u00b1 12 rpm", "narrow: 4000 rpm", "wide: 6500.0 \u00b1 9.0 rpm"] and chart["panels"][0]["title"] == "balanced: Hopf" and chart["panels"][0]["y"] == ["speed", "rpm"], texts
    chart, own = charts["clearances.balanced"], results["balanced"]
    wide, = [c for c in named(chart, "wide", 0, 2) if c.get("bare")]
    assert close(wide["y"], 1.2 * own.get("branch/y")[:, 2] / synthetic.CLEARANCE[2]) and chart["panels"][0]["y"] == ["y / c", ""] and len({c["c"] for c in chart["lines"] if c.get("bare")}) == 3


def values(folder, charts):
    with Drawn(folder) as results:
        # Campbell: frequency and damping of each mode, red where it grows.
        chart, study = charts["modes.campbell"], results["modes"]
        mode = study.get("spectrum/mode") == 1
        top, = named(chart, "mode 1")
        assert close(top["x"], study.get("spectrum/speed")[mode] * RPM) and close(top["y"], study.get("spectrum/frequency")[mode] / (2 * np.pi))
        assert top["more"][0][0] == "log. decrement" and close(top["more"][0][2], study.get("spectrum/log_decrement")[mode], 1e-4)
        assert close(top["b"], 1e-3 * study.get("spectrum/frequency")[mode] / (2 * np.pi), 1e-2) and set(top["more"][0][3]) == {2e-4}, "bars of modes"
        grows = [chart["styles"][int(s, 36)]["c"] == style.BAD for s in top["s"]]
        decrement = study.get("spectrum/log_decrement")[mode]
        assert any(grows) and not all(grows) and grows == list((decrement[:-1] < 0) & (decrement[1:] < 0)), grows
        assert {k["t"] for k in chart["keys"]} >= {"unstable", "forward", "backward"} and len(named(chart, "critical speeds")[0]["t"]) == 5

        values_of_maps(charts, results)
        # Bode: amplitude and lag, gaps without an answer, peaks that are motions.
        chart, study = charts["generator_pair.response"], results["generator pair"]
        answer = study.get("response/answer") > 0
        top, lag = named(chart, "y, vertical", 0, 0)[0], named(chart, "y, vertical", 1, 0)[0]
        assert close(top["y"], np.where(answer, study.get("response/y_amplitude")[:, 0] * 1e6, np.nan)), "amplitude"
        assert close(lag["y"], np.where(answer, np.mod(-np.degrees(study.get("response/y_phase")[:, 0]), 360), np.nan)), "lag"
        assert chart["panels"][0]["y"] == ["amplitude, 0-peak", "\u00b5m"] and chart["panels"][1]["reverse"] and chart["panels"][0]["bands"]
        peak, = named(chart, "peaks", 0, 0)
        assert peak["x"] == [2683] and "AF 12.4" in peak["t"][0] and "25.5 %" in peak["t"][0], peak
        assert len(charts["generator_pair.response-bearings"]["choose"]["of"]) == 5

        # Branches: the points that the cursor finds are those computed; a mark at each bifurcation; the kept orbits.
        chart, study = charts["pair_G6.3.cycles-vertical"], results["pair, G6.3"]
        high = [c for c in named(chart, "pair, G6.3", 0, 2) if c.get("bare")][0]
        assert close(high["x"], study.get("branch/parameter")) and close(high["y"], study.get("branch/y_max")[:, 2] * 1e6)
        assert [int(s) for s in high["s"]] == [int(s == 0) for s in study.get("branch/stable")], "stability of the points"
        assert high["at"] == list(range(140)) and high["more"][0][0] == "largest multiplier"
        marks = [c for c in chart["lines"] if c.get("m") and c.get("o") == 2]
        assert {c["n"] for c in marks} == {"period doubling (flip)", "Neimark-Sacker", "limit point of cycles", "early end"}, {c["n"] for c in marks}
        assert any("film is broken through" in c["t"][0] for c in marks)
        orbits = [c for c in named(chart, "pair, G6.3", 1, 2) if c.get("f") is not None]
        kept = study.orbits
        assert [c["f"] for c in orbits] == [o.point for o in kept] and close(orbits[3]["x"][:-1], kept[3].x[::len(kept[3].x) // 96, 2] * 1e6), "orbits"
        assert close(orbits[3]["y"][:-1], kept[3].y[::len(kept[3].y) // 96, 2] * 1e6, 1e-4), "orbits"
        assert chart["panels"][1]["equal"] and named(chart, "clearance", 1, 2) and orbits[0]["x"][0] == orbits[0]["x"][-1]
        assert {c["n"] for c in charts["bifurcations"]["lines"] if not c.get("m")} >= {"balanced", "pair, G2.5", "pair, G6.3"}

        # Time histories end where the motion ends; shapes are those of the modes.
        chart, study = charts["period_two.history"], results["period two"]
        line, = named(chart, "x", 0, 0)
        assert line["x"][-1] == 0 and close(line["y"], study.get("orbit/x")[:, 0] * 1e6)
        chart = charts["period_two.motion"]
        assert close(named(chart, "orbit", 0, 0)[0]["y"], study.get("orbit/y")[:, 0] * 1e6, 1e-4) and len(named(chart, "once per revolution", 0, 0)[0]["x"]) == 20
        assert close(named(chart, "x, horizontal", 1, 0)[0]["x"], study.get("spectrum/order")[:121], 1e-4) and chart["panels"][1]["log"] and len(chart["panels"]) == 3
        # Transfer functions: the phase is broken where it passes 180 degrees.
        chart = charts["disc.response-node.7.x"]
        top, phase = (named(chart, "from node 7 y", k)[0] for k in (0, 1))
        assert close(top["y"], results["disc"].get("response/machine/node.7.x.from.node.7.y/amplitude")) and top["u"] == "m/N" and chart["panels"][0]["logx"]
        broken, = [k for k, s in enumerate(phase["s"]) if chart["styles"][int(s, 36)].get("c") == "transparent"]
        assert phase["y"][broken] > 0 > phase["y"][broken + 1], broken
        chart, study = charts["modes.shapes-3d"], results["modes"]
        assert len(chart["modes"]) == 6 and chart["modes"][1]["t"].startswith("2: 12.589 Hz"), [m["t"] for m in chart["modes"]]
        x, y = (np.array(chart["modes"][1][d][0]) + 1j * np.array(chart["modes"][1][d][1]) for d in "xy")
        wave = np.sin(2 * np.pi * np.array(chart["z"]) / 32)
        assert abs(abs(np.vdot(wave, x)) / np.linalg.norm(wave) / np.linalg.norm(x) - 1) < 1e-4, "shape of mode 2"
        sense = (np.conj(study.get("shapes/x_real") + 1j * study.get("shapes/x_imag")) * (study.get("shapes/y_real") + 1j * study.get("shapes/y_imag"))).imag[1, 50]
        assert np.sign(np.vdot(x, y).imag) == np.sign(sense) != 0, "sense of whirl"


def page(folder):
    """Each chart stands before the picture that paper shows; names of studies are text; without the library there are pictures only."""
    synthetic.make(folder)
    with (folder / "manifest.txt").open("a") as listed:  # pictures of nothing: what they show is tested elsewhere
        for picture in sorted(CHARTS | {"modes.shapes", "machine"}):
            (folder / f"{picture}.png").touch()
            listed.write(f"{picture}.png\n")
    with h5py.File(folder / "results.h5", "a") as root:
        for name in ("pair, G2.5", "pair, G6.3"):
            root[f"studies/{name}/orbits"]["point"] = np.linspace(0, 139, 20).astype(int)
        root["studies/pair, G6.3"].attrs["end"] = "the film is broken through </script><b>"
        oscillator(root)
        maps(root)
    with with_library("/*! a library */"):
        done = command.call("report", folder)
        assert done.returncode == 0 and not done.stderr, done.stderr
        text = (folder / "report.html").read_text()
        charts = charts_of(text)
        assert "</script><b>" not in text and "\\u003c/script>" in text, "a text of the results ends a script"
        assert set(charts) == CHARTS, set(charts) ^ CHARTS
        for name, chart in charts.items():
            whole(chart, name)
        values(folder, charts)
        assert text.count("<script>/*! a library */</script>") == 1 and "class WhirlShapes" in text and "charts-note" in text
        assert not re.search(r"(src|href)=(?!['\"]?(data:|#))", re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL)), "the page needs another file"
        assert "@media print" in live.STYLE and ".charted img{display:none}" in live.STYLE
    with with_library(None):
        done = command.call("report", folder)
        bare = (folder / "report.html").read_text()
    assert done.returncode == 0 and "<script" not in bare and "class=live" not in bare, done.stderr
    assert done.stderr.count("\n") == 1 and "libjs-chart.js" in done.stderr, done.stderr
    assert bare.count("<img") == text.count("<img"), "pictures depend on the library"
    # A chart that fails costs itself only.
    real, live_motion.history = live_motion.history, lambda *_: 1 / 0
    try:
        with with_library("/*! a library */"):
            done = command.call("report", folder)
    finally:
        live_motion.history = real
    assert done.returncode == 0 and "period two: the chart 'history' cannot be made" in done.stderr and set(charts_of((folder / "report.html").read_text())) == CHARTS - {"period_two.history"}, done.stderr


def creeping(folder):
    """A machine without a frequency has neither a Campbell diagram nor its chart."""
    synthetic.make(folder)
    with h5py.File(folder / "results.h5", "a") as root:
        root["studies/modes/spectrum/frequency"][...] = 0
        root["studies/modes/spectrum/log_decrement"][...] = np.inf
    with Drawn(folder) as results:
        assert campbell.draw(results["modes"]) == [] and live_modes.campbell(results["modes"], "campbell") is None
    assert campbell.range_of(np.array([np.inf])) == (-0.1, 0.3)


def numbers(_):
    """Six digits, whole numbers without a point, no number where there is none."""
    assert live.rounded([1234.5678, -0.00123456789, 0, np.nan, np.inf, 5e9, 3.0]) == [1234.57, -0.00123457, 0, None, None, 5000000000, 3]
    assert json.dumps(live.rounded([0.1 + 0.2, 1 / 3, 2e-17])) == "[0.3, 0.333333, 2e-17]"
    assert live.rounded([36.80512, 36.81268, 36.80871], 4) == [36.80512, 36.81268, 36.80871]  # an orbit that is small beside its distance from the centre


def licence(_):
    """The library of Debian, where it is installed, stands in the page with its licence."""
    if not any(p.is_file() for p in live.LIBRARY):
        print("libjs-chart.js is not installed")
        return
    text = live.library()
    assert "Chart.js v" in text[:5000] and "Permission is hereby granted" in text[:5000] and "</script" not in text


for check in (numbers, licence, creeping, page):
    with tempfile.TemporaryDirectory() as name:
        check(pathlib.Path(name) / "x")
print("the charts hold the results")
