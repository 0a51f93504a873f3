"""What a case of a study is called, where it is, and what its result depends on."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """One case of a study.

    Attributes
    ----------
    name
        What it is called in tables, without the folders of this machine.
    source
        Where it is, or how it is generated.
    key
        Hash of all that its result depends on; names the files of the result.
    """

    name: str
    source: str
    key: str
