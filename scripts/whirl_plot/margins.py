"""The operating speeds of a study, as the program stored them."""


def operating_in(study):
    """Lowest and highest operating speed in the unit of the study; None if it had none."""
    values = study.values
    for low, high in (("operating_speed",) * 2, ("operating_range.from", "operating_range.to")):
        if low in values and high in values and values[low].value is not None and values[high].value is not None:
            return values[low].value, values[high].value
    return None
