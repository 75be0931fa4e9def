#!/usr/bin/env python3
"""What the report says of results that are known: verdicts and margins of summary.json, sweeps with bars and trends, options."""
import json
import pathlib
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(pathlib.Path(__file__).parent), str(ROOT / "scripts")]
import synthetic  # noqa: E402
import whirl  # noqa: E402
from whirl_plot import brief, report, style, tables  # noqa: E402
from whirl_plot.subject import Drawn  # noqa: E402

RPM = np.pi / 30


def results_with(folder, change, fill=lambda root: None):
    """Results of synthetic.py; `change` gets the studies of summary.json by name and the summary."""
    synthetic.make(folder)
    with h5py.File(folder / "results.h5", "a") as root:
        fill(root)
    path = folder / "summary.json"
    summary = json.loads(path.read_text())
    change({s["name"]: s for s in summary["studies"]}, summary)
    path.write_text(json.dumps(summary))
    return Drawn(folder)


def table_of(study, caption):
    return next(t for t in tables.findings(study) if t.caption == caption)


def verdicts(folder):
    """Stability is what summary.json says; a branch that ended early is so as far as it was followed."""
    def said(stability, status="completed"):
        def fill(root):
            root["studies/balanced"].attrs["status"] = status
        with results_with(folder, lambda s, _: s["balanced"].update({"stability": stability, "status": status}), fill) as results:
            return brief.of(results["balanced"]), table_of(results["balanced"], "Along the branch").rows

    words, rows = said("undamped throughout")
    assert words == "undamped throughout" and rows[0][1] == "undamped", (words, rows)
    assert said("loses stability")[0] == "loses stability at the Hopf point at 5025 \u00b1 12 rpm"
    words, _ = said("stable throughout", "ended at 6000 rpm: reached the largest number of points")
    assert words == "stable as far as followed; ends: reached the largest number of points", words

    def behind(studies, _):
        studies["balanced"]["stability"] = "loses stability"
        one = studies["balanced"]["bifurcations"][0]
        studies["balanced"]["bifurcations"] = [{**one, "value": 4000.0, "others_unstable": 2.0}, {**one, "others_unstable": 0.0}]
    with results_with(folder, behind) as results:
        assert "5025" in brief.of(results["balanced"]), "a Hopf point of a branch that is unstable already is no threshold"


def sentences(folder):
    """What a bifurcation means and where a branch is stable is what summary.json says, word for word."""
    def change(studies, _):
        studies["balanced"].update({"stability": "loses stability", "ranges": [
            {"from": 500, "to": 5025, "unit": "rpm", "stability": "stable"}, {"from": 5025, "to": 6000, "unit": "rpm", "stability": "unstable"},
            {"from": 6000, "to": 8000, "unit": "rpm", "stability": "stable"}]})
        studies["balanced"]["bifurcations"][0].update({"sentence": "above this speed whirl grows from nothing", "others_unstable": 0})
    with results_with(folder, change) as results:
        study = results["balanced"]
        assert table_of(study, "Bifurcations").rows[0][-1].startswith("above this speed whirl grows from nothing")
        assert [r[1] for r in table_of(study, "Along the branch").rows] == ["stable", "unstable", "stable"]
        assert "stable again from 6000 to 8000 rpm" in brief.of(study), brief.of(study)


def modes(folder):
    """A computed speed is no threshold; margins are those of summary.json."""
    with results_with(folder, lambda *_: None) as results:
        words = brief.of(results["modes"])
        speed, decrement = (results["modes"].get(f"spectrum/{k}") for k in ("speed", "log_decrement"))
        high = speed[decrement < 0].min() / RPM
        low = max(s for s in np.unique(speed) / RPM if s < high - 1e-6)
        assert f"becomes unstable between {low:.5g} and {high:.5g} rpm" in words, words
        assert len(table_of(results["modes"], "Critical speeds: damped frequency equal to the speed").head) == 6

    def undamped(root):
        root["studies/modes/spectrum/log_decrement"][...] = 0
    with results_with(folder, lambda *_: None, undamped) as results:
        assert brief.of(results["modes"]) == "undamped"

    def told(studies, _):
        studies["modes"]["values"] = {
            "critical.1.speed": {"value": 689.4, "unit": "rpm", "uncertainty": 1.5}, "critical.1.log_decrement": {"value": 0.2, "unit": "1"},
            "critical.1.separation_margin": {"value": 0.12, "unit": "1"}, "critical.1.required_margin": {"value": 0.16, "unit": "1"},
            "operating_speed": {"value": 3600, "unit": "rpm"}, "threshold": {"value": 5022.2, "unit": "rpm", "uncertainty": 3.1}}

    def verdicts(root):
        root["studies/modes/critical"].create_dataset("verdict", data=["too near", "far enough", "damped, not critical", "", "far enough"])
        root["studies/modes/critical"].create_dataset("whirl", data=["backward", "forward", "mixed", "forward", "planar"])
    with results_with(folder, told, verdicts) as results:
        critical = table_of(results["modes"], "Critical speeds: damped frequency equal to the speed")
        assert critical.rows[0][:4] == [1, "689.4 \u00b1 1.5", 1, "backward"] and critical.rows[0][-3:] == ["12", "16", "no"], critical.rows[0]
        assert [r[2] for r in table_of(results["modes"], "Damped, not critical: amplification factor below 2.5 (API 684)").rows] == [3]
        assert "unstable from 5022.2 \u00b1 3.1 rpm" in brief.of(results["modes"])


