#!/usr/bin/env python3
"""Draws synthetic results and checks that every picture came, is not blank, and that gaps in the data cost only their own picture."""
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
from html.parser import HTMLParser

import h5py
import numpy as np
from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import command  # noqa: E402
import synthetic  # noqa: E402

ROOT = pathlib.Path(__file__).parents[2]
EXPECTED = {
    "at_service_speed": ["sag", "journals", "film-B1", "film-B3"],
    "modes": ["campbell", "shapes", "shapes-3d"],
    "generator_pair": ["response", "response-bearings"],
    "balanced": ["equilibria", "locus"],
    "pair_G2.5": ["cycles-vertical", "cycles-horizontal", "orbits", "multipliers"],
    "pair_G6.3": ["cycles-vertical", "cycles-horizontal", "orbits", "multipliers"],
    "hard": ["impedance"],
    "soft": ["frequencies"],
    "period_two": ["motion", "history"],
    "through": ["waterfall", "orders"],
    "hot": ["thd-maps", "thd-velocity", "thd-fluid", "thd-heat", "thd-profiles", "thd-film", "thd-radial", "thd-axial", "thd-axial-orifice", "thd-iterations", "thd-meshes", "thd-budget", "thd-effective", "thd-properties"],
    "clearances": ["trends", "balanced"],
}
TOGETHER = ["bifurcations", "map-locus", "map-stiffness", "map-damping", "map-stability", "map-pressure"]


def run(script, *words):
    return subprocess.run([str(ROOT / "scripts" / script), *map(str, words)], capture_output=True, text=True)


def check(condition, what):
    if not condition:
        sys.exit(f"FAILED: {what}")


def check_picture(path):
    drawing = path.with_suffix(".svg")
    check(drawing.is_file() and drawing.stat().st_size < 700_000, f"{drawing.name} is missing or large")
    check(xml.etree.ElementTree.parse(drawing).getroot().tag.endswith("svg"), f"{drawing.name} is no SVG")
    check_pixels(path)


def check_pixels(path):
    check(path.is_file(), f"{path.name} is missing")
    image = Image.open(path)
    # Fields have all colours, lines few.
    field = any(word in path.stem for word in ("film-", "thd-maps", "thd-velocity", "thd-fluid", "thd-heat", "thd-film", "thd-radial", "thd-axial"))
    check(image.mode == ("RGB" if field else "P") and image.width >= 1000, f"{path.name} is small or of other colours: {image}")
    check(np.mean(np.any(np.asarray(image.convert("RGB")) < 230, axis=-1)) > 0.01, f"{path.name} is blank")


class Page(HTMLParser):
    def __init__(self):
        super().__init__()
        self.images, self.links, self.text = 0, [], ""

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("src", "href") and not value.startswith(("data:", "#")):
                self.links.append(value)
        self.images += tag == "img"

    def handle_data(self, data):
        self.text += data


with tempfile.TemporaryDirectory() as name:
    whole = pathlib.Path(name) / "whole"
    synthetic.make(whole)
    done = run("plot", whole, "--formats", "png,svg")
    check(done.returncode == 0 and not done.stderr, f"plot said {done.returncode}\n{done.stderr}")
    for study, pictures in EXPECTED.items():
        for picture in pictures:
            check_picture(whole / f"{study}.{picture}.png")
    for picture in TOGETHER:
        check_picture(whole / f"{picture}.png")
    made = sorted(str(p) for k in ("*.png", "*.svg") for p in whole.glob(k))
    check(sorted(done.stdout.split("\n")[:-1]) == made, "plot does not name each file once")
    listed = (whole / "manifest.txt").read_text().splitlines()
    check(sorted(str(whole / n) for n in listed if n not in synthetic.FILES) == made, "the manifest does not name each file once")

    done = run("report", whole)
    check(done.returncode == 0, f"report said {done.returncode}\n{done.stderr}")
    page = Page()
    page.feed((whole / "report.html").read_text())
    check(page.images == len(list(whole.glob("*.png"))), f"the report has {page.images} pictures")
    check(not page.links, f"the report needs {page.links}")
    check("report.html" in (whole / "manifest.txt").read_text().splitlines(), "the manifest does not name the report")
    for words in ("42.166 t", "Hopf point", "5025 \u00b1 12", "<A & B>", "counter-clockwise", "213.4"):
        check(words in page.text, f"the report does not say {words}")

    # A run that ended early: no summary, a study without points, one with a single point, one of an unknown kind. All figures are made,
    # the one of a single point is drawn.
    part = pathlib.Path(name) / "part"
    synthetic.make(part)
    (part / "summary.json").unlink()
    with h5py.File(part / "results.h5", "a") as root:
        for table in ("branch", "bifurcations", "orbits"):
            del root["studies/pair, G6.3"][table]
        branch = root["studies/balanced/branch"]
        for column in list(branch):
            first = branch[column][:1]
            del branch[column]
            branch[column] = first
        root["studies/balanced/branch/stable"][...] = 1
        del root["studies/balanced/bifurcations"]
        del root["studies/hot/film"]
        root.create_group("studies/unknown").attrs["kind"] = "of the future"
    done = command.call("plot", part, "--formats", "png", draw={"balanced.equilibria"})
    check(done.returncode == 0 and not done.stderr, f"plot of an early end said {done.returncode}\n{done.stderr}")
    check_pixels(part / "balanced.equilibria.png")
    check(not (part / "pair_G6.3.orbits.png").exists(), "a picture of nothing")
    check(not list(part.glob("hot.thd-[fv]*")) and (part / "hot.thd-iterations.png").exists(), "pictures of a film that was not stored")
    check(len(done.stdout.splitlines()) > 25 and (part / "modes.campbell.png").exists(), f"few pictures of an early end:\n{done.stdout}")
    done = command.call("report", part)
    check(done.returncode == 0, f"the report needs summary.json\n{done.stderr}")

    few = pathlib.Path(name) / "few"
    synthetic.make(few)
    with h5py.File(few / "results.h5", "a") as root:
        for study in set(root["studies"]) - {"period two"}:
            del root["studies"][study]
    listed = ""
    for time, draw in (("", run), (" again", command.call)):
        done = draw("plot", few, "--formats", "png")
        check(done.returncode == 0 and list(few.glob("*.png")) and not list(few.glob("*.svg")), f"--formats png{time}")
        now = (few / "manifest.txt").read_text()
        check(not time or now == listed, "drawing again changes the manifest")
        listed = now
print("all pictures are there")
