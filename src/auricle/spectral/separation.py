"""What keeps approximate eigenvectors of one symmetric matrix apart, and how it is measured."""

from dataclasses import astuple, dataclass, replace
from typing import Self

import numpy as np
from scipy import sparse

from auricle.arrays import Floats, Integers, PerMode
from auricle.spectral.row_products import row_quotients
from auricle.spectral.workers import Workers, slices

_AT_ONCE = 256
_ROUNDING = np.finfo(float).eps / 2


@dataclass(frozen=True, eq=False)
class Separation:
    """What keeps approximate eigenvectors of one symmetric matrix apart.

    Attributes
    ----------
    values
        Approximate eigenvalues, ascending, shape (k,).
    residuals
        Norms of what the matrix makes of the vectors beyond these multiples, shape (k,).
    scaled
        The same of that times a diagonal scaling S, shape (k,).
    stretched
        Norms of S⁻¹ times the vectors, shape (k,).
    hidden
        What rounding may hide of what is scaled, as a share of what is stretched.
    """

    values: PerMode
    residuals: PerMode
    scaled: PerMode
    stretched: PerMode
    hidden: float

    def relative_residuals(self, least: float) -> PerMode:
        """Residuals over eigenvalues; over `least` where these are smaller."""
        relative: PerMode = self.residuals / np.maximum(self.values, least)
        return relative

    def replaced(self, some: Integers, own: "Separation") -> "Separation":
        """The same with that of some of the vectors, found anew, in place of theirs."""
        return replace(
            self,
            values=_replaced(self.values, some, own.values),
            residuals=_replaced(self.residuals, some, own.residuals),
            scaled=_replaced(self.scaled, some, own.scaled),
            stretched=_replaced(self.stretched, some, own.stretched),
        )

    def bounds(self, groups: Integers) -> Floats:
        """Largest inner product that vectors of two groups can have; ∞ where nothing is known.

        With A·u = μ·u + r and A·v = ν·v + s the product (μ − ν)·u·v is u·s − v·r, so that |u·v| is
        not more than (‖S⁻¹u‖·‖S·s‖ + ‖S⁻¹v‖·‖S·r‖) / |μ − ν|. Where the matrix is large, what
        rounding makes of a vector is large too and the vector small: the scaling evens that out.

        Parameters
        ----------
        groups
            Indices of vectors, shape (t, any); the result has shape (t, t), and is ∞ where the
            first of the two groups does not lie above the second.

        Examples
        --------
        >>> values, residuals = np.array([1.0, 2.0, 4.0]), np.array([1e-9, 3e-9, 1e-9])
        >>> apart = Separation(values, residuals, residuals, np.ones(3), 0.0)
        >>> float(apart.bounds(np.array([[0, 1], [2, 2]]))[1, 0])
        2e-09
        """
        lowest, highest = self.values[groups].min(axis=1), self.values[groups].max(axis=1)
        beyond = (self.scaled + self.hidden * self.stretched)[groups].max(axis=1)
        size = self.stretched[groups].max(axis=1)
        distance = lowest[:, None] - highest
        sizes = beyond[:, None] * size + size[:, None] * beyond
        bounds = np.full(sizes.shape, np.inf)
        np.divide(sizes, distance, out=bounds, where=distance > 0)
        return bounds


def _replaced(given: PerMode, some: Integers, own: PerMode) -> PerMode:
    changed = given.copy()
    changed[some] = own
    return changed


@dataclass(frozen=True, eq=False)
class Measure:
    """Measures the `Separation` of approximate eigenvectors of one symmetric matrix.

    Attributes
    ----------
    matrix
        Shape (n, n).
    scaling
        The diagonal of S, at most 1 and less where the matrix's own is large, shape (n,).
    hidden
        What rounding may hide of what is scaled, as a share of what is stretched.
    workers
        Who share the rows.
    """

    matrix: sparse.csc_array
    scaling: Floats
    hidden: float
    workers: Workers

    @classmethod
    def of(cls, matrix: sparse.csc_array, largest: float, workers: Workers) -> Self:
        """For eigenvalues of no more than `largest`."""
        diagonal = matrix.diagonal()
        usual = max(float(np.median(diagonal)), np.finfo(float).tiny)
        scaling = np.sqrt(usual / np.maximum(diagonal, usual))
        return cls(matrix, scaling, _hidden(matrix, scaling, largest), workers)

    def __call__(self, rows: Floats, guesses: PerMode) -> Separation:
        """Of rows, shape (k, n), from nearly their eigenvalues, shape (k,)."""
        found = np.empty((4, len(rows)))

        def fill(some: slice) -> None:
            quotients = row_quotients(self.matrix, rows[some], guesses[some], self.scaling)
            found[:, some] = astuple(quotients)

        self.workers.each(fill, slices(len(rows), _AT_ONCE))
        values, residuals, scaled, stretched = found
        return Separation(values, residuals, scaled, stretched, self.hidden)


def _hidden(matrix: sparse.csc_array, scaling: Floats, largest: float) -> float:
    """What rounding can hide of S·(A·x − μ·x), as a share of ‖S⁻¹x‖, for μ up to `largest`.

    A sum of d products less another is right to d + 2 roundings of the magnitudes in it, which are
    those of (S·A·S + μ·S²)·S⁻¹x. A matrix's norm is not more than the root of the largest sum of a
    row times that of a column.
    """
    roundings = _ROUNDING * (np.diff(matrix.indptr) + 2)
    magnitudes = sparse.csc_array(
        (np.abs(matrix.data), matrix.indices, matrix.indptr), matrix.shape
    )

    def sums(weights: Floats) -> Floats:
        total: Floats = scaling * (magnitudes @ (scaling * weights) + largest * scaling * weights)
        return total

    rows, columns = roundings * sums(np.ones(len(scaling))), sums(roundings)
    return float(np.sqrt(rows.max() * columns.max()))
