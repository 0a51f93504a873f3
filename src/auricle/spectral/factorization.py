"""A shifted symmetric matrix in factors: solves with it, and counts the eigenvalues below it."""

from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.errors import SolverError
from auricle.spectral.bolsters import Bolstered
from auricle.spectral.elimination import EliminationPlan, elimination_plan, plan_in_order
from auricle.spectral.factor_streams import Room, Rooms
from auricle.spectral.ldl import eliminate, working_size
from auricle.spectral.ordering import nested_dissection
from auricle.spectral.row_products import Entries
from auricle.spectral.solves import Solver, solve
from auricle.spectral.workers import Workers

_NARROW, _WIDE, _AT_ONCE = 4, 8, 16
"""Right-hand sides that a register holds, one kind or the other, and that are solved at a time."""
_GROWTHS, _MOST_BOLSTERS = (50.0, 1e3, 1e5, np.inf), 64
"""Largest entries that L may have: the first for which not more pivots are bolstered than is cheap
to correct for."""
_MOVE, _LEAST_MOVE = 1e-4, 1e-10
"""Of the shift, and of the largest entry of the matrix."""
_ATTEMPTS = 6
_LARGEST_BACKWARD_ERROR = 1e-7
"""Of a trial solve; above it the shift is moved. One refinement takes this to rounding."""
_REFINED_ABOVE = 1e-11
"""Backward error above which solves are refined unasked: eigenpairs need 1e-9."""
_IN_ORDER = np.empty(0, np.int64)
"""What a solver is told where the matrix's rows lie in the order of elimination."""


@dataclass(frozen=True, eq=False)
class SymbolicFactorization:
    """What all matrices of one pattern share in their factorisations, at any shift.

    Attributes
    ----------
    plan
        Order of elimination, supernodes, and the place of every entry.
    """

    plan: EliminationPlan
    _starts: NDArray[np.int32]
    _neighbours: NDArray[np.int32]

    @property
    def n_bytes(self) -> int:
        """Memory that one factorisation takes while it is made, without the matrix and plan."""
        return 8 * working_size(self.plan)

    def fits(self, matrix: sparse.csc_array) -> bool:
        """Whether a matrix has exactly the pattern that was analysed."""
        return np.array_equal(matrix.indptr, self._starts) and np.array_equal(
            matrix.indices, self._neighbours
        )


def analyze(matrix: sparse.csc_array, workers: Workers | None = None) -> SymbolicFactorization:
    """Order and plan the factorisation of a symmetric matrix; its values do not matter.

    Parameters
    ----------
    matrix
        Both triangles stored, shape (n, n).
    workers
        Who share the work, if any; the order does not depend on them.

    Raises
    ------
    SolverError
        If the matrix has no rows, or has an entry without its mirror image.
    """
    n = matrix.shape[0]
    if n == 0 or matrix.shape[1] != n or not _mirrored(matrix):
        raise SolverError(
            f"a matrix of shape {matrix.shape} is not symmetric: store both of its triangles"
        )
    return _symbolic(matrix, elimination_plan(matrix, nested_dissection(matrix, workers)))


def in_order(
    matrix: sparse.csc_array, symbolic: SymbolicFactorization
) -> tuple[sparse.csc_array, SymbolicFactorization]:
    """The matrix with its rows and columns in the order of elimination, and the analysis of that.

    There neighbours lie side by side, and solves need not look for them.

    Examples
    --------
    >>> path = sparse.csc_array(sparse.diags_array([np.ones(50)] * 2, offsets=[-1, 1]))
    >>> _, symbolic = in_order(path, analyze(path))
    >>> bool((symbolic.plan.order == np.arange(51)).all())
    True
    """
    order = symbolic.plan.order
    ordered = sparse.csc_array(matrix[order][:, order])
    ordered.sort_indices()
    return ordered, _symbolic(ordered, plan_in_order(symbolic.plan, ordered))


def _symbolic(matrix: sparse.csc_array, plan: EliminationPlan) -> SymbolicFactorization:
    return SymbolicFactorization(plan, matrix.indptr.copy(), matrix.indices.copy())


