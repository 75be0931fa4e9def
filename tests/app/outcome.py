#!/usr/bin/env python3
"""The console ends with what was asked: the numbers of summary.json in units that a person reads, after what is known at the
service speed, in tables of at most 100 characters.

outcome.py PROGRAM SOURCE
"""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
work = pathlib.Path(tempfile.mkdtemp(prefix="whirl_outcome_"))
failures = []


def run(deck, name, *words):
    done = subprocess.run([program, "run", str(deck), "-o", str(work / name), *words], capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        sys.exit(f"{deck}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    studies = json.loads((work / name / "summary.json").read_text())["studies"]
    wide = [line for line in done.stdout.splitlines() if line.startswith("    ") and len(line) > 100]
    if wide:
        failures.append(f"{name}: lines of tables wider than 100:\n" + "\n".join(wide))
    return done.stdout, {s["name"]: {k: v["value"] for k, v in s["values"].items()} for s in studies}


def row(text, start, expected, digits=2e-3):
    """The line that begins with the words of `start` (after spaces) holds these numbers in this order."""
    first = start.split()
    for line in text.split("\n"):
        words = re.sub(r" \+- \S+| (fwd|bwd|node)\b", "", line).split()
        if words[:len(first)] != first or len(words) < len(first) + len(expected):
            continue
        try:
            found = [float(w) for w in words[len(first):len(first) + len(expected)]]
        except ValueError:
            continue
        if all(abs(f - e) <= digits * max(abs(e), 1e-9) for f, e in zip(found, expected)):
            return
    failures.append(f"no line '{start}' with {expected} in\n{text}")


train = source / "inputs" / "turbine_train"
text, s = run(train / "static.yaml", "static")
sits = s["at service speed"]
for b in "B1", "B3", "B5":
    at = {k: sits[f"bearing.{b}.{k}"] for k in ("x", "y", "eccentricity.x", "eccentricity.y", "min_thickness", "max_pressure")}
    row(text, b, [sits[f"load.{b}"] / 1e3, at["x"] * 1e6, at["y"] * 1e6, math.hypot(at["eccentricity.x"], at["eccentricity.y"])])
    row(text, b, [at["min_thickness"] * 1e6, at["max_pressure"] / 1e6])
row(text, "B4", [s["alignment"]["elevation.B4"] * 1e6, s["alignment"]["reaction.B4"] / 1e3, s["alignment"]["reaction_aligned.B4"] / 1e3])

short = source / "inputs" / "rigid_rotor" / "short_f1.yaml"
text, s = run(short, "short", "--set", "studies.2.cycle_branch.at=[400 rad/s]")
unbroken = " ".join(text.split())
if not re.search(r"loses stability at the threshold 437\.\d+ rad/s \(subcritical Hopf point\), where whirl of 35\.\d+ Hz begins, 0\.50\d+ of the speed\. "
                 r"Above this speed the rotor jumps to large whirl; just below it a disturbance can trigger the same whirl\.", unbroken):
    failures.append("the threshold, its whirl and what it means:\n" + text)
if text.count("above this speed the rotor jumps to large whirl;") > 0:
    failures.append("a bifurcation is explained twice:\n" + text)
row(text, "400 rad/s, left", [s["unbalanced"][f"at.400.peak_to_peak.left.{d}"] * 1e6 for d in "xy"])

response = ["studies=[{unbalance_response: {name: r, unbalance: [gen_pair], range: {from: 2400 rpm, to: 3000 rpm}, points: 25, "
            "nodes: [120, 6], operating: {from: 3000 rpm, to: 3600 rpm}}}]"]
text, s = run(train / "response.yaml", "response", "--set", response[0], "--set", "rotor.reduction={type: guyan, masters: [6, 49, 54, 93, 111, 120, 140, 160, 181]}")
peak = {k: s["r"][f"node.120.peak.1.{k}"] for k in ("speed", "semi_major", "amplification_factor", "separation_margin", "required_margin")}
af = peak["amplification_factor"]
if abs(peak["separation_margin"] - (3000 - peak["speed"]) / 3000) > 1e-9 or abs(peak["required_margin"] - 0.17 * (1 - 1 / (af - 1.5))) > 1e-9:
    failures.append(f"margins of API 617: {peak}")
row(text, "1", [120, peak["speed"], peak["semi_major"] * 1e6, af, 100 * peak["separation_margin"], 100 * peak["required_margin"]])

# On a falling range the threshold is not the first Hopf point of the list.
rigid = source / "inputs" / "rigid_rotor"
text, s = run(train / "balanced.yaml", "falling", "--set", "studies=[{equilibrium_branch: {name: down, parameter: speed, "
              "range: {from: 6000 rpm, to: 4500 rpm}}}]", "bearings.*.film.cells=[30, 8]",
              "rotor.reduction={type: guyan, masters: [6, 49, 54, 93, 111, 120, 140, 160, 181]}")
said = re.search(r"The threshold is (\S+) .*rpm: the lowest speed", text)
if not said or abs(float(said[1]) * math.pi / 30 / s["down"]["threshold"] - 1) > 1e-3 or text.count("    Hopf point  ") < 2:
    failures.append(f"the threshold {s['down']['threshold']} rad/s of a falling range:\n{text}")
# Critical speeds with margins; modes where there are none.
text, s = run(source / "tests" / "app" / "friswell_591.yaml", "criticals", "--set", "studies=[{modes: {name: m, range: {from: 100 rpm, "
              "to: 3000 rpm}, points: 30, operating: {from: 2500 rpm, to: 2800 rpm}}}, {modes: {name: one, speeds: [500 rpm], count: 11}}]",
              "rotor.stiffness_damping=1e-5 s", "service_speed=2600 rpm")
told, opens, table = (text.find(words) for words in ("m: completed", "at the service speed, 2600 rpm:", "  Critical speeds: "))
if not 0 < told < opens < table or not re.search(r"critical speed above: 2756\.\S* \+- \S+ rpm, 6\.0 % from the service speed", text):
    failures.append("the service speed opens what was found:\n" + text)
# A run begins with what `check` says about the deck.
slim = ["--set", "rotor.segments.3.length=2 m", "--set", "studies=[{modes: {speeds: [500 rpm], count: 2, supports: films}}]"]
checked = subprocess.run([program, "check", str(source / "tests" / "app" / "friswell_591.yaml"), *slim], capture_output=True, text=True, timeout=300).stdout
warned = [line for line in checked.split("\n") if line.startswith("  warning: ")]
ran = [line for line in run(source / "tests" / "app" / "friswell_591.yaml", "slim", *slim)[0].split("\n") if line.startswith("  warning: ")]
if not any("rotor.segments.3: length over stiffness diameter" in line for line in warned) or ran[:len(warned)] != warned:
    failures.append(f"warnings of a run {ran} and of a check {warned}")
m = s["m"]
row(text, "1", [m[f"critical.1.{k}"] for k in ("speed", "mode", "log_decrement", "amplification_factor")]
    + [100 * m["critical.1.separation_margin"], 100 * m["critical.1.required_margin"]])
columns = [line.split(",") for line in (work / "criticals" / "csv" / "m" / "critical.csv").read_text().splitlines()]
if columns[0][2:4] != ["mode", "whirl"] or [c[3] for c in columns[1:5]] != ["backward", "forward"] * 2 or not all(w in text for w in ("1 bwd", "2 fwd")):
    failures.append(f"critical speeds have their sense of whirl: {columns}\n{text}")
if abs(m["critical.1.amplification_factor"] * m["critical.1.log_decrement"] - math.pi) > 1e-9:
    failures.append(f"amplification factor and log decrement: {m}")
if "Modes at 500 rpm" not in text or "1 more stand in summary.json" not in text:
    failures.append("modes at a single speed:\n" + text)
text, s = run(rigid / "bearing_map.yaml", "map")
if "stable up to 437.64" not in text:
    failures.append("what a bearing map says of the rotor:\n" + text)
text, s = run(rigid / "bearing_map.yaml", "coefficients", "--set", "studies=[{dynamic_coefficients: {name: c, eccentricity: 0.5, speeds: [160 rad/s]}}]")
study = json.loads((work / "coefficients" / "summary.json").read_text())["studies"][0]
stiffness = study["brief"]["tables"][0]
kxx = next(cell for column, cell in zip(stiffness["columns"], stiffness["rows"][0]) if column["name"] == "K xx")
if kxx["value"] != study["values"]["speed.160.ratio.1.K.xx"]["value"] or not any(line.split()[:4] == ["160", "rad/s", "1", kxx["text"].split()[0]] for line in text.splitlines()):
    failures.append("stiffness and damping of a bearing by itself:\n" + text)
text, s = run(rigid / "short_f1.yaml", "more", "--set", "studies=[{motion: {name: free, speed: 200 rad/s, discard: 20, revolutions: 4}}]")
if "comes to rest (a fixed point)" not in text:
    failures.append("the kind of a motion:\n" + text)

# A sweep shows the deck as given first, then its variants, each with its own verdict and numbers.
text, s = run(rigid / "short_f1.yaml", "sweep", "--set", "studies=[{equilibrium_branch: {name: b, parameter: speed, range: {from: 160 rad/s, "
              "to: 560 rad/s}}}, {sweep: {name: c, grid: {bearings.*.geometry.clearance: [x0.8]}}}]")
found = json.loads((work / "sweep" / "summary.json").read_text())["studies"]
sweep = next(x for x in found if x["kind"] == "sweep")
column = next(c for c in sweep["columns"] if c["name"] == "b.threshold")
values = dict(zip(("given", "x0.8"), column["values"]))
if abs(values["given"] - values["x0.8"]) < 1e-3 * values["given"]:
    failures.append(f"the variant moves the threshold: {values}")
for name, value in values.items():
    line = next((x for x in text.split("\n") if re.search(f"{name}  .*unstable in part", x)), "")
    if not any(re.fullmatch(r"[0-9.]+", w) and abs(float(w) / value - 1) < 1e-5 for w in line.split()):
        failures.append(f"no row '{name}' with {value} in\n{text}")
# An undamped row is marked too; the two factors of one resonance are explained.
nelson, damped = source / "tests" / "app" / "nelson.yaml", "[2000 N s/m, 0 N s/m, 0 N s/m, 2000 N s/m]"
marks = ["--set", "bars=none", "studies=[{modes: {name: m, speeds: [1000 rpm], count: 2}}, {frequency_response: {name: f, speed: 1000 rpm, range: {from: 1600 rad/s, "
         "to: 1800 rad/s}, points: 3, inputs: [{node: 5, direction: x}], outputs: [{node: 5, direction: x}]}}, {sweep: {name: c, of: [m], grid: {gravity: [x2]}}}]"]
factors = ["--set", "bars=none", f"bearings.*.film.damping={damped}", "unbalance={u: {planes: [{node: 5, amount: 1 g mm}]}}",
           "studies=[{modes: {name: m, range: {from: 15000 rpm, to: 18000 rpm}, points: 3, count: 2}}, {unbalance_response: {name: r, unbalance: [u], "
           "range: {from: 15000 rpm, to: 19000 rpm}, points: 21, nodes: [5]}}]"]
for name, words, said in (("marks", marks, "without limit(.|\n)*as given  .*undamped"),
                          ("factors", factors, r"AF \(3 dB\): N/\(N2 - N1\) of this\s+response\s+at\s+0.707\s+of\s+its\s+peak\s+\(API\s+684\);\s+'m'\s+gives")):
    text, _ = run(nelson, name, *words)
    # A run that goes on says the same of what had ended.
    again, _ = run(nelson, name, *words, "--resume")
    if not re.search(said, text) or again != text:
        failures.append(f"no '{said}' in\n{text}\nor not in the run that goes on:\n{again}")

# On a terminal of 80 columns all lines fit, long warnings as well. Elsewhere a warning stays one line.
for columns, deck in (("80", "tutorial/2_unbalance.yaml"), ("80", "merot/frequency_response.yaml"), (None, "merot/frequency_response.yaml")):
    env = {k: v for k, v in os.environ.items() if k != "COLUMNS"} | ({"COLUMNS": columns} if columns else {})
    done = subprocess.run([program, "run", source / "inputs" / deck, "-o", work / f"columns_{columns}_{deck[0]}"], capture_output=True, text=True, env=env)
    widest = max(map(len, done.stdout.splitlines()), default=0)
    if done.returncode or (widest > 80) != (columns is None):
        failures.append(f"{deck} with COLUMNS={columns}: exit {done.returncode}, lines of up to {widest} characters")

if not failures:
    shutil.rmtree(work)
print("\n".join(failures) or "the console ends with what was asked")
sys.exit(1 if failures else 0)
