"""Separation margins of critical speeds and peaks to the operating speed, as the program stored them."""
from .units import digits, with_bar

MARGIN_HEAD = ["margin [%]", "required [%]", "enough"]
MARGIN_NOTE = "margin to the operating speed, required by API 617 and API 684 (2005), 2.5: none below an amplification factor of 2.5"
# The program's verdicts in the column that asks whether the margin is enough.
ENOUGH = {"too near": "no", "far enough": "yes", "damped, not critical": "damped", "undetermined": "undetermined", "not excited": "not excited"}
NOT_EXCITED = "not excited: backward whirl on circles, which unbalance does not excite on these supports"


def operating_in(study):
    """Lowest and highest operating speed in the unit of the study; None if it had none."""
    values = study.values
    for low, high in (("operating_speed",) * 2, ("operating_range.from", "operating_range.to")):
        if low in values and high in values and values[low].value is not None and values[high].value is not None:
            return values[low].value, values[high].value
    return None


def margin_note(operating, unit):
    return f"operating speed {' to '.join(digits(v, 5) for v in dict.fromkeys(operating))} {unit}; {MARGIN_NOTE}"


def margin_cells(actual, required, verdict):
    """Cells below MARGIN_HEAD; `actual` and `required` are (value, bar) as fractions, None where not known."""
    percent = lambda v: with_bar(*(None if x is None else 100 * x for x in v))  # noqa: E731
    return [percent(actual), "none" if required[0] == 0 else percent(required), ENOUGH.get(verdict, "\u2013")]
