"""Draws every picture that a results folder has data for:  scripts/plot DIR [--formats png,svg,pdf]"""
import argparse
import importlib
import pathlib
import sys

import whirl

from . import style
from .subject import Drawn, called, said_in_a_sentence

# Which pictures a kind of study gets, in the order of the report: functions of modules, which are imported for what there is.
PICTURES = {
    "static": ["shapes.draw_sag", "orbits.draw_positions", "film.draw"],
    "alignment": ["shapes.draw_sag"],
    "bearing_map": ["bearing_map.draw_impedance", "bearing_map.draw_frequencies"],
    "gas_bearing": ["gas.draw_curves", "gas.draw_isobars", "gas.draw_meshes", "gas.draw_map"],
    "dynamic_coefficients": ["dynamic.draw", "enforced.draw"],
    "modes": ["campbell.draw", "shapes.draw_modes", "whirl_map.draw", "line.draw"],
    "critical_speed_map": ["critical.draw_map"],
    "element_convergence": ["elements.draw_errors", "elements.draw_shifts", "elements.draw_conditions"],
    "frequency_response": ["transfer.draw"],
    "reduction_errors": ["reductions.draw_errors", "reductions.draw_orbits", "reductions.draw_maps"],
    "unbalance_response": ["response.draw"],
    "equilibrium_branch": ["bifurcation.draw_equilibria", "orbits.draw_locus"],
    "cycle_branch": ["bifurcation.draw_cycles", "bifurcation.draw_frequency", "orbits.draw", "orbits.draw_harmonics", "multipliers.draw"],
    "linearity": ["linearity.draw_transfer", "linearity.draw_coherence", "linearity.draw_excitation"],
    "motion": ["motion.draw", "motion.draw_history", "motion.draw_full_spectrum", "orders.draw_waterfall", "orders.draw_orders"],
    "run_up": ["orders.draw_waterfall", "orders.draw_orders"],
    "thd": ["thd_maps.draw_maps", "thd_maps.draw_velocity", "thd_maps.draw_fluid", "thd_maps.draw_heat", "thd_cuts.draw_profiles", "thd_sections.draw_film", "thd_cuts.draw_radial",
            "thd_cuts.draw_axial", "thd_sections.draw_axial", "thd.draw_iterations", "thd.draw_meshes", "thd.draw_budget", "thd_compare.draw_effective", "thd_compare.draw_properties"],
    "locus": [], "mesh_convergence": [],
    "sweep": ["sweep.draw_trends", "sweep.draw_at_rest", "sweep.draw_branches", "sweep.draw_response", "sweep.draw_stability_factors", "sweep.draw_films", "sweep.draw_coefficients"],
}
OTHERS = ["columns.draw"]  # of kinds that are not in the list
TOGETHER = ["machine.draw", "gas.draw_knudsen", "bifurcation.draw_together", "eccentricity.draw", "bearing_map.draw_together", "locus.draw_together", "run_up.draw_together"]


def function(name):
    module, what = name.split(".")
    return getattr(importlib.import_module(f"{__package__}.{module}"), what)


def drawn(results, command="plot"):
    """Files of all pictures of a run, each as it is made; ends with the number of pictures that failed."""
    if command == "report":
        style.use_style(("png",))  # what its page shows
    failed = 0
    jobs = [(s.name, picture, s) for s in results.studies for picture in PICTURES.get(s.kind, OTHERS)]
    jobs += [(results.title, picture, results) for picture in TOGETHER]
    for name, picture, subject in jobs:
        try:
            for file in function(picture)(subject):
                yield file
        except whirl.Error:
            raise
        except OSError:  # the disk, which the next picture needs as well
            raise
        except Exception as error:  # one picture that fails must not cost the others
            print(f"{command}: {name}: {picture} cannot be drawn: {type(error).__name__}: {error}", file=sys.stderr)
            failed += 1
    return failed


def formats(text):
    kinds = tuple(dict.fromkeys(text.split(",")))
    if not set(kinds) <= {"png", "svg", "pdf"}:
        raise argparse.ArgumentTypeError(f"'{text}': choose from png, svg, pdf, with commas between")
    return kinds


def main(argv):
    parser = argparse.ArgumentParser(prog=called("plot"), description="Draws every picture that a results folder has data for.")
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path, help="folder of a run, with its results.h5")
    parser.add_argument("--formats", type=formats, default=("png",), help="of the pictures, with commas between: png (default), svg, pdf")
    words = parser.parse_args(argv)
    style.use_style(words.formats)
    with said_in_a_sentence("plot"), Drawn(words.directory) as results:
        files = drawn(results)
        while True:
            try:
                print(next(files), flush=True)
            except StopIteration as end:
                return 1 if end.value else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