def responses(folder):
    """The peaks are those of the list in summary.json, in its order; those about unstable equilibria are named only where there is no other."""
    with results_with(folder, lambda *_: None) as results:
        study = results["generator pair"]
        table = table_of(study, "Peaks of the response, the four largest of each probe")
        assert table.head == ["probe", "peak at [rpm]", "amplitude [\u00b5m]", "amplification N/(N2 \u2212 N1)", "margin [%]", "required [%]", "enough", "equilibrium", ""], table.head
        assert table.rows == [
            ["node 120", "2683.00 \u00b1 0.10", "75.00 \u00b1 0.20", "12.40 \u00b1 0.20", "25.5", "16", "yes", "stable", ""],
            ["", "5120.00 \u00b1 0.10", "91.00 \u00b1 0.20", "\u2013", "42", "16", "\u2013", "unstable", "no amplification factor: the range ends"],
            ["B3, journal", "2690.00 \u00b1 0.10", "30.00 \u00b1 0.20", "11.90 \u00b1 0.20", "25", "16", "yes", "stable", ""]], table.rows
        assert "operating speed 3600 rpm" in table.note, table.note
        assert brief.of(study) == "largest peak 75 \u00b5m at node 120, 2683 rpm, amplification 12.4", brief.of(study)

    def unstable(studies, _):
        studies["generator pair"]["stability"] = "unstable throughout"
        for p in studies["generator pair"]["peaks"]:
            p["stability"] = "unstable"
    with results_with(folder, unstable) as results:
        assert brief.of(results["generator pair"]) == "unstable throughout; 2 peaks, none of which is a motion of the machine"


def service(folder):
    """The page opens with what summary.json knows of the service speed."""
    def change(_, summary):
        summary["warnings"] = ["lubricants.oil: a viscosity of 12000 mPa s is unusual"]
        summary["service_speed"] = {"value": 3600, "unit": "rpm", "facts": [
            {"what": "stability", "mark": "stable", "study": "balanced, modes"},
            {"what": "margin in speed to the threshold of stability", "value": 39.2, "unit": "%", "uncertainty": 0.3, "study": "balanced"},
            {"what": "highest film temperature", "place": "B3", "value": 341.15, "unit": "K", "study": "at service speed"},
            {"what": "largest vibration", "mark": "not known: no `unbalance_response` gives one at this speed", "study": None}]}
    with results_with(folder, change) as results:
        text = report.page_of(results)
    for words in ("At the service speed, 3600 rpm", "39.20 \u00b1 0.30 %", "68 \u00b0C", "balanced, modes", "not known: no `unbalance_response`", "12000 mPa s is unusual"):
        assert words in text, words
    assert text.index("At the service speed") < text.index("12000 mPa s is unusual")
    assert text.index("At the service speed") < text.index("In brief") < text.index("The machine</h2>")


