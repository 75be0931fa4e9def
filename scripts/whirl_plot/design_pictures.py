"""Pictures of docs/design_studies.md from the results of its decks."""
import pathlib
import shutil

from . import style, sweep
from .subject import Drawn

# Picture of docs/: run, sweep, what draws it, name of its file among the results. Each in the grade that the source's figure has.
PICTURES = {
    "design_pedestals_balanced": ("design", "pedestals", sweep.draw_branches, "pedestals.balanced"),
    "design_pedestals_g25": ("design", "pedestals", sweep.draw_branches, "pedestals.G2.5"),
    "design_pedestals": ("design", "pedestals", sweep.draw_branches, "pedestals.G6.3"),
    "design_elevation": ("design", "elevation of bearing 5", sweep.draw_branches, "elevation_of_bearing_5.balanced"),
    "design_clearance": ("design", "clearance", sweep.draw_branches, "clearance.G6.3"),
    "design_offset": ("design", "offset", sweep.draw_branches, "offset.balanced"),
    "design_preload": ("design", "preload", sweep.draw_branches, "preload.G6.3"),
    "design_arc": ("design", "arc", sweep.draw_branches, "arc.G6.3"),
    "design_slenderness_g25": ("design", "slenderness", sweep.draw_branches, "slenderness.G2.5"),
    "design_slenderness": ("design", "slenderness", sweep.draw_branches, "slenderness.G6.3"),
    "design_whirl": ("pedestals_whirl", "pedestals", sweep.draw_branches, "pedestals.whirl"),
    "design_stability_factors": ("reduction", "whole shaft", sweep.draw_stability_factors, "whole_shaft.stability_factors"),
    "design_response": ("reduction", "whole shaft", sweep.draw_response, "whole_shaft.linear_response"),
    "design_stiffness": ("coefficients", "over speed", sweep.draw_coefficients, "over_speed.stiffness"),
    "design_damping": ("coefficients", "over speed", sweep.draw_coefficients, "over_speed.damping"),
    "design_film_mesh": ("film_meshes", "film mesh", sweep.draw_films, "film_mesh.at_service_speed.B1"),
}


class Pictures:
    """Draws each sweep once; `computed` gives the folder of a run."""

    def __init__(self, computed):
        self.computed, self.drawn = computed, {}
        style.use_style(("png",))

    def copy(self, name, docs):
        run, study, draw, stem = PICTURES[name]
        key = run, study, draw
        if key not in self.drawn:
            with Drawn(self.computed(run)) as results:
                self.drawn[key] = {pathlib.Path(f).name: f for f in draw(results[study])}
        shutil.copyfile(self.drawn[key][f"{stem}.png"], docs / f"{name}.png")
