"""How a map is projected on an operator's modes: the other half of a reading of the paper.

With dual areas a and modes h that are orthonormal without areas, every projection met is
coefficients = hᵀ·(aˢ·map) for one exponent s. Its Parseval identity follows: the squared
coefficients of all modes add up to Σ (aˢ·map)².
"""

from dataclasses import dataclass
from typing import Literal

from auricle.arrays import Floats, PerVertex
from auricle.study.paper.operators import OperatorName

Reading = Literal["as_printed", "symmetrised", "area_weighted"]
Projection = Literal["unweighted", "weighted"]


@dataclass(frozen=True)
class Transform:
    """An operator with a projection.

    Attributes
    ----------
    operator
        ``as_printed``, ``symmetrised`` or ``area_weighted``; the last has the modes a^-½·h, which
        are orthonormal under the areas, where h are those of the symmetrised one.
    projection
        ``unweighted``: the sum over vertices of map times mode, as the paper prints it;
        ``weighted``: each vertex times its dual area.
    exponent
        s above.
    """

    operator: Reading
    projection: Projection
    exponent: float

    @property
    def matrix(self) -> OperatorName:
        """Which matrix's eigenvectors are needed."""
        return "as_printed" if self.operator == "as_printed" else "symmetrised"

    @property
    def has_constant_mode(self) -> bool:
        """Whether a constant map has one coefficient only: then centring moves no other."""
        return (self.operator, self.projection) in (
            ("as_printed", "unweighted"),
            ("area_weighted", "weighted"),
        )

    def weighted(self, values: Floats, areas: PerVertex) -> Floats:
        """aˢ·map, what the orthonormal modes are applied to; values of shape (n, c)."""
        scaled: Floats = values * (areas**self.exponent)[:, None]
        return scaled


TRANSFORMS = (
    Transform("as_printed", "unweighted", 0.0),
    Transform("as_printed", "weighted", 1.0),
    Transform("symmetrised", "unweighted", 0.0),
    Transform("area_weighted", "weighted", 0.5),
    Transform("area_weighted", "unweighted", -0.5),
)
"""All of them; the symmetrised operator weighted by √a would be the area-weighted one again."""
