"""Numbers as a person reads them: micrometres, kilonewtons, rpm, with as many digits as they are worth."""
import math
import re

# SI unit -> (from this size on, factor, unit), the largest that fits.
SCALES = {
    "m": [(0, 1e6, "\u00b5m"), (2e-3, 1e3, "mm"), (2, 1, "m")],
    "N": [(0, 1, "N"), (1e3, 1e-3, "kN"), (1e7, 1e-6, "MN")],
    "N m": [(0, 1, "N m"), (1e3, 1e-3, "kN m")],
    "N/m": [(0, 1e-3, "kN/m"), (1e6, 1e-6, "MN/m"), (1e9, 1e-9, "GN/m")],
    "N s/m": [(0, 1, "N s/m"), (1e3, 1e-3, "kN s/m"), (1e6, 1e-6, "MN s/m")],
    "Pa": [(0, 1, "Pa"), (1e3, 1e-3, "kPa"), (1e5, 1e-6, "MPa"), (1e9, 1e-9, "GPa")],
    "Pa s": [(0, 1e3, "mPa s")],
    "W": [(0, 1, "W"), (1e3, 1e-3, "kW"), (1e6, 1e-6, "MW")],
    "m^3/s": [(0, 6e4, "l/min")],
    "s": [(0, 1e3, "ms"), (1, 1, "s")],
    "rad": [(0, 180 / math.pi, "deg")],
    "kg": [(0, 1e3, "g"), (1, 1, "kg"), (1e4, 1e-3, "t")],
    "kg m": [(0, 1e6, "g mm"), (1e-3, 1e3, "kg mm")],
    "K": [(0, 1, "K")],
}
WORDS = {"1": "", "um": "\u00b5m", "deg": "\u00b0"}


def scale_of(unit, size):
    """Factor and unit in which numbers of this size (SI) read best."""
    chosen = (1, WORDS.get(unit, unit))
    for low, factor, name in SCALES.get(unit, []):
        if low == 0 or abs(size) >= low:
            chosen = (factor, name)
    return chosen


def digits(value, count=5):
    """A number of `count` significant digits without a tail of zeros or an exponent where none is needed."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "\u2013"
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return str(value)
    if value == 0:
        return "0"
    if not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{count - 1}e}".replace("-", "\u2212")
    places = max(0, count - 1 - math.floor(math.log10(abs(value))))
    text = f"{value:.{places}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "\u2212")


def with_bar(value, bar):
    """`5021.4 \u00b1 6.9`: the bar with two digits, the value as far as the bar reaches; without a bar the value alone."""
    if value is None:
        return "\u2013"
    if bar is None or not math.isfinite(bar):
        return digits(value)
    if bar == 0 or bar < 1e-9 * abs(value):
        return digits(value, 7)
    places = max(0, 1 - math.floor(math.log10(bar)))
    if places > 12:
        return digits(value, 9)
    return f"{value:.{places}f} \u00b1 {bar:.{places}f}".replace("-", "\u2212")


def person(value, unit, count=5):
    """A number in SI with the unit that reads best."""
    if value is None:
        return "\u2013"
    factor, name = scale_of(unit, value)
    return f"{digits(value * factor, count)} {name}".strip()


def reading(value, bar, unit):
    """A number of summary.json and its bar in the unit that reads best."""
    if value is None:
        return "\u2013"
    factor, name = scale_of(unit, value)
    return f"{with_bar(value * factor, None if bar is None else bar * factor)} {name}".strip()


def quantity(text, count=4):
    """A quantity of resolved.yaml, `0.00018 m`, as a person reads it; what is none stays as it is."""
    match = re.fullmatch(r"\s*([-+0-9.eE]+)\s+(\S.*)", str(text))
    if not match:
        return str(text)
    try:
        return person(float(match[1]), match[2].strip(), count)
    except ValueError:
        return str(text)


def number(text):
    """The number of a quantity of resolved.yaml in SI; None if there is none."""
    match = re.match(r"\s*([-+0-9.eE]+)", str(text))
    try:
        return float(match[1]) if match else None
    except ValueError:
        return None