def _mirrored(matrix: sparse.csc_array) -> bool:
    """Whether the transpose of a square matrix has the same pattern."""
    parts = (np.ones(len(matrix.indices), np.int8), matrix.indices, matrix.indptr)
    pattern = sparse.csc_array(parts, shape=matrix.shape, copy=True)
    pattern.sort_indices()
    mirrored = sparse.csc_array(pattern.T)
    mirrored.sort_indices()
    return np.array_equal(pattern.indptr, mirrored.indptr) and np.array_equal(
        pattern.indices, mirrored.indices
    )


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
    backward_error
        Of one solve made as a trial, without refinement: the largest residual of a row against
        what went into it, |r| / (|matrix − shift·I|·|x| + |right|) (Oettli & Prager 1964). It
        does not grow where the shift is near an eigenvalue, only where pivots were poor.
    """

    shift: float
    n_below: int
    backward_error: float = field(init=False)
    _entries: Entries
    _plan: EliminationPlan
    _room: Room | None
    _bolstered: Bolstered

    def __post_init__(self) -> None:
        right = np.random.default_rng(0).standard_normal(self.size)
        solution = self.solve(right, refine=False)
        error = _backward_error(self._entries, self.shift, right, solution)
        object.__setattr__(self, "backward_error", error)

    @property
    def size(self) -> int:
        """Number of rows of the matrix."""
        return len(self._plan.order)

    def solve(self, right: Floats, *, refine: bool | None = None) -> Floats:
        """Solution x of (matrix − shift·I) x = right, for right of shape (n,) or (n, b).

        Blocks are much faster than single columns. With `refine` the residual is solved for once
        more, at twice the time; unless told, where `backward_error` is more than 1e-11.
        """
        columns = right.reshape(self.size, -1)
        solution = np.empty_like(columns, dtype=np.float64)
        for first in range(0, columns.shape[1], _AT_ONCE):
            some = columns[:, first : first + _AT_ONCE]
            n_right = some.shape[1]
            n_solved = _NARROW if n_right <= _NARROW else -(-n_right // _WIDE) * _WIDE
            padded = np.zeros((self.size, n_solved))
            padded[:, :n_right] = some
            solved = np.empty_like(padded)
            solve(self.solver(refined=refine), padded, solved, (0.0,) * min(n_solved, _WIDE))
            solution[:, first : first + _AT_ONCE] = solved[:, :n_right]
        return solution.reshape(right.shape)

    def solver(self, *, refined: bool | None = None) -> Solver:
        """For solves of groups of 4 or 8 in compiled code, while these factors are held.

        Raises
        ------
        SolverError
            If the factors were let go.
        """
        if self._room is None:
            raise SolverError(f"the factors at shift {self.shift:.6g} were let go: factor again")
        if refined is None:
            refined = self.backward_error > _REFINED_ABOVE
        order = _IN_ORDER if self._is_in_order else self._plan.order
        streams, bolstered = self._room.streams, self._bolstered
        return Solver(self._plan, streams, bolstered, order, self._entries, self.shift, refined)

    def let_go(self) -> None:
        """Leave the factors' room to the next: shift and count stay, solves are over."""
        object.__setattr__(self, "_room", None)

    @cached_property
    def _is_in_order(self) -> bool:
        return np.array_equal(self._plan.order, np.arange(self.size))


