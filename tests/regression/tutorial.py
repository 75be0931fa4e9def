#!/usr/bin/env python3
"""Runs the commands and examples of the tutorial and of the front page, and holds the values that they state against the answers.

tutorial.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]
"""
import contextlib
import io
import os
import pathlib
import re
import shlex
import subprocess
import sys

from harness import Harness

RPM = 30 / 3.141592653589793
# Runs whose error bars or whose kind of bifurcation a page states; the others go without, which costs half.
BARS = {"3_oil_films", "4_limit_cycle", "6_own_machine"}


class Pages:
    """The pages, the results of their commands by name, and the statements that were checked."""

    def __init__(self, h):
        self.h = h
        self.texts = {"README": (h.source / "README.md").read_text(encoding="utf-8")}
        for path in sorted((h.source / "docs/tutorial").glob("*.md")):
            self.texts[path.stem if path.stem != "README" else "index"] = path.read_text(encoding="utf-8")

    def commands(self, page):
        """Indented lines that start with a command."""
        return re.findall(r"^    ((?:scripts/run|build/whirl|cp) .*)$", self.texts[page], re.M)

    def states(self, page, text, value, what, slack=0.0):
        """`text` stands on the page, and its number is the value within half of its last digit (and `slack`)."""
        number = re.search(r"-?\d+(?:\.\d+)?(?:e\d+)?", text)[0]
        mantissa, _, exponent = number.partition("e")
        last = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        self.h.true(f"{page} states {text}", text in self.texts[page])
        self.h.close(f"{page}: {what}", value, float(number), 0.51 * last + slack)


def run_commands(h, pages):
    """Every command of every page, in the order of the pages, as a user would call them. Name of a run: results by whirl.read."""
    import whirl
    os.chdir(h.work)
    (h.work / "inputs").symlink_to(h.source / "inputs")
    runs, tried = {}, 0
    for page in pages.texts:
        for line in pages.commands(page):
            if "DECK" in line or "KEY" in line:
                continue  # how commands look in general
            words = shlex.split(line)
            if words[0] == "cp":
                h.true(line, (h.work / words[1]).is_file())
                continue
            if words[0] == "build/whirl":
                if words[1] not in ("check", "describe"):
                    continue
                done = subprocess.run([h.program, *words[1:]], capture_output=True, text=True)
                h.true(line, done.returncode == 0 and done.stdout.strip(), done.stderr)
                continue
            deck, rest = words[1], words[2:]
            if "tutorial" not in deck:
                continue  # the main job has tests of its own
            name = pathlib.Path(deck).stem
            tried += bool(rest)
            key = f"{name}+" if rest else name
            out = f"results/{name}" if not rest else f"results/tried_{name}_{tried}"
            if rest[:1] == ["-o"]:
                out, rest = rest[1], rest[2:]
                key = pathlib.Path(out).name
            if key in runs:
                continue
            flags = [] if key in BARS else ["--set", "bars=none"]
            done = subprocess.run([h.program, "run", deck, "-o", out, "--force", *rest, *flags], capture_output=True, text=True)
            h.true(line, done.returncode == 0, done.stderr + done.stdout[-300:] if done.returncode else "")
            runs[key] = whirl.read(out)
    return runs


def threshold(run, study="threshold"):
    return run.values(study)["threshold"].value * RPM


def bifurcation(run, study, kind):
    found = [b for b in run.bifurcations(study) if b["type"] == kind]
    return found[0] if found else {"value": None}


