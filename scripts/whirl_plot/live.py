"""Charts of the report in which values can be read: their data as JSON inside the page, the library that draws them, its licence.

A chart is a dict: `panels` with axes `x`, `y` as (name, unit); `lines` with `x`, `y`, the number `p` of their panel, the name `n` by which the
reader switches them on and off, and the number `o` of what the reader chooses of `choose`. live.js draws it."""
import functools
import html
import importlib
import json
import pathlib
import re
import sys

import numpy as np

import whirl

from .style import GREY, service_speed_in

# Debian's libjs-chart.js. The page is one file that opens without a network, so it holds the library.
LIBRARY = [pathlib.Path(folder) / "chart.min.js" for folder in ("/usr/share/javascript/chart.js", "/usr/share/nodejs/chart.js/dist")]
LICENCE = pathlib.Path("/usr/share/doc/libjs-chart.js/copyright")
HERE = pathlib.Path(__file__).parent
DIGITS = 6

# The picture that a chart stands for, by the end of its name -> function of a module that makes the chart of a study.
CHARTS = {
    "campbell": "live_modes.campbell", "shapes-3d": "live_modes.shapes", "response": "live_response.shaft", "response-bearings": "live_response.journals",
    "history": "live_motion.history", "motion": "live_motion.motion", "transfer": "live_response.transfer", "run-up": "live_response.run_up", "equilibria": "live_branches.equilibria", "cycles-vertical": "live_branches.vertical",
    "cycles-horizontal": "live_branches.horizontal", "nodes": "live_branches.nodes", "bifurcations": "live_branches.together", "orbits": "live_branches.orbits",
    "critical-speeds": "live_maps.critical", "loci": "live_maps.loci", "multipliers": "live_maps.multipliers",
}

STYLE = """
.controls{display:flex;flex-wrap:wrap;gap:.3em .5em;align-items:center;font-size:.86em;margin:.2em 0 .4em}
.controls select{font:inherit;max-width:100%;min-width:0;padding:.1em} .controls label{display:inline-flex;gap:.4em;align-items:center;max-width:100%;min-width:0}
.key{font:inherit;border:1px solid var(--line);border-radius:4px;background:#fff;padding:.1em .5em;cursor:pointer;color:var(--ink)}
.key[aria-pressed=false].toggle{color:var(--grey);text-decoration:line-through;background:#f3f6f9} .style{color:var(--grey)} .reset{border-color:var(--blue);color:var(--blue)}
.swatch{display:inline-block;min-width:1.3em;vertical-align:middle;text-align:center;line-height:0}
.panels.beside{display:grid;grid-template-columns:minmax(0,1.7fr) minmax(0,1fr);gap:.6em} .chart{position:relative;height:360px;min-width:0} .chart.square,.chart.shapes{height:400px} .chart.square{max-width:640px} .beside>.chart{height:400px}
.chart canvas{touch-action:pan-y;width:100%;height:100%} canvas:focus-visible{outline:2px solid var(--blue);outline-offset:2px} .live{border:1px solid var(--line);border-radius:4px;padding:.6em}
.said{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%)} .live,.charts-note{display:none} .has-charts .charts-note{display:block}
.has-charts .charted>.live{display:block} .has-charts .charted img{display:none}
@media (max-width:700px){.panels.beside{grid-template-columns:minmax(0,1fr)} .chart,.beside>.chart{height:300px} .chart.square{height:340px} .live{padding:.3em}}
@media print{.has-charts .charted>.live,.has-charts .charts-note{display:none} .has-charts .charted img{display:inline}}
"""
NOTE = ("Charts show the value under the cursor. Drag a frame to zoom, double-click for the whole range, press the names to switch curves on and off. "
        "With the keyboard: arrows move along the curves, + and \u2212 zoom, 0 shows the whole range. Paper shows the pictures instead.")


