"""All values of a sweep with bars, and their trends over what it changes; the brief of the study has the main ones."""
import math
import re

from .units import WORDS, digits, scale_of, with_bar

SPEEDS = {"rpm": 30 / math.pi, "Hz": 0.5 / math.pi}
SIGNS = {"+": "rises", "-": "falls", "0": "does not change", "mixed": "rises and falls", "undetermined": "undetermined: the bars contain zero", "no bar": "no bar"}


def columns_of(study):
    return [c for c in study.summary.get("columns", []) if any(v is not None for v in c["values"])]


def parts_of(study, column):
    """Study and value that a column is of; names of studies may have dots."""
    names = {s["name"] for v in study.summary.get("variants", []) for s in v.get("studies", [])}
    known = [n for n in names if column.startswith(f"{n}.")]
    head = max(known, key=len) if known else column.partition(".")[0]
    return head, column[len(head) + 1:]


def own_speed(study, column):
    """Unit of the bifurcations of the study that a column is of."""
    head = parts_of(study, column["name"])[0]
    units = [c["unit"] for c in study.summary.get("columns", []) if c["name"].startswith(f"{head}.") and c["unit"] in ("rpm", "Hz")]
    return units[0] if units else None


def readable(study, column):
    """(unit, values, bars) in the unit in which a column reads best; a speed in that of the study's range."""
    unit, values, bars = column["unit"], column["values"], column["uncertainties"]
    speed = own_speed(study, column) if unit == "rad/s" else None
    if speed:
        factor, unit = SPEEDS[speed], speed
    else:
        factor, unit = scale_of(unit, max((abs(v) for v in values if v is not None), default=0.0))
    scaled = [[None if v is None else v * factor for v in some] for some in (values, bars)]
    return unit, *scaled


def head_of(study, column, unit):
    head, value = parts_of(study, column)
    return f"{head}: {value.replace('_', ' ').replace('.', ' ')}" + (f" [{unit}]" if unit else "")


def rows_of(study):
    """Names of the rows of the table: the deck as it stands if it was computed, and the variants."""
    names = [v["name"] for v in study.summary.get("variants", [])]
    rows = max((len(c["values"]) for c in study.summary.get("columns", [])), default=0)
    return ["as given"] * (rows == len(names) + 1) + names


def verdicts_of(study):
    """Row -> what its studies say of its stability; nothing of results without that column."""
    words = study.get("table/verdict")
    return {} if words is None else dict(zip(rows_of(study), map(str, words)))


def has_unstable(words):
    """Whether the words of a verdict tell of a machine that is unstable somewhere."""
    return bool(re.search(r"\bunstable\b|\bloses stability\b", words, re.IGNORECASE))


def trends_of(study, only, table):
    """Sign, and the difference between the first place and the last with the sum of their bars."""
    by_name = {c["name"]: c for c in study.summary.get("columns", [])}
    rows = []
    for t in study.summary.get("trends", []):
        if t["column"] not in only or not t["difference"]:
            continue
        unit, values, bars = readable(study, by_name[t["column"]])
        at_variant = dict(zip(rows_of(study), zip(values, bars)))
        first, last = (at_variant[t["variants"][k]] for k in (0, -1))
        total = None if first[1] is None or last[1] is None else first[1] + last[1]
        at = WORDS.get(t["unit"], t["unit"])
        over = t["quantity"].split(".")[-1].replace("_", " ") if t["quantity"] != "at" else study.name
        rows.append([head_of(study, t["column"], ""), over + (f"; {t['beside']}" if t["beside"] else ""), f"{digits(t['at'][0], 5)} to {digits(t['at'][-1], 5)} {at}".strip(),
                     SIGNS.get(t["sign"], t["sign"]), f"{with_bar(last[0] - first[0], total)} {unit}".strip()])
    return table("Trends", ["value", "over", "from", "", "in all"], rows,
                 "from the first place to the last; a sign counts where no bar of a difference between neighbours contains zero")


def everything(study, table):
    """All values, a row each, if there are few enough variants to stand side by side."""
    names = rows_of(study)
    if not 0 < len(names) <= 16:
        return []
    verdicts = verdicts_of(study)
    rows = [["verdict", *[verdicts.get(n, "-") for n in names]]] if any(v != "-" for v in verdicts.values()) else []
    for c in columns_of(study):
        unit, values, bars = readable(study, c)
        rows.append([head_of(study, c["name"], unit), *[with_bar(v, b) for v, b in zip(values, bars)]])
    return [table("All values of the variants", ["value", *names], rows), trends_of(study, {c["name"] for c in columns_of(study)}, table)]
