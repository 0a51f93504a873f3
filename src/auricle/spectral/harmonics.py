"""Manifold harmonics: the eigenfunctions of a surface's Laplacian, complete and certified."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy import sparse
from threadpoolctl import ThreadpoolController

from auricle.arrays import Floats, Modes, PerMode, PerVertex, read_only
from auricle.errors import InputError, SolverError
from auricle.progress import Progress, silent
from auricle.spectral.factorization import SymbolicFactorization, analyze, factorize, in_order
from auricle.spectral.ladder import CLUSTER_GAP, end_of_cluster
from auricle.spectral.laplacian import Laplacian, laplacian
from auricle.spectral.memory import require_memory
from auricle.spectral.mode_arrays import modes_in_place
from auricle.spectral.orthonormal_rows import Orthonormal
from auricle.spectral.power import Spectrum
from auricle.spectral.refinement import corrected, free_of_rounding
from auricle.spectral.slicing import LowestPairs, lowest_eigenpairs
from auricle.spectral.workers import Workers
from auricle.surface.mesh import Mesh

LARGEST_RESIDUAL = 1e-9
LARGEST_ORTHOGONALITY_ERROR = 1e-10
_DENSE_SIZE = 1_500
_DENSE_SHARE = 1 / 4
_DENSE_COPIES = 5
"""Full matrices that LAPACK's divide and conquer holds at one time."""


@dataclass(frozen=True)
class Certificate:
    """Evidence that a set of harmonics is complete and accurate.

    Attributes
    ----------
    n_asked, n_modes
        Harmonics asked for and returned; more are returned where the last one asked for belongs
        to a cluster of equal eigenvalues, which is returned whole.
    gap_per_mm2
        A number between the last eigenvalue returned and the next one.
    eigenvalues_below_gap
        Eigenvalues below it, counted by matrix inertia and not by the solver: equals `n_modes`.
    largest_residual
        Of ‖stiffness·u − λ·areas·u‖ in the inverse-area norm, relative to λ; for the zero modes
        relative to the first eigenvalue that is not zero.
    largest_orthogonality_error
        Of |modesᵀ·areas·modes − identity|: measured, but for modes whose eigenvalues are so far
        apart that their residuals bound it to less than 4e-11.
    n_zero_modes
        Harmonics constant on a piece of the surface: as many as there are pieces.
    method
        ``dense LAPACK`` or ``block Lanczos with spectrum slicing``.
    retries
        What the solver searched for again, one phrase each.
    """

    n_asked: int
    n_modes: int
    gap_per_mm2: float
    eigenvalues_below_gap: int
    largest_residual: float
    largest_orthogonality_error: float
    n_zero_modes: int
    method: str
    retries: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Harmonics:
    """Manifold harmonics of one mesh, orthonormal under its vertex areas.

    The only inner product is modesᵀ·diag(areas)·modes = identity. Each mode's sign makes its
    entry of largest magnitude positive.

    Attributes
    ----------
    eigenvalues
        Shape (k,), 1/mm², ascending from 0.
    modes
        Shape (n, k), 1/mm.
    areas
        Shape (n,), mm².
    laplacian
        Which operator: ``cotangent`` or ``intrinsic Delaunay``.
    certificate
        Of completeness and accuracy.
    """

    eigenvalues: PerMode
    modes: Modes
    areas: PerVertex
    laplacian: str
    certificate: Certificate

    def __post_init__(self) -> None:
        for name in ("eigenvalues", "modes", "areas"):
            object.__setattr__(self, name, read_only(getattr(self, name), np.float64))
        if self.modes.shape != (len(self.areas), len(self.eigenvalues)):
            raise InputError(
                f"modes have shape {self.modes.shape} for {len(self.areas)} vertices and "
                f"{len(self.eigenvalues)} eigenvalues"
            )

    @property
    def n_modes(self) -> int:
        """Number of harmonics."""
        return len(self.eigenvalues)

    @property
    def area(self) -> float:
        """Area of the surface, mm²."""
        return float(self.areas.sum())

    def transform(self, values: Floats) -> Floats:
        """Coefficients of a map: its area-weighted projection on the harmonics.

        Shape (k,) for values of shape (n,), or (k, c) for (n, c); the map's unit times mm.
        """
        weighted = values * self.areas.reshape(-1, *[1] * (values.ndim - 1))
        coefficients: Floats = self.modes.T @ weighted
        return coefficients

    def inverse(self, coefficients: Floats) -> Floats:
        """The map that has these leading coefficients, shape (n,) or (n, c)."""
        values: Floats = self.modes[:, : len(coefficients)] @ coefficients
        return values

    def power_spectrum(self, values: Floats) -> Spectrum:
        """Power of a map by harmonic, against its total power by Parseval.

        A vector map's columns are added up. The mean is split off first, so that an offset of
        any size (250 mm of scanner origin, 1e6 mm) leaves the rest of the spectrum alone.

        Raises
        ------
        InputError
            If a value is missing (fill it first) or the map is constant.
        """
        if not np.isfinite(values).all():
            raise InputError("the map has unsampled vertices: fill them before the transform")
        columns = values.reshape(len(values), -1)
        n_constant = self.certificate.n_zero_modes
        # Twice, since one subtraction of a large mean leaves its rounding behind.
        constants = self.modes[:, :n_constant]
        mean = constants @ self.transform(columns)[:n_constant]
        varying = columns - mean
        rest = constants @ self.transform(varying)[:n_constant]
        coefficients = self.transform(varying - rest)
        coefficients[:n_constant] = self.transform(mean + rest)[:n_constant]
        power = (coefficients**2).sum(axis=1)
        varying_total = float((self.areas[:, None] * (varying - rest) ** 2).sum())
        return Spectrum(self.eigenvalues, power, varying_total, n_constant)


