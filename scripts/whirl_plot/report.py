"""One self-contained HTML page of a results folder: the machine, what was asked, the pictures, and all numbers."""
import base64
import hashlib
import html
import math
import re
import sys
import time

from whirl.answer import in_print

from . import __main__ as plot
from . import brief, live, style, sweep_tables, tables
from .campbell import EITHER
from .manifest import register
from .subject import Drawn, results_directory, said_in_a_sentence
from .units import digits, reading, with_bar

STYLE = """
:root{--ink:#222;--grey:#6b7280;--line:#e3e7ec;--blue:#0b62a4;--bad:#c8102e}
body{font:15px/1.5 system-ui,'DejaVu Sans',sans-serif;color:var(--ink);max-width:1180px;margin:0 auto;padding:1.5em}
h1{font-size:1.75em;margin:.2em 0 0} h2{font-size:1.35em;margin:2.2em 0 .3em;border-bottom:2px solid var(--line);padding-bottom:.2em}
h3{font-size:1.05em;margin:1.4em 0 .2em} .note{color:var(--grey);font-size:.88em;margin:.2em 0 1em;max-width:75em}
nav{margin:1em 0;padding:.6em .9em;background:#f3f6f9;border-radius:6px} nav a{display:inline-block;margin-right:1.1em} a{color:var(--blue)}
table{border-collapse:collapse;margin:.4em 0 .2em;font-size:.9em} caption{text-align:left;font-weight:600;padding:.4em 0;font-size:1.05em} caption span{display:inline-block;white-space:nowrap}
td.short{white-space:nowrap} td.long{min-width:14em}
th,td{padding:.25em 1.1em .25em 0;text-align:left;border-bottom:1px solid var(--line);vertical-align:top} th{color:var(--grey);font-weight:600}
td.name{white-space:nowrap} td.n,th.n{text-align:right;font-variant-numeric:tabular-nums} td.n{white-space:nowrap} figure{margin:1.2em 0} figcaption{color:var(--grey);font-size:.88em}
img{max-width:100%;border:1px solid var(--line);border-radius:4px} details{margin:.7em 0} summary{cursor:pointer;color:var(--blue)}
body{counter-reset:figures tables} figcaption::before{counter-increment:figures;content:"Figure " counter(figures) ". ";font-weight:600}
caption span::before{counter-increment:tables;content:"Table " counter(tables) ". "}
@media print{nav{display:none} body{max-width:none;padding:0;font-size:10pt} figure,table,tr{break-inside:avoid} h2{break-after:avoid} .scroll{overflow:visible}}
@media screen and (max-width:700px){body{padding:.8em;overflow-wrap:break-word} caption span{white-space:normal;max-width:calc(100vw - 2.5em)} img{min-width:600px} td.name{white-space:normal} td.long{min-width:9em} th,td{padding-right:.8em}}
.bad{color:var(--bad);font-weight:600} .warn{color:var(--bad);margin:.2em 0;padding-left:1.2em} .scroll{overflow-x:auto} pre{background:#f3f6f9;padding:.8em;overflow-x:auto;font-size:.85em}
"""

