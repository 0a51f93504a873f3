"""Numbers written as text, checked word by word before a lenient parser sees them."""

import re

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
