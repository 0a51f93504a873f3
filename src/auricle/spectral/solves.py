"""Solves with a shifted matrix from its factors, from the right-hand side to the solution."""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled
from auricle.spectral.bolsters import Bolstered, take_out_bolsters
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.factor_streams import FactorStreams
from auricle.spectral.lanes import zeros
from auricle.spectral.row_products import Entries
from auricle.spectral.substitution import substitute


class Solver(NamedTuple):
    """All that a solve reads.

    Attributes
    ----------
    plan, streams
        The factors, as `auricle.spectral.ldl.eliminate` leaves them.
    bolstered
        What these factors have in their diagonal and the matrix has not.
    order
        Rows in the order of elimination, shape (n,); none where they lie in it already.
    entries
        Of the matrix, not shifted; both triangles.
    shift
        By which it was shifted.
    refined
        Whether the residual is solved for once more.
    """

    plan: EliminationPlan
    streams: FactorStreams
    bolstered: Bolstered
    order: Integers
    entries: Entries
    shift: float
    refined: bool


@compiled
def solve(solver: Solver, right: Floats, solution: Floats, like: tuple[float, ...]) -> None:
    """Set `solution` to (matrix − shift·I)⁻¹·right, both of shape (n, b), contiguous.

    `like` has as many numbers as there are columns, 4 or 8, or half of 16.
    """
    order, zero = solver.order, zeros(like)
    change, rest = solution, right
    for attempt in range(1 + solver.refined):
        if attempt > 0:
            change, rest = np.empty_like(solution), _residual(solver, right, solution)
        columns = change if len(order) == 0 else np.empty_like(solution)
        if len(order) == 0:
            columns[:] = rest
        for i in range(len(order)):
            columns[i] = rest[order[i]]
        substitute(solver.plan, solver.streams, columns, zero)
        take_out_bolsters(solver.bolstered, columns, zero)
        for i in range(len(order)):
            change[order[i]] = columns[i]
        if attempt > 0:
            _add(change, solution)


@compiled
def _add(change: Floats, solution: Floats) -> None:
    for i in range(len(solution)):
        for j in range(solution.shape[1]):
            solution[i, j] += change[i, j]


@compiled
def _residual(solver: Solver, right: Floats, solution: Floats) -> Floats:
    starts, neighbours, data = solver.entries
    residual = np.empty_like(right)
    for i in range(len(residual)):
        for j in range(residual.shape[1]):
            residual[i, j] = right[i, j] + solver.shift * solution[i, j]
            for e in range(starts[i], starts[i + 1]):
                residual[i, j] -= data[e] * solution[neighbours[e], j]
    return residual
