"""What a picture is of: a study or a whole run, with the names of its files and the units in which it reads best."""
import contextlib
import math
import pathlib
import re
import sys

import whirl

from .style import COLOURS, INK, length_unit

COLOURED = ("cycle_branch", "locus", "run_up", "bearing_map")


class Subject(whirl.Study):
    """A study as the pictures see it."""

    with_warnings = ""  # its picture that bears its warnings

    @property
    def run_title(self):
        return self.results.title

    @property
    def colour(self):
        """The same in all pictures of a run; equilibria are ink."""
        names = [s.name for s in self.results.studies if s.kind in COLOURED]
        return COLOURS[names.index(self.name) % len(COLOURS)] if self.name in names else INK

    @property
    def warnings(self):
        """Sentences of summary.json that the numbers of the study must not be read without."""
        found = self.summary.get("warnings", [])
        return [str(w) for w in found] if isinstance(found, list) else []

    @property
    def in_space(self):
        """Whether x and y are directions in space; another system than a rotor shows two of its states as x and y."""
        return "places/name" not in self.group

    @property
    def shown(self):
        """What the positions of branches and motions are."""
        return str(self.group["places/name"].attrs["description"]) if not self.in_space else "journal relative to the bearing centre"

    @property
    def turns(self):
        """The unit of time of motions. Nothing turns in another system than a rotor; its speed is the frequency of a force or a scale."""
        return "revolutions" if self.in_space else f"periods of {2 * math.pi / self.attribute('speed', 1):.4g} s"

    @property
    def micro(self):
        """Factor and unit of orbits: micrometres, or as they are where another system than a rotor shows them."""
        return (1e6, "\u00b5m") if self.in_space else (1, "1")

    def measure(self, values):
        """Factor and unit in which positions read best; another system than a rotor need not show lengths."""
        return length_unit(values) if self.in_space else (1, "1")

    def file(self, what):
        """Where a picture of this study goes, without its ending."""
        name = re.sub(r"[^A-Za-z0-9.+-]+", "_", self.name).strip("_.") or "study"
        return self.results.directory / f"{name}.{what}"


class Whole:
    """Several studies of a run."""

    def __init__(self, results, name):
        self.results, self.run_title, self.name, self.status = results, results.title, name, ""
        self.warnings = []

    def file(self, what):
        return self.results.directory / what


class Drawn(whirl.Results):
    """Results whose studies can be drawn."""

    study_type = Subject

    def whole(self, name):
        return Whole(self, name)


def called(command):
    """What the user calls: `whirl-plot` of an installation, `scripts/plot` of the sources."""
    name = pathlib.Path(sys.argv[0]).name
    return name if name == f"whirl-{command}" else f"scripts/{command}"


def results_directory(command, argv):
    """The results folder that a command `COMMAND DIR` was given, or the exit code if it was not given one."""
    if len(argv) != 1 or argv[0] in ("-h", "--help"):
        print(f"usage: {called(command)} DIR", file=sys.stderr)
        return 0 if argv and argv[0] in ("-h", "--help") else 2
    return pathlib.Path(argv[0])


@contextlib.contextmanager
def said_in_a_sentence(command):
    """Ends the program with one sentence and exit code 2 where results are missing, damaged or of something else."""
    try:
        yield
    except whirl.Error as error:
        sys.exit(_refuse(command, str(error)))
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        sys.exit(_refuse(command, f"these results are damaged or of another version: {error}"))
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        sys.exit(_refuse(command, f"cannot use{where}: {error.strerror or error}"))


def _refuse(command, sentence):
    print(f"{command}: {sentence}", file=sys.stderr)
    return 2

