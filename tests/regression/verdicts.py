#!/usr/bin/env python3
"""What branches of the train conclude.

verdicts.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]

beyond: a range that begins beyond the threshold says so. clearance: the curve of the threshold over the clearance of
bearing 4 is no border of stability where a branch at that clearance finds another mode unstable before it.
criticality: the balanced train begins to whirl supercritically on every film mesh.
neimark_sacker: so does the train with G6.3 at 2580 rpm, which differences as short as the mesh had called super- or
subcritical by chance.
"""
import sys

from harness import GUYAN, Harness, value

COARSE = ["bearings.B%d.film.cells=[60, 12]" % b for b in range(1, 6)]


def beyond(h):
    """The threshold of the balanced train is at 5021 rpm (reference 5025 +- 16)."""
    s = h.run("balanced.yaml", "beyond",
              [*GUYAN, *COARSE, "studies.1.equilibrium_branch.range={from: 5200 rpm, to: 6000 rpm}"])["balanced"]
    h.true("unstable throughout", s["stability"] == "unstable throughout", s["stability"])
    h.true("no threshold", "threshold" not in s["values"])
    h.true("its Hopf point has others", s["bifurcations"] and s["bifurcations"][0]["others_unstable"] == 2)


def clearance(h):
    """Over the clearance of bearing 4, 300 um in the deck."""
    deck = h.work / "curve.yaml"
    deck.write_text(f"""
base: {h.train / "balanced.yaml"}
studies:
  - equilibrium_branch: {{name: branch, parameter: speed, range: {{from: 4500 rpm, to: 5400 rpm}}}}
  - locus:
      name: curve
      of: branch
      parameter: bearings.B4.geometry.clearance
      range: {{from: 280 um, to: 360 um}}
      first_range: {{from: 3000 rpm, to: 7000 rpm}}
""")
    s = h.run(deck, "curve", [*GUYAN, *COARSE])["curve"]
    end = h.run("balanced.yaml", "end", [*GUYAN, *COARSE, "bearings.B4.geometry.clearance=360 um",
                                         "studies.1.equilibrium_branch.range={from: 5000 rpm, to: 6000 rpm}"])["balanced"]
    curve = {name: column["values"] for name, column in s["curve"].items()}
    h.close("the curve reaches 360 um", curve["second"][-1], 360, 1e-9)
    first, others = end["bifurcations"][0], [b for b in end["bifurcations"] if b["others_unstable"] == 2]
    h.true("the branch at 360 um is stable up to another mode's threshold", first["others_unstable"] == 0)
    h.true("and meets the curve beyond it", bool(others))
    if others:
        h.close("where the curve says", curve["parameter"][-1], others[0]["value"], 1e-3)
        h.true("behind the threshold", others[0]["value"] > first["value"])
    h.close("threshold at 360 um [rad/s]", value(end, "threshold"), first["value"] * 3.14159265358979 / 30, 1e-6)
    h.true("the curve is marked there", curve["others_unstable"][-1] == 2 and s.get("warnings"), str(s.get("warnings")))
    nominal = min(range(len(curve["second"])), key=lambda k: abs(curve["second"][k] - 300))
    h.true("and not at 300 um", curve["others_unstable"][nominal] == 0)


def criticality(h):
    """Cycles of first harmonics of 0.10, 0.20, 0.25 clearances lie 11.0, 37.3, 45.1 rpm above the Hopf point (reference)."""
    found = []
    for cells in ([60, 12], [90, 18]):
        s = h.run("balanced.yaml", f"cells {cells[0]}",
                  [*GUYAN, *(f"bearings.B{b}.film.cells={cells}" for b in range(1, 6)),
                   "studies.1.equilibrium_branch.range={from: 4700 rpm, to: 5300 rpm}"])["balanced"]
        b = s["bifurcations"][0]
        h.true(f"{cells}: decided by cycles", b["criticality_by"].startswith("cycles at"), b["criticality_by"])
        h.true(f"{cells}: supercritical", b["criticality"] == "supercritical", str(b))
        found.append(b)
    a, b = found
    h.close("one curvature [rpm per clearance^2]", a["criticality_coefficient"], b["criticality_coefficient"],
            a["criticality_uncertainty"] + b["criticality_uncertainty"])


def neimark_sacker(h):
    found = []
    for cells in ([40, 12], [60, 16]):
        s = h.run("unbalance.yaml", f"cells {cells[0]}",
                  [*(f"bearings.B{b}.film.cells={cells}" for b in range(1, 6)),
                   "studies=[{cycle_branch: {name: G6.3, unbalance: [gen_pair_g63], parameter: speed, intervals: 60, "
                   "range: {from: 2540 rpm, to: 2600 rpm}}}]"])["G6.3"]
        h.true(f"{cells}: one point, supercritical", len(s["bifurcations"]) == 1
               and s["bifurcations"][0]["criticality"] == "supercritical", str(s["bifurcations"]))
        found += s["bifurcations"][:1]
    a, b = found
    h.close("one coefficient", a["criticality_coefficient"], b["criticality_coefficient"],
            a["criticality_uncertainty"] + b["criticality_uncertainty"])


def main():
    h = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"beyond": beyond, "clearance": clearance, "criticality": criticality,
     "neimark_sacker": neimark_sacker}[sys.argv[3]](h)
    h.finish()


if __name__ == "__main__":
    main()
