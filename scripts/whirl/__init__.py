"""Whirl from Python: read the results of a run, and run decks.

    import whirl
    results = whirl.read("results/unbalance")
    table = results.table("G2.5")
    table["parameter"], table.units["parameter"]

Needs h5py and numpy; pandas only for Table.frame(). Everything that goes wrong raises whirl.Error with one sentence.
"""
from .results import Error, Orbit, Quantity, Results, Study, read
from .running import RunError, run
from .table import Table

__all__ = ["Error", "Orbit", "Quantity", "Results", "RunError", "Study", "Table", "read", "run"]
