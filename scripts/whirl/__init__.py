"""Whirl from Python: read the results of a run, and run decks.

    import whirl
    results = whirl.read("results/unbalance")
    table = results.table("G2.5")
    table["parameter"], table.units["parameter"]

    deck = whirl.Deck(title="fan", rotor={...}, bearings={...}, studies=[{"modes": {"speeds": ["3000 rpm"]}}])
    results = deck.run("results/fan", progress=True)
    results["modes"].answer.sentences, results.plot()

Needs h5py and numpy; pandas only for Table.frame(). Everything that goes wrong raises whirl.Error with one sentence.
"""
from .answer import Answer, AnswerTable
from .deck import Deck, quantity, shaft
from .results import Error, Orbit, Quantity, Results, Study, read
from .running import RunError, run, sweep
from .table import Table

__all__ = ["Answer", "AnswerTable", "Deck", "Error", "Orbit", "Quantity", "Results", "RunError", "Study", "Table", "quantity", "read", "run", "shaft", "sweep"]
