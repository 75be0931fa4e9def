"""Separation margins of critical speeds and peaks to the operating speed: as summary.json has them, else from the deck."""
import numpy as np

from .units import digits, number, with_bar


def required_margin(factor, below):
    """API 617 and API 684 (2005), 2.5: none for an amplification factor below 2.5; else 17 (1 - 1/(AF - 1.5)) percent for a peak below
    the operating speed, ten more for one above it."""
    if factor is None:
        return None
    if factor < 2.5:
        return 0.0
    return (0.17 if below else 0.27) - 0.17 / (factor - 1.5)


def speed_in(unit, value):
    """rad/s of a speed in `unit`."""
    return value * {"rpm": np.pi / 30, "Hz": 2 * np.pi}.get(unit, 1.0)


def operating_range(study):
    """(lowest, highest) operating speed in rad/s: of the study, else the service speed that the deck's unbalances name; None if
    there is none."""
    def si(text):
        return speed_in(str(text).split(" ", 1)[-1].strip(), number(text) or 0.0)

    deck = study.results.deck or {}
    for entry in deck.get("studies") or []:
        for options in entry.values() if isinstance(entry, dict) else []:
            if not isinstance(options, dict) or options.get("name") != study.name:
                continue
            if isinstance(options.get("operating"), dict):
                return si(options["operating"].get("from")), si(options["operating"].get("to"))
            if "operating_speed" in options:
                return (si(options["operating_speed"]),) * 2
    speeds = [si(u["service_speed"]) for u in (deck.get("unbalance") or {}).values() if isinstance(u, dict) and "service_speed" in u]
    return (min(speeds), max(speeds)) if speeds and min(speeds) > 0 else None


def margins(speed, factor, operating):
    """Cells: actual and required separation margin, as fractions of the nearer border, and whether it suffices."""
    if operating is None:
        return []
    low, high = operating
    below = speed < low or (speed <= high and high - speed >= speed - low)
    actual = (low - speed) / low if speed < low else (speed - high) / high if speed > high else 0.0
    required = required_margin(factor, below)
    verdict = "\u2013" if required is None else "yes" if actual >= required else "no"
    return [f"{100 * actual:.1f} %", "\u2013" if required is None else "none" if required == 0 else f"{100 * required:.1f} %", verdict]


def told(study, name):
    """A value of summary.json with its bar; a dash where there is none."""
    v = study.values.get(name)
    return "\u2013" if v is None else with_bar(v.value, v.uncertainty)


def told_margins(study, head):
    """The cells of margins() as summary.json has them."""
    values = study.values
    actual, required = (values[head + k].value if head + k in values else None for k in ("separation_margin", "required_margin"))
    percent = lambda v: "\u2013" if v is None else f"{100 * v:.1f} %"  # noqa: E731
    verdict = "\u2013" if actual is None or required is None else "yes" if actual >= required else "no"
    return [percent(actual), "none" if required == 0 else percent(required), verdict]


def range_in(operating, to_unit):
    return " to ".join(digits(float(v * to_unit), 5) for v in dict.fromkeys(operating))


MARGIN_HEAD = ["margin", "required", "enough"]
MARGIN_NOTE = "margin to the operating speed, required by API 617 and API 684 (2005), 2.5: none below an amplification factor of 2.5"
