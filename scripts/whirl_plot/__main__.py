"""Draws every picture that a results folder has data for."""
import pathlib
import sys

from . import (bearing_map, bifurcation, campbell, eccentricity, film, locus, motion, multipliers, orbits, response,
               shapes)
from .data import open_results
from .style import use_style

# Which pictures a kind of study gets, in the order of the report.
PICTURES = {
    "static": [shapes.draw_sag, orbits.draw_positions, film.draw],
    "alignment": [shapes.draw_sag],
    "bearing_map": [bearing_map.draw_impedance, bearing_map.draw_frequencies],
    "modes": [campbell.draw, shapes.draw_modes],
    "unbalance_response": [response.draw],
    "equilibrium_branch": [bifurcation.draw_equilibria, orbits.draw_locus],
    "cycle_branch": [bifurcation.draw_cycles, orbits.draw, multipliers.draw],
    "motion": [motion.draw],
}


def main(argv):
    if len(argv) != 1 or argv[0] in ("-h", "--help"):
        print("usage: scripts/plot DIR", file=sys.stderr)
        return 0 if argv and argv[0] in ("-h", "--help") else 2
    directory = pathlib.Path(argv[0])
    if not (directory / "results.h5").is_file():
        print(f"plot: there is no {directory / 'results.h5'}", file=sys.stderr)
        return 2
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
                     *locus.draw_together(results)]:
            print(file)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
