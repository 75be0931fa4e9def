"""What a sweep found, as tables: its variants with bars, and trends over what it changes."""
import math
import re

from .units import WORDS, digits, scale_of, with_bar

# Columns that answer what was asked; the others are in the table of all values.
MAIN = re.compile(r"(^|\.)(threshold|whirl_frequency|contact|(hopf|fold|cyclic_fold|flip|neimark_sacker|branch_point)\.\d+|critical\.\d+\.speed|"
                  r"peak\.\d+\.(speed|semi_major|amplification_factor)|load\.[^.]+|min_thickness|multiplier\.modulus|peak_to_peak\.[^.]+\.[xy])$")
SHOWN = 8  # columns side by side
SPEEDS = {"rpm": 30 / math.pi, "Hz": 0.5 / math.pi}
SIGNS = {"+": "rises", "-": "falls", "mixed": "rises and falls", "undetermined": "undetermined: the bars contain zero", "no bar": "no bar"}


def columns_of(study):
    return [c for c in study.summary.get("columns", []) if any(v is not None for v in c["values"])]


def parts_of(study, column):
    """Study and value that a column is of; names of studies may have dots."""
    names = {s["name"] for v in study.summary.get("variants", []) for s in v.get("studies", [])}
    known = [n for n in names if column.startswith(f"{n}.")]
    head = max(known, key=len) if known else column.partition(".")[0]
    return head, column[len(head) + 1:]


def main_columns(study):
    """Those of MAIN; a bifurcation that is the threshold of all variants stands once."""
    every = columns_of(study)
    found = [c for c in every if MAIN.search(c["name"])]
    thresholds = {parts_of(study, c["name"])[0]: readable(study, c)[1] for c in found if c["name"].endswith(".threshold")}

    def said(c):
        head, value = parts_of(study, c["name"])
        pairs = list(zip(thresholds.get(head, []), readable(study, c)[1]))
        return value != "threshold" and bool(pairs) and all(None not in p and math.isclose(*p, rel_tol=1e-9) for p in pairs)
    return [c for c in found if not said(c)] or every[:SHOWN]


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


def quantity_of(study):
    """What changes, of the first trend: its name and unit, and variant -> place."""
    trends = study.summary.get("trends", [])
    if not trends:
        return None
    first = trends[0]
    column = study.get("table/" + first["quantity"].replace("/", "_"))
    places = {} if column is None else dict(zip(rows_of(study), map(float, column)))
    for t in trends:
        if t["quantity"] == first["quantity"]:
            places.update(zip(t["variants"], t["at"]))
    name = study.name if first["quantity"] == "at" else first["quantity"].split(".")[-1].replace("_", " ")
    return name, WORDS.get(first["unit"], first["unit"]), places


def head_of(study, column, unit):
    head, value = parts_of(study, column)
    return f"{head}: {value.replace('_', ' ').replace('.', ' ')}" + (f" [{unit}]" if unit else "")


def rows_of(study):
    """Names of the rows of the table: the deck as it stands if it was computed, and the variants."""
    names = [v["name"] for v in study.summary.get("variants", [])]
    rows = max((len(c["values"]) for c in study.summary.get("columns", [])), default=0)
    return ["as given"] * (rows == len(names) + 1) + names


def ended(study):
    """Variant -> why one of its studies did not complete."""
    return {v["name"]: "; ".join(f"{s['name']}: {s['status']}" for s in v.get("studies", []) if s.get("status") not in ("", None, "completed"))
            for v in study.summary.get("variants", [])}


def verdicts_of(study):
    """Row -> what its studies say of its stability; nothing of results without that column."""
    words = study.get("table/verdict")
    return {} if words is None else dict(zip(rows_of(study), map(str, words)))


def has_unstable(words):
    """Whether the words of a verdict tell of a machine that is unstable somewhere."""
    return bool(re.search(r"\bunstable\b|\bloses stability\b", words, re.IGNORECASE))


def table_of_columns(study, caption, columns, table):
    names, quantity, reasons, verdicts = rows_of(study), quantity_of(study), ended(study), verdicts_of(study)
    rows, head = [[n] for n in names], ["variant"]
    if any(v != "-" for v in verdicts.values()):
        head.append("verdict")
        for row, n in zip(rows, names):
            row.append(verdicts.get(n, "-"))
    if quantity and quantity[2]:
        head.append(quantity[0] + (f" [{quantity[1]}]" if quantity[1] else ""))
        for row, n in zip(rows, names):
            row.append(digits(quantity[2].get(n), 5))
    for c in columns:
        unit, values, bars = readable(study, c)
        head.append(head_of(study, c["name"], unit))
        for row, value, bar in zip(rows, values, bars):
            row.append(with_bar(value, bar))
    if any(reasons.values()):
        head.append("not completed")
        for row, n in zip(rows, names):
            row.append(reasons.get(n, ""))
    return table(caption, head, rows, "the bar after \u00b1 estimates the error of each variant; all values are in csv/")


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


def tables(study, table):
    """The variants with their main values, and the trends of these."""
    chosen = main_columns(study)
    parts = [chosen[k:k + SHOWN] for k in range(0, len(chosen), SHOWN)]
    out = [table_of_columns(study, "Variants" if len(parts) == 1 else f"Variants, {k} of {len(parts)}", part, table) for k, part in enumerate(parts, 1)]
    return out + [trends_of(study, {c["name"] for c in chosen}, table)]


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


def brief(study):
    """Sentences: how many variants over what, the trends of the first main values, what failed."""
    quantity, failed = quantity_of(study), sum(map(bool, ended(study).values()))
    variants = study.summary.get("variants", [])
    out = [f"{len(variants)} variants" + (f" over {quantity[0]}" if quantity else "")]
    verdicts = verdicts_of(study)
    unstable = [n for n in rows_of(study) if has_unstable(verdicts.get(n, ""))]
    if unstable:
        out.append("unstable, at least in part: " + ", ".join(unstable[:6]) + (f" and {len(unstable) - 6} more" if len(unstable) > 6 else ""))
    main = {c["name"]: c for c in main_columns(study)}
    for t in study.summary.get("trends", []):
        if len(out) > 3 or t["column"] not in main or t["sign"] not in ("+", "-") or not t["difference"]:
            continue
        c = main[t["column"]]
        unit, values, bars = readable(study, c)
        at = dict(zip(rows_of(study), zip(values, bars)))
        first, last = (at.get(n) for n in (t["variants"][0], t["variants"][-1]))
        if first and last:
            out.append(f"{head_of(study, c['name'], '')} {SIGNS[t['sign']]} from {with_bar(*first)} to {with_bar(*last)} {unit}".strip())
    return out + ([f"{failed} with a study that did not complete"] if failed else [])
