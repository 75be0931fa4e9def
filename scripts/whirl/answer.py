"""The answer of a study, as summary.json has it: sentences and tables with units and bars."""
import html
import re
import typing

import numpy as np


PRINTED = {"u": "\u00b5", "degC": "\u00b0C"}  # of units on the screen


def units(text):
    """Units behind numbers as people print them: `\u00b5m`, `\u00b5rad`, `\u00b0C`."""
    return re.sub(r"(?<=\d )(u(?=m\b|rad\b)|degC\b)", lambda m: PRINTED[m[1]], text)


def plain(text):
    """The text of a number as people write it: `5021.4 \u00b1 6.9`, a minus that is as long as a plus."""
    return units(text).replace(" +- ", " \u00b1 ").replace("-", "\u2212") if text[:1] in "-(0123456789" else text


def in_print(text):
    """Words with numbers among them: `23.20 \u00b1 0.40 \u00b5m at node 4`."""
    return units(text.replace(" +- ", " \u00b1 "))


class Cell(typing.NamedTuple):
    """`text` is what a person reads, in the unit that the table shows; value and uncertainty are in `unit`, None where there is no number."""

    text: str
    value: typing.Optional[float] = None
    uncertainty: typing.Optional[float] = None
    unit: str = ""


class AnswerTable(typing.NamedTuple):
    """`columns` and `shown`: names and the units that a person reads; `units`: those of the numbers, SI or that of the study."""

    caption: str
    columns: list
    shown: list
    units: list
    rows: list
    note: str = ""

    @property
    def heads(self):
        return [f"{name} [{unit}]" if unit else name for name, unit in zip(self.columns, self.shown)]

    def column(self, name):
        """Numbers of a column as an array in its unit, or its texts where it has none."""
        k = self.columns.index(name)
        values = [row[k].value for row in self.rows]
        if all(v is None for v in values):
            return [row[k].text for row in self.rows]
        return np.array([np.nan if v is None else v for v in values])

    def __str__(self):
        """The table as lines of text."""
        rows = [self.heads] + [[c.text for c in row] for row in self.rows]
        numbers = [any(row[k].value is not None for row in self.rows) for k in range(len(self.columns))]
        width = [max(len(row[k]) for row in rows) for k in range(len(self.columns))]
        lines = ["  ".join(cell.rjust(w) if n else cell.ljust(w) for cell, w, n in zip(row, width, numbers)).rstrip() for row in rows]
        return "\n".join([self.caption, *("  " + line for line in lines), *([f"  {self.note}"] if self.note else [])])

    def _repr_html_(self):
        head = "".join(f"<th>{html.escape(h)}</th>" for h in self.heads)
        body = "".join("<tr>" + "".join(f"<td>{html.escape(c.text)}</td>" for c in row) + "</tr>" for row in self.rows)
        return f"<table><caption>{html.escape(self.caption)}</caption><tr>{head}</tr>{body}</table>"


class Answer(typing.NamedTuple):
    sentences: list
    tables: list

    def __str__(self):
        """Sentences and tables as text."""
        return "\n".join([*self.sentences, *map(str, self.tables)])

    def _repr_html_(self):
        return "".join(f"<p>{html.escape(s)}</p>" for s in self.sentences) + "".join(t._repr_html_() for t in self.tables)


def _cell(cell, unit):
    if cell is None:
        return Cell("\u2013")
    if isinstance(cell, str):
        return Cell(cell)
    return Cell(plain(cell["text"]), cell["value"], cell.get("uncertainty"), unit or cell["unit"])


def answer(summary):
    """The answer in the entry of a study in summary.json; empty if it has none."""
    brief = summary.get("brief", {})
    tables = [AnswerTable(t["caption"], [c["name"] for c in t["columns"]], [units(f"1 {c['shown']}")[2:] for c in t["columns"]],
                          [c["unit"] for c in t["columns"]],
                          [[_cell(cell, c["unit"]) for cell, c in zip(row, t["columns"])] for row in t["rows"]], in_print(t.get("note", "")))
              for t in brief.get("tables", [])]
    return Answer([in_print(s) for s in brief.get("sentences", [])], tables)