def check(h, pages, runs):
    one, two, three, four, five, fan = (runs[k] for k in ("1_springs", "2_unbalance", "3_oil_films", "4_limit_cycle", "5_seal", "6_own_machine"))
    v = {k: q.value for k, q in one.values("Campbell").items()}
    pages.states("1_springs", "91.55 Hz", one.values("pinned")["frequency.1"].value * RPM / 60, "first frequency on pins")
    for k, words in ((1, ("5003.2 rpm", "0.217", "14.5")), (2, ("5137.0 rpm", "0.109", "28.9"))):
        for text, key in zip(words, ("speed", "log_decrement", "amplification_factor")):
            pages.states("1_springs", text, v[f"critical.{k}.{key}"], f"{key} of critical speed {k}")
    v = {k: q.value for k, q in one.values("map").items()}
    pages.states("1_springs", "1602 rpm", v["softest.forward.1"] * RPM, "on soft springs")
    pages.states("1_springs", "5497 rpm", v["stiffest.forward.1"] * RPM, "on stiff springs")

    v = {k: q.value for k, q in two.values("response").items()}
    pages.states("2_unbalance", "66.05 kg", v["unbalance.disc.mass"], "mass")
    pages.states("2_unbalance", "246 g mm", v["unbalance.disc.plane.1"] * 1e6, "unbalance")
    pages.states("2_unbalance", "5133.2 rpm", v["node.11.peak.1.speed"], "peak", 0.1)
    pages.states("2_unbalance", "146.6 µm", v["node.11.peak.1.semi_major"] * 1e6, "height of the peak", 0.01)
    pages.states("2_unbalance", "19.3 µm", v["node.3.peak.1.semi_major"] * 1e6, "height at the journal", 0.01)
    pages.states("2_unbalance", "25.0", v["node.11.peak.1.amplification_factor"], "amplification factor", 0.03)
    pages.states("2_unbalance", "17.2 %", v["node.11.peak.1.separation_margin"] * 100, "margin", 0.01)
    pages.states("2_unbalance", "16.3 %", v["node.11.peak.1.required_margin"] * 100, "required margin", 0.02)
    twice = runs["2_unbalance+"].values("response")["node.11.peak.1.semi_major"].value
    h.true("twice the damping lowers the peak", twice < v["node.11.peak.1.semi_major"])

    v = {k: q.value for k, q in three.values("at service speed").items()}
    pages.states("3_oil_films", "324.0 N", v["load.DE"], "load")
    pages.states("3_oil_films", "11.6 µm", v["bearing.DE.x"] * 1e6, "x of the journal")
    pages.states("3_oil_films", "2.7 µm", -v["bearing.DE.y"] * 1e6, "y of the journal")
    pages.states("3_oil_films", "53.1 µm", v["bearing.DE.min_thickness"] * 1e6, "film thickness")
    pages.states("3_oil_films", "7560.1 rpm", threshold(three), "threshold", 0.02)
    q = three.values("threshold")
    pages.states("3_oil_films", "0.507 of the speed", q["whirl_frequency"].value / q["threshold"].value, "whirl ratio")
    pages.states("3_oil_films", "18.1 %", (threshold(three) / 6400 - 1) * 100, "margin")
    h.true("3_oil_films: the Hopf point is subcritical", bifurcation(three, "threshold", "hopf").get("criticality") == "subcritical")
    h.true("a film on a mesh moves the threshold by 1 %", 0.005 < abs(threshold(runs["3_oil_films+"]) / threshold(three) - 1) < 0.015)

    hopf, fold = bifurcation(four, "whirl", "hopf"), bifurcation(four, "whirl", "cyclic_fold")
    pages.states("4_limit_cycle", "7560.3 rpm", hopf["value"], "Hopf point", 0.01)
    pages.states("4_limit_cycle", "0.24 rpm", hopf.get("reduction_error"), "error of the reduction")
    pages.states("4_limit_cycle", "7309 rpm", fold["value"], "fold", fold.get("uncertainty") or 0)
    h.true("4_limit_cycle: the stable whirl is above the fold", fold.get("stable_side") == "above", str(fold.get("stable_side")))
    branch = four.table("whirl")
    eccentricity, speed = branch["eccentricity_max"].max(axis=1), branch["parameter"]
    near = lambda wanted: min(range(branch.rows), key=lambda k: (abs(speed[k] - wanted), -eccentricity[k]))  # noqa: E731
    pages.states("4_limit_cycle", "0.66", eccentricity[near(fold["value"])], "eccentricity at the fold", 0.01)
    large = max(range(branch.rows), key=lambda k: -abs(speed[k] - 8300))
    pages.states("4_limit_cycle", "0.92", eccentricity[large], "eccentricity at 8300 rpm", 0.006)
    ratio = [60 / (branch["period"][k] * speed[k]) for k in (0, large)]
    pages.states("4_limit_cycle", "0.507", ratio[0], "whirl ratio at birth")
    pages.states("4_limit_cycle", "0.500", ratio[1], "whirl ratio of the large whirl")
    hot = runs["4_limit_cycle+"]
    pages.states("4_limit_cycle", "7369 rpm", bifurcation(hot, "whirl", "hopf")["value"], "threshold in hot oil")
    pages.states("4_limit_cycle", "7219 rpm", bifurcation(hot, "whirl", "cyclic_fold")["value"], "fold in hot oil", 1)

    v = {k: q.value for k, q in five.values("modes").items()}
    pages.states("5_seal", "55.4 Hz", v["at.6400.first_forward.frequency"] * RPM / 60, "first forward mode")
    pages.states("5_seal", "2.05", v["at.6400.first_forward.log_decrement"], "its decrement")
    pages.states("5_seal", "0.40", v["at.6400.least_damped.log_decrement"], "least damped mode")
    margin = next(f for f in five.summary["service_speed"]["facts"] if f["what"].startswith("margin"))
    pages.states("5_seal", "17.0 %", margin["value"], "margin at the service speed")
    sweep = next(c for c in five["clearance"].summary["columns"] if c["name"] == "threshold.threshold")
    for text, found in zip(("7486 rpm", "8122 rpm", "6887 rpm", "6357 rpm"), sweep["values"], strict=True):
        pages.states("5_seal", text, found * RPM, "threshold")
    pages.states("5_seal", "3.262e6 N/m", bifurcation(runs["5_seal+"], "coupling", "hopf")["value"], "cross-coupling at the threshold")

    v = {k: q.value for k, q in (fan.values("place") | fan.values("response")).items()}
    for page in ("6_own_machine", "README"):
        pages.states(page, "1023 N", v["load.fan"], "load of the fan bearing")
        pages.states(page, "54.5 N", v["load.drive"], "load of the drive bearing")
        pages.states(page, "15.9 µm", v["operating.node.1.semi_major"] * 1e6, "vibration of the wheel", 0.1)
        pages.states(page, "3767 +- 3 rpm", threshold(fan), "threshold", 1)
        pages.states(page, "6399 rpm", threshold(runs["lemon"]), "threshold in lemon bores", 3)
        pages.states(page, "38.6 µm", runs["lemon"].values("response")["operating.node.1.semi_major"].value * 1e6, "vibration in lemon bores", 0.1)
    v |= {k: q.value for k, q in fan.values("Campbell").items()}
    for page in ("6_own_machine", "README"):
        pages.states(page, "3560 rpm", v["critical.1.speed"], "critical speed", 0.5)
        pages.states(page, "18.7 %", v["critical.1.separation_margin"] * 100, "margin of the critical speed")
        pages.states(page, "25.6 %", v["critical.1.required_margin"] * 100, "required margin")
    pages.states("6_own_machine", "13.6", v["critical.1.amplification_factor"], "amplification factor")
    pages.states("6_own_machine", "109.9 kg", v["mass.total"], "mass")
    q = fan.values("threshold")
    pages.states("6_own_machine", "0.500 of the speed", q["whirl_frequency"].value / q["threshold"].value, "whirl ratio")
    h.close("6_own_machine: bar of the threshold", q["threshold"].uncertainty * RPM, 3, 1)
    whirl = runs["6_own_whirl"]
    pages.states("6_own_machine", "6394 rpm", bifurcation(whirl, "whirl", "hopf")["value"], "Hopf point on the coarse film")
    pages.states("6_own_machine", "6124 rpm", bifurcation(whirl, "whirl", "cyclic_fold")["value"], "fold on the coarse film", 1)
    end = whirl.table("whirl")
    pages.states("6_own_machine", "0.98", end["eccentricity_max"][-1].max(), "eccentricity at the end")
    pages.states("6_own_machine", "78 µm", end["x_max"][-1].max() * 1e6, "place of the journal at the end")
    pages.states("6_own_machine", "30 µm", end["film_min"][-1].min() * 1e6, "thinnest film at the end")


