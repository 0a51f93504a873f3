"""Numbers written as text, which lenient parsers are kept from taking for what they are not."""

import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.surface.formats.header import damaged, shown

_NUMBER = rb"[-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?+|[-+]?(?:nan|inf(?:inity)?)"
_OTHER_WORD = re.compile(rb"(?<!\S)(?!(?:" + _NUMBER + rb")(?!\S))\S+", re.IGNORECASE)


def first_other_word(line: bytes) -> bytes | None:
    """First word of `line` that is not a number; None if all are.

    Parsers built on ``strtod`` or ``>>`` take ``0,5`` for 0 without a murmur.

    Examples
    --------
    >>> first_other_word(b"1 -2.5e-3 nan .5")
    >>> first_other_word(b"1 0,5 3")
    b'0,5'
    """
    found = _OTHER_WORD.search(line)
    return found[0] if found else None


def numbers_in(line: bytes, where: str) -> int:
    """How many numbers `line` holds, all of its words being numbers.

    Raises
    ------
    FormatError
        If a word is not a number; `where` says of what it should have been part.
    """
    other = first_other_word(line)
    if other is not None:
        hint = " (a comma is not a decimal point)" if b"," in other else ""
        raise damaged(f"holds {shown(other)} where {where} should be{hint}")
    return len(line.split())


def rows_of_numbers(
    lines: Sequence[bytes],
    *,
    encoding: str,
    dtype: type = np.float64,
    delimiter: str | None = None,
) -> NDArray[Any]:
    """Numbers of a table, a row a line, shape (lines, columns).

    Parameters
    ----------
    lines
        At least one, of words between `delimiter`, white space if None.
    encoding
        Of what else may stand there.
    dtype
        Of the numbers.

    Raises
    ------
    ValueError
        If a word is not a number, a line has none, or lines differ in how many they have.

    Examples
    --------
    >>> rows_of_numbers([b"1 2", b"3 4"], encoding="ascii").tolist()
    [[1.0, 2.0], [3.0, 4.0]]
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            table: NDArray[Any] = np.loadtxt(
                lines, dtype=dtype, comments=None, delimiter=delimiter, ndmin=2, encoding=encoding
            )
    except Warning as fault:
        raise ValueError(str(fault)) from fault
    # Lines of what passes for white space in Unicode, such as 0x1E, are left out by the parser.
    if len(table) != len(lines):
        raise ValueError(f"of {len(lines):,} lines {len(table):,} hold numbers")
    return table
