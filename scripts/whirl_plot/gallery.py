"""Runs decks and puts their pictures into docs/: gallery.py [PICTURE...], in the root of the sources."""
import pathlib
import shutil
import subprocess
import sys

# Name of a run: deck, overrides.
RUNS = {
    "unbalance": ("turbine_train/unbalance.yaml", []),
    "response": ("turbine_train/response.yaml", []),
    "self_excited": ("turbine_train/self_excited.yaml", []),
    "train_run_up": ("turbine_train/run_up.yaml", []),
    **{f: (f"rigid_rotor/{f}.yaml", []) for f in ("figure_5_2", "figure_5_3", "figure_5_4", "figure_5_5", "figure_5_6", "figure_4_7",
                                                 "figure_2_2", "figure_2_2_chaos", "run_up", "loci")},
    **{f: (f"compliant_rotor/{f}.yaml", []) for f in ("figure_5_7", "figure_5_8", "figure_5_9", "figure_4_10", "figure_4_13",
                                                     "figure_5_13", "figure_5_13_sweep", "finite_curve")},
    "chart_load": ("rigid_rotor/stability_chart.yaml", []),
    "chart_compliance": ("compliant_rotor/stability_chart.yaml", []),
    "figure_5_10": ("compliant_rotor/figure_5_10.yaml", ["bearings.half.film.compliance=1"]),
    "brusselator": ("other_systems/brusselator.yaml", []),
    **{f"tutorial/{f}": (f"tutorial/{f}.yaml", []) for f in ("1_springs", "2_unbalance", "3_oil_films", "4_limit_cycle", "5_seal", "6_own_whirl")},
}
# Picture of docs/: run and picture in its results.
PICTURES = {
    "bifurcations": ("unbalance", "bifurcations"),
    "train_orbits": ("unbalance", "G2.5.orbits"),
    "train_response": ("response", "generator_pair_G2.5.response1"),
    "train_whirl": ("self_excited", "whirl.cycles-vertical"),
    "train_run_up": ("train_run_up", "run-up"),
    "rigid_5_3": ("figure_5_3", "whirl.frequency"),
    **{f"rigid_5_{k}": (f"figure_5_{k}", "eccentricity") for k in (2, 4, 5, 6)},
    **{f"compliant_5_{k}": (f"figure_5_{k}", "eccentricity") for k in (7, 8, 9, 10)},
    "compliant_5_13": ("figure_5_13", "synchronous.cycles-horizontal"),
    "compliant_5_13_sweep": ("figure_5_13_sweep", "run-up"),
    "compliant_finite": ("finite_curve", "eccentricity"),
    "map_4_3": ("figure_4_7", "short.impedance"),
    "map_4_4": ("figure_4_7", "finite.impedance"),
    "map_4_6": ("figure_4_10", "map-pressure"),
    "map_4_7": ("figure_4_7", "map-locus"),
    "map_4_8": ("figure_4_7", "map-stiffness"),
    "map_4_9": ("figure_4_7", "map-damping"),
    "map_4_10": ("figure_4_10", "map-locus"),
    "map_4_11": ("figure_4_10", "map-stiffness"),
    "map_4_12": ("figure_4_10", "map-damping"),
    "map_4_13": ("figure_4_13", "map-locus"),
    "map_4_14": ("figure_4_13", "map-stiffness"),
    "map_4_15": ("figure_4_13", "map-damping"),
    "motion_period_2": ("figure_2_2", "period_2.motion"),
    "motion_quasi_periodic": ("figure_2_2", "quasi-periodic.motion"),
    "motion_chaotic": ("figure_2_2_chaos", "chaotic.motion"),
    "run_up": ("run_up", "run-up"),
    "loci": ("loci", "loci"),
    "chart_load": ("chart_load", "loci"),
    "chart_compliance": ("chart_compliance", "loci"),
    "brusselator": ("brusselator", "oscillation.orbits"),
    "tutorial/1_springs": ("tutorial/1_springs", "Campbell.campbell"),
    "tutorial/2_unbalance": ("tutorial/2_unbalance", "response.response"),
    "tutorial/3_oil_films": ("tutorial/3_oil_films", "threshold.equilibria"),
    "tutorial/4_limit_cycle": ("tutorial/4_limit_cycle", "bifurcations"),
    "tutorial/5_seal": ("tutorial/5_seal", "clearance.threshold"),
    "tutorial/6_own_machine": ("tutorial/6_own_whirl", "whirl.cycles-vertical"),
}


def results(run):
    """The folder of a run with its pictures, computed unless it is there."""
    deck, overrides = RUNS[run]
    out = pathlib.Path("results/gallery") / run
    words = ["build/whirl", "run", f"inputs/{deck}", "-o", str(out), "--resume"]
    for o in overrides:
        words += ["--set", o]
    # A branch that ended early still has a picture, and its title says so.
    done = subprocess.run(words, stdout=subprocess.DEVNULL)
    if done.returncode not in (0, 3):
        sys.exit(f"gallery: {deck}: exit {done.returncode}")
    subprocess.run(["scripts/plot", str(out)], stdout=subprocess.DEVNULL, check=True)
    return out


def main(names):
    unknown = [n for n in names if n not in PICTURES]
    if unknown:
        sys.exit(f"gallery: there is no picture {', '.join(unknown)}; there are {', '.join(sorted(PICTURES))}")
    folders = {}
    for name in names or PICTURES:
        run, picture = PICTURES[name]
        if run not in folders:
            folders[run] = results(run)
        target = pathlib.Path("docs") / f"{name}.png"
        shutil.copyfile(folders[run] / f"{picture}.png", target)
        print(f"{target}: {target.stat().st_size / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
