"""Reading results.h5: what a study stored, by name, with defaults for what it left out."""
import contextlib
import json
import pathlib
import re
import sys

import h5py
import numpy as np

from .style import length_unit


def text(value):
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


class Study:
    """One group /studies/<name>."""

    def __init__(self, group, directory, run_title):
        self.group = group
        self.directory = pathlib.Path(directory)
        self.run_title = run_title
        self.name = self.attribute("title", group.name.rsplit("/", 1)[-1])
        self.kind = self.attribute("kind", "")
        self.status = self.attribute("status", "")

    def attribute(self, name, default=None):
        if name not in self.group.attrs:
            return default
        value = self.group.attrs[name]
        return text(value) if isinstance(value, (bytes, str)) else value

    def has(self, *paths):
        """True if all datasets are there and none is empty."""
        return all(p in self.group and (not isinstance(self.group[p], h5py.Dataset) or self.group[p].size) for p in paths)

    def get(self, path, default=None):
        if path not in self.group:
            return default
        data = self.group[path][()]
        if isinstance(data, (bytes, str)):
            return text(data)
        data = np.asarray(data)
        return np.array([text(v) for v in data.ravel()]).reshape(data.shape) if data.dtype.kind in "OS" else data

    def bearings(self, count):
        """Names of the bearings, or of what another system shows; numbered if the study gave none."""
        names = self.get("bearings/name", self.get("places/name"))
        return list(names) if names is not None and len(names) == count else [f"bearing {i + 1}" for i in range(count)]

    @property
    def shown(self):
        """What the positions of branches and motions are."""
        return text(self.group["places/name"].attrs["description"]) if "places/name" in self.group else "journal relative to the bearing centre"

    @property
    def micro(self):
        """Factor and unit of orbits: micrometres, or as they are where another system than a rotor shows them."""
        return (1, "1") if "places/name" in self.group else (1e6, "\u00b5m")

    def measure(self, values):
        """Factor and unit in which positions read best; another system than a rotor need not show lengths."""
        return (1, "1") if "places/name" in self.group else length_unit(values)

    def file(self, what):
        """Where a picture of this study goes."""
        name = re.sub(r"[^A-Za-z0-9.+-]+", "_", self.name).strip("_.") or "study"
        return self.directory / f"{name}.{what}.png"


class Whole:
    """What a picture of several studies is called and where it goes."""

    def __init__(self, results, name):
        self.run_title, self.name, self.status = results.title, name, ""
        self.directory = results.directory

    def file(self, what):
        return self.directory / f"{what}.png"


class Results:
    def __init__(self, file, directory):
        self.directory = pathlib.Path(directory)
        self.title = text(file.attrs.get("title", self.directory.name))
        groups = file["studies"] if "studies" in file else {}
        studies = [Study(groups[name], directory, self.title) for name in groups]
        self.studies = sorted(studies, key=lambda s: (self._order().get(s.name, len(groups)), s.name))

    def whole(self, name):
        return Whole(self, name)

    def _order(self):
        """Place of each study in the deck, from summary.json."""
        try:
            summary = json.loads((self.directory / "summary.json").read_text())
            return {s["name"]: i for i, s in enumerate(summary["studies"])}
        except (OSError, ValueError, KeyError):
            return {}


@contextlib.contextmanager
def open_results(directory):
    # A results file is replaced as a whole, never written in place, so it needs no lock.
    with h5py.File(pathlib.Path(directory) / "results.h5", "r") as file:
        yield Results(file, directory)


def results_directory(command, argv):
    """The results folder that a command `scripts/COMMAND DIR` was given, or the exit code if it was not given one."""
    if len(argv) != 1 or argv[0] in ("-h", "--help"):
        print(f"usage: scripts/{command} DIR", file=sys.stderr)
        return 0 if argv and argv[0] in ("-h", "--help") else 2
    directory = pathlib.Path(argv[0])
    if not (directory / "results.h5").is_file():
        print(f"{command}: there is no {directory / 'results.h5'}", file=sys.stderr)
        return 2
    return directory
