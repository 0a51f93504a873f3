"""Solves with a matrix from the factors of another that differs in a few diagonal entries."""

from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled
from auricle.spectral.lanes import Lanes, added, load, store, width
from auricle.spectral.side_by_side import set_side_by_side
from auricle.spectral.tile_sums import TILE, lines_at_once, sum_lines

_AT_ONCE = 4
"""Bolsters whose influence is solved for together: as many as the solves of small surfaces take."""
_SINGULAR = 1e-10
"""Eigenvalue of what is inverted, in units of the inverse bolsters, that counts as none."""


class Bolstered(NamedTuple):
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
        Z in tiles, as `auricle.spectral.tile_sums` reads it.
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
    def none(cls) -> Self:
        """Of factors that have none."""
        return cls(np.empty(0, np.int64), np.empty(0), np.empty((0, 0)), 0)

    @classmethod
    def of(cls, bolsters: Floats, solve: Callable[[Floats], None]) -> Self | None:
        """From what was added to the diagonal, shape (n,), and solves with the factors.

        `solve` turns right-hand sides, shape (n, 4), into solutions in place. None where the matrix
        is singular to rounding.
        """
        places = np.flatnonzero(bolsters)
        influences = np.empty((len(bolsters), len(places)))
        for first in range(0, len(places), _AT_ONCE):
            some = places[first : first + _AT_ONCE]
            units = np.zeros((len(bolsters), _AT_ONCE))
            units[some, np.arange(len(some))] = 1.0
            solve(units)
            influences[:, first : first + len(some)] = units[:, : len(some)]
        bolsters = bolsters[places]
        beside = influences[places]
        roots = np.sqrt(np.abs(bolsters))
        scaled = np.diag(np.sign(bolsters)) - roots[:, None] * (beside + beside.T) / 2 * roots
        eigenvalues, vectors = np.linalg.eigh(scaled)
        if not np.abs(eigenvalues).min(initial=np.inf) > _SINGULAR:
            return None
        inverse = roots[:, None] * (vectors / eigenvalues) @ vectors.T * roots
        n_negative = int((eigenvalues < 0).sum()) - int((bolsters < 0).sum())
        return cls(places, _in_tiles(influences), np.ascontiguousarray(inverse), n_negative)


@compiled
def take_out_bolsters(bolstered: Bolstered, solutions: Floats, zero: Lanes) -> None:
    """Turn solutions with the factored matrix into the matrix's, shape (n, 4, 8 or 16), in place.

    `zero` has as many lanes as there are solutions, or half as many.
    """
    if len(bolstered.places) > 0:
        multiples = _multiples(bolstered.places, bolstered.inverse, solutions)
        _add(bolstered.influences, multiples, solutions, zero)


@compiled
def _multiples(places: Integers, inverse: Floats, solutions: Floats) -> Floats:
    """C⁻¹·Eᵀy, shape (r, b): what the influences are multiplied by."""
    multiples = np.zeros((len(places), solutions.shape[1]))
    for i in range(len(places)):
        for k in range(len(places)):
            for j in range(solutions.shape[1]):
                multiples[i, j] += inverse[i, k] * solutions[places[k], j]
    return multiples


@compiled
def _add(influences: Floats, factors: Floats, solutions: Floats, zero: Lanes) -> None:
    """Add influences·factors to the solutions."""
    (n, n_right), count = solutions.shape, len(factors)
    numbers, multiples = solutions.reshape(-1), factors.reshape(-1)
    sums = np.empty(2 * TILE * width(zero))
    for side in range(0, n_right, width(zero)):
        row = 0
        while row < n:
            part = (row * count, lines_at_once(max(n - row, TILE), zero), count)
            sum_lines(influences, part, (multiples, side, n_right), (sums, 0, width(zero)), zero)
            for i in range(min(part[1], n - row)):
                target = (row + i) * n_right + side
                found = added(load(zero, numbers, target), load(zero, sums, i * width(zero)))
                store(found, numbers, target)
            row += part[1]


@compiled
def _in_tiles(rows: Floats) -> Floats:
    """Rows in tiles of eight, filled up with zeros."""
    n, count = rows.shape
    tiles = np.zeros((-(-n // TILE), count * TILE))
    for t in range(len(tiles)):
        set_side_by_side(rows[t * TILE : (t + 1) * TILE], tiles[t], TILE)
    return tiles.reshape(-1)
