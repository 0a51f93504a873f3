"""Solves with a matrix from the factors of another that differs in a few diagonal entries."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.spectral.gram_schmidt import add_multiples, aligned_rows

_SINGULAR = 1e-10
"""Eigenvalue of what is inverted, in units of the inverse bolsters, that counts as none."""


@dataclass(frozen=True, eq=False)
class Bolstered:
    """What takes the bolsters of a few pivots out again (Sherman, Morrison & Woodbury).

    With B the factored matrix, E the unit vectors of the bolstered rows and D their bolsters, the
    matrix is B − E·D·Eᵀ, and x of (B − E·D·Eᵀ) x = r is y + Z·C⁻¹·Eᵀy, where y = B⁻¹r, Z = B⁻¹E
    and C = D⁻¹ − Eᵀ·Z. Counted twice over (Haynsworth 1968), the matrix has as many negative
    eigenvalues as B and C together less those of D.

    Attributes
    ----------
    places
        Bolstered rows, shape (r,).
    influences
        Z, one a row, as of `aligned_rows`, with 0 beyond: shape (r, n or more).
    inverse
        C⁻¹, shape (r, r).
    n_negative
        Negative eigenvalues of C less those of D.

    References
    ----------
    Hager 1989, "Updating the inverse of a matrix"; Haynsworth 1968, "Determination of the inertia
    of a partitioned Hermitian matrix".
    """

    places: Integers
    influences: Floats
    inverse: Floats
    n_negative: int

    @classmethod
    def of(cls, bolsters: Floats, solve: Callable[[Floats, Floats], None]) -> "Bolstered | None":
        """From what was added to the diagonal, shape (n,), and solves with the factors.

        `solve` is given right-hand sides and room for solutions, one a row, shape (r, n or more).
        None where the matrix is singular to rounding.
        """
        places = np.flatnonzero(bolsters)
        units, influences = (aligned_rows(len(places), len(bolsters)) for _ in range(2))
        units[:], influences[:] = 0.0, 0.0
        units[np.arange(len(places)), places] = 1.0
        bolsters = bolsters[places]
        solve(units, influences)
        beside = influences[:, places]
        roots = np.sqrt(np.abs(bolsters))
        scaled = np.diag(np.sign(bolsters)) - roots[:, None] * (beside + beside.T) / 2 * roots
        eigenvalues, vectors = np.linalg.eigh(scaled)
        if not np.abs(eigenvalues).min(initial=np.inf) > _SINGULAR:
            return None
        inverse = roots[:, None] * (vectors / eigenvalues) @ vectors.T * roots
        n_negative = int((eigenvalues < 0).sum()) - int((bolsters < 0).sum())
        return cls(places, influences, inverse, n_negative)

    def take_out_of(self, solutions: Floats) -> None:
        """Turn solutions with the factored matrix into the matrix's, one a row.

        As many numbers each as `influences`.
        """
        if len(self.places):
            add_multiples(solutions, solutions[:, self.places] @ self.inverse, self.influences)
