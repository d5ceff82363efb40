"""Numbers as the report's tables show them."""

import math

NOT_KNOWN = "–"
_DIGITS = {"ms": 0, "mm": 1}


def number(value, unit=""):
    """A value for a table: text as it is, numbers with sensible digits, a dash when not known."""
    if value is None:
        return NOT_KNOWN
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        return NOT_KNOWN
    shown = "{:.{}f}".format(value, _DIGITS.get(unit, 2))
    return shown if unit in ("", "1") else shown + " " + unit


def difference(unit, predicted, happened):
    """Happened less predicted, signed; "same" or "differs" for texts."""
    if predicted is None or happened is None:
        return NOT_KNOWN
    if isinstance(predicted, str) or isinstance(happened, str):
        return "same" if predicted == happened else "differs"
    if not (math.isfinite(predicted) and math.isfinite(happened)):
        return NOT_KNOWN
    text = number(happened - predicted, unit)
    return text if text.startswith("-") else "+" + text