# What a picture shows, by the end of its name.
CAPTIONS = {
    "machine": "The machine.", "sag": "Line of the shaft along the bearings and couplings.", "journals": "Where the journals sit in their clearances.",
    "campbell": "Natural frequencies over speed, and their damping.", "shapes": "Mode shapes along the shaft.",
    "shapes-3d": "Mode shapes in space: orbits of the nodes, and the shaft at one moment.", "response": "Response to unbalance of the shaft (Bode).",
    "response-bearings": "Response to unbalance of the journals in their bearings (Bode).", "equilibria": "Where the journals rest, and the least stable eigenvalue.",
    "locus": "Path of the journals' rest positions in their clearances.", "cycles-vertical": "Largest and smallest vertical position over a cycle.",
    "cycles-horizontal": "Largest and smallest horizontal position over a cycle.", "nodes": "Amplitudes of the shaft at chosen nodes.",
    "orbits": "Orbits of the journals.", "multipliers": "Floquet multipliers: a cycle is stable while all lie inside the unit circle.",
    "frequency": "Whirl frequency over running speed.", "motion": "The motion in time.", "full-spectrum": "Circles that the orbits are made of, forward and backward.",
    "waterfall": "Spectra over the course of the motion.", "orders": "Orders of the speed over the course of the motion.",
    "bifurcations": "All branches together, vertical motion of the journals.",
    "eccentricity": "Largest eccentricity over speed.", "loci": "Where motions lose stability, over two parameters.", "run-up": "Amplitude on the way up and down.",
    "trends": "Where bifurcations lie over what the sweep changes.", "impedance": "Resistance to a squeeze, over the journal's place.",
    "map-locus": "Where the journal rests under a load.", "map-stiffness": "Stiffness over the load.", "map-damping": "Damping over the load.",
    "map-stability": "Where a rigid rotor loses stability.", "map-pressure": "Pressure and thickness around the bearing.",
    "history": "The motion over time.", "harmonics": "Harmonics of the self-excited vibration.", "critical-speeds": "Undamped critical speeds over the stiffness of the supports.",
    "columns-shaft": "Moment, shear force and stress along the shaft.",
    "convergence": "Natural frequencies over the number of elements.", "shifts": "Frequencies of other elements against those of the deck.",
    "conditions": "Condition of the eigenvalues.", "reduction-errors": "Errors of reduced shafts.", "reduction-orbits": "Orbits of whole and reduced shafts.",
    "reduction-maps": "Entries of the reduced matrices.", "whirl-map": "Sense of whirl of each mode along the shaft, over the speed.",
    "gas-curves": "Load, attitude, flow and losses of the gas film over the eccentricity.", "gas-isobars": "Pressure of the gas film.",
    "gas-meshes": "Load over the mesh, by the model of the orifices.", "gas-map": "Load and flow over clearance and diameter of the orifices.", "gas-knudsen": "Thickness of the film at which slip has to be counted.",
    "line-modes": "Modes of torsion or along the axis.", "transfer": "Transfer functions of the motion under random forces.", "coherence": "Coherence: how much of the motion is linear in the forces.",
    "excitation": "Spectrum of the random forces.", "thd-iterations": "Convergence of film and solids.", "thd-meshes": "Results of the film with heat over the mesh.",
    "thd-budget": "Where the heat comes from and goes to, over the speed.", "thd-effective": "How well one temperature stands for the film.",
    "thd-properties": "Clearance and properties of the fluid over the temperature.", "thd-profiles": "Temperature across the film.",
    "thd-radial": "Temperature along the radius, from shaft to bush.", "thd-maps": "Pressure and temperature of the film, unwrapped.", "thd-velocity": "Velocity in the film.",
    "thd-axial": "Temperature along the shaft, where the film is thinnest and opposite.", "thd-axial-orifice": "Temperature along the shaft, at an orifice and between two.",
    "thd-fluid": "Properties of the fluid in the film.", "thd-heat": "Heat per area of the film.", "thd-film": "Temperature in sections through the film.",
    "frequencies": "Stiffness and damping over the frequency of a vibration.", "stiffness": "Stiffness of the films.", "damping": "Damping of the films.",
}
# The same where the name ends with a place or a quantity.
BY_PLACE = {"film-": "Film of bearing {}: pressure and thickness, unwrapped.", "coefficients-": "Coefficients of the film: {}.", "enforced-": "Coefficients by enforced motion: {}.",
            "response-": "Transfer functions to {} (amplitude and phase).", "shapes-3d-": "Mode shapes in space: {}.", "shapes-": "Mode shapes along the shaft: {}.",
            "orbits-": "Orbits: {}.", "multipliers-": "Floquet multipliers: {}.", "columns-": "Columns of the table of the {}."}
# Where x and y are states of another system than a rotor.
OF_STATES = {"cycles-vertical": "Largest and smallest y over a cycle.", "cycles-horizontal": "Largest and smallest x over a cycle.", "orbits": "Orbits.",
             "bifurcations": "All branches together, y.", "equilibria": "Equilibria, and the least stable eigenvalue."}
