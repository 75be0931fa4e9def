"""Tables and pictures of docs/design_studies.md from the results of their decks: design_page.py [NAME...], in the root of the sources.

A table stands between `<!-- table NAME -->` and `<!-- end -->`. What the source states and the rule by which we agree are here;
numbers and verdicts come from summary.json and results.h5.
"""
import json
import math
import os
import pathlib
import re
import subprocess
import sys

import h5py
import numpy

from .design_pictures import PICTURES, Pictures

PAGE = pathlib.Path("docs/design_studies.md")
RESULTS = pathlib.Path(os.environ.get("WHIRL_RESULTS", "results/design_studies"))
# Balanced trains only, on the whole shaft: the cycles give way to a place of rest.
WHOLE = ["rotor.reduction={type: none}", "studies.2={static: {name: rest 1, speed: 3600 rpm}}",
         "studies.3={static: {name: rest 2, speed: 3600 rpm}}", "studies.{4,5,6,7,8,9,10}.sweep.of=[balanced]",
         "studies.1.equilibrium_branch.range={from: 2800 rpm, to: 6800 rpm}"]
RUNS = {"design": ("design", []), "whole": ("design", WHOLE),
        **{name: (name, []) for name in ("pedestals_whirl", "reduction", "coefficients", "film_meshes")}}
SERVICE = 3600  # rpm: the operating range ends here
SECOND = (2300, 3100)  # rpm: around the second critical speed of the generator
SIGNIFICANT = 250  # rpm: half of the shifts that the source calls an effect
SHORT = {"neimark_sacker": "", "flip": " (flip)", "cyclic_fold": " (fold)"}
SIDE = {"supercritical": "super", "subcritical": "sub", "undetermined": "?"}
LABELS = {"weak": "pedestals 2-4 x 0.1", "strong": "pedestals 2-4 x 10", "low": "bearing 5 -500 um", "high": "bearing 5 +500 um",
          "narrow": "clearance 2-4 -20 %", "wide": "clearance 2-4 +20 %", "a quarter": "offset 0.25 c", "a half": "offset 0.5 c",
          "lambda 11": "slenderness 11", "lambda 12": "slenderness 12", "lambda 15": "slenderness 15"}


class Study:
    """A study with its place in results.h5."""

    def __init__(self, summary, group):
        self.summary, self.group, self.status = summary, group, summary["status"]
        self.bifurcations = summary.get("bifurcations", [])

    def of(self, *types):
        return [b for b in self.bifurcations if b["type"] in types]

    def first(self, kind):
        return next(iter(self.of(kind)), None)

    def losses(self):
        """The last bifurcation along a branch at which nothing else is unstable: beyond it the branch does not become stable again.
        None if it is stable at its end."""
        if self.group["branch/stable"][-1] > 0:
            return None
        return [b for b in self.of(*SHORT) if b.get("others_unstable") == 0][-1]

    def value(self, name):
        v = self.summary["values"].get(name)
        return None if v is None else v["value"]


class Run:
    """Variants by name; `as given` is the deck as it stands. Sweeps that were run by themselves are taken from folders NAME.PART."""

    def __init__(self, name):
        self.variants = {}
        for folder in [RESULTS / name, *sorted(RESULTS.glob(f"{name}.*/"))]:
            self.add(folder)

    def add(self, folder):
        file = h5py.File(folder / "results.h5")
        studies = json.loads((folder / "summary.json").read_text())["studies"]
        alone = {s["name"]: Study(s, file["studies"].get(s["name"])) for s in studies if "variants" not in s}
        if alone:
            self.variants["as given"] = alone
        for sweep in (s for s in studies if "variants" in s):
            groups = {g.attrs["title"]: g for g in file[f"studies/{sweep['name']}/variants"].values()}
            for v in sweep["variants"]:
                self.variants[v["name"]] = {s["name"]: Study(s, groups[v["name"]].get(s["name"])) for s in v["studies"]}

    def __call__(self, variant, study):
        return self.variants[variant][study]