def factorize(
    matrix: sparse.csc_array,
    shift: float,
    *,
    symbolic: SymbolicFactorization | None = None,
    rooms: Rooms | None = None,
) -> ShiftedFactorization:
    """Factor (matrix − shift·I), moving the shift a little if it meets an eigenvalue.

    The elimination is symmetric, so that the signs of its pivots count eigenvalues. Its pivots
    are chosen within small blocks only, which does not guarantee stability: a pivot that is tiny
    against its column of the matrix, or a trial solve of large residual, gives the shift away as
    too near an eigenvalue (of the matrix or of a leading part of it), and the shift moves up by
    0.01 % (or, near zero, by 1e-10 of the largest entry), then by twice that, and so on.

    Parameters
    ----------
    matrix
        Symmetric, both triangles stored.
    shift
        Where to factor.
    symbolic
        The analysis of a matrix of the same pattern; made here where there is none at hand.
    rooms
        Where the factors are put, and which have their room back when no one holds these.

    Raises
    ------
    SolverError
        If no shift nearby can be factored, or `symbolic` is of another pattern.

    Examples
    --------
    Of the eigenvalues 0, 1, …, 9 three lie below 2.5:

    >>> factors = factorize(sparse.csc_array(sparse.diags_array(np.arange(10.0))), 2.5)
    >>> factors.n_below
    3
    >>> [float(x) for x in factors.solve(np.ones(10))[:4]]
    [-0.4, -0.6666666666666666, -2.0, 2.0]
    """
    symbolic = symbolic or analyze(matrix)
    if not symbolic.fits(matrix):
        raise SolverError("the matrix has another pattern than its analysis: analyze it anew")
    # Numbers of another kind, or that cannot be written, would be compiled for anew.
    data = np.require(matrix.data, np.float64, ["C", "W"])
    entries = (matrix.indptr, matrix.indices, data)
    magnitudes = _largest_magnitudes(matrix.indptr, data)
    scale = float(magnitudes.max())
    magnitudes = magnitudes[symbolic.plan.order]
    moved = float(shift)
    for attempt in range(_ATTEMPTS):
        factors = _factored(entries, (moved, magnitudes), symbolic.plan, rooms or Rooms())
        if factors is not None and factors.backward_error <= _LARGEST_BACKWARD_ERROR:
            return factors
        moved = shift + max(_MOVE * abs(shift), _LEAST_MOVE * scale) * 2**attempt
    raise SolverError(f"no shift near {shift:.6g} can be factored: is the surface degenerate?")


def _factored(
    entries: Entries, scales: tuple[float, Floats], plan: EliminationPlan, rooms: Rooms
) -> ShiftedFactorization | None:
    """Factors at exactly this shift; None where the matrix is singular there to rounding.

    `scales` are the shift, and magnitudes of columns.
    """
    shift, magnitudes = scales
    room, bolstered = rooms.take(plan), None
    for growth in _GROWTHS:
        eliminated = eliminate(plan, entries[2], shift, magnitudes, room.streams, growth=growth)
        if eliminated is None or np.count_nonzero(eliminated[1]) <= _MOST_BOLSTERS:
            break
    if eliminated is not None:
        n_negative, bolsters = eliminated
        bare = Solver(plan, room.streams, Bolstered.none(), _IN_ORDER, entries, shift, False)
        bolstered = Bolstered.of(bolsters, partial(_solve_in_place, bare))
    if bolstered is None:
        return None
    n_below = n_negative + bolstered.n_negative
    return ShiftedFactorization(shift, n_below, entries, plan, room, bolstered)


def _solve_in_place(solver: Solver, columns: Floats) -> None:
    solve(solver, columns, columns, (0.0,) * columns.shape[1])


@compiled
def _largest_magnitudes(starts: NDArray[np.int32], data: Floats) -> Floats:
    """Of the entries of each column; 0 where there is none."""
    largest = np.zeros(len(starts) - 1)
    for column in range(len(largest)):
        for e in range(starts[column], starts[column + 1]):
            largest[column] = max(largest[column], abs(data[e]))
    return largest


@compiled
def _backward_error(entries: Entries, shift: float, right: Floats, solution: Floats) -> float:
    """The largest residual of a row against what went into it; infinite where it is no number."""
    starts, neighbours, data = entries
    largest = 0.0
    for row in range(len(right)):
        rest = right[row] + shift * solution[row]
        size = abs(right[row]) + abs(shift * solution[row])
        for e in range(starts[row], starts[row + 1]):
            product = data[e] * solution[neighbours[e]]
            rest, size = rest - product, size + abs(product)
        error = abs(rest) / size
        if np.isnan(error):
            return np.inf
        largest = max(largest, error)
    return largest
