#!/usr/bin/env python3
"""The report in headless Chromium at 1400 and 390 pixels: nothing from the network, no errors, nothing wider than the screen; values under the
cursor are those of the results; zoom, names, keyboard, orbits beside branches, shapes that move; pictures on paper and without JavaScript."""
import pathlib
import sys
import tempfile

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import browser  # noqa: E402
import command  # noqa: E402
import synthetic  # noqa: E402
from whirl_plot import live  # noqa: E402

SKIPPED = 77
# A chart by the picture that it stands for; its figure brought into sight and made.
FIND = """(name => { const place = [...document.querySelectorAll('.live')].find(l => l.parentElement.querySelector('img').alt === name);
                     place.scrollIntoView({block: 'center'}); return place; })"""


def figure(page, name):
    page.ask(f"window.place = {FIND}('{name}'), 0")
    page.until("!!window.place.whirl")
    page.ask("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def point(page, chart, name, index):
    """Where on the screen a computed point of a curve is, and what it is."""
    page.ask(f"place.whirl.charts[{chart}].canvas.scrollIntoView({{block: 'center'}})")
    return page.ask(f"""(() => {{ const c = place.whirl.charts[{chart}], k = c.data.datasets.findIndex(d => d.line.n === '{name}' && !d.line.quiet),
        p = c.getDatasetMeta(k).data[{index}], r = c.canvas.getBoundingClientRect(), l = c.data.datasets[k].line;
        return [r.left + p.x, r.top + p.y, l.x[{index}], l.y[{index}]]; }})()""")


def said(page, chart):
    return page.until(f"(t => t.opacity > 0 && [...t.title, ...t.body.flatMap(b => b.lines)].join(' '))(place.whirl.charts[{chart}].tooltip)")


def limits(page, chart=0):
    return page.ask(f"['x', 'y'].flatMap(k => [place.whirl.charts[{chart}].scales[k].min, place.whirl.charts[{chart}].scales[k].max])")


def campbell(page, results):
    figure(page, "modes.campbell")
    x, y, *_ = point(page, 0, "mode 3", 25)
    page.mouse("mouseMoved", x + 1, y - 1)
    words = said(page, 0)
    rows = np.nonzero(results["spectrum/mode"][()] == 3)[0][25]
    speed, frequency, decrement = (results[f"spectrum/{k}"][rows] for k in ("speed", "frequency", "log_decrement"))
    for value in (f"{speed * 30 / np.pi:.5g}", f"{frequency / (2 * np.pi):.3f} \u00b1 0.012 Hz", f"{decrement:.5f} \u00b1 0.00020"):
        assert value in words, (words, value)
    assert "mode 3" in words and "forward" in words, words
    # Zoom by a frame, which the damping below shares; the whole range again; the same by keys.
    before = limits(page)
    page.drag((x - 40, y - 40), (x + 60, y + 30))
    zoomed = limits(page)
    assert zoomed[1] - zoomed[0] < 0.45 * (before[1] - before[0]) and zoomed[3] - zoomed[2] < 0.4 * (before[3] - before[2]), (before, zoomed)
    assert np.allclose(limits(page, 1)[:2], zoomed[:2]), "the damping is not zoomed"
    for count in (1, 2):
        page.mouse("mousePressed", x, y, 1, count)
        page.mouse("mouseReleased", x, y, 0, count)
    assert limits(page) == before, "the whole range"
    page.ask("place.querySelector('canvas').focus()")
    page.key("ArrowRight")
    first = page.ask("place.querySelector('output').textContent")
    page.key("ArrowRight")
    assert first and page.ask("place.querySelector('output').textContent") not in ("", first), first
    page.key("+", "+")
    assert limits(page)[1] - limits(page)[0] < 0.6 * (before[1] - before[0]) and not page.ask("place.querySelector('.reset').hidden")
    page.ask("place.querySelector('.reset').click()")
    assert limits(page) == before
    # A name switches its curve off in both panels.
    for shown in (False, True):
        page.ask("[...place.querySelectorAll('.toggle')].find(b => b.dataset.name === 'mode 3').click()")
        assert page.ask("place.whirl.charts.map(c => c.data.datasets.some(d => d.line.n === 'mode 3'))") == [shown, shown]


def response(page, results):
    figure(page, "generator_pair.response")
    x, y, *_ = point(page, 0, "y, vertical", 100)
    page.mouse("mouseMoved", x, y + 1)
    words = said(page, 0)
    major = results["response/semi_major"][100, 0] * 1e6
    assert all(w in words for w in ("semi-major axis", f"{major:.5g} \u00b5m", "y, vertical", "x, horizontal", "lag")), words
    page.ask("(s => { s.value = 1; s.onchange(); })(place.querySelector('select'))")
    assert abs(point(page, 0, "semi-major axis", 100)[3] - results["response/semi_major"][100, 1] * 1e6) < 1e-4, "the other node"


def branch(page, results):
    """The orbit beside a branch is the one that was kept next to the point under the cursor."""
    figure(page, "pair_G6.3.cycles-vertical")
    seen = set()
    for index in (20, 130):
        x, y, *_ = point(page, 0, "pair, G6.3", index)
        page.mouse("mouseMoved", x, y)
        assert "pair, G6.3" in said(page, 0)
        kept = results["orbits/point"][()]
        nearest = results["orbits/parameter"][np.argmin(np.abs(kept - index))]
        title = page.until(f"(t => t.includes('{nearest:.5g}') && t)(String(place.whirl.charts[1].options.plugins.title.text))")
        seen.add(title)
    assert len(seen) == 2, seen
    scale = page.ask("(c => ['x', 'y'].map((k, i) => (c.scales[k].max - c.scales[k].min) / [c.chartArea.width, c.chartArea.height][i]))(place.whirl.charts[1])")
    assert abs(scale[0] / scale[1] - 1) < 0.02, f"an orbit that is no orbit: {scale}"
    mark = page.ask("""(() => { const c = place.whirl.charts[0], k = c.data.datasets.findIndex(d => d.line.n === 'Neimark-Sacker'), p = c.getDatasetMeta(k).data[0],
                          r = c.canvas.getBoundingClientRect(); return [r.left + p.x, r.top + p.y]; })()""")
    page.mouse("mouseMoved", *mark)
    page.until("place.whirl.charts[0].tooltip.body.flatMap(b => b.lines).join(' ').includes('Neimark-Sacker: speed 5057')")


def shapes(page, still):
    figure(page, "modes.shapes-3d")
    if still:
        assert not page.ask("place.whirl.playing"), "it moves though less motion was asked for"
        return
    start = page.ask("place.whirl.angle")
    page.until(f"place.whirl.angle !== {start}")
    page.ask("place.whirl.button.click()")
    rest = page.ask("place.whirl.angle")
    page.ask("new Promise(done => setTimeout(done, 200))")
    assert page.ask("place.whirl.angle") == rest, "it moves after `pause`"
    drawn = "place.whirl.canvas.toDataURL()"
    one = page.ask(drawn)
    page.ask("(s => { s.value = 2; s.onchange(); })(place.querySelector('select'))")
    assert page.ask(drawn) != one and "3: " in page.ask("place.whirl.words.textContent")


def everything(page, width):
    """All charts are made without an error, and nothing is wider than the screen."""
    page.call("Emulation.setDeviceMetricsOverride", width=width, height=page.ask("document.documentElement.scrollHeight"), deviceScaleFactor=1, mobile=False)
    page.until("[...document.querySelectorAll('.live')].every(l => l.whirl)")
    assert page.ask("document.documentElement.scrollWidth") == width, f"the page is wider than {width}"
    wide = page.ask("""[...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > innerWidth + 1 && !e.closest('.scroll, pre, option'))
                         .map(e => e.tagName + ' ' + e.textContent.slice(0, 30))""")
    assert not wide, wide
    images = "[...document.querySelectorAll('img')].filter(i => i.offsetWidth).length"
    count = page.ask("[document.querySelectorAll('.live').length, document.querySelectorAll('img').length]")
    assert page.ask(images) == count[1] - count[0], "a chart beside its picture"
    page.call("Emulation.setEmulatedMedia", media="print")
    assert page.ask(images) == count[1] and not page.ask("[...document.querySelectorAll('.live')].some(l => l.offsetWidth)"), "charts on paper"
    page.call("Emulation.setEmulatedMedia", media="")
    return count


if not browser.program() or live.library() is None:
    print("chromium or libjs-chart.js is not installed")
    sys.exit(SKIPPED)
with tempfile.TemporaryDirectory() as name, browser.Browser() as page:
    folder = pathlib.Path(name) / "x"
    synthetic.make(folder)
    with h5py.File(folder / "results.h5", "a") as root:
        for pair in ("pair, G2.5", "pair, G6.3"):
            root[f"studies/{pair}/orbits"]["point"] = np.linspace(0, 139, 20).astype(int)
        spectrum = root["studies/modes/spectrum"]
        synthetic.put(spectrum, frequency_uncertainty=np.full(len(spectrum["speed"]), 0.012 * 2 * np.pi), log_decrement_uncertainty=np.full(len(spectrum["speed"]), 2e-4))
    done = command.call("report", folder)
    assert done.returncode == 0 and not done.stderr, done.stderr
    report = folder / "report.html"
    with h5py.File(folder / "results.h5") as root:
        for width in (1400, 390):
            page.open(report, width)
            assert [r for r in page.requests if not r.startswith(("data:", report.as_uri()))] == [], page.requests
            campbell(page, root["studies/modes"])
            response(page, root["studies/generator pair"])
            branch(page, root["studies/pair, G6.3"])
            shapes(page, False)
            charts, images = everything(page, width)
            assert charts == 18, charts
            assert not page.errors, page.errors
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    page.open(report, 1400)
    shapes(page, True)
    page.call("Emulation.setScriptExecutionDisabled", value=True)
    page.open(report, 1400)
    page.call("Emulation.setScriptExecutionDisabled", value=False)
    assert page.ask("[...document.querySelectorAll('img')].filter(i => i.offsetWidth).length") == images, "no pictures without JavaScript"
print("the report works in Chromium")
