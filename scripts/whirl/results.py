"""Reading a results folder: summary.json and results.h5."""
import contextlib
import functools
import html
import itertools
import json
import pathlib
import typing

import h5py
import numpy as np

from .answer import answer
from .table import Table

# The table that a kind of study is about.
MAIN_TABLE = {"static": "bearings", "modes": "spectrum", "bearing_map": "locus", "dynamic_coefficients": "places",
              "unbalance_response": "response",
              "equilibrium_branch": "branch", "cycle_branch": "branch", "locus": "locus", "run_up": "run_up", "motion": "spectrum",
              "gas_bearing": "curves", "linearity": "levels",
              "critical_speed_map": "map"}


class Error(Exception):
    """What is wrong with results or with a question asked of them, in one sentence."""


class Quantity(typing.NamedTuple):
    """A number of summary.json: value (None where there is none), unit, and uncertainty in the same unit if it is known."""

    value: typing.Optional[float]
    unit: str
    uncertainty: typing.Optional[float] = None


class Orbit(typing.NamedTuple):
    """One cycle of a branch: parameter in `unit`, names of the places, x and y [time][place] at equal steps over a period; stable: None
    where that is not known."""

    parameter: float
    unit: str
    places: list
    x: np.ndarray
    y: np.ndarray
    stable: typing.Optional[bool]
    point: typing.Optional[int]


def text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


@contextlib.contextmanager
def damaged(path):
    """What HDF5 says of a damaged file, in one sentence."""
    try:
        yield
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        raise Error(f"{path} is damaged: {' '.join(str(error).split())}") from None


