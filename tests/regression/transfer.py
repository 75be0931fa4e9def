#!/usr/bin/env python3
"""Runs branches of equilibria of rotors in films with states, with eigenvalues of the whole pencil and from transfer functions.

transfer.py PROGRAM SOURCE CASE [LAUNCHER WORDS...]

The Hopf points must be the same, on any number of ranks too, and nothing may be missed without a warning.
"""
import sys

from harness import RANKS, Harness, value

TRANSFER = ["--", "-modes_by", "transfer"]


def branch(where):
    low, high = where
    return f"studies=[{{equilibrium_branch: {{name: balanced, parameter: speed, range: {{from: {low} rad/s, to: {high} rad/s}}}}}}]"


# Deck, range about its Hopf point [rad/s], overrides.
CASES = {
    "short": ("compliant_rotor/short.yaml", (400, 480), []),
    "long": ("compliant_rotor/long.yaml", (140, 180), []),
    "finite": ("compliant_rotor/finite.yaml", (370, 430), ["bearings.half.film.cells=[24, 6]"]),
    "water": ("compliant_rotor/water_bearing.yaml", (400, 470), ["bearings.*.film.cells=[40, 4]"]),
    "damped": ("compliant_rotor/short.yaml", (380, 640), ["bearings.half.film.liner_damping=0.1 ms", "bearings.half.film.cells=[40, 4]"]),
    "conserving": ("rigid_rotor/mass_conserving.yaml", (400, 480),
                   ["bearings.*.film.cells=[24, 4]", "bearings.*.film.grooves.1.pressure=2 kPa"]),
}


def compare(h, name, a, b, within):
    h.true(f"{name}: as many points", a["points"] == b["points"], f"{a['points']} {b['points']}")
    h.true(f"{name}: no warnings", not b.get("warnings"), str(b.get("warnings")))
    kinds = [[e["type"] for e in s["bifurcations"]] for s in (a, b)]
    h.true(f"{name}: a Hopf point both ways", kinds[0] == kinds[1] and "hopf" in kinds[0], str(kinds))
    for e, f in zip(a["bifurcations"], b["bifurcations"]):
        h.close(f"{name}: {e['type']}", f["value"], e["value"], within * e["value"])
        h.close(f"{name}: its period", f["period_s"], e["period_s"], within * e["period_s"])


def both_ways(h):
    for name, (deck, where, more) in CASES.items():
        at = h.source / "inputs" / deck
        whole = h.run(at, f"{name}_whole", [branch(where), *more])["balanced"]
        transfer = h.run(at, f"{name}_transfer", [branch(where), *more], flags=TRANSFER)["balanced"]
        compare(h, name, whole, transfer, 1e-9)
    searched(h)


def searched(h):
    """Modes say where they were looked for, and what the rotor takes part in is the same both ways."""
    deck, _, more = CASES["conserving"]
    modes = ["studies=[{modes: {name: modes, speeds: [420 rad/s], count: 4, max_frequency: 400 rad/s}}]", *more]
    whole, transfer = (h.run(h.source / "inputs" / deck, f"modes_{len(flags)}", modes, flags=flags)["modes"] for flags in ([], TRANSFER))
    h.true("the whole pencil has no region", value(whole, "search.frequency") is None)
    h.close("the region reaches beyond the modes wanted [rad/s]", value(transfer, "search.frequency"), 400 / 0.94, 1e-9)
    h.close("and half as far to the left", value(transfer, "search.decay"), 200 / 0.94, 1e-9)
    h.close("none is missed", value(transfer, "search.missed"), 0, 0)
    h.true("those found are counted", value(transfer, "search.counted") >= 2 * len(transfer["modes"]) > 0)
    least = [m for m in whole["modes"] if m["real"] > -200 / 0.94 / 2]
    h.true("both ways have modes near the axis", len(least) > 0)
    for m in least:
        same = min(transfer["modes"], key=lambda n: abs(n["real"] - m["real"]) + abs(n["imag"] - m["imag"]))
        for what in ("real", "imag", "participation"):
            h.close(f"{what} of the mode at {m['imag']:.0f} rad/s", same[what], m[what], 1e-6 * max(1, abs(m["imag"])))
        h.true("the rotor takes part", m["participation"] > 1e-3)


def missed(h):
    """Each place of a damped liner has an eigenvalue near -1/tau that the journal hardly sees: counted, not found, said."""
    s = h.run(h.source / "inputs/compliant_rotor/short.yaml", "missed",
              [branch((400, 420)), "bearings.half.film.liner_damping=3 ms", "bearings.half.film.cells=[40, 4]"], flags=TRANSFER)["balanced"]
    h.true("what the count has more is said", (value(s, "missed_eigenvalues") or 0) > 0, str(value(s, "missed_eigenvalues")))
    h.true("and warned of", any("missed" in w for w in s.get("warnings", [])), str(s.get("warnings")))


def ranks(h):
    deck, where, more = CASES["finite"]
    runs = [h.run(h.source / "inputs" / deck, f"ranks_{n}", [branch(where), *more, "layout.machine=all_ranks"], flags=TRANSFER,
                  launcher=[*h.launcher, "-n", str(n)])["balanced"] for n in RANKS]
    for n, s in enumerate(runs[1:], 2):
        h.true(f"{n} ranks share one machine", s["layout"] == f"one machine on {n} ranks (by the deck)", s["layout"])
        compare(h, f"{n} ranks", runs[0], s, 1e-8)


if __name__ == "__main__":
    harness = Harness(sys.argv[1], sys.argv[2], sys.argv[4:])
    {"both_ways": both_ways, "missed": missed, "ranks": ranks}[sys.argv[3]](harness)
    harness.finish()
