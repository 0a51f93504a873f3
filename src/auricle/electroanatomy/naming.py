"""Names that may leave a reader: the vendor's own words and those of anatomy, no free text."""

import re

_WORDS = (
    r"map|remap|la|ra|lv|rv|rvot|lvot|laa|cs|svc|ivc|pv|pvs|lspv|lipv|rspv|ripv|ao|aorta|"
    r"left|right|atrium|atrial|ventricle|ventricular|endo|epi|pre|post|sr|af|at|vt|afl|pvc|"
    r"lat|voltage|bipolar|unipolar|activation|pace|paced|pacing|sinus|rhythm|ablation|fam|"
    r"geometry|surface|copy|of|and|\d{1,3}"
)
_PLAIN = re.compile(rf"(?:{_WORDS})(?:[\s_.+\-]+(?:{_WORDS}))*", re.IGNORECASE)
_CHANNEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9 .+\-_/]{0,15}")


def map_name(written: str, number: int) -> tuple[str, bool]:
    """A name for the map that is `number` of its study, and whether it is the written one.

    Operators write into names what they like, patients' names and dates among it; only names
    made of chambers, rhythms, numbers of up to three figures and words like "map" are kept.

    Examples
    --------
    >>> map_name("1-1-ReMap", 2), map_name("LA post Smith", 3)
    (('1-1-ReMap', True), ('map 3', False))
    """
    text = written.strip()
    digits = sum(letter.isdigit() for letter in text)
    if len(text) <= 48 and digits <= 4 and _PLAIN.fullmatch(text):
        return text, True
    return f"map {number}", False


def channel_names(written: list[str]) -> tuple[str, ...]:
    """Names of channels: an electrode's as written, anything else by its place; no two alike.

    Examples
    --------
    >>> channel_names(["M1-M2", "a note, of some length, by someone", "M1-M2"])
    ('M1-M2', 'channel 2', 'channel 3')
    """
    names: list[str] = []
    for place, text in enumerate(written, start=1):
        stripped = text.strip()
        kept = _CHANNEL.fullmatch(stripped) is not None and stripped not in names
        names.append(stripped if kept else f"channel {place}")
    return tuple(names)