CONVENTIONS = [
    ("Axes", "x to the right, y up, z along the shaft; nodes are numbered from 1 along z."),
    ("Rotation", "from x to y, counter-clockwise with x to the right. Forward whirl turns with the shaft."),
    ("Angles", "theta from +x, counter-clockwise. Lags are behind the shaft angle."),
    ("Amplitudes", "0-peak, unless a name says peak to peak."),
    ("Journal positions", "journal minus pedestal minus elevation, relative to the bearing centre."),
    ("Loads", "of the journal on its bearing, positive down."),
    ("Bars", "after \u00b1: an estimate of the error from film mesh, time mesh and location, in the unit of the number."),
]


NUMBER = re.compile(r"\(?[\u2212-]?[0-9.]+(e[\u2212+-]?\d+)?( \u00b1 [0-9.]+)?(\)e[\u2212+-]?\d+)?( %)?|\u2013|without limit")


def escape(text):
    return html.escape(str(text))


def numeric(cell):
    return isinstance(cell, (int, float)) or bool(re.fullmatch(NUMBER, str(cell)))


def marked(cell, verdict=False):
    """A table cell. A bad verdict is red. In the rows of a sweep the verdict is a whole sentence."""
    bad = verdict and sweep_tables.has_unstable(str(cell)) or re.match(r"no$|unstable\b|too near\b|diverges\b", str(cell), re.IGNORECASE)
    return f"<span class=bad>{escape(cell)}</span>" if bad else escape(cell)


def show(table, folded=False):
    right = [all(numeric(row[k]) for row in table.rows) for k in range(len(table.head))]
    # Short texts stay on one line, long ones keep a width in which they can be read.
    length = [max((len(str(row[k])) for row in table.rows), default=0) for k in range(len(table.head))]
    mark = [" class=n" if r else " class=short" if n <= 30 else " class=long" for r, n in zip(right, length)]
    # A unit stays in one piece where a narrow screen breaks the line of the heads.
    heads = [re.sub(r"\[.*?\]", lambda unit: unit[0].replace(" ", "\u00a0"), escape(h)) for h in table.head]
    head = "".join(f"<th{m}>{h}</th>" for m, h in zip(mark, heads))
    body = "".join("<tr>" + "".join(f"<td{m}>{marked(c, 'verdict' in (h, row[0]))}</td>" for m, h, c in zip(mark, table.head, row)) + "</tr>" for row in table.rows)
    note = f"<p class=note>{escape(table.note)}</p>" if table.note else ""
    caption = "" if folded or not table.caption else f"<caption><span>{escape(table.caption)}</span></caption>"
    whole = f"<div class=scroll><table>{caption}<tr>{head}</tr>{body}</table></div>{note}"
    return f"<details><summary>{escape(table.caption)} ({len(table.rows)})</summary>{whole}</details>" if folded else whole


def anchor(name):
    return "s-" + re.sub(r"[^A-Za-z0-9]+", "-", name)


def caption(what, subject=None):
    """What a picture shows, by the end of its name, `shapes-3d-1500`: its kind, and a place or a speed."""
    kind = re.sub(r"-?\d+$", "", what)
    if what in OF_STATES and not all(getattr(s, "in_space", True) for s in getattr(subject, "studies", [subject])):
        return OF_STATES[what]
    if what in CAPTIONS or kind in CAPTIONS:
        words, number = CAPTIONS.get(what) or CAPTIONS[kind], what.removeprefix(kind).lstrip("-")
        at = kind.startswith("shapes") and what not in CAPTIONS and number
        if kind.startswith("response") and number:  # five places in a picture
            return f"{words.removesuffix('.')}, part {number}."
        return f"{words.removesuffix('.')}, at {number} {subject.attribute('speed_unit', 'rad/s')}." if at and subject is not None else words
    for head, told in BY_PLACE.items():
        if what.startswith(head):
            which = re.sub("[-._]", " ", what.removeprefix(head))
            return told.format(re.sub(r"^(translation|tilt) (\w+)$", r"\1, over the \2", which))
    if getattr(subject, "kind", "") == "sweep":
        return f"All variants in one picture: {re.sub('[-._]', ' ', what)}."
    return f"{kind.replace('-', ' ').capitalize()}."


