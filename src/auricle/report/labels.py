"""Labels: names from files as words a figure can carry, with their units."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from matplotlib.font_manager import FontProperties, findfont, get_font

from auricle.study.result import Signal
from auricle.surface.field import FieldMap

LONGEST = 32
"""Characters of a name that a figure shows."""

_UNITS: Mapping[str, str] = MappingProxyType(
    {
        "local_activation_time": "ms",
        "lat": "ms",
        "bipolar_voltage": "mV",
        "unipolar_voltage": "mV",
        "impedance": "Ω",
        "force": "g",
        "thickness": "mm",
        "conduction_velocity": "m/s",
    }
)
"""Units of the fields OpenEP names, for files that do not state one."""

_MISSING = "\N{REPLACEMENT CHARACTER}"


def signal_label(signal: Signal) -> str:
    """Words for a signal in a figure; a field's name is the file's, so it is not trusted."""
    return figure_text(signal.title.replace("_", " ").strip())


def figure_text(text: str) -> str:
    r"""Text that matplotlib prints as it stands: one line, no formulas, no missing glyphs.

    Examples
    --------
    >>> figure_text("a\nb")
    'a b'
    >>> len(figure_text("x" * 1000))
    32
    """
    one_line = " ".join(text.split()) or "unnamed"
    if len(one_line) > LONGEST:
        one_line = one_line[: LONGEST - 1] + "…"
    known = _known_characters()
    printable = "".join(letter if ord(letter) in known else _MISSING for letter in one_line)
    # An even number of dollar signs would start a formula.
    return printable.replace("$", r"\$")


@cache
def _known_characters() -> frozenset[int]:
    font = get_font(findfont(FontProperties(family="DejaVu Sans")))
    return frozenset(font.get_charmap())


def unit_of(field: FieldMap) -> str:
    """Unit of a field as the file states it, else as its OpenEP name implies, else empty.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=1)
    >>> unit_of(FieldMap(sphere, sphere.vertices[:, 0], "local_activation_time"))
    'ms, by its name'
    """
    implied = _UNITS.get(field.name.lower(), "")
    return field.unit or (f"{implied}, by its name" if implied else "")


def with_unit(words: str, unit: str) -> str:
    """Label of an axis or a colour bar.

    Examples
    --------
    >>> with_unit("wavelength", "mm")
    'wavelength (mm)'
    >>> with_unit("tawss", "")
    'tawss (no unit stated)'
    """
    return f"{words} ({figure_text(unit) if unit else 'no unit stated'})"
