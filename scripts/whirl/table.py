"""A table of results: columns of numpy arrays with a unit and a description each."""
import collections.abc

import numpy as np


class Table(collections.abc.Mapping):
    """Columns by name: numpy arrays of one length, [row] or [row][place].

    name         of the table in its study, "branch" for instance
    units        column -> unit as text, "1" if dimensionless, "" for names and counts
    descriptions column -> what it holds
    places       column -> names along its second axis, for columns of two axes
    rows         number of rows
    """

    def __init__(self, name, columns, units, descriptions, places):
        self.name, self._columns, self.units, self.descriptions, self.places = name, columns, units, descriptions, places
        self.rows = len(next(iter(columns.values()))) if columns else 0

    def __getitem__(self, column):
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(f"the table '{self.name}' has no column '{column}'; it has {', '.join(self._columns)}") from None

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(self._columns)

    def __repr__(self):
        return f"<table {self.name}: {self.rows} rows of {', '.join(self._columns)}>"

    def flat(self):
        """Column -> array of one axis; a column of two is split into `name.place`, as in the CSV beside the results."""
        out = {}
        for name, values in self._columns.items():
            if values.ndim == 1:
                out[name] = values
            else:
                out.update((f"{name}.{place}", values[:, k]) for k, place in enumerate(self.places[name]))
        return out

    def array(self):
        """One numpy array of records, its fields as the columns; the units stay in `units`."""
        records = np.zeros(self.rows, [(n, v.dtype, v.shape[1:]) for n, v in self._columns.items()])
        for name, values in self._columns.items():
            records[name] = values
        return records

    def frame(self):
        """A pandas DataFrame of the flat columns; its attrs["units"] holds their units. ImportError without pandas."""
        import pandas
        frame = pandas.DataFrame(self.flat())
        frame.attrs["units"] = self._flat_units()
        return frame

    def _flat_units(self):
        units = {}
        for name, values in self._columns.items():
            units.update(dict.fromkeys([name] if values.ndim == 1 else [f"{name}.{place}" for place in self.places[name]], self.units[name]))
        return units