def what_of(path, subject):
    """What a picture shows: its name without that of its study."""
    return path.stem.removeprefix(subject.file("").name) if hasattr(subject, "kind") else path.stem


def picture(path, subject=None):
    """A picture; of a study, or of the run, with the chart that takes its place on a screen, where there is one."""
    what = what_of(path, subject)
    chart = live.chart_of(subject, what) if subject is not None else ""
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"<figure>{chart}<div class=scroll><img alt='{escape(path.stem)}' src='data:image/png;base64,{data}'></div><figcaption title='{escape(path.name)}'>{escape(caption(what, subject))}</figcaption></figure>"


UNITS = (("_rad_s", "rad/s"), ("_rpm", "rpm"), ("_rad", "rad"), ("_s", "s"))  # at the ends of names


def detail(name, value, bar):
    """`whirl_frequency_rad_s` as `whirl frequency 220.4 rad/s`."""
    tail, unit = next(((tail, unit) for tail, unit in UNITS if name.endswith(tail)), ("", "1"))
    words = name.removesuffix(tail).replace("_", " ")
    return f"{words} {reading(value, bar, unit) if isinstance(value, (int, float)) and not isinstance(value, bool) else digits(value)}"


def details(event):
    """All that summary.json says of a bifurcation beside its type and place: its sentence first, the parts of its bar last."""
    parts = {k: v for k, v in event.items() if k in ("uncertainty_film_mesh", "uncertainty_time_mesh", "uncertainty_location")}
    bars = {k: event.get(f"uncertainty_{k}", event.get(f"{k}_uncertainty")) for k in event}
    bars["criticality_coefficient"] = event.get("criticality_uncertainty")
    usual = {"type", "parameter", "value", "unit", "uncertainty", "sentence", "criticality_uncertainty", *parts}
    usual |= {name for k in event for name in (f"uncertainty_{k}", f"{k}_uncertainty")}
    said = [event["sentence"]] if isinstance(event.get("sentence"), str) else []
    said += [detail(k, v, bars.get(k)) for k, v in event.items() if k not in usual and v is not None]
    shares = ", ".join(f"{k.removeprefix('uncertainty_').replace('_', ' ')} {digits(v, 2)}" for k, v in parts.items() if v)
    return "; ".join(said + ([f"parts of the bar: {shares} {event.get('unit', '')}".strip()] if shares else []))


def all_values(study):
    """Everything of summary.json that the tables above may have left out."""
    rows = [[k, reading(v.value, v.uncertainty, v.unit)] for k, v in study.values.items()]
    out = [tables.Table("All values", ["name", "value"], rows, "in units that read well; summary.json has all digits in the units of the program")]
    more = [[style.MARKS.get(b.get("type"), ("", "", b.get("type")))[2], f"{with_bar(b.get('value'), b.get('uncertainty'))} {b.get('unit', '')}".strip(), in_print(details(b))] for b in study.bifurcations]
    out.append(tables.Table("All about the bifurcations", ["type", "value", "more"], more))
    hertz = lambda v: v / (2 * math.pi) if isinstance(v, (int, float)) else None  # noqa: E731
    modes = [[f"{digits(m.get('speed'), 6)} {m.get('speed_unit', '')}".strip(), digits(m.get("mode"), 4), with_bar(hertz(m.get("imag")), hertz(m.get("imag_uncertainty"))),
              with_bar(m.get("real"), m.get("real_uncertainty")), with_bar(m.get("log_decrement"), m.get("log_decrement_uncertainty")),
              digits(m.get("damping_ratio"), 4), m.get("whirl") or "", m.get("stability") or ""] for m in study.modes]
    out.append(tables.Table("All modes", ["speed", "mode", "frequency [Hz]", "real part [1/s]", "log. decrement", "damping ratio", "whirl", ""], modes,
                            EITHER if any(m.get("whirl") == "either" for m in study.modes) else ""))
    if study.kind == "sweep":
        out += sweep_tables.everything(study, tables.Table)
    return [show(t, folded=True) for t in out if t.rows]


