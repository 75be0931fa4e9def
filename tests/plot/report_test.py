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


def branches(folder):
    """The answer of a study stands in the page and in its first lines word for word; a study that ended early says so behind it."""
    number = lambda value, text, bar=None: {"value": value, "text": text} | ({"uncertainty": bar} if bar else {})  # noqa: E731
    told = {"sentences": ["The equilibrium loses stability at 5025 +- 12 rpm.", "It is stable again from 6000 to 8000 rpm."], "tables": [
        {"caption": "Bifurcations", "note": "bar: film mesh", "columns": [{"name": n, "unit": u, "shown": u} for n, u in (("what", ""), ("speed", "rpm"), ("what it means", ""))],
         "rows": [["Hopf point", number(5025.0, "5025 +- 12", 12.0), "above this speed whirl grows from nothing"]]}]}

    def said(status):
        def fill(root):
            root["studies/balanced"].attrs["status"] = status
        with results_with(folder, lambda s, _: s["balanced"].update({"brief": told, "status": status}), fill) as results:
            return brief.of(results["balanced"]), table_of(results["balanced"], "Bifurcations"), results["balanced"].answer.tables[0]

    words, table, data = said("completed")
    assert words == "The equilibrium loses stability at 5025 \u00b1 12 rpm. It is stable again from 6000 to 8000 rpm.", words
    assert table.head == ["what", "speed [rpm]", "what it means"] and table.note == "bar: film mesh", table
    assert table.rows == [["Hopf point", "5025 \u00b1 12", "above this speed whirl grows from nothing"]], table.rows
    assert data.column("speed").tolist() == [5025.0] and data.rows[0][1].uncertainty == 12.0
    assert said("ended at 6000 rpm: reached the largest number of points")[0].endswith("8000 rpm. Ended at 6000 rpm: reached the largest number of points.")


def answers(folder):
    """Sentences and tables of a brief stand in the page as summary.json has them, bad verdicts in red."""
    def told(studies, _):
        studies["modes"]["brief"] = {"sentences": ["critical speed with an amplification above 2.5: 689.4 +- 1.5 rpm"], "tables": [
            {"caption": "Critical speeds", "note": "margin to the operating speed 3600 rpm",
             "columns": [{"name": n, "unit": u, "shown": u if u != "1" else "", "factor": 1} for n, u in (("no.", ""), ("speed", "rpm"), ("AF", "1"), ("verdict", ""))],
             "rows": [["1", {"value": 689.4, "unit": "rpm", "uncertainty": 1.5, "text": "689.4 +- 1.5"}, {"value": 15.7, "unit": "1", "text": "15.7"}, "TOO NEAR"],
                      ["2", {"value": 5100.0, "unit": "rpm", "text": "5100"}, None, "UNSTABLE"]]}]}
    with results_with(folder, told) as results:
        study = results["modes"]
        table, page = table_of(study, "Critical speeds"), report.page_of(results)
        assert table.head == ["no.", "speed [rpm]", "AF", "verdict"] and table.note.endswith("3600 rpm"), table
        assert table.rows == [["1", "689.4 \u00b1 1.5", "15.7", "TOO NEAR"], ["2", "5100", "\u2013", "UNSTABLE"]], table.rows
        assert "above 2.5: 689.4 \u00b1 1.5 rpm" in brief.of(study) and study.answer.tables[0].column("speed")[0] == 689.4
        assert all(f"<span class=bad>{mark}</span>" in page for mark in ("TOO NEAR", "UNSTABLE")), page
        assert brief.of(results["generator pair"]) == "", "results without a brief say nothing"


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
    """All values of the variants with bars, and their trends; bad verdicts in red."""
    def change(studies, _):
        s = studies["clearances"]
        s["columns"] += [{"name": "balanced.threshold", "unit": "rad/s", "values": [5025.0 * RPM, 4000.0 * RPM, 6500.0 * RPM], "uncertainties": [12 * RPM, None, 9 * RPM]},
                         {"name": "balanced.hopf.2", "unit": "rpm", "values": [None, 7000.0, None], "uncertainties": [None, 3.0, None]},
                         {"name": "balanced.nondimensional.load", "unit": "1", "values": [1.0, 1.0, 1.0], "uncertainties": [None] * 3}]
        s["trends"][0].update({"quantity": "bearings.*.geometry.clearance", "unit": "um", "at": [160.0, 200.0, 240.0]})
        s["trends"].append({**s["trends"][0], "column": "balanced.threshold"})

    with results_with(folder, change) as results:
        study = results["clearances"]
        values, trends = (t for t in report.sweep_tables.everything(study, tables.Table))
        everything = "".join(report.all_values(study))
    assert values.head == ["value", "as given", "narrow", "wide"], values.head
    assert ["balanced: threshold [rpm]", "5025 \u00b1 12", "4000", "6500.0 \u00b1 9.0"] in values.rows, values.rows
    assert ["balanced: threshold", "clearance", "160 to 240 \u00b5m", "rises", "2500 rpm"] in trends.rows, trends.rows
    assert "All values of the variants (6)" in everything and "balanced: nondimensional load" in everything
    red = [report.marked(c, True).startswith("<span") for c in ("loses stability", "stable 300 to 1470, unstable to 3000 rpm", "a: stable; r: unstable", "UNSTABLE",
                                                                 "stable throughout", "undetermined", "-")]
    assert red == [True] * 4 + [False] * 3 and everything.count("<span class=bad>loses stability</span>") == 2, (red, everything)
    assert report.show(values).count("class=bad") == 2 and "class=bad" not in report.marked("where it loses stability"), report.show(values)


