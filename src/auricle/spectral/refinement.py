"""Eigenpairs brought to rounding: what the matrix leaves over of them is corrected for."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import eigh

from auricle.arrays import Floats, Integers, PerMode
from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    factorize,
)
from auricle.spectral.orthonormal_rows import Orthonormal, orthonormalized
from auricle.spectral.row_products import row_products
from auricle.spectral.workers import Workers, slices

_AT_ONCE = 16
_ENOUGH, _NEARLY = 8e-10, 0.1
"""Residual, relative to the eigenvalue, that is left alone, and the share of it that is not where
others are corrected."""
_CORRECTIONS = 5
_PROGRESS = 0.5
"""Share of the largest residual that must be gone for another correction to be worth its time, from
the second on: the first is of another kind."""
_SIMILAR, _BELOW = 1.1, 0.995


def rayleigh_quotients(
    matrix: sparse.csc_array, rows: Floats, workers: Workers
) -> tuple[PerMode, PerMode]:
    """Of each row the value nearest to an eigenvalue, and the norm of what is left, shape (k,)."""
    values, residuals = np.empty(len(rows)), np.empty(len(rows))

    def fill(some: slice) -> None:
        values[some], left_over = _left_over(matrix, rows[some])
        residuals[some] = np.linalg.norm(left_over, axis=1)

    workers.each(fill, slices(len(rows), _AT_ONCE))
    return values, residuals


@dataclass(frozen=True, eq=False)
class Refined:
    """Approximate eigenvectors, with what the matrix makes of them.

    Attributes
    ----------
    rows
        Orthonormal, one a row, shape (k, n).
    values, residuals
        Rayleigh quotients, and norms of what is left over, shape (k,).
    departure
        Of the rows from orthonormal, as `orthonormalized` measured it.
    """

    rows: Floats
    values: PerMode
    residuals: PerMode
    departure: float


def freed_of_rounding(
    matrix: sparse.csc_array,
    rows: Floats,
    *,
    least: float,
    workers: Workers,
    symbolic: SymbolicFactorization | None = None,
) -> Floats:
    """Rows without what rounding put into them, where the matrix would make much of it.

    An entry of an iteration's vector is right to rounding of the vector's length and not of its
    own size. At vertices of very little area the matrix is large, and there that shows. Such
    errors belong to eigenvalues far above those sought, and one solve with the matrix, shifted
    to be positive definite, takes them out. Rows are returned as they are where none is expected.
    Arguments are those of `corrected`.
    """
    if np.finfo(float).eps * matrix.diagonal().max() <= _ENOUGH * least:
        return rows
    values, residuals = rayleigh_quotients(matrix, rows, workers)
    noisy = np.flatnonzero(residuals > _NEARLY * _ENOUGH * np.maximum(values, least))
    factors = factorize(matrix, -least, symbolic=symbolic)
    return _solved_for(matrix, rows, noisy, factors, workers)


def corrected(
    matrix: sparse.csc_array,
    approximate: Orthonormal,
    *,
    least: float,
    workers: Workers,
    symbolic: SymbolicFactorization | None = None,
) -> Refined:
    """Rows whose residual, relative to the eigenvalue, is below 8e-10 where rounding allows.

    First what rounding leaves is taken out of those that leave over more, as `freed_of_rounding`
    does. Where that is not enough, the rows are rotated into Ritz vectors, and steps of inverse
    iteration follow at shifts near to what is left.

    Parameters
    ----------
    matrix
        Symmetric, positive semi-definite, shape (n, n).
    approximate
        Eigenvectors of its lowest eigenvalues, one a row, shape (k, n).
    least
        Eigenvalue that residuals of smaller ones are relative to.
    workers
        Who share the solves.
    symbolic
        The analysis of the matrix's pattern, where there is one at hand.
    """
    before, rows = np.inf, approximate.rows
    for attempt in range(_CORRECTIONS + 1):
        values, residuals = rayleigh_quotients(matrix, rows, workers)
        relative = residuals / np.maximum(values, least)
        worst = float(relative.max())
        stuck = attempt > 1 and worst > _PROGRESS * before
        if worst <= _ENOUGH or attempt == _CORRECTIONS or stuck:
            break
        before = worst
        # Those nearly poor would be the next to be so.
        groups = [(-least, np.flatnonzero(relative > _NEARLY * _ENOUGH))]
        if attempt:
            rows = _rotated(matrix, rows, workers)
            groups = _by_height(*_poor(matrix, rows, least, workers), least)
        for shift, some in groups:
            factors = factorize(matrix, shift, symbolic=symbolic)
            rows = _solved_for(matrix, rows, some, factors, workers)
        approximate = orthonormalized(rows, workers)
        rows = approximate.rows
    return Refined(rows, values, residuals, approximate.departure)


def _poor(
    matrix: sparse.csc_array, rows: Floats, least: float, workers: Workers
) -> tuple[PerMode, Integers]:
    """Rayleigh quotients, and which rows leave over more than they should."""
    values, residuals = rayleigh_quotients(matrix, rows, workers)
    return values, np.flatnonzero(residuals > _ENOUGH * np.maximum(values, least))


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


def _rotated(matrix: sparse.csc_array, rows: Floats, workers: Workers) -> Floats:
    """Of the space the rows span, those that the matrix maps onto themselves (Rayleigh-Ritz).

    Neighbouring runs' vectors can be mixed with each other, where eigenvalues are nearly equal.
    """
    products = np.empty((len(rows), len(rows)))

    def fill(some: slice) -> None:
        products[some] = row_products(matrix, rows[some]) @ rows.T

    workers.each(fill, slices(len(rows), _AT_ONCE))
    _, rotation = eigh(0.5 * (products + products.T))
    rotated: Floats = rotation.T @ rows
    return rotated


def _solved_for(
    matrix: sparse.csc_array,
    rows: Floats,
    poor: Integers,
    factors: ShiftedFactorization,
    workers: Workers,
) -> Floats:
    """Rows with what is left over of the poor ones solved for: a step of inverse iteration."""
    better = rows.copy()

    def fill(some: slice) -> None:
        _, left_over = _left_over(matrix, rows[poor[some]])
        better[poor[some]] -= factors.solve(left_over.T).T

    workers.each(fill, slices(len(poor), _AT_ONCE))
    return better


def _left_over(matrix: sparse.csc_array, rows: Floats) -> tuple[Floats, Floats]:
    """Rayleigh quotients, and what the matrix makes of the rows beyond them."""
    left_over = row_products(matrix, rows)
    values = np.einsum("kn,kn->k", rows, left_over)
    left_over -= values[:, None] * rows
    return values, left_over