def warned(warnings):
    """The warnings of a study or of the machine, which its numbers must not be read without."""
    return f"<ul class=warn>{''.join(f'<li>{escape(in_print(w))}</li>' for w in warnings)}</ul>" if warnings else ""


def counted(number, what, several=""):
    """`1 point`, `2 points`."""
    return f"{number} {what if number == 1 else several or what + 's'}"


def section(study, pictures):
    bad = "" if study.status == "completed" else " class=bad"
    seconds, points = study.summary.get("wall_seconds"), study.summary.get("points")
    facts = [escape(study.kind.replace("_", " ")), f"<span{bad}>{escape(in_print(study.status or 'not finished'))}</span>"]
    if points is not None:
        facts.append(escape(counted(points, "point")))
    if isinstance(seconds, (int, float)):
        facts.append(f"{seconds:.1f} s")
    return "\n".join([f"<h2 id='{anchor(study.name)}'>{escape(study.name)}</h2><p class=note>{', '.join(facts)}</p>", warned(study.warnings),
                      *(show(t) for t in tables.findings(study)), *(picture(p, study) for p in pictures), *all_values(study)])


def in_brief(results):
    """One line a study, and its warnings below it."""
    said = [(s, brief.of(s)) for s in results.studies]
    rows = "".join(f"<tr><td class=name><a href='#{anchor(s.name)}'>{escape(s.name)}</a></td><td>{escape(words)}{warned(s.warnings)}</td></tr>"
                   for s, words in said if words or s.warnings)
    return f"<h2 id=brief>In brief</h2><table>{rows}</table>" if rows else ""


def at_service_speed(results):
    """What is known of the machine at its service speed, as summary.json has it."""
    service = results.summary.get("service_speed")
    if not isinstance(service, dict):
        return ""
    rows = []
    for fact in service.get("facts", []):
        value, bar, unit = fact.get("value"), fact.get("uncertainty"), fact.get("unit", "")
        if unit == "K" and value is not None:
            value, unit = value - 273.15, "\u00b0C"
        shown = "" if value is None else reading(value, bar, unit)
        place = f"at {fact['place']}" if fact.get("place") else ""
        rows.append([fact.get("what", ""), ", ".join(w for w in (f"{shown} {place}".strip(), fact.get("mark", "")) if w), fact.get("study") or ""])
    table = tables.Table("", ["", "", "study"], rows)
    return f"<h2 id=service>At the service speed, {escape(with_bar(service.get('value'), None))} {escape(service.get('unit', ''))}</h2>{show(table)}"


def left_over(results):
    """Entries of summary.json without data in results.h5: studies that delivered nothing."""
    known = {s.name for s in results.studies}
    rows = [[s["name"], s.get("kind", ""), s.get("status", "")] for s in results.summary.get("studies", []) if s["name"] not in known]
    return show(tables.Table("Studies without results", ["study", "kind", "how it ended"], rows)) if rows else ""


def plainly(value):
    """A value of the deck without the marks of a programming language."""
    if isinstance(value, dict):
        return ", ".join(f"{k} {plainly(v)}" for k, v in value.items())
    if isinstance(value, list):
        return ", ".join(f"({plainly(v)})" if isinstance(v, (dict, list)) else plainly(v) for v in value)
    return ("yes" if value else "no") if isinstance(value, bool) else str(value)


def options_in_force(results):
    """Options of the studies and of the run, as the deck was understood."""
    deck, summary, out = results.deck or {}, results.summary, []
    algebra = [[o["name"], o["value"], o.get("source", "")] for o in summary.get("options", []) if isinstance(o, dict) and "name" in o and "value" in o]
    if algebra:
        out.append(show(tables.Table("PETSc options in force", ["option", "value", "from"], algebra,
                                     "options of the algebra, which the deck does not hold: another run needs them as well"), folded=True))
    for entry in deck.get("studies") or []:
        for kind, options in entry.items() if isinstance(entry, dict) else []:
            rows = [[k, plainly(v)] for k, v in (options or {}).items() if v not in ([], "", None)]
            out.append(show(tables.Table(f"{(options or {}).get('name', '')} ({kind.replace('_', ' ')})".strip(), ["option", "value"], rows), folded=True))
    return "\n".join(out)