def sweep(folder):
    """Variants and trends with bars; a variant that failed says why."""
    def change(studies, _):
        s = studies["clearances"]
        s["variants"][1]["studies"] = [{"name": "balanced", "status": "ended at 7000 rpm: contact"}]
        s["columns"] += [{"name": "balanced.threshold", "unit": "rad/s", "values": [5025.0 * RPM, 4000.0 * RPM, 6500.0 * RPM], "uncertainties": [12 * RPM, None, 9 * RPM]},
                         {"name": "balanced.hopf.2", "unit": "rpm", "values": [None, 7000.0, None], "uncertainties": [None, 3.0, None]},
                         {"name": "balanced.nondimensional.load", "unit": "1", "values": [1.0, 1.0, 1.0], "uncertainties": [None] * 3}]
        s["trends"][0].update({"quantity": "bearings.*.geometry.clearance", "unit": "um", "at": [160.0, 200.0, 240.0]})
        s["trends"].append({**s["trends"][0], "column": "balanced.threshold"})

    with results_with(folder, change) as results:
        study = results["clearances"]
        table, trends = table_of(study, "Variants"), table_of(study, "Trends")
        everything = "".join(report.all_values(study))
        words = brief.of(study)
    assert table.head == ["variant", "verdict", "clearance [\u00b5m]", "balanced: threshold [rpm]", "balanced: hopf 2 [rpm]", "not completed"], table.head
    assert table.rows == [["as given", "loses stability", "200", "5025 \u00b1 12", "\u2013", ""], ["narrow", "loses stability", "160", "4000", "7000.0 \u00b1 3.0", ""],
                          ["wide", "-", "240", "6500.0 \u00b1 9.0", "\u2013", "balanced: ended at 7000 rpm: contact"]], table.rows
    assert trends.rows == [["balanced: threshold", "clearance", "160 to 240 \u00b5m", "rises", "2500 rpm"]], trends.rows
    assert "All values of the variants (6)" in everything and "balanced: nondimensional load" in everything
    red = [report.marked(c, True).startswith("<span") for c in ("loses stability", "stable 300 to 1470, unstable to 3000 rpm", "a: stable; r: unstable",
                                                                 "stable throughout", "undetermined", "-")]
    assert red == [True] * 3 + [False] * 3 and everything.count("<span class=bad>loses stability</span>") == 2, (red, everything)
    assert report.show(table).count("class=bad") == 2 and "class=bad" not in report.marked("where it loses stability"), report.show(table)
    assert words == "2 variants over clearance; unstable, at least in part: as given, narrow; balanced: threshold rises from 4000 to 6500.0 \u00b1 9.0 rpm; 1 with a study that did not complete", words


def others_in_brief(folder):
    def change(studies, summary):
        summary["studies"] += [
            {"name": "up", "kind": "run_up", "status": "completed", "values": {"bearing.left.peak.amplitude": {"value": 2.3178e-5, "unit": "m"},
                                                                              "bearing.left.peak.speed": {"value": 639.35, "unit": "rad/s"}}},
            {"name": "flips", "kind": "locus", "status": "completed", "values": {}, "codimension_two": [
                {"type": "resonance_1_2", "value": 1384.59138, "value_uncertainty": 0.42, "second_value": 6.8193, "second_value_uncertainty": 0.015}]},
            {"name": "hard", "kind": "bearing_map", "status": "completed", "values": {}, "brief": {
                "sentences": ["the rotor is stable up to 437.642 rad/s"],
                "tables": [{"caption": "Locus", "note": "S: load", "columns": [{"name": "S", "unit": "1", "shown": "", "factor": 1}, {"name": "x", "unit": "m", "shown": "um", "factor": 1e6}],
                            "rows": [["large", {"value": -5e-5, "unit": "m", "uncertainty": 1e-7, "text": "-50.00 +- 0.10"}], [None, "none"]]}]}}]

    def fill(root):
        synthetic.study(root, "up", "run_up", speed_unit="rad/s")
        group = synthetic.study(root, "flips", "locus", bifurcation="flip", parameter="speed", parameter_unit="rad/s",
                                second="unbalance.a.planes.1.eccentricity", second_unit="um").create_group("locus")
        synthetic.put(group, parameter=[389.2, 1648.0], second=[0.884, 7.25])
    with results_with(folder, change, fill) as results:
        assert brief.of(results["up"]) == "largest vibration 23.2 \u00b5m at left, 639.4 rad/s"
        assert brief.of(results["flips"]) == "curve of a flip: speed 389.2 to 1648 rad/s, eccentricity 0.884 to 7.25 \u00b5m; on it: 1:2 resonance"
        assert [r[1:] for r in table_of(results["flips"], "Points of codimension two").rows] == [["1384.59 \u00b1 0.42", "6.819 \u00b1 0.015"]]
        assert brief.of(results["hard"]) == "the rotor is stable up to 437.642 rad/s"
        table = table_of(results["hard"], "Locus")
        assert table.head == ["S", "x [\u00b5m]"] and table.rows == [["large", "\u221250.00 \u00b1 0.10"], ["\u2013", "none"]] and table.note == "S: load", table
        column = results["hard"].answer.tables[0].column("x")
        assert column[0] == -5e-5 and column[1] != column[1], column


