"""Decks from Python: dicts, numpy arrays for shafts, texts with units for quantities."""
import copy
import json
import pathlib

import numpy as np

from .results import Error


def quantity(value, unit):
    """`12.5 mm`: a number with its unit as decks write it, exact; of an array a list."""
    if np.ndim(value):
        return [quantity(v, unit) for v in np.asarray(value).tolist()]
    return f"{float(value)!r} {unit}"


def shaft(length, diameter, inner=None, unit="mm"):
    """Segments of a shaft from arrays of equal length: lengths, outer diameters (or one for all), inner diameters if it is hollow."""
    length = np.atleast_1d(np.asarray(length, float))
    columns = {"length": length, "diameter": np.broadcast_to(np.asarray(diameter, float), length.shape)}
    if inner is not None:
        columns["inner_diameter"] = np.broadcast_to(np.asarray(inner, float), length.shape)
    return [{key: quantity(values[k], unit) for key, values in columns.items() if key != "inner_diameter" or values[k] > 0} for k in range(len(length))]


def plain(value, place=""):
    """The value as JSON knows it, which is YAML as well."""
    if isinstance(value, dict):
        return {str(k): plain(v, f"{place}.{k}") for k, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v, f"{place}.{k}") for k, v in enumerate(value, 1)]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        raise Error(f"{place.lstrip('.')}: {value} is no number that a deck can have")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise Error(f"{place.lstrip('.')}: a deck has no values of type {type(value).__name__}")


class Deck(dict):
    """A deck as a dict of dicts, lists, numbers and texts; numpy arrays become lists.

        deck = whirl.Deck(title="fan", rotor={"segments": whirl.shaft([100] * 8, 40), "material": {...}}, ...)
        deck.run(output="results/fan")["modes"].answer

    Numbers with a dimension are texts with their unit ("12 mm") or whirl.quantity(12, "mm"). Paths of tables are relative to the
    folder of the file that is written.
    """

    def copy(self):
        return Deck(copy.deepcopy(dict(self)))

    def write(self, path):
        """Writes the deck, as JSON, which is YAML; returns its path."""
        path = pathlib.Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(plain(self), indent=1) + "\n", encoding="utf-8")
        return path

    def run(self, output, **words):
        """Writes deck.yaml into `output` beside the results and runs it; `words` as of whirl.run."""
        from .running import run
        output = pathlib.Path(output)
        return run(self.write(output.with_name(output.name + ".deck.yaml")), output=output, **words)
