"""Draws every picture that a results folder has data for."""
import sys

from . import bearing_map, bifurcation, campbell, eccentricity, film, locus, motion, multipliers, orbits, response, run_up, shapes
from .data import open_results, results_directory
from .style import use_style

# Which pictures a kind of study gets, in the order of the report.
PICTURES = {
    "static": [shapes.draw_sag, orbits.draw_positions, film.draw],
    "alignment": [shapes.draw_sag],
    "bearing_map": [bearing_map.draw_impedance, bearing_map.draw_frequencies],
    "modes": [campbell.draw, shapes.draw_modes],
    "unbalance_response": [response.draw],
    "equilibrium_branch": [bifurcation.draw_equilibria, orbits.draw_locus],
    "cycle_branch": [bifurcation.draw_cycles, bifurcation.draw_frequency, orbits.draw, multipliers.draw],
    "motion": [motion.draw],
}


def main(argv):
    directory = results_directory("plot", argv)
    if isinstance(directory, int):
        return directory
    use_style()
    failed = 0
    with open_results(directory) as results:
        for study in results.studies:
            for picture in PICTURES.get(study.kind, []):
                try:
                    files = picture(study)
                except Exception as error:  # one picture that fails must not cost the others
                    print(f"plot: {study.name}: {picture.__module__.split('.')[-1]}: {error!r}", file=sys.stderr)
                    failed += 1
                else:
                    for file in files:
                        print(file)
        for file in [*bifurcation.draw_together(results), *eccentricity.draw(results), *bearing_map.draw_together(results),
                     *locus.draw_together(results), *run_up.draw_together(results)]:
            print(file)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
