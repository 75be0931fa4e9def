#!/usr/bin/env python3
"""Runs the examples of docs/python.md one after the other:  page_test.py PROGRAM"""
import os
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
os.environ["WHIRL_PROGRAM"] = str(pathlib.Path(sys.argv[1]).resolve())
blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / "docs" / "python.md").read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
assert len(blocks) >= 6, "the page has lost its examples"
with tempfile.TemporaryDirectory() as name:
    os.symlink(ROOT / "inputs", f"{name}/inputs")
    os.chdir(name)
    known = {}
    for block in blocks:
        print("-" * 20, block, sep="\n", flush=True)
        exec(compile(block, "docs/python.md", "exec"), known)
    # What the page says: Hopf point of the short bearings at F0* = 1, 2.7353 of 160 rad/s (independent value, see the gallery).
    assert abs(known["threshold"].value / 160 - 2.7353) < 1e-4, known["threshold"]
    # Four times the load doubles Omega_0 = sqrt(F/(m c)) and F0*: the last run is that of F0* = 2.
    assert abs(known["run"].values("b")["threshold"].value / 320 - 2.6712) < 1e-4
    # The option of the page is one that the program asks for: a loose tolerance is refused.
    (option,) = known["strict"].summary["options"]
    assert (option["name"], option["value"], option["source"]) == ("-newton_snes_rtol", "1e-20", "command line"), option
    words = {"studies": "[{equilibrium_branch: {name: balanced, parameter: speed, range: {from: 80 rad/s, to: 640 rad/s}}}]"}
    try:
        known["whirl"].run("inputs/rigid_rotor/figure_5_2.yaml", set=words, output="loose", options=["--", option["name"], "0.5"])
    except known["whirl"].RunError as error:
        assert error.code == 2 and "less accurate" in str(error), error
    else:
        raise AssertionError("a loose tolerance was taken")
    first = [r.table("balanced")["y"][0, 0] for r in (known["strict"], known["results"])]
    assert abs(first[1] / first[0] - 1) < 1e-6, first
    # A run that fails says so.
    try:
        known["whirl"].run("inputs/rigid_rotor/figure_5_2.yaml", set={"rotor.mass": "3 N"}, output="wrong")
    except known["whirl"].RunError as error:
        assert error.code == 2 and "mass" in str(error), error
    else:
        sys.exit("a wrong value was taken")
print("the page is right")
