"""A shifted symmetric matrix in factors: solves with it, and counts the eigenvalues below it."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from auricle.arrays import Floats
from auricle.errors import SolverError

_TINY_PIVOT = 1e-11
_REFINABLE = 1e-6
_MOVE = 1e-4
_ATTEMPTS = 6


@dataclass(frozen=True, eq=False)
class ShiftedFactorization:
    """Factors of (matrix − shift·I) for a sparse symmetric matrix.

    Attributes
    ----------
    shift
        The shift that was factored.
    n_below
        Number of eigenvalues of the matrix below the shift, by Sylvester's law of inertia: the
        signs of the pivots of a symmetric elimination.
    """

    shift: float
    n_below: int
    _shifted: sparse.csc_array
    _factors: SuperLU

    @property
    def size(self) -> int:
        """Number of rows of the matrix."""
        return int(self._shifted.shape[0])

    def solve(self, right: Floats) -> Floats:
        """Solution x of (matrix − shift·I) x = right, for right of shape (n,) or (n, b).

        With one step of iterative refinement: an elimination that keeps to the diagonal needs it,
        most of all where vertex areas are very uneven.
        """
        solution: Floats = self._factors.solve(np.ascontiguousarray(right))
        left = np.ascontiguousarray(right - self._shifted @ solution)
        solution += self._factors.solve(left)
        return solution


def factorize(matrix: sparse.csc_array, shift: float) -> ShiftedFactorization:
    """Factor (matrix − shift·I), moving the shift a little if it meets an eigenvalue.

    The elimination keeps to the diagonal, so that the signs of its pivots count eigenvalues.
    Such an elimination has no guarantee of stability, so it is tried out: a pivot that is tiny
    against the matrix, or a solve with a large residual, gives the shift away as too near an
    eigenvalue (of the matrix or of a leading part of it), and the shift moves up by 0.01 %, then
    twice that, and so on. A small residual is left to iterative refinement.

    Raises
    ------
    SolverError
        If no shift nearby can be factored.
    """
    identity = sparse.eye_array(matrix.shape[0], format="csc")
    scale = float(np.abs(matrix.data).max())
    probe = np.cos(np.arange(matrix.shape[0], dtype=np.float64))
    moved = shift
    for attempt in range(_ATTEMPTS):
        shifted = sparse.csc_array(matrix - moved * identity)
        factors = _symmetric_factors(shifted)
        if factors is not None:
            pivots = factors.U.diagonal()
            left = np.linalg.norm(shifted @ factors.solve(probe) - probe) / np.linalg.norm(probe)
            if np.abs(pivots).min() > _TINY_PIVOT * scale and left < _REFINABLE:
                n_below = int((pivots < 0).sum())
                return ShiftedFactorization(moved, n_below, shifted, factors)
        moved = shift * (1 + _MOVE * 2**attempt) if shift else scale * 1e-12 * 2**attempt
    raise SolverError(f"no shift near {shift:.6g} can be factored: is the surface degenerate?")


def _symmetric_factors(matrix: sparse.csc_array) -> SuperLU | None:
    """SuperLU factors whose row and column orders agree; None where it had to pivot."""
    try:
        factors = splu(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:  # SuperLU's word for an exactly singular matrix
        return None
    return factors if np.array_equal(factors.perm_r, factors.perm_c) else None