def bearing_map(folder):
    def change(studies, summary):
        summary["studies"] += [
            {"name": "hard", "kind": "bearing_map", "status": "completed", "values": {}, "brief": {
                "sentences": ["the rotor is stable up to 437.642 rad/s"],
                "tables": [{"caption": "Locus", "note": "S: load", "columns": [{"name": "S", "unit": "1", "shown": "", "factor": 1}, {"name": "x", "unit": "m", "shown": "um", "factor": 1e6}],
                            "rows": [["large", {"value": -5e-5, "unit": "m", "uncertainty": 1e-7, "text": "-50.00 +- 0.10"}], [None, "none"]]}]}}]

    with results_with(folder, change) as results:
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
    """Warnings of a study stand in the summary of the page, in its section, and below the first of its pictures."""
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
            first = len(written)
            style.save(style.plt.figure(), study, "response2")
        finally:
            style.write = kept
    sentence = sentence.replace("um", "\u00b5m")
    assert text.count(sentence) == 2 and "second &lt;b&gt;" in text, text.count(sentence)
    assert lines == [f"Warning: {sentence}", "Warning: second <b>"], lines
    assert any(sentence in t.replace("\n", " ") for t in written[:first]), written
    assert not any(sentence[:20] in t for t in written[first:]) and any("2 warnings: see the first picture" in t for t in written[first:]), written
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
        assert evil not in text, some
        return len(some)

    leaves = [p for p, leaf in places(json.loads(whole)) if leaf]
    # A study of another name has no entry.
    names = [p for p in leaves if p[0] == "studies" and p[2:] == ("name",)]
    assert shown([p for p in leaves if p not in names]) > 40 and shown(names) == len(names), leaves


def page(folder):
    """The whole page holds the sweep's table and one line of each of its kinds."""
    told = {"sentences": ["The equilibrium loses stability at 5025 +- 12 rpm."], "tables": []}
    with results_with(folder, lambda s, _: s["balanced"].update({"stability": "loses stability", "brief": told})) as results:
        text = report.page_of(results)
    for words in ("All values of the variants", "<summary>Trends", "5025 \u00b1 12",
                  "loses stability at 5025"):
        assert words in text, words
    # A picture of the run is none of a study of that name.
    with results_with(folder, lambda *_: None, lambda root: root["studies/clearances"].attrs.update({"title": "run-up"})) as results:
        for name in ("run-up", "run-up.trends"):
            (folder / f"{name}.png").touch()
        (folder / "manifest.txt").write_text("run-up.png\nrun-up.trends.png\n")
        found, whole = report.pictures_of(results)
    assert [p.stem for p in whole] == ["run-up"] and [p.stem for study, own in found for p in own] == ["run-up.trends"], (found, whole)


for check in (branches, answers, service, sweep, bearing_map, options, warnings, foreign, page):
    with tempfile.TemporaryDirectory() as name:
        check(pathlib.Path(name) / "x")
print("the report says what the results say")
