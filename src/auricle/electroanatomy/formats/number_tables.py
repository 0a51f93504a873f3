"""Tables of numbers written as text, strict about what is a number."""

import re
from collections.abc import Sequence

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.surface.formats.header import damaged, shown
from auricle.surface.formats.number_text import first_other_word, rows_of_numbers

LARGEST = 1e30
"""Of any size: nothing that is measured in a heart comes near it."""
_FIGURES = re.compile(rb"[-+\d.,eE]{1,24}")


def number_table(lines: Sequence[bytes], *, where: str, delimiter: str | None = None) -> Floats:
    """Rows of numbers of equal length, NaN among them at most, shape (lines, columns).

    Parameters
    ----------
    lines
        One row each, of words between `delimiter`, white space if None.
    where
        What is read, for the message.

    Raises
    ------
    FormatError
        If a word is not a number, one is beyond `LARGEST`, or a line has none of them, or more or
        fewer than the first.

    Examples
    --------
    >>> number_table([b"0 = 1.5 2".replace(b"=", b" ")], where="the mesh").tolist()
    [[0.0, 1.5, 2.0]]
    """
    if not lines:
        return np.empty((0, 0))
    try:
        table: Floats = rows_of_numbers(lines, encoding="latin-1", delimiter=delimiter)
    except ValueError as fault:
        raise _fault(lines, where, delimiter) from fault
    if (np.abs(table) > LARGEST).any():
        raise damaged(f"holds a number beyond all bounds in {where}")
    return table


def number(word: bytes | str, *, where: str) -> float:
    """One number.

    Raises
    ------
    FormatError
        If `word` is none, or beyond `LARGEST`.
    """
    text = word.decode("latin-1") if isinstance(word, bytes) else word
    try:
        value = float(text)
    except ValueError as fault:
        raise not_a_number(text.encode("latin-1", "replace"), where) from fault
    if abs(value) > LARGEST:
        raise damaged(f"holds a number beyond all bounds in {where}")
    return value


def not_a_number(word: bytes, where: str) -> FormatError:
    """The fault of a word that is not a number; words of letters are not repeated."""
    if _FIGURES.fullmatch(word.strip()) is None:
        return damaged(f"holds a word in {where} where a number should be")
    hint = " (a comma is not a decimal point)" if b"," in word else ""
    return damaged(f"holds {shown(word)} in {where} where a number should be{hint}")


def _fault(lines: Sequence[bytes], where: str, delimiter: str | None) -> FormatError:
    for line in lines:
        spaced = line if delimiter is None else line.replace(delimiter.encode(), b" ")
        other = first_other_word(spaced)
        if other is not None:
            return not_a_number(other, where)
    return damaged(f"holds lines of different lengths in {where}")