def examples(h, pages):
    """The deck of the front page is the deck of step 6; the examples in Python run; a wrong deck is refused as the page says."""
    deck = (h.source / "inputs/tutorial/6_own_machine.yaml").read_text(encoding="utf-8")
    shown = re.findall(r"^```yaml\n(.*?)^```$", pages.texts["README"], re.M | re.S)
    h.true("the deck of the front page is 6_own_machine.yaml", deck in shown)
    h.true("it has at most 25 lines", len(deck.splitlines()) <= 25, str(len(deck.splitlines())))
    (h.work / "my_machine.yaml").write_text(deck.replace("clearance: 80 um", "clearance: 80"), encoding="utf-8")
    done = subprocess.run([h.program, "check", "my_machine.yaml"], capture_output=True, text=True)
    h.true("the message of the page", done.returncode == 2 and done.stderr.strip() in pages.texts["6_own_machine"], done.stderr)
    blocks = [b for t in pages.texts.values() for b in re.findall(r"^```python\n(.*?)^```$", t, re.M | re.S)]
    h.true("there is an example", len(blocks) >= 1)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in blocks:
            exec(compile(block, "tutorial", "exec"), {})
    h.true("it prints the threshold", printed.getvalue().startswith("3767 rpm"), printed.getvalue())


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    sys.path.insert(0, str(harness.source / "scripts"))
    all_pages = Pages(harness)
    results = run_commands(harness, all_pages)
    check(harness, all_pages, results)
    examples(harness, all_pages)
    os.chdir("/")
    harness.finish()
