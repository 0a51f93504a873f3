"""Mapping points: where a catheter touched, and what was measured there."""

from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Integers, Points, Truths, read_only
from auricle.errors import InputError

UNITS = {
    "local_activation_time": "ms",
    "bipolar_voltage": "mV",
    "unipolar_voltage": "mV",
    "impedance": "ohm",
    "force": "g",
}
"""Unit of each quantity of a mapping point, by OpenEP's name of it."""


def _unrecorded() -> Floats:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class MappingPoints:
    """Mapping points as a table, in the order of their acquisition; NaN is "missing".

    Parameters
    ----------
    positions
        Where the electrode was, shape (n, 3), mm; copied and frozen, as all columns are.
    projected_positions
        The same on the surface, shape (n, 3), mm; an empty array becomes NaN throughout, here
        and in every other column.
    local_activation_time
        Map annotation minus reference annotation, shape (n,), ms.
    bipolar_voltage, unipolar_voltage
        Peak to peak, shape (n,), mV.
    impedance
        Shape (n,), ohm.
    force
        Contact force, shape (n,), g.
    identifiers
        Number of each point in its map, shape (n,); 1 … n where none are given.
    included
        Which points the vendor's map uses, shape (n,); all where none are given.

    Raises
    ------
    InputError
        If a column has another length, a position is not finite or a value is infinite.

    Examples
    --------
    >>> points = MappingPoints(np.zeros((2, 3)), bipolar_voltage=np.array([0.4, np.nan]))
    >>> len(points), points.local_activation_time.tolist(), points.identifiers.tolist()
    (2, [nan, nan], [1, 2])
    """

    positions: Points
    projected_positions: Points = field(default_factory=_unrecorded)
    local_activation_time: Floats = field(default_factory=_unrecorded)
    bipolar_voltage: Floats = field(default_factory=_unrecorded)
    unipolar_voltage: Floats = field(default_factory=_unrecorded)
    impedance: Floats = field(default_factory=_unrecorded)
    force: Floats = field(default_factory=_unrecorded)
    identifiers: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    included: Truths = field(default_factory=lambda: np.empty(0, np.bool_))

    def __post_init__(self) -> None:
        positions = np.asarray(self.positions, np.float64)
        if positions.ndim != 2 or positions.shape[1] != 3:
            raise InputError(f"positions have shape {positions.shape}: give (n, 3)")
        if not np.isfinite(positions).all():
            raise InputError("a mapping point's position is NaN or infinite: leave the point out")
        n = len(positions)
        object.__setattr__(self, "positions", read_only(positions, np.float64))
        self._freeze("projected_positions", np.full((n, 3), np.nan))
        for name in UNITS:
            self._freeze(name, np.full(n, np.nan))
        self._freeze("identifiers", np.arange(1, n + 1))
        self._freeze("included", np.ones(n, np.bool_))

    def _freeze(self, name: str, unrecorded: NDArray[np.generic]) -> None:
        given = np.asarray(getattr(self, name))
        column = given if given.size else unrecorded
        if column.shape != unrecorded.shape:
            raise InputError(f"{name} has shape {column.shape}: give {unrecorded.shape}")
        if np.isinf(column.astype(np.float64)).any():
            raise InputError(f"{name} holds infinite values: mark them NaN")
        object.__setattr__(self, name, read_only(column, unrecorded.dtype))

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def recorded(self) -> tuple[str, ...]:
        """Names of the quantities in `UNITS` of which at least one value is there."""
        return tuple(name for name in UNITS if np.isfinite(getattr(self, name)).any())

    def chosen(self, rows: Integers | Truths) -> "MappingPoints":
        """The table of some rows, given by index or by truth value."""
        columns = {column.name: getattr(self, column.name)[rows] for column in fields(self)}
        return MappingPoints(**columns)


def no_points() -> MappingPoints:
    """The table of a map without points."""
    return MappingPoints(np.empty((0, 3)))
