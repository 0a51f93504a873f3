"""Wording: how names and numbers are written for people."""

import math

from auricle.study.result import Signal

_MINUS = "\N{MINUS SIGN}"
_NOT_SHOWN = "\N{REPLACEMENT CHARACTER}"
_LONGEST_NAME = 60
_ABBREVIATIONS = {"lat": "local activation time"}


def printable(text: str) -> str:
    r"""Text of a file made safe to show: one line, nothing invisible, no control of a terminal.

    Examples
    --------
    >>> printable("bi\x1b[31mpolar\nvoltage")
    'bi�[31mpolar voltage'
    """
    shown = "".join(
        letter if letter.isprintable() or letter.isspace() else _NOT_SHOWN for letter in text
    )
    return " ".join(shown.split())


def field_words(name: str) -> str:
    """Name of a field in words, as OpenEP's names read.

    Examples
    --------
    >>> field_words("local_activation_time"), field_words("LAT")
    ('local activation time', 'local activation time')
    """
    words = printable(name.replace("_", " ")) or "a field without a name"
    words = _ABBREVIATIONS.get(words.lower(), words)
    return words if len(words) <= _LONGEST_NAME else words[: _LONGEST_NAME - 1].rstrip() + "…"


def signal_words(signal: Signal) -> str:
    """Name of a map in words: a field's by its name, others as they are titled."""
    return field_words(signal.name) if signal.kind == "field" else printable(signal.title)


def number(value: float, *, digits: int = 3) -> str:
    """A number to so many significant digits, thousands set off by commas.

    Examples
    --------
    >>> number(13_902.5), number(0.58231), number(-3.0), number(0.0), number(2.08e-11)
    ('13,900', '0.582', '−3', '0', '2.08e−11')
    >>> number(float("nan"))
    '–'
    """
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits}g}")
    if not 1e-3 <= abs(rounded) < 1e9:
        return f"{rounded:.{digits}g}".replace("-", _MINUS)
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
    text = f"{rounded:,.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text.replace("-", _MINUS)


def percent(share: float) -> str:
    """A share in percent, to two digits, or three from 99 % up, where the rest counts.

    Examples
    --------
    >>> percent(0.3162), percent(0.1), percent(0.9987), percent(1.0), percent(0.004)
    ('32 %', '10 %', '99.9 %', '100 %', '0.4 %')
    """
    return f"{number(100 * share, digits=3 if 0.99 < share < 1 else 2)} %"


def listed(parts: list[str]) -> str:
    """Parts as they are read out.

    Examples
    --------
    >>> listed(["a"]), listed(["a", "b"]), listed(["a", "b", "c"])
    ('a', 'a and b', 'a, b and c')
    """
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def counted(n: int, singular: str, plural: str = "") -> str:
    """A number and what it counts.

    Examples
    --------
    >>> counted(1, "hole"), counted(1200, "vertex", "vertices")
    ('1 hole', '1,200 vertices')
    """
    return f"{n:,} {singular if n == 1 else plural or singular + 's'}"
