"""Names of uploaded files, fit to be written to this machine's disk."""

_LONGEST = 100
_BARRED = ':*?"<>|'


def plain_name(told: str) -> str:
    r"""The last part of a path as the page told it, without anything that could lead elsewhere.

    >>> plain_name("../../etc/passwd"), plain_name("C:\\scans\\heart.nrrd"), plain_name("..")
    ('passwd', 'heart.nrrd', 'upload')
    """
    last = told.replace("\\", "/").rpartition("/")[2]
    kept = "".join(letter for letter in last if letter.isprintable() and letter not in _BARRED)
    return kept.strip(". ")[-_LONGEST:] or "upload"