def options(folder):
    """Options of PETSc as a table, lists of the deck without brackets: nothing of the language that the report is written in."""
    def change(_, summary):
        summary["options"] = [{"name": "-newton_snes_rtol", "value": "1e-3", "source": "PETSC_OPTIONS"}]

    with results_with(folder, change) as results:
        (folder / "resolved.yaml").write_text("studies:\n  - cycle_branch: {name: c, detect: [flip, hopf], range: {from: 1 rpm, to: 2 rpm}, nodes: [], x: true}\n")
        page = report.options_in_force(results)
    for words in ("-newton_snes_rtol", "1e-3", "PETSC_OPTIONS", "flip, hopf", "from 1 rpm, to 2 rpm", ">yes<"):
        assert words in page, words
    assert "{" not in page and "[" not in page and "&#x27;" not in page, page


def warnings(folder):
    """Warnings of a study stand in the summary of the page, in its section, and below each of its pictures."""
    sentence = "the linear motion leaves bearing B3 -4 um of film: no answer between 2120 and 2260 rpm"
    with results_with(folder, lambda s, _: s["generator pair"].update({"warnings": [sentence, "second <b>"]})) as results:
        text = report.page_of(results)
        study = results["generator pair"]
        lines = style.warning_lines(study.warnings, 200)
        assert results["balanced"].warnings == [] and style.warning_lines([], 80) == []
        written = []
        figure = style.plt.figure()
        style.write, kept = (lambda figure, stem: written.extend(t.get_text() for t in figure.texts) or []), style.write
        try:
            style.save(figure, study, "response")
        finally:
            style.write = kept
    assert text.count(sentence) == 2 and "second &lt;b&gt;" in text, text.count(sentence)
    assert lines == [f"Warning: {sentence}", "Warning: second <b>"], lines
    assert any(sentence in t.replace("\n", " ") for t in written), written
    assert style.warning_lines(["a"] * 5, 80)[-1] == "and 2 more warnings in the report"


def foreign(folder):
    """Markup in any field of a summary that another program wrote comes out as text, or the results are refused."""
    evil = "<script>alert(1)</script>"

    def places(node, path=()):
        """Paths of all fields, and whether each is a leaf: keys of objects, objects of lists, and the first of other items of these."""
        items = node.items() if isinstance(node, dict) else [(k, v) for k, v in enumerate(node) if k == 0 or isinstance(v, dict)] if isinstance(node, list) else []
        for key, value in items:
            yield (*path, key), not isinstance(value, (dict, list))
            yield from places(value, (*path, key))

    with results_with(folder, lambda s, _: s["balanced"].update({"warnings": ["one"], "stability": "loses stability"})):
        pass
    path = folder / "summary.json"
    whole = path.read_text()

    def shown(some):
        """How many of the places, filled all at once, a page shows; where it refuses them, those of both halves by themselves."""
        summary = json.loads(whole)
        for *most, last in some:
            node = summary
            for key in most:
                node = node[key]
            node[last] = evil
        path.write_text(json.dumps(summary))
        try:
            with Drawn(folder) as results:
                text = report.page_of(results)
        except (whirl.Error, AttributeError, IndexError, KeyError, TypeError, ValueError):  # a sentence and exit code 2
            return 0 if len(some) == 1 else shown(some[:len(some) // 2]) + shown(some[len(some) // 2:])
        assert "<script" not in text, some
        return len(some)

    leaves = [p for p, leaf in places(json.loads(whole)) if leaf]
    # A study of another name has no entry.
    names = [p for p in leaves if p[0] == "studies" and p[2:] == ("name",)]
    assert shown([p for p in leaves if p not in names]) > 40 and shown(names) == len(names), leaves


def page(folder):
    """The whole page holds the sweep's table and one line of each of its kinds."""
    with results_with(folder, lambda s, _: s["balanced"].update({"stability": "loses stability"})) as results:
        text = report.page_of(results)
    for words in ("<caption>Variants</caption>", "<caption>Trends</caption>", "5025 \u00b1 12", "2 variants over clearance",
                  "loses stability at the Hopf point"):
        assert words in text, words


for check in (verdicts, sentences, modes, responses, service, sweep, others_in_brief, options, warnings, foreign, page):
    with tempfile.TemporaryDirectory() as name:
        check(pathlib.Path(name) / "x")
print("the report says what the results say")