def computed(name):
    """The folder of a run, computed unless it is there."""
    deck, overrides = RUNS[name]
    out = RESULTS / name
    words = ["build/whirl", "run", f"inputs/turbine_train/{deck}.yaml", "-o", str(out), "--resume"]
    for o in overrides:
        words += ["--set", o]
    finished = out / "summary.json"
    if not finished.exists() or list(out.glob("*.checkpoint.h5")):
        # A variant whose branch ends early is a result too, and its status says so.
        done = subprocess.run(words, stdout=subprocess.DEVNULL)
        if done.returncode not in (0, 3):
            sys.exit(f"design_studies: {deck}: exit {done.returncode}")
    return out


def compute(name):
    computed(name)
    return Run(name)


def number(value, bar):
    """Both in rpm, with the digits that the bar allows."""
    if bar is None:
        return f"{value:.0f}"
    return f"{value:.0f} ± {bar:.0f}" if bar >= 2 else f"{value:.1f} ± {max(bar, 0.1):.1f}"


def where(b):
    return number(b["value"], b["uncertainty"])


def shift(b, a):
    """Of b against a, with the sum of both bars."""
    return b["value"] - a["value"], b["uncertainty"] + a["uncertainty"]


def signed(d):
    return f"{d[0]:+.0f} ± {d[1]:.0f}"


def rises(*shifts):
    """Whether all shifts are positive; a bar that contains zero leaves it open."""
    return "no" if any(d < -bar for d, bar in shifts) else "yes" if all(d > bar for d, bar in shifts) else "open"


def falls(*shifts):
    return rises(*((-d, bar) for d, bar in shifts))


def stays(*shifts):
    """Whether all shifts are below what counts."""
    small = [abs(d) + bar <= SIGNIFICANT for d, bar in shifts]
    large = [abs(d) - bar > SIGNIFICANT for d, bar in shifts]
    return "no" if any(large) else "yes" if all(small) else "open"


def inside(study, low=0, high=SERVICE):
    """Neimark-Sacker points of a range."""
    return [b for b in study.of("neimark_sacker") if low < b["value"] < high]


def listed(points):
    return ", ".join(where(b) for b in points) or "none"


def with_side(points):
    return ", ".join(f"{where(b)}{SHORT[b['type']]} {SIDE.get(b['criticality'], '')}".strip() for b in points) or "none"


def upper(study):
    b = study.losses()
    if b is None:
        end = study.group["branch/parameter"][-1]
        return "8000 and more" if end > 7999 else f"{end:.0f}, where the branch ends"
    return where(b) + SHORT[b["type"]]


