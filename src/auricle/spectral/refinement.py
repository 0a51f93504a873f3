"""Eigenpairs brought to rounding: what the matrix leaves over of them is corrected for."""

import numpy as np
from scipy import sparse

from auricle.arrays import Floats, Integers, PerMode
from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    factorize,
)
from auricle.spectral.orthonormal_rows import Orthonormal, orthonormalized
from auricle.spectral.row_products import row_products
from auricle.spectral.separation import Measure
from auricle.spectral.workers import Workers, slices

_AT_ONCE = 16
_ENOUGH, _NEARLY = 8e-10, 0.1
"""Residual, relative to the eigenvalue, that is left alone, and the share of it that is not where
others are corrected."""
_EXCEPTIONAL = 10.0
"""Of the median of the matrix's diagonal: vertices of so much more have far too little area."""
_CORRECTIONS = 4
_PROGRESS = 0.5
"""Share of the largest residual that must be gone for another correction to be worth its time."""
_SIMILAR, _BELOW = 1.1, 0.995


def free_of_rounding(
    matrix: sparse.csc_array, rows: Floats, values: PerMode, *, least: float
) -> None:
    """Take out of rows, in place, what rounding put into them where the matrix makes much of it.

    An entry of an iteration's vector is right to rounding of the vector's length and not of its
    own size. At the few vertices of very little area the matrix is large, and there that shows.
    What belongs there follows from all other entries by a small system of equations.

    Parameters
    ----------
    matrix
        Symmetric, positive semi-definite, shape (n, n).
    rows, values
        Eigenvectors of its lowest eigenvalues, one a row, shape (k, n), and these, shape (k,).
    least
        Eigenvalue that residuals of smaller ones are relative to.
    """
    diagonal = matrix.diagonal()
    loud = np.finfo(float).eps * diagonal > _NEARLY * _ENOUGH * least
    places = np.flatnonzero(loud & (diagonal > _EXCEPTIONAL * np.median(diagonal)))
    if not len(places):
        return
    columns = sparse.csc_array(matrix[:, places])
    around = np.unique(columns.indices)
    left_over = columns[around].T @ rows[:, around].T - values * rows[:, places].T
    factors = factorize(sparse.csc_array(columns[places]), 0.0)
    rows[:, places] -= factors.solve(left_over).T


def corrected(
    matrix: sparse.csc_array,
    rows: Floats,
    guesses: PerMode,
    *,
    least: float,
    workers: Workers,
    symbolic: SymbolicFactorization | None = None,
) -> Orthonormal:
    """Orthonormal rows whose residual, relative to the eigenvalue, is below 8e-10 if it can be.

    First what rounding leaves is taken out of those that leave over more: it belongs to eigenvalues
    far above, and one solve with the matrix, shifted to be positive definite, makes little of it.
    Where that is not enough, the rows are rotated into Ritz vectors, and steps of inverse iteration
    follow at shifts near to what is left.

    Parameters
    ----------
    matrix
        Symmetric, positive semi-definite, shape (n, n).
    rows
        Eigenvectors of its lowest eigenvalues, nearly orthonormal, one a row, shape (k, n); changed
        in place.
    guesses
        Of the eigenvalues, shape (k,).
    least
        Eigenvalue that residuals of smaller ones are relative to.
    workers
        Who share the solves.
    symbolic
        The analysis of the matrix's pattern, where there is one at hand.
    """
    separated = Measure.of(matrix, float(np.abs(guesses).max(initial=0.0)), workers)
    known = separated(rows, guesses)
    relative = known.relative_residuals(least)
    if relative.max() > _ENOUGH:
        # Those nearly poor would be the next to be so.
        some = np.flatnonzero(relative > _NEARLY * _ENOUGH)
        factors = factorize(matrix, -float(known.values.max()), symbolic=symbolic)
        _solve_for(matrix, rows, some, factors, workers)
        known = known.replaced(some, separated(rows[some], known.values[some]))
    found = orthonormalized(rows, known, separated, workers)
    before = np.inf
    for _ in range(_CORRECTIONS):
        worst = float(found.separation.relative_residuals(least).max())
        if worst <= _ENOUGH or worst > _PROGRESS * before:
            break
        before = worst
        values, rows = _rotated(matrix, found.rows, workers)
        known = separated(rows, values)
        poor = np.flatnonzero(known.relative_residuals(least) > _ENOUGH)
        for shift, some in _by_height(known.values, poor, least):
            factors = factorize(matrix, shift, symbolic=symbolic)
            _solve_for(matrix, rows, some, factors, workers)
        found = orthonormalized(rows, separated(rows, known.values), separated, workers)
    return found


def _by_height(values: PerMode, poor: Integers, least: float) -> list[tuple[float, Integers]]:
    """Poor rows in groups of similar eigenvalues, each with a shift just below its lowest."""
    groups: list[tuple[float, Integers]] = []
    left = poor[np.argsort(values[poor], kind="stable")]
    while len(left):
        low = max(float(values[left[0]]), 0.5 * least)
        n_here = int((values[left] <= _SIMILAR * low).sum())
        shift = _BELOW * low
        groups.append((shift, left[:n_here]))
        left = left[n_here:]
    return groups


def _rotated(matrix: sparse.csc_array, rows: Floats, workers: Workers) -> tuple[PerMode, Floats]:
    """Of the space the rows span, those that the matrix maps onto themselves (Rayleigh-Ritz).

    Neighbouring runs' vectors can be mixed with each other, where eigenvalues are nearly equal.
    """
    products = np.empty((len(rows), len(rows)))

    def fill(some: slice) -> None:
        products[some] = row_products(matrix, rows[some]) @ rows.T

    workers.each(fill, slices(len(rows), _AT_ONCE))
    values, rotation = np.linalg.eigh(0.5 * (products + products.T))
    return values, rotation.T @ rows


def _solve_for(
    matrix: sparse.csc_array,
    rows: Floats,
    poor: Integers,
    factors: ShiftedFactorization,
    workers: Workers,
) -> None:
    """Solve, in place, for what is left over of the poor rows: a step of inverse iteration."""

    def fill(some: slice) -> None:
        wrong = rows[poor[some]]
        left_over = row_products(matrix, wrong)
        left_over -= np.einsum("kn,kn->k", wrong, left_over)[:, None] * wrong
        rows[poor[some]] = wrong - factors.solve(left_over.T).T

    workers.each(fill, slices(len(poor), _AT_ONCE))
