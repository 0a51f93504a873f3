"""Electroanatomical studies: maps of one chamber or several, as one session recorded them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.points import MappingPoints, no_points
from auricle.errors import InputError
from auricle.surface.soup import TriangleSoup

UNKNOWN_SPACE = "unknown"


@dataclass(frozen=True, eq=False)
class ElectroanatomicMap:
    """One map: a surface with the vendor's values on it, and the points they came from.

    Attributes
    ----------
    name
        What to call it: the file's name for it where that is the vendor's own or the name of a
        chamber, else its number in the study; never free text.
    surface
        Triangles as read, with the vendor's values at vertices under OpenEP's names; None where
        there are none.
    points
        The table of mapping points, possibly empty.
    electrograms
        By row of `points`; rows without are not in it.
    cycle_length
        ms; NaN where the file does not say.
    window_of_interest
        First and last moment, ms after the reference annotation; of most of the points.
    space
        Always ``unknown``: mapping systems do not tie their axes to the patient's.
    remarks
        What was left out or doubtful, one phrase each, with its count.

    Raises
    ------
    InputError
        If an electrogram belongs to no point.
    """

    name: str
    surface: TriangleSoup | None = None
    points: MappingPoints = field(default_factory=no_points)
    electrograms: Mapping[int, Electrogram] = field(default_factory=lambda: MappingProxyType({}))
    cycle_length: float = math.nan
    window_of_interest: tuple[float, float] = (math.nan, math.nan)
    space: str = UNKNOWN_SPACE
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "electrograms", MappingProxyType(dict(self.electrograms)))
        if any(row not in range(len(self.points)) for row in self.electrograms):
            raise InputError(f"an electrogram belongs to none of {len(self.points)} points")


@dataclass(frozen=True, eq=False)
class ElectroanatomicStudy:
    """All maps of one export.

    Attributes
    ----------
    system
        ``CARTO 3``, ``EnSite Precision``, ``EnSite X``, ``OpenEP``, ``openCARP`` or ``CSV``.
    maps
        In the file's order.
    remarks
        What was left out of the study as a whole, one phrase each, with its count.
    """

    system: str
    maps: tuple[ElectroanatomicMap, ...]
    remarks: tuple[str, ...] = ()