class Study:
    """One study of a run: a group of results.h5 and its entry in summary.json.

    name, kind, status    as in the deck; `status` is "completed" or says why it ended early
    summary               its entry in summary.json as a dict, empty if the run did not get so far
    """

    def __init__(self, results, group, summary):
        self.results, self.group, self.summary = results, group, summary
        self.name = self.attribute("title", group.name.rsplit("/", 1)[-1])
        self.kind = self.attribute("kind", "")
        self.status = self.attribute("status", "")

    def __repr__(self):
        return f"<{self.kind} '{self.name}': {self.status}>"

    def attribute(self, name, default=None):
        with damaged(self.results.path):
            if name not in self.group.attrs:
                return default
            value = self.group.attrs[name]
        return text(value) if isinstance(value, (bytes, str)) else value

    def has(self, *paths):
        """True if all datasets are there and none is empty."""
        with damaged(self.results.path):
            return all(p in self.group and (not isinstance(self.group[p], h5py.Dataset) or self.group[p].size) for p in paths)

    def get(self, path, default=None):
        """The dataset at a path within the study, as a numpy array (texts as str), or `default`."""
        with damaged(self.results.path):
            if path not in self.group:
                return default
            data = self.group[path][()]
        if isinstance(data, (bytes, str)):
            return text(data)
        data = np.asarray(data)
        return np.array([text(v) for v in data.ravel()]).reshape(data.shape) if data.dtype.kind in "OS" else data

    @property
    def answer(self):
        """What the study found: `sentences`, and `tables` with units and bars, as screen and report show them."""
        return answer(self.summary)

    @property
    def multipliers(self):
        """Floquet multipliers of the cycles of a branch as complex numbers, [point][multiplier]; None if it keeps none."""
        if not self.has("branch/multipliers_real", "branch/multipliers_imag"):
            return None
        return self.get("branch/multipliers_real") + 1j * self.get("branch/multipliers_imag")

    def _repr_html_(self):
        """What a notebook shows: how the study ended, its warnings and its answer."""
        warnings = self.summary.get("warnings", [])
        return (f"<h4>{html.escape(self.name)} ({html.escape(self.kind)}, {html.escape(self.status)})</h4>"
                + "".join(f"<p><b>{html.escape(str(w))}</b></p>" for w in warnings if isinstance(w, str)) + self.answer._repr_html_())

    def bearings(self, count):
        """Names of the bearings, or of what another system shows; numbered if the study gave none."""
        names = self.get("bearings/name", self.get("places/name"))
        return list(names) if names is not None and len(names) == count else [f"bearing {i + 1}" for i in range(count)]

    def labels(self, path):
        """Names of the places along the axes of a dataset beside the first one, a list for each; numbers from 1 where it stores none."""
        with damaged(self.results.path):
            data = self.group[path]
            stored = [data.attrs.get(f"labels_{k}" if k > 1 else "labels") for k in range(1, data.ndim)]
            shape = data.shape[1:]
        return [[text(v) for v in names] if names is not None and len(names) == n else [str(i + 1) for i in range(n)]
                for names, n in zip(stored, shape)]

    @property
    def tables(self):
        """Names of the tables: groups of datasets with one row each per point."""
        with damaged(self.results.path):
            return [name for name, group in self.group.items() if isinstance(group, h5py.Group) and _rows(group)]

    def table(self, name=None):
        """A table by name; the one that the study is about if none is given."""
        known = self.tables
        chosen = name or MAIN_TABLE.get(self.kind)
        own = [n for n in known if n != "unbalance"]  # which every study lists that applies one
        if chosen not in known and name is None and len(own) == 1:
            chosen = own[0]
        if chosen not in known:
            raise Error(f"'{self.name}' has no table '{chosen}'; it has {', '.join(known) or 'none'}")
        with damaged(self.results.path):
            group = self.group[chosen]
            rows = _rows(group)
            columns = {n: self.get(f"{chosen}/{n}") for n in group
                       if isinstance(group[n], h5py.Dataset) and group[n].shape and group[n].shape[0] == rows}
            words = {n: {k: text(v) for k, v in group[n].attrs.items()} for n in columns}
        # Columns in the order of the branch first, then by name.
        first = [n for n in ("parameter", "speed", "name", "eccentricity") if n in columns]
        columns = {n: columns[n] for n in first + sorted(set(columns) - set(first))}
        places = {n: [".".join(p) for p in itertools.product(*self.labels(f"{chosen}/{n}"))] for n, v in columns.items() if v.ndim > 1}
        columns = {n: v.reshape(len(v), -1) if v.ndim > 1 else v for n, v in columns.items()}
        return Table(chosen, columns, {n: words[n].get("unit", "") for n in columns},
                     {n: words[n].get("description", "") for n in columns}, places)

    @property
    def values(self):
        """Name -> Quantity of summary.json; SI unless it is of the study's own range."""
        return {k: Quantity(v.get("value"), v.get("unit", ""), v.get("uncertainty"))
                for k, v in self.summary.get("values", {}).items()}

    @property
    def bifurcations(self):
        """Bifurcations as in summary.json: dicts with type, parameter, value, unit, uncertainty, criticality, ..."""
        return list(self.summary.get("bifurcations", []))

    @property
    def modes(self):
        """Modes as in summary.json: dicts with speed, real, imag, log_decrement, whirl."""
        return list(self.summary.get("modes", []))

    @property
    def peaks(self):
        """Peaks of a linear response as in summary.json, by place and falling height: dicts with place; speed, semi_major,
        amplification_factor, separation_margin and required_margin as dicts with value, unit and uncertainty; stability; verdict;
        notes. What is not known is not there."""
        return list(self.summary.get("peaks", []))

    @property
    def orbits(self):
        """The cycles that a branch kept, as a list of Orbit."""
        if not self.has("orbits/x", "orbits/y"):
            return []
        x, y = self.get("orbits/x"), self.get("orbits/y")
        parameter, point = np.atleast_1d(self.get("orbits/parameter")), self.get("orbits/point")
        stable = self.get("branch/stable")
        names, unit = self.bearings(x.shape[2]), self.attribute("parameter_unit", "")
        told = np.full(len(parameter), np.nan) if point is None or stable is None else stable[point]  # not a number: unknown
        return [Orbit(float(p), unit, names, x[k], y[k], None if np.isnan(told[k]) else bool(told[k] > 0.5),
                      int(point[k]) if point is not None else None) for k, p in enumerate(parameter)]

    @property
    def fields(self):
        """Bearing -> pad -> field -> numpy array: theta, z [node]; pressure, thickness, ... [theta][z]; SI."""
        if not self.has("films"):
            return {}
        return {b: {p: {f: self.get(f"films/{b}/{p}/{f}") for f in pads[p]} for p in pads} for b, pads in self.group["films"].items()}


def _rows(group):
    """Number of rows of a table: the first extent of its datasets of most axes; nothing if the group is none."""
    data = [d for d in group.values() if isinstance(d, h5py.Dataset)]
    axes = max((d.ndim for d in data), default=0)
    rows = {d.shape[0] for d in data if d.ndim == axes} if axes else set()
    return rows.pop() if len(rows) == 1 and len(data) == len(group) else None


