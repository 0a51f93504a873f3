"""What a foreign file says, made fit for checks and one-line messages."""

import re

from auricle.errors import FormatError


def damaged(cause: str) -> FormatError:
    """Name the fault of a file that does not keep its promise, and what helps."""
    return FormatError(f"{cause}: the file is damaged or cut short; export it again")


def count_of(word: bytes | str, what: str) -> int:
    """Read the whole number a header gives for `what`.

    Raises
    ------
    FormatError
        If it is not a plain decimal number that could count anything.

    Examples
    --------
    >>> count_of(b"12", "vertices")
    12
    """
    text = word.decode("ascii", "replace") if isinstance(word, bytes) else word
    if re.fullmatch(r"[0-9]{1,15}", text.strip()) is None:
        raise damaged(f"announces {shown(text)} as its number of {what}")
    return int(text)


def require_bytes(what: str, *, needed: int, left: int) -> None:
    """Refuse counts that the rest of the file cannot hold.

    Raises
    ------
    FormatError
        If `needed` bytes are more than the `left` ones.
    """
    if needed > left:
        raise damaged(
            f"announces {what}, so {needed:,} bytes or more, with {max(left, 0):,} bytes left"
        )


def shown(words: bytes | str, *, longest: int = 48) -> str:
    r"""Foreign text made fit for a one-line message: short, quoted, printable.

    Examples
    --------
    >>> print(shown(b"caf\xe9\n"))
    'caf\xe9'
    """
    quoted = ascii(text_of(words[:longest]).strip()).replace("\\\\", "\\")
    return quoted if len(quoted) <= longest else f"{quoted[:longest]}…{quoted[0]}"


def text_of(words: bytes | str) -> str:
    """Text of bytes that should be UTF-8; those that are not come back escaped."""
    return words.decode("utf-8", "backslashreplace") if isinstance(words, bytes) else words


def printable(text: str) -> str:
    r"""Keep the text of one line: what cannot be printed is escaped.

    >>> print(printable("two\nlines"))
    two\nlines
    """
    return "".join(
        letter if letter.isprintable() else ascii(letter).strip("'\"") for letter in text
    )
