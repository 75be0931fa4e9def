#!/usr/bin/env python3
"""Prints a table of the located bifurcations of a rigid rotor: published, reference, and this program's, by running the decks.

validate.py PROGRAM SOURCE [FIGURE...]      figures as in the names of the decks, 5_2 to 5_10; all if none is named
"""
import sys

import compliant
import rigid
from harness import Harness

# What van de Vrande (2001) prints, in the order of the reference values of each study; - where it gives none.
PRINTED = {
    ("5_2", "", "balanced"): ["2.7353"], ("5_2", "", "whirl"): ["2.74", "2.61"], ("5_2", "", "a1"): ["2.47", "3.41"],
    ("5_2", "", "a1 flip 1"): ["-", "18.8"], ("5_2", "", "a1 flip 2"): ["-"], ("5_2", "", "a2"): ["2.87", "5.76"], ("5_2", "", "a2 flip 1"): ["19.8"],
    ("5_2", "", "a3"): ["10.4"],
    ("5_4", "", "balanced"): ["2.7563"], ("5_4", "", "whirl"): ["2.76", "-"], ("5_4", "", "a1"): ["2.47", "3.81"],
    ("5_4", "", "a1 flip 1"): ["-", "23.2"], ("5_4", "", "a1 flip 2"): ["-"], ("5_4", "", "a2"): ["8.88", "10.1"], ("5_4", "", "a2 flip 1"): ["13.8"],
    ("5_4", "", "a3"): ["20.7"],
    ("5_5", "", "balanced"): ["2.6712"], ("5_5", "", "whirl"): ["2.67", "-", "-"], ("5_5", "", "a1"): ["2.49", "3.11"],
    ("5_5", "", "a1 flip 1"): ["2.45", "15.6"], ("5_5", "", "a1 flip 2"): ["3.14", "-"], ("5_5", "", "a2"): ["2.40", "3.96"],
    ("5_5", "", "a2 flip 1"): ["13.8"], ("5_5", "", "a3"): ["4.70", "6.37"], ("5_5", "", "a3 flip 1"): ["9.63"],
    ("5_6", "", "balanced"): ["1.9594 [1]"], ("5_6", "", "whirl"): ["1.97"], ("5_6", "", "a1"): ["1.84", "2.20"],
    ("5_6", "", "a1 flip 1"): ["16.3"], ("5_6", "", "a2"): ["1.76", "2.76"], ("5_6", "", "a2 flip 1"): ["9.08"],
    ("5_6", "", "a3"): ["1.76", "3.81"], ("5_6", "", "a3 flip 1"): ["4.12"],
    ("5_7", "0.01", "balanced"): ["2.72"], ("5_7", "0.01", "whirl"): ["2.72", "2.62"],
    ("5_7", "0.1", "balanced"): ["2.71"], ("5_7", "0.1", "whirl"): ["2.71", "2.72", "2.50"],
    ("5_7", "1", "balanced"): ["2.22"], ("5_7", "1", "whirl"): ["2.22", "1.97"],
    ("5_8", "0.01", "a2"): ["3.02 [2]", "5.88"], ("5_8", "0.01", "a2 flip 1"): ["9.06"],
    ("5_8", "0.1", "a2"): ["4.31 [2]", "5.95"], ("5_8", "0.1", "a2 flip 2"): ["6.87 [5]"],
    ("5_8", "1", "a2"): ["2.36", "3.10"], ("5_8", "1", "a2 flip 1"): ["2.61"],
    ("5_9", "0", "balanced"): ["0.405 [3]"], ("5_9", "0.01", "balanced"): ["0.413"], ("5_9", "0.1", "balanced"): ["0.494 [4]"],
    ("5_9", "0.1", "whirl"): ["0.494 [4]"],
    ("5_9", "1", "balanced"): ["1.10"],
    ("5_10", "0.01", "a2"): ["0.414 [2]"], ("5_10", "0.1", "a2"): ["0.507"], ("5_10", "1", "a2"): ["1.16"],
}
# Estimates are differences of cycles at whose residuals of 1e-9 Newton's method stops: no value is known better than that,
# relatively, even where a difference happens to vanish.
FLOOR = 1e-9
WORDS = {"hopf": "Hopf", "cyclic_fold": "cyclic fold", "flip": "flip", "neimark_sacker": "Neimark-Sacker"}


def rows(h, figure, compliance, deck, overrides, wanted):
    # A branch that delivers nothing leaves the others of its deck as they are.
    run = h.run((h.source / "inputs" / deck).resolve(), f"{figure}_{compliance}", overrides, code=None)
    for name, points in wanted.items():
        printed = PRINTED.get((figure, compliance, name))
        if not printed:
            continue
        for text, (kind, reference, *_) in zip(printed, points, strict=True):
            b = compliant.nearest(run[name], kind, reference)
            found, error = b.get("nondimensional_speed"), b.get("uncertainty")
            here = "-" if found is None else f"{found:.6g}"
            if found is not None and error is not None:
                here += f" \u00b1 {max(error * found / b['value'], FLOOR * found):.1g}"
            case = f"B = {compliance}, {name}" if compliance else name
            print(f"| {figure.replace('_', '.')} | {case} | {WORDS[kind]} | {text} | {reference:.9g} | {here} |", flush=True)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], [])
    asked = sys.argv[3:]
    print("| figure | branch | point | printed | reference | Whirl |\n|---|---|---|---|---|---|")
    for figure, wanted in rigid.FIGURES.items():
        if not asked or figure in asked:
            rows(harness, figure, "", f"rigid_rotor/figure_{figure}.yaml", [], wanted)
    for (figure, compliance), (overrides, wanted) in compliant.CASES.items():
        if (not asked or figure in asked) and any((figure, compliance, name) in PRINTED for name in wanted):
            rows(harness, figure, compliance, compliant.deck_of(figure), overrides, wanted)