def markdown(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def variants():
    run = compute("design")
    rows = []
    for name, studies in run.variants.items():
        t = studies["balanced"].first("hopf")
        rows.append([LABELS.get(name, name), where(t), SIDE[t["criticality"]], *(upper(studies[g]) for g in ("G2.5", "G6.3"))])
    return markdown(["variant", "threshold", "side", "G2.5 stable up to", "G6.3 stable up to"], rows)


def service():
    run = compute("design")
    rows = [[LABELS.get(name, name), *(with_side([b for b in s[g].of(*SHORT) if b["value"] < SERVICE]) for g in ("G2.5", "G6.3"))] for name, s in run.variants.items()]
    return markdown(["variant", "G2.5", "G6.3"], rows)


def stretches(study):
    """Speeds between which a branch of whirl is stable, by its birth and its points; those nearer to the birth than a tenth of its bar
    cannot be told from it."""
    speed, stable, hopf = study.group["branch/parameter"][()], study.group["branch/stable"][()] > 0, study.first("hopf")
    kept = abs(speed - hopf["value"]) > 0.1 * hopf["uncertainty"]
    speed, stable = numpy.append(hopf["value"], speed[kept]), numpy.append(stable[kept][:1], stable[kept])
    edges = numpy.flatnonzero(numpy.diff(numpy.concatenate([[False], stable, [False]]).astype(int)))
    pairs = [(speed[a], speed[b - 1]) for a, b in zip(edges[::2], edges[1::2])]
    return "; ".join(f"{min(p):.0f} to {max(p):.0f}" for p in pairs) or "nowhere"


def apart_from_birth(study):
    """Folds of a branch of whirl. One nearer to the Hopf point than a tenth of its bar cannot be told from it."""
    hopf = study.first("hopf")
    return [b for b in study.of("cyclic_fold") if abs(b["value"] - hopf["value"]) > 0.1 * hopf["uncertainty"]]


def ending(study):
    """Where a branch of whirl ends, and why."""
    film, contact = re.search(r"film of bearing \D*(\d+) falls below (.*?) \(", study.status), study.summary["values"].get("contact")
    if not film or not contact:
        return study.status
    return f"contact at {number(contact['value'], contact['uncertainty'])}: film of bearing {film[1]} below {film[2]}"


def whirl():
    run = compute("pedestals_whirl")
    rows = []
    for name, studies in run.variants.items():
        s = studies["whirl"]
        hopf = s.first("hopf")
        rows.append([LABELS.get(name, name), f"{where(hopf)} {SIDE[hopf['criticality']]}", stretches(s),
                     listed(apart_from_birth(s)), with_side(s.of("neimark_sacker")), ending(s)])
    return markdown(["variant", "Hopf point", "stable", "folds", "Neimark-Sacker points", "end"], rows)


def reduction():
    run = compute("reduction")
    modes = {}
    for variant in ("whole", "as given"):
        for m in run(variant, "stability factors").summary["modes"]:
            if m["imag"] > 0 and m["real"] < 0 and 600 < m["imag"] * 30 / math.pi < 1500:
                delta = -2 * math.pi * m["real"] / m["imag"]
                modes.setdefault((m["speed"], variant), []).append((m["imag"] * 30 / math.pi, 10 ** -delta))
    rows = []
    for speed in (3600, 4500):
        pairs = zip(sorted(modes[speed, "whole"]), sorted(modes[speed, "as given"]))
        rows += [[f"{speed} rpm", f"{f:.0f}", f"{a:.4f}", f"{b:.4f}"] for (f, a), (_, b) in pairs if a > 0.5]
    return markdown(["speed", "damped frequency [rpm]", "whole", "reduced"], rows)


def whole():
    reduced, full = compute("design"), compute("whole")
    rows = []
    for name, studies in full.variants.items():
        a, b = studies["balanced"].first("hopf"), reduced(name, "balanced").first("hopf")
        if a:
            rows.append([LABELS.get(name, name), where(a), where(b), f"{b['value'] - a['value']:+.1f}"])
    return markdown(["variant", "whole shaft", "21 nodes", "error of the reduction"], rows)


def statements():
    run, beyond = compute("design"), compute("pedestals_whirl")

    def hopf(name):
        return run(name, "balanced").first("hopf")

    def against(name, other="as given"):
        return shift(hopf(name), hopf(other))

    def last(name, grade):
        """The last loss of stability; at its end for a branch that keeps it, with a bar of zero: a lower bound."""
        s = run(name, grade)
        return s.losses() or {"value": s.group["branch/parameter"][-1], "uncertainty": 0.0, "bound": True}

    def moved(name, grade):
        d = shift(last(name, grade), last("as given", grade))
        return d, ("more than " if last(name, grade).get("bound") else "") + signed(d)

    def agree(*conditions):
        return "yes" if all(conditions) else "no"

    def per(names, text):
        return "; ".join(f"{n}: {text(n)}" for n in names)

    def size(name):
        return run(name, "G2.5").value(f"at.{SERVICE}.peak_to_peak.B5.y") * 1e6

    def criticality(name):
        return hopf(name)["criticality"]

    def seconds(name, grade="G6.3"):
        return inside(run(name, grade), *SECOND)

    def first_ns(name):
        return run(name, "G2.5").first("neimark_sacker")

    def whirl_ns(name):
        return beyond(name, "whirl").first("neimark_sacker")

    three, lambdas, weak, strong = ("weak", "as given", "strong"), ("lambda 11", "lambda 12", "as given", "lambda 15"), against("weak"), against("strong")
    w_given, w_weak = whirl_ns("as given"), whirl_ns("weak")
    w_shift = shift(w_weak, w_given) if w_given and w_weak else None
    g25 = {name: shift(first_ns(name), first_ns("as given")) for name in ("weak", "strong")}
    wide, narrow = moved("wide", "G6.3"), moved("narrow", "G6.3")
    offsets = [against(n) for n in ("a quarter", "a half")]
    forced = [moved(n, "G6.3") for n in ("a quarter", "a half")]
    preloads = [against("as given", "preload 0.3"), against("preload 0.6")]
    late = [shift(last("as given", "G6.3"), last("preload 0.3", "G6.3")), moved("preload 0.6", "G6.3")[0]]
    stiff, slender = against("lambda 11"), against("lambda 15")
    rows = [
        ("4.2, fig. 4.6a, balanced", "weak pedestals raise the threshold by about 500", signed(weak), rises(weak)),
        ("4.2, fig. 4.6a, balanced", "all three Hopf points are supercritical", per(three, criticality),
         "yes" if all(criticality(n) == "supercritical" for n in three) else
         "no" if any(criticality(n) == "subcritical" for n in three) else "open"),
        ("4.2, fig. 4.6a, balanced", "weak: the whirl becomes quasi-periodic about 2000 later",
         signed(w_shift) if w_shift else per(three, lambda n: listed(beyond(n, "whirl").of("neimark_sacker"))),
         rises(w_shift) if w_shift else "no such point to compare"),
        ("4.2, fig. 4.6a, balanced", "weak: a small range of stable whirl beyond the threshold, none as given and strong",
         per(three, lambda n: stretches(beyond(n, "whirl"))),
         agree(stretches(beyond("weak", "whirl")) != "nowhere", *(stretches(beyond(n, "whirl")) == "nowhere" for n in three[1:]))),
        ("4.2, fig. 4.6b, G2.5", "weak pedestals reduce the response", f"bearing 5, y at {SERVICE}: {size('as given'):.1f} to {size('weak'):.1f} um peak to peak",
         agree(size("weak") < size("as given"))),
        ("4.2, fig. 4.6b, G2.5", "Neimark-Sacker points only above the operating range", per(three, lambda n: listed(inside(run(n, "G2.5")))),
         agree(*(not inside(run(n, "G2.5")) for n in three))),
        ("4.2, fig. 4.6b, G2.5", "the first comes about 500 earlier on weak pedestals", signed(g25["weak"]), falls(g25["weak"])),
        ("4.2, fig. 4.6b, G2.5", "and about 500 later on strong ones", signed(g25["strong"]), rises(g25["strong"])),
        ("4.2, fig. 4.6c, G6.3", "further ones near the second critical speed as given and strong",
         per(three[1:], lambda n: listed(seconds(n))), agree(*(seconds(n) for n in three[1:]))),
        ("4.2, fig. 4.6c, G6.3", "weak: none in the operating range, but close above it", listed(inside(run("weak", "G6.3"))),
         agree(not inside(run("weak", "G6.3")))),
        ("4.2, fig. 4.7, balanced", "the threshold rises with the elevation of bearing 5", f"{signed(against('high'))} at +500 um, {signed(against('low'))} at -500 um",
         rises(against("high"), against("as given", "low"))),
        ("4.3, fig. 4.8a, balanced", "clearance +20 %: threshold about 500 higher", signed(against("wide")), rises(against("wide"))),
        ("4.3, fig. 4.8a, balanced", "clearance -20 %: no significant shift", signed(against("narrow")), stays(against("narrow"))),
        ("4.3, fig. 4.8b, G6.3", "clearance +20 %: last loss of stability about 1700 later", wide[1], rises(wide[0])),
        ("4.3, fig. 4.8b, G6.3", "clearance -20 %: no significant shift of it", narrow[1], stays(narrow[0])),
        ("4.3, fig. 4.8b, G6.3", "Neimark-Sacker points at the second critical speed as given and with +20 %, none with -20 %",
         per(("as given", "wide", "narrow"), lambda n: listed(seconds(n))), agree(seconds("as given"), seconds("wide"), not seconds("narrow"))),
        ("4.3, fig. 4.9, balanced", "offset: no significant shift of the threshold", f"{signed(offsets[0])} at 0.25 c, {signed(offsets[1])} at 0.5 c", stays(*offsets)),
        ("4.3, unbalanced", "offset: nor of the last loss of stability (here G6.3)", f"{forced[0][1]}, {forced[1][1]}", stays(*(f[0] for f in forced))),
        ("4.3, fig. 4.10a, balanced", "preload raises the threshold", f"0.3 to 0.5: {signed(preloads[0])}; 0.5 to 0.6: {signed(preloads[1])}", rises(*preloads)),
        ("4.3, fig. 4.10b, G6.3", "preload raises the last loss of stability", f"0.3 to 0.5: {signed(late[0])}; 0.5 to 0.6: {signed(late[1])}", rises(*late)),
        ("4.3, fig. 4.10b, G6.3", "at the second critical speed: no Neimark-Sacker point with preload 0.3, one with 0.6",
         per(("preload 0.3", "preload 0.6"), lambda n: listed(seconds(n))), agree(not seconds("preload 0.3"), seconds("preload 0.6"))),
        ("4.3, fig. 4.10b, G6.3", "preload 0.6: last loss of stability near 7500", upper(run("preload 0.6", "G6.3")),
         agree(abs(last("preload 0.6", "G6.3")["value"] - 7500) <= 500)),
        ("4.3, fig. 4.11, G6.3", "no Neimark-Sacker point below 3600 with an arc of 140 deg, but with 120 and 160 deg",
         "; ".join(f"{a}: {listed(inside(run(n, 'G6.3')))}" for a, n in ((120, "arc 120 deg"), (140, "arc 140 deg"), (160, "as given"))),
         agree(inside(run("arc 120 deg", "G6.3")), not inside(run("arc 140 deg", "G6.3")), inside(run("as given", "G6.3")))),
        ("4.4, fig. 4.12a, balanced", "a stiff generator (11) loses stability later, a slender one (15) earlier", f"{signed(stiff)} and {signed(slender)}",
         rises(stiff, (-slender[0], slender[1]))),
        ("4.4, fig. 4.12b, G2.5", "no Neimark-Sacker point in the operating range with 11", listed(inside(run("lambda 11", "G2.5"))),
         agree(not inside(run("lambda 11", "G2.5")))),
        ("4.4, fig. 4.12b, G2.5", "but with 12 and 13", per(lambdas[1:3], lambda n: listed(inside(run(n, "G2.5")))),
         agree(*(inside(run(n, "G2.5")) for n in lambdas[1:3]))),
        ("4.4, fig. 4.12c, G6.3", "(the same question with G6.3; the text does not say)", per(lambdas, lambda n: listed(inside(run(n, "G6.3")))), "-"),
    ]
    return markdown(["source", "statement", "Whirl", "agreement"], [list(r) for r in rows])


TABLES = {f.__name__: f for f in (variants, service, statements, whirl, reduction, whole)}


def fill(name):
    """Replaces a table of the page."""
    table = TABLES[name]()
    # The page is read after the computation, which takes long: its text may have been edited meanwhile.
    page, count = re.subn(rf"(<!-- table {name} -->\n).*?(<!-- end -->)", lambda m: f"{m[1]}{table}\n{m[2]}", PAGE.read_text(), flags=re.S)
    if count != 1:
        sys.exit(f"design_studies: {PAGE} has {count} places for the table {name}")
    PAGE.write_text(page)


def main(names):
    unknown = [n for n in names if n not in (*TABLES, *PICTURES)]
    if unknown:
        sys.exit(f"design_studies: there is no table or picture {', '.join(unknown)}; there are {', '.join((*TABLES, *PICTURES))}")
    pictures = Pictures(computed)
    for name in names or (*TABLES, *PICTURES):
        if name in TABLES:
            fill(name)
        else:
            pictures.copy(name, PAGE.parent)


if __name__ == "__main__":
    main(sys.argv[1:])