class Results:
    """The results folder of a run.

    directory   pathlib.Path of the folder
    title       of the deck
    summary     summary.json as a dict, empty if the run was killed before it wrote one
    studies     list of Study in the order of the deck
    """

    study_type = Study

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        self.path = self.directory / "results.h5"
        self.summary = _summary(self.directory / "summary.json")
        if not self.path.is_file():
            raise Error(f"there is no {self.path}")
        if self.path.stat().st_size == 0:
            raise Error(f"{self.path} is empty")
        with damaged(self.path):
            # A results file is replaced as a whole, never written in place, so it needs no lock.
            self.file = h5py.File(self.path, "r", locking=False)
            title = text(self.file.attrs.get("title", self.directory.name))
            if "studies" not in self.file or not isinstance(self.file["studies"], h5py.Group):
                raise Error(f"{self.path} holds no results of whirl: it has no group 'studies'")
            groups = dict(self.file["studies"].items())
        self.title = str(self.summary.get("title") or title)
        entries = {s["name"]: s for s in self.summary.get("studies", [])}
        order = {name: i for i, name in enumerate(entries)}
        studies = []
        for name, group in groups.items():
            if not isinstance(group, h5py.Group):
                raise Error(f"{self.path} holds no results of whirl: 'studies/{name}' is no group")
            study = self.study_type(self, group, {})
            study.summary = entries.get(study.name, {})
            studies.append(study)
        self.studies = sorted(studies, key=lambda s: (order.get(s.name, len(order)), s.name))

    @functools.cached_property
    def deck(self):
        """resolved.yaml as a dict: the deck as it was understood, every default written out, quantities as texts with their
        SI unit. None if it is not there or PyYAML is not installed."""
        path = self.directory / "resolved.yaml"
        try:
            import yaml
            if path.exists() and not path.is_file():
                raise Error(f"{path} is no file")
            deck = path.read_text(encoding="utf-8")
            loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
            # The program writes none; aliases of aliases make a small file a tree without end.
            if any(isinstance(event, yaml.AliasEvent) for event in yaml.parse(deck, loader)):
                raise Error(f"{path} is no deck that whirl wrote: it holds aliases")
            return yaml.load(deck, loader)
        except (ImportError, OSError):
            return None
        except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
            raise Error(f"{path} is damaged: {' '.join(str(error).split())}") from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Closes results.h5; tables that were read stay."""
        self.file.close()

    def __repr__(self):
        return f"<results in {self.directory}: {', '.join(s.name for s in self.studies)}>"

    def _repr_html_(self):
        return f"<h3>{html.escape(self.title)}</h3>" + "".join(s._repr_html_() for s in self.studies)

    def plot(self, formats=("png",)):
        """Draws all pictures of the run into its folder; returns their paths. Needs matplotlib."""
        from whirl_plot import __main__ as pictures
        from whirl_plot import style, subject
        style.use_style(tuple(formats))
        with subject.Drawn(self.directory) as results:
            return [pathlib.Path(file) for file in pictures.drawn(results)]

    def __getitem__(self, name):
        for study in self.studies:
            if study.name == name:
                return study
        raise Error(f"{self.directory} has no study '{name}'; it has {', '.join(s.name for s in self.studies) or 'none'}")

    def table(self, study, name=None):
        """A table of a study, the one that it is about if none is named."""
        return self[study].table(name)

    def values(self, study=None):
        """Name -> Quantity of a study; study -> name -> Quantity if none is named."""
        return self[study].values if study is not None else {s.name: s.values for s in self.studies}

    def bifurcations(self, study=None):
        """Bifurcations of a study; of all, each with its "study", if none is named."""
        if study is not None:
            return self[study].bifurcations
        return [{"study": s.name, **b} for s in self.studies for b in s.bifurcations]

    def orbits(self, study):
        return self[study].orbits

    def fields(self, study):
        return self[study].fields


def _summary(path):
    if not path.is_file():
        return {}
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Error(f"{path} is damaged: {' '.join(str(error).split())}") from None
    studies = summary.get("studies", []) if isinstance(summary, dict) else None
    if not isinstance(studies, list) or not all(isinstance(s, dict) and isinstance(s.get("name"), str) for s in studies):
        raise Error(f"{path} is no summary of a run of whirl")
    return summary


def read(directory):
    """The results in a folder; Error in one sentence if there are none, or if they are damaged or of something else."""
    return Results(directory)
