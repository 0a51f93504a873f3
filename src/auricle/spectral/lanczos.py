"""Block Lanczos iteration on a shifted inverse: the eigenpairs nearest to one shift."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from auricle.arrays import Floats
from auricle.spectral.factorization import ShiftedFactorization

_MUCH = 1e-9


@dataclass(frozen=True, eq=False)
class RitzPairs:
    """Converged eigenpairs near a shift.

    Attributes
    ----------
    values
        Eigenvalues, shape (c,), ascending.
    vectors
        Orthonormal eigenvectors, shape (n, c).
    """

    values: Floats
    vectors: Floats


def eigenpairs_near(
    factors: ShiftedFactorization,
    known: Floats,
    *,
    block: int,
    n_steps: int,
    tolerance: float,
    rng: np.random.Generator,
) -> RitzPairs:
    """Eigenpairs of the factored matrix nearest to its shift, apart from those already known.

    Block Lanczos with full reorthogonalisation, on the inverse of (matrix − shift·I), started at
    random and kept orthogonal to `known`, so what it finds is new, also within a cluster of equal
    eigenvalues.

    Parameters
    ----------
    factors
        Of the shifted matrix.
    known
        Orthonormal eigenvectors to stay orthogonal to, shape (n, c); may have no columns.
    block, n_steps
        Width of the block and number of blocks in the basis.
    tolerance
        A pair counts as converged when the residual of its inverse eigenproblem, relative to its
        inverse eigenvalue, is below this.
    rng
        Source of the starting block.

    References
    ----------
    Grimes, Lewis & Simon 1994, "A shifted block Lanczos algorithm …".
    """
    n, n_known = known.shape
    basis = np.empty((n, n_known + block * (n_steps + 1)), order="F")
    basis[:, :n_known] = known
    own = basis[:, n_known:]
    start = rng.standard_normal((n, block))
    start -= known @ (known.T @ start)
    own[:, :block], coupling = _orthonormal(start, known)
    projected = np.zeros((block * n_steps, block * n_steps))
    for step in range(n_steps):
        here = slice(step * block, (step + 1) * block)
        image = factors.solve(own[:, here], refine=True)
        if step:
            before = slice((step - 1) * block, step * block)
            image -= own[:, before] @ coupling.T
            projected[here, before] = coupling
            projected[before, here] = coupling.T
        diagonal = own[:, here].T @ image
        image -= own[:, here] @ diagonal
        projected[here, here] = (diagonal + diagonal.T) / 2
        following, coupling = _orthonormal(image, basis[:, : n_known + here.stop])
        own[:, here.stop : here.stop + block] = following
    inverses, rotations = eigh(projected, driver="evd")
    leftover = coupling @ rotations[-block:]
    converged = np.linalg.norm(leftover, axis=0) <= tolerance * np.abs(inverses)
    chosen = np.flatnonzero(converged)[np.argsort(factors.shift + 1 / inverses[converged])]
    # One more step of inverse iteration costs nothing here: it is the basis's next block.
    weights = np.concatenate([rotations[:, chosen], leftover[:, chosen] / inverses[chosen]])
    vectors = own @ (weights / np.linalg.norm(weights, axis=0))
    return RitzPairs(factors.shift + 1 / inverses[chosen], vectors)


def _orthonormal(columns: Floats, basis: Floats) -> tuple[Floats, Floats]:
    """Orthonormal columns and a triangle with columns ≈ orthonormal·triangle, orthogonal to basis.

    The three-term recurrence has removed what of the basis should be in `columns`; this pass of
    block Gram-Schmidt removes what rounding left, and a second one follows where that was much.
    """
    left = basis.T @ columns
    columns = columns - basis @ left
    if np.abs(left).max(initial=0.0) > _MUCH * np.linalg.norm(columns, axis=0).min():
        columns -= basis @ (basis.T @ columns)
    orthonormal, triangle = np.linalg.qr(columns)
    return orthonormal, triangle
