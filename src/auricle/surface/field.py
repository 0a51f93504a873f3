"""A feature map: one value, or one row of values, at every vertex of a mesh."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Truths, read_only
from auricle.errors import InputError
from auricle.surface.mesh import Mesh


@dataclass(frozen=True, eq=False)
class FieldMap:
    """Values on a mesh's vertices, with a name and a unit.

    Parameters
    ----------
    mesh
        The surface the values belong to.
    values
        Shape (n,) or (n, c); NaN means "not sampled"; copied and frozen.
    name
        As OpenEP names it where it has a name (``local_activation_time``, ``bipolar_voltage``).
    unit
        ``ms``, ``mV``, ``mm``, …; empty when the file does not say.

    Raises
    ------
    InputError
        If the number of values is not the number of vertices, or a value is infinite.
    """

    mesh: Mesh
    values: Floats
    name: str
    unit: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", read_only(self.values, np.float64))
        if self.values.ndim not in (1, 2) or len(self.values) != self.mesh.n_vertices:
            raise InputError(
                f"field {self.name!r} has shape {self.values.shape} on {self.mesh.n_vertices} "
                "vertices: give one value, or one row, a vertex"
            )
        if np.isinf(self.values).any():
            raise InputError(f"field {self.name!r} holds infinite values: mark them NaN")

    @property
    def sampled(self) -> Truths:
        """Which vertices hold a value, shape (n,)."""
        finite: Truths = np.isfinite(self.values)
        return finite if finite.ndim == 1 else np.asarray(finite.all(axis=1))
