#!/usr/bin/env python3
"""The page of the design studies: how its tables read numbers, and that its command makes all that stands there."""
import pathlib
import re
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from whirl_plot import design_page, design_pictures  # noqa: E402


def branch(parameter, stable, bifurcations=(), status="completed", values=None):
    group = {"branch/parameter": np.array(parameter, float), "branch/stable": np.array(stable, float)}
    return design_page.Study({"status": status, "bifurcations": list(bifurcations), "values": values or {}}, group)


def event(kind, value, bar=10.0, others=0, side="undetermined"):
    return {"type": kind, "value": value, "uncertainty": bar, "others_unstable": others, "criticality": side}


def whole_page():
    """Every table and every picture of the page is made by the command, and the command makes no other."""
    page = design_page.PAGE.name
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    assert sorted(re.findall(r"<!-- table (\w+) -->", text)) == sorted(design_page.TABLES)
    assert sorted(re.findall(r"!\[[^]]+\]\((\w+)\.png\)", text)) == sorted(design_pictures.PICTURES)
    assert all((ROOT / "docs" / f"{name}.png").exists() for name in design_pictures.PICTURES)
    assert {run for run, *_ in design_pictures.PICTURES.values()} <= set(design_page.RUNS)


def edited_meanwhile():
    """What was written into the page during the computation stays."""
    real = design_page.PAGE, design_page.TABLES
    with tempfile.TemporaryDirectory() as name:
        page = pathlib.Path(name) / "page.md"
        page.write_text("old words\n<!-- table one -->\nold\n<!-- end -->\n")

        def one():
            page.write_text(page.read_text().replace("old words", "new words"))
            return "new"
        design_page.PAGE, design_page.TABLES = page, {"one": one}
        try:
            design_page.main(["one"])
        finally:
            design_page.PAGE, design_page.TABLES = real
        assert page.read_text() == "new words\n<!-- table one -->\nnew\n<!-- end -->\n", page.read_text()


def verdicts():
    """A bar that contains the threshold leaves a statement open."""
    assert design_page.rises((20, 10)) == "yes" and design_page.rises((5, 10)) == "open" and design_page.rises((-20, 10), (30, 1)) == "no"
    assert design_page.falls((-20, 10)) == "yes" and design_page.falls((20, 10)) == "no"
    assert design_page.stays((240, 9)) == "yes" and design_page.stays((240, 20)) == "open" and design_page.stays((-300, 20), (0, 1)) == "no"
    assert design_page.where(event("hopf", 5010.8, 38.3)) == "5011 ± 38" and design_page.where(event("flip", 3486.84, 0.02)) == "3486.8 ± 0.1"


def branches():
    """Where branches are stable, where they lose it for the last time, and where whirl ends."""
    lost = [event("neimark_sacker", 2600), event("neimark_sacker", 2700), event("flip", 3700, 3.0), event("neimark_sacker", 5000, others=2)]
    assert design_page.upper(branch([1500, 2650, 3000, 8000], [1, 0, 1, 0], lost)) == "3700 ± 3 (flip)"
    assert design_page.upper(branch([1500, 8000], [1, 1])) == "8000 and more"
    assert design_page.upper(branch([1500, 7200.4], [1, 1])) == "7200, where the branch ends"
    events = [event("hopf", 5011, 38), event("cyclic_fold", 5011.03), event("cyclic_fold", 5059, 29), event("cyclic_fold", 4996, 27)]
    told = "ended at 5192.71 rpm: film of bearing B1 falls below 0.09 um (minimum_film)"
    whirl = branch([5012, 5011.5, 5058, 5050, 4997, 4998, 5190], [1, 0, 1, 0, 0, 1, 1], events, told, {"contact": {"value": 5192.71, "uncertainty": 12.0}})
    assert design_page.stretches(whirl) == "5011 to 5058; 4998 to 5190"
    assert design_page.listed(design_page.apart_from_birth(whirl)) == "5059 ± 29, 4996 ± 27"
    assert design_page.ending(whirl) == "contact at 5193 ± 12: film of bearing 1 below 0.09 um"
    assert design_page.ending(branch([1, 2], [1, 1], status="stopped")) == "stopped"


for check in (whole_page, edited_meanwhile, verdicts, branches):
    check()
print("the page of the design studies reads its results")