def rounded(values, count=DIGITS, bars=None):
    """The values as a list of numbers of `count` significant digits, None where there is none: more cannot be seen and makes a page long. A
    value with a bar has at least the digits of the bar and one more."""
    values = np.asarray(values, float)
    size = np.abs(values)
    known = np.isfinite(values)
    first = np.floor(np.log10(np.where(known & (size > 0), size, 1.0)))
    places = count - 1 - first
    # A small orbit far from the centre keeps its shape; what is smaller still is rounding.
    if (wide := np.ptp(values[known]) if known.any() else 0) > 1e-9 * np.max(size[known], initial=0):
        places = np.maximum(places, np.minimum(3 - np.floor(np.log10(wide)), 14 - first))
    if bars is not None:
        sure = np.isfinite(bars) & (np.asarray(bars) > 0)
        places = np.where(sure, np.clip(2 - np.floor(np.log10(np.where(sure, bars, 1.0))), places, 14 - first), places)
    up, down = 10.0 ** np.clip(places, 0, 300), 10.0 ** np.clip(-places, 0, 300)
    short = np.rint(np.where(known, values, 0) / down * up) / up * down
    return [(int(v) if v == int(v) and abs(v) < 1e15 else v) if k else None for v, k in zip(short.tolist(), known.tolist())]


def line(x, y, name=None, panel=0, option=None, colour=GREY, **more):
    """A curve. `bar` are the bars of y, `s` gives each point the style of the stretch behind it, `more` = [(name, unit, values, bars)] are
    values beside y, `t` texts instead; what nobody reads needs fewer `digits`."""
    count, bar = more.pop("digits", DIGITS), more.pop("bar", None)
    found = {"x": rounded(x, count), "y": rounded(y, count, bar), "c": colour}
    if bar is not None and np.any(np.isfinite(bar)):
        found["b"] = rounded(bar, 3)
    if panel:
        found["p"] = panel
    if name is not None:
        found["n"] = name
    if option is not None:
        found["o"] = option
    if more.get("more"):
        more["more"] = [(what, unit, rounded(values, 5, *bars), *(rounded(b, 3) for b in bars if b is not None)) for what, unit, values, *bars in more["more"]]
    return {**found, **{k: v for k, v in more.items() if v is not None}}


class Styles:
    """Looks of stretches of curves, each stored once: colour, dash (0 solid, 1 dashed, 2 dotted, 3 chain) and words of the value."""

    def __init__(self):
        self.known = {}

    def __call__(self, colour=None, dash=0, words=""):
        number = self.known.setdefault((colour, dash, words), len(self.known))
        return "0123456789abcdefghijklmnopqrstuvwxyz"[number]

    @property
    def table(self):
        return [{k: v for k, v in (("c", c), ("d", d), ("t", t)) if v} for c, d, t in self.known]


def service_place(study, unit):
    """[(speed, words)] of the service speed on an axis of speeds in `unit`."""
    at = service_speed_in(study, unit)
    return [] if at is None else [(round(at, 6), "service speed")]


@functools.cache
def library():
    """The text of the library with its licence, or None where it is not installed."""
    for path in LIBRARY:
        if path.is_file():
            text = path.read_text(encoding="utf-8")
            if re.match(r"/\*!\s*\* Chart\.js v[34]\.", text) and "</script" not in text:
                licence = LICENCE.read_text(encoding="utf-8").replace("*/", "* /").replace("</", "< /") if LICENCE.is_file() else ""
                return (f"/*\n{licence}*/\n" if licence else "") + text
    return None


def maker_of(study, what):
    """The function that makes the chart in place of a picture, `module.name`; None if there is none."""
    kind = "transfer" if getattr(study, "kind", "") == "frequency_response" else what if what in CHARTS else re.sub(r"-?\d+$", "", what)
    return "live_sweep.sweep" if getattr(study, "kind", "") == "sweep" else CHARTS.get(kind)


def chart_of(study, what):
    """The chart in place of a picture as HTML; empty if there is none, or the library is not installed."""
    made_by = maker_of(study, what)
    if made_by is None or library() is None:
        return ""
    module, name = made_by.split(".")
    try:
        data = getattr(importlib.import_module(f"{__package__}.{module}"), name)(study, what)
    except whirl.Error:
        raise
    except Exception as error:  # the picture is there; a chart that fails must not cost the page
        print(f"report: {getattr(study, 'name', 'run')}: the chart '{what}' cannot be made: {type(error).__name__}: {error}", file=sys.stderr)
        return ""
    if not data:
        return ""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    return f"<div class=live><script type='application/json'>{text}</script></div>"


def note(page):
    """What to do with charts, where a page has any."""
    return f"<p class='note charts-note'>{html.escape(NOTE)}</p>" if "<div class=live>" in page else ""


def scripts(page):
    """The library and the scripts at the end of a page that has charts."""
    if "<div class=live>" not in page:
        return ""
    return "".join(f"<script>{text}</script>\n" for text in (library(), *((HERE / f).read_text(encoding="utf-8") for f in ("live_base.js", "live_shapes.js", "live.js"))))