def manifold_harmonics(
    mesh: Mesh, n_modes: int, *, seed: int = 1, threads: int = 2, progress: Progress = silent
) -> Harmonics:
    """The first `n_modes` manifold harmonics of a mesh: complete and certified, or refused.

    Small problems and large shares of the spectrum are solved densely, the others by spectrum
    slicing. Either way the number of eigenvalues is counted independently by matrix inertia.

    Parameters
    ----------
    mesh
        Any triangle mesh; several pieces are allowed.
    n_modes
        How many, the constant one included; if the last belongs to a cluster of equal
        eigenvalues the whole cluster is returned.
    seed
        Of the solver's starting vectors; the same seed gives the same digits.
    threads
        How many neighbouring slices of the spectrum are searched at one time, 1 or 2; the digits
        are the same.
    progress
        Told the number of harmonics found.

    Raises
    ------
    InputError
        If `n_modes` is less than 1 or not less than the number of vertices.
    SolverError
        If the result misses its certificate.

    References
    ----------
    Vallet & Lévy 2008, "Spectral geometry processing with manifold harmonics".

    Examples
    --------
    A sphere's second eigenvalue is l(l+1)/R² = 2/R², three times:

    >>> from auricle.surface.shapes import icosphere
    >>> basis = manifold_harmonics(icosphere(radius=10.0, subdivisions=3), 4)
    >>> [round(float(value), 3) for value in basis.eigenvalues[1:] * 10**2]
    [2.0, 2.0, 2.0]
    """
    return operator_harmonics(
        laplacian(mesh), n_modes, seed=seed, threads=threads, progress=progress
    )


def operator_harmonics(
    operator: Laplacian,
    n_modes: int,
    *,
    seed: int = 1,
    threads: int = 2,
    progress: Progress = silent,
) -> Harmonics:
    """The first eigenfunctions of any pair of stiffness and areas, as `manifold_harmonics` does.

    Areas that are all the same make it the standard eigenproblem of a symmetric matrix. Arguments
    and errors are those of `manifold_harmonics`.
    """
    n = len(operator.areas)
    if not 1 <= n_modes < n:
        raise InputError(f"{n_modes} harmonics of {n} vertices: ask for 1 to {n - 1}")
    # Slices of the spectrum are the parts of the work that run side by side: in the narrow matrix
    # products of each a second thread gains little, and on shared cores it costs many times over.
    with _libraries().limit(limits=1, user_api="blas"), Workers(threads, progress) as workers:
        return _solved(operator, n_modes, seed=seed, workers=workers)


@cache
def _libraries() -> ThreadpoolController:
    """Those of matrix products, which take a while to find."""
    return ThreadpoolController()