def pictures_of(results):
    """[(study, its pictures)] and the pictures of the whole run, in the order in which they were drawn: that of the manifest."""
    listed = results.directory / "manifest.txt"
    names = listed.read_text(encoding="utf-8").split("\n") if listed.is_file() else []
    every = sorted((p for p in results.directory.glob("*.png") if not names or p.name in names),
                   key=lambda p: names.index(p.name) if names else (p.stat().st_mtime_ns, p.name))
    used, found = set(), []
    stems = {s: s.file("x").name.removesuffix("x") for s in results.studies}
    for study in results.studies:
        longer = [stem for stem in stems.values() if len(stem) > len(stems[study])]
        mine = [p for p in every if p.stem.startswith(stems[study]) and not any(p.stem.startswith(stem) for stem in longer)]
        used.update(mine)
        found.append((study, mine))
    return found, [p for p in every if p not in used]


def origin(directory):
    """When a run ended and of what deck: the folder, and the first digits of the SHA-256 of the deck as it was understood."""
    summary, deck = directory / "summary.json", directory / "resolved.yaml"
    when = [time.strftime("%d %B %Y, %H:%M", time.localtime(summary.stat().st_mtime))] if summary.is_file() else []
    return when + [f"results in {escape(directory.name)}"] + ([f"deck {hashlib.sha256(deck.read_bytes()).hexdigest()[:12]}"] if deck.is_file() else [])


def page_of(results):
    studies, general = pictures_of(results)
    summary, title = results.summary, escape(results.title)
    ended = [s for s in results.studies if s.status != "completed"]
    facts = [f"whirl {escape(summary.get('version', ''))}", *origin(results.directory)]
    if summary.get("ranks"):
        facts.append(escape(counted(summary["ranks"], "rank")))
    if isinstance(summary.get("wall_seconds"), (int, float)):
        facts.append(f"{summary['wall_seconds']:.1f} s")
    facts.append(counted(len(studies), "study", "studies") + (f", <span class=bad>{len(ended)} ended early</span>" if ended else ""))
    links = "".join(f"<a href='#{anchor(s.name)}'>{escape(s.name)}</a>" for s, _ in studies)
    machine = [p for p in general if p.stem == "machine"]
    together = [p for p in general if p.stem != "machine"]
    conventions = tables.Table("Conventions", ["", ""], [list(c) for c in CONVENTIONS])
    inputs = tables.inputs(results)
    body = "\n".join([
        at_service_speed(results), warned([str(w) for w in summary.get("warnings", [])] if isinstance(summary.get("warnings"), list) else []),
        in_brief(results), "<h2 id=machine>The machine</h2>", *(picture(p) for p in machine), *(show(t) for t in inputs), show(conventions, folded=True),
        *([f"<h2 id=together>All together</h2>{''.join(picture(p, results) for p in together)}"] if together else []),
        *(section(s, p) for s, p in studies), left_over(results),
        f"<h2 id=options>Options in force</h2><p class=note>as the deck was understood, every default written out; resolved.yaml beside this page is that deck</p>{options_in_force(results)}"])
    return "\n".join([
        f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>{title}</title><style>{STYLE}{live.STYLE}</style>",
        f"<h1>{title}</h1><p class=note>{', '.join(facts)}</p>",
        f"<nav><a href='#machine'>The machine</a>{links}<a href='#options'>Options</a></nav>{live.note(body)}", body, live.scripts(body), "</html>"])


def main(argv):
    directory = results_directory("report", argv)
    if isinstance(directory, int):
        return directory
    style.use_style(("png",))
    with said_in_a_sentence("report"), Drawn(directory) as results:
        if not any(p for _, p in pictures_of(results)[0]):
            for _ in plot.drawn(results, "report"):  # a report by itself draws what it shows
                pass
        target = register(directory / "report.html")
        target.write_text(page_of(results), encoding="utf-8")
        if live.library() is None and any(live.maker_of(study, what_of(p, study)) for study, pictures in pictures_of(results)[0] for p in pictures):
            print("report: the page has pictures in place of charts; for charts install Debian's libjs-chart.js and write it again", file=sys.stderr)
    print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
