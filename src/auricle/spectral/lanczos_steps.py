"""Steps of block Lanczos iteration, compiled: several of them are one call.

Between two calls the interpreter holds a lock that threads which search side by side wait for.
"""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.gram_schmidt import by_householder, make_orthonormal, take_out
from auricle.spectral.narrow_products import Groups
from auricle.spectral.solves import Solver, solve

LEAST_LOST = 1e-15
"""How far from orthogonal to the basis a block is at least once it was made so."""
_LEAST_SQUARE = 1e-300


class Recurrence(NamedTuple):
    """What the steps of a run change.

    Attributes
    ----------
    basis
        Blocks of width b, beside the known vectors, all in groups; the first of them is made.
    projected
        The inverse in the basis, shape (m·b, m·b).
    coupling
        What couples the last block to the one before, a lower triangle, shape (b, b).
    """

    basis: Groups
    projected: Floats
    coupling: Floats


class Lost(NamedTuple):
    """How far from orthogonal to the basis rounding may have left the latest blocks.

    Attributes
    ----------
    scale
        Of the inverse: the largest image of a block met.
    least, most
        How far a block is after all was taken out of it, and how far one may be that is left as
        it is.
    before, last
        Of the block before the last, and of that.
    n_looks
        How often all was taken out.
    """

    scale: float
    least: float
    most: float
    before: float
    last: float
    n_looks: int


def take_steps(
    solver: Solver, run: Recurrence, lost: Lost, n_known: int, steps: tuple[int, int]
) -> Lost:
    """Lengthen the basis of a run by a block a step.

    Parameters
    ----------
    solver
        Whose solves are the operator.
    run
        Changed in place.
    lost
        Of what was made so far.
    n_known
        Groups of the basis that hold known vectors.
    steps
        From which step up to which, exclusive.

    Returns
    -------
    Lost
        Of what is made then.
    """
    lanes = run.basis.shape[2]
    step, end = steps
    while step < end:
        step, lost, is_made = _take(solver, run, lost, n_known, (step, end), (0.0,) * lanes)
        if not is_made:
            # Vectors too near to dependent, which is rare, are left to a library.
            width = len(run.coupling) // lanes
            block = run.basis[n_known + step * width :][:width]
            run.coupling[:] = by_householder(block, run.coupling)
    return lost


@compiled
def _take(
    solver: Solver,
    run: Recurrence,
    lost: Lost,
    n_known: int,
    steps: tuple[int, int],
    like: tuple[float, ...],
) -> tuple[int, Lost, bool]:
    """Steps until all are taken, or one whose block could not be made orthonormal.

    Returns how many blocks follow the first, and whether the last of them was made.
    """
    size = len(run.coupling)
    width = size // run.basis.shape[2]
    for step in range(steps[0], steps[1]):
        end = n_known + (step + 1) * width
        for group in range(end, end + width):
            solve(solver, run.basis[group - width], run.basis[group], like)
        image = run.basis[end : end + width]
        diagonal, left = np.zeros((size, size)), np.zeros((size, size))
        lost = _make_orthogonal(run.basis[:end], n_known, image, (diagonal, left), lost, like)
        _project(run, step, diagonal)
        run.coupling[:] = np.eye(size)
        if not make_orthonormal(image, left, run.coupling, like):
            return step + 1, lost, False
    return steps[1], lost, True


@compiled
def _make_orthogonal(
    basis: Groups,
    n_known: int,
    image: Groups,
    products: tuple[Floats, Floats],
    lost: Lost,
    like: tuple[float, ...],
) -> Lost:
    """Make the image of the last block of a basis orthogonal to that.

    Sets `products`, of zeros, to the image's part in the last block and to the inner products of
    what is left of it.

    In exact arithmetic the last two blocks would do. Rounding leaves some of the others behind, and
    every step that looks at the last two only enlarges that, by the ratio of the operator to what
    is left of the image. All are taken out of the image as soon as it has more of them than may
    stay in the basis (Simon 1984, partial reorthogonalisation).
    """
    diagonal, left = products
    near = basis[max(len(basis) - 2 * len(image), 0) :]
    inside = _take_out(near, image, left, like)
    size = len(left)
    diagonal += inside[len(inside) - size :]
    if n_known > 0:
        rest = _take_out(basis, image, left, like)
        diagonal += rest[len(rest) - size :]
        return lost
    scale = max(lost.scale, np.sqrt(np.sum(inside**2)))
    squares = np.empty(size)
    for i in range(size):
        squares[i] = max(left[i, i], _LEAST_SQUARE)
    now = lost.last * scale / np.sqrt(squares.min()) + lost.before
    if not now > lost.most:
        return Lost(scale, lost.least, lost.most, lost.last, now, lost.n_looks)
    rest = _take_out(basis, image, left, like)
    # What was found tells how much rounding leaves in this run.
    excess = 0.0
    for row in rest:
        for i in range(size):
            excess = max(excess, row[i] ** 2 / squares[i])
    least = min(max(lost.least * np.sqrt(excess) / now, LEAST_LOST), lost.most)
    return Lost(scale, least, lost.most, lost.last, least, lost.n_looks + 1)


@compiled
def _take_out(basis: Groups, image: Groups, left: Floats, like: tuple[float, ...]) -> Floats:
    """Take a basis out; returns coefficients, sets `left` to the products of what is left."""
    coefficients = np.zeros((len(basis) * image.shape[2], len(left)))
    left[:] = 0.0
    take_out(basis, image, coefficients, left, like)
    return coefficients


@compiled
def _project(run: Recurrence, step: int, diagonal: Floats) -> None:
    """Note what the inverse makes of a block in the basis."""
    size = len(diagonal)
    here = step * size
    for i in range(size):
        for j in range(size):
            run.projected[here + i, here + j] = (diagonal[i, j] + diagonal[j, i]) / 2
            if step > 0:
                run.projected[here - size + i, here + j] = run.coupling[i, j]
                run.projected[here + j, here - size + i] = run.coupling[i, j]