def _solved(operator: Laplacian, n_modes: int, *, seed: int, workers: Workers) -> Harmonics:
    matrix = _symmetrized(operator)
    symbolic = analyze(matrix, workers)
    order = symbolic.plan.order
    matrix, symbolic = in_order(matrix, symbolic)
    scale = 4 * np.pi / operator.areas.sum()
    n = len(operator.areas)
    if n <= _DENSE_SIZE or n_modes > n * _DENSE_SHARE:
        method = "dense LAPACK"
        require_memory(_DENSE_COPIES * 8 * n**2, f"{n_modes} harmonics of {n} vertices")
        workers.report("harmonics", 0, n_modes)
        values, vectors = workers.result(workers.submit(np.linalg.eigh, matrix.toarray()))
        pairs = LowestPairs(values, np.ascontiguousarray(vectors), np.inf, n, ())
    else:
        method = "block Lanczos with spectrum slicing"
        pairs = lowest_eigenpairs(
            matrix,
            n_modes,
            density=1 / scale,
            rng=np.random.default_rng(seed),
            workers=workers,
            symbolic=symbolic,
        )
    n_returned = end_of_cluster(pairs.values, n_modes, scale)
    least = _least(pairs.values, scale)
    values, rows = pairs.values[:n_returned], pairs.room[:, :n_returned].T
    counted = workers.submit(_counted, matrix, pairs, n_returned, symbolic)
    free_of_rounding(matrix, rows, values, least=least)
    refined = corrected(matrix, rows, values, least=least, workers=workers, symbolic=symbolic)
    found = refined.separation.values
    certificate = _certificate(refined, workers.result(counted), operator=operator)
    certificate = replace(certificate, n_asked=n_modes, method=method, retries=pairs.retries)
    _require_certificate(certificate)
    values = np.where(np.arange(n_returned) < certificate.n_zero_modes, 0.0, found)
    if refined.rows is not rows:
        rows[:] = refined.rows
    modes = modes_in_place(pairs.room, n_returned, order, operator.areas, workers)
    return Harmonics(values, modes, operator.areas, operator.kind, certificate)


def _least(values: Floats, scale: float) -> float:
    """The least eigenvalue that is not zero; one of the surface's scale where all are."""
    above = values[values > CLUSTER_GAP * scale]
    return float(above[0]) if len(above) else scale


def _symmetrized(operator: Laplacian) -> sparse.csc_array:
    """The matrix areas^-½ · stiffness · areas^-½, with the same eigenvalues, in 1/mm²."""
    stiffness, roots = operator.stiffness.sorted_indices(), 1 / np.sqrt(operator.areas)
    beside = np.repeat(roots, np.diff(stiffness.indptr))
    # Rows of a symmetric matrix are its columns.
    parts = (
        stiffness.data * roots[stiffness.indices] * beside,
        stiffness.indices,
        stiffness.indptr,
    )
    return sparse.csc_array(parts, shape=stiffness.shape)


def _counted(
    matrix: sparse.csc_array, pairs: LowestPairs, n_returned: int, symbolic: SymbolicFactorization
) -> tuple[float, int]:
    """A number between the last eigenvalue returned and the next one, and the count below it.

    The search's own last count is that of those returned, but for clusters and shifts that moved.
    All that was found may be asked for: then the next is only known to lie beyond the height up
    to which none is missing.
    """
    if n_returned == len(pairs.values) and np.isfinite(pairs.complete_below):
        return pairs.complete_below, pairs.n_counted
    last = float(pairs.values[n_returned - 1])
    further = pairs.values[n_returned:]
    following = float(further[0]) if len(further) else min(pairs.complete_below, 2 * last)
    factors = factorize(matrix, 0.5 * (last + following), symbolic=symbolic)
    return factors.shift, factors.n_below


def _certificate(
    found: Orthonormal, counted: tuple[float, int], *, operator: Laplacian
) -> Certificate:
    """Of eigenpairs of the symmetrised matrix, given the last gap and the count below that."""
    values = found.separation.values
    scale, n_modes = 4 * np.pi / operator.areas.sum(), len(values)
    n_zero = int((values < CLUSTER_GAP * scale).sum())
    first = values[n_zero] if n_zero < n_modes else scale
    return Certificate(
        n_asked=n_modes,
        n_modes=n_modes,
        gap_per_mm2=counted[0],
        eigenvalues_below_gap=counted[1],
        largest_residual=float(found.separation.relative_residuals(first).max()),
        largest_orthogonality_error=found.departure,
        n_zero_modes=n_zero,
        method="",
    )


def _require_certificate(certificate: Certificate) -> None:
    if certificate.eigenvalues_below_gap != certificate.n_modes:
        raise SolverError(
            f"{certificate.eigenvalues_below_gap} eigenvalues lie below the last gap but "
            f"{certificate.n_modes} were found: ask for another number of harmonics"
        )
    if certificate.largest_residual > LARGEST_RESIDUAL:
        raise SolverError(
            f"a harmonic's residual is {certificate.largest_residual:.1e}, more than "
            f"{LARGEST_RESIDUAL:.0e}: is the surface degenerate?"
        )
    if certificate.largest_orthogonality_error > LARGEST_ORTHOGONALITY_ERROR:
        raise SolverError(
            f"harmonics deviate from orthonormal by {certificate.largest_orthogonality_error:.1e}, "
            f"more than {LARGEST_ORTHOGONALITY_ERROR:.0e}: is the surface degenerate?"
        )
