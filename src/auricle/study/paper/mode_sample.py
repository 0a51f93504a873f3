"""A sample of all n eigenvectors of an operator: the lowest without a gap, and probes above.

Shares of accumulated *amplitude* need the sum over all n coefficients, which no inner product
gives. All eigenvectors of 10,000 vertices take some ten minutes; but amplitudes change slowly
along the spectrum, so the lowest thousand together with bunches of neighbours at heights above,
whose places in the spectrum inertia counts, give the whole curve. Energy's total is exact, by
Parseval's identity, against which the sample is checked.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import eigh

from auricle.arrays import Floats, PerMode
from auricle.progress import Progress, silent
from auricle.spectral.factorization import SymbolicFactorization, analyze, factorize
from auricle.spectral.harmonics import Harmonics, operator_harmonics
from auricle.spectral.lanczos import Effort, LanczosRun
from auricle.spectral.workers import Workers
from auricle.study.paper.operators import Operator

SMALL = 1_500
"""Up to so many vertices all eigenvectors are solved for."""

_FRACTIONS = np.array([0.0, 0.1, 0.2, 0.333, 0.5, 0.667, 0.833, 0.967, 1.0])
_HEIGHTS = np.array([0.0, 1.11, 2.04, 3.25, 4.93, 7.1, 10.7, 18.6, 40.0])
"""Eigenvalue times mean dual area against place in the spectrum, as on a simplified atrium: only to
spread the probes; where each lies is counted."""
_HIGHEST = 0.97
_EFFORT = Effort(4, 50, 50, 1e-10)
_LEAST = 1e-300


@dataclass(frozen=True)
class Probe:
    """Neighbouring eigenvectors somewhere in the spectrum.

    Attributes
    ----------
    place
        Mean index of them among all eigenvectors.
    first, last
        Their rows in the sample: from `first` up to but without `last`.
    """

    place: float
    first: int
    last: int


@dataclass(frozen=True, eq=False)
class ModeSample:
    """Eigenvectors of a symmetric matrix, the lowest ones and probes of the others.

    Attributes
    ----------
    rows
        Orthonormal eigenvectors, one a row, shape (m, n): the `n_lowest` first, then the probes'.
    n_lowest
        How many lowest there are, none missing.
    probes
        The others, ascending.
    evidence
        How the lowest were certified complete.
    """

    rows: Floats
    n_lowest: int
    probes: tuple[Probe, ...]
    evidence: str

    @property
    def n_modes(self) -> int:
        """Number of eigenvectors there are, sampled or not."""
        return int(self.rows.shape[1])

    def curve(self, measure: PerMode) -> PerMode:
        """A measure of every mode that is not negative, from the sample's, shape (n,).

        As given for the lowest modes; above, the means of the probes, and of as many of the
        uppermost of the lowest, joined by straight lines in the logarithms of index and measure.
        """
        lowest = measure[: self.n_lowest]
        if not self.probes:
            return lowest
        bunch = min(self.n_lowest, max(probe.last - probe.first for probe in self.probes))
        places = [self.n_lowest - bunch / 2, *(probe.place for probe in self.probes)]
        means = [
            lowest[-bunch:].mean(),
            *(measure[probe.first : probe.last].mean() for probe in self.probes),
        ]
        above = np.arange(self.n_lowest, self.n_modes) + 0.5
        logarithms = np.interp(np.log(above), np.log(places), np.log(np.maximum(means, _LEAST)))
        return np.concatenate([lowest, np.exp(logarithms)])

    def energy_curve(self, power: PerMode, total: float) -> tuple[PerMode, float]:
        """The power of every mode with the exact total, and the sampled total over the exact one.

        The lowest modes' power is exact; what is above is scaled to hold what is left.
        """
        curve = self.curve(power)
        above = curve[self.n_lowest :]
        balance = float(curve.sum() / total) if total > 0 else 1.0
        left = max(total - float(curve[: self.n_lowest].sum()), 0.0)
        if above.sum() > 0:
            above *= left / above.sum()
        return curve, balance


def sampled_modes(
    operator: Operator,
    *,
    n_lowest: int,
    n_probes: int,
    seed: int = 1,
    harmonics: Harmonics | None = None,
    progress: Progress = silent,
) -> ModeSample:
    """The lowest modes of an operator, certified complete, and probes of the rest.

    Parameters
    ----------
    operator
        Of a surface in one piece.
    n_lowest
        How many lowest modes; all of them are taken on a mesh of up to 1,500 vertices.
    n_probes
        How many bunches above, of about 60 modes each.
    seed
        Of the solver's starting vectors.
    harmonics
        The operator's lowest harmonics where they are at hand already.
    progress
        Told the number of harmonics found.

    Raises
    ------
    SolverError
        If the lowest modes miss their certificate.
    """
    n = len(operator.areas)
    if n <= SMALL:
        rows = np.ascontiguousarray(eigh(operator.matrix.toarray(), driver="evd")[1].T)
        return ModeSample(rows, n, (), "all modes by dense LAPACK")
    if harmonics is None:
        harmonics = operator_harmonics(
            operator.pair, n_lowest, seed=seed, threads=1, progress=progress
        )
    lowest = (harmonics.modes * np.sqrt(harmonics.areas)[:, None]).T
    found = [np.ascontiguousarray(lowest)]
    probes: list[Probe] = []
    first = harmonics.n_modes
    for place, rows in _probed(operator, harmonics.n_modes, n_probes, seed):
        if len(rows) and place > _occupied(probes, harmonics.n_modes):
            probes.append(Probe(place, first, first + len(rows)))
            found.append(rows)
            first += len(rows)
    certificate = harmonics.certificate
    evidence = (
        f"{certificate.eigenvalues_below_gap} eigenvalues counted below the gap by inertia, "
        f"{certificate.n_modes} found"
    )
    return ModeSample(np.concatenate(found), harmonics.n_modes, tuple(probes), evidence)


def _occupied(probes: list[Probe], n_lowest: int) -> float:
    """Index that a further probe must lie above."""
    return probes[-1].place if probes else float(n_lowest)


def _probed(
    operator: Operator, n_lowest: int, n_probes: int, seed: int
) -> list[tuple[float, Floats]]:
    """Places of probes and their eigenvectors, one a row, ascending."""
    matrix = operator.matrix
    n = matrix.shape[0]
    symbolic = analyze(matrix)
    # Evenly in the square root of the index: densest where the curves bend.
    start = np.sqrt(n_lowest / n)
    fractions = np.linspace(start, np.sqrt(_HIGHEST), n_probes + 1)[1:] ** 2
    heights = np.interp(fractions, _FRACTIONS, _HEIGHTS) / operator.areas.mean()
    generator = np.random.default_rng(seed)
    found = [_probe(matrix, float(height), symbolic, generator) for height in heights]
    return sorted(found, key=lambda each: each[0])


def _probe(
    matrix: sparse.csc_array,
    height: float,
    symbolic: SymbolicFactorization,
    rng: np.random.Generator,
) -> tuple[float, Floats]:
    factors = factorize(matrix, height, symbolic=symbolic)
    nothing = np.empty((factors.size, 0))
    run = LanczosRun(factors, nothing, effort=_EFFORT, rng=rng, pause=lambda: None).until()
    n_under = int(np.searchsorted(run.values, factors.shift))
    place = factors.n_below + 0.5 * (len(run.values) - 2 * n_under)
    with Workers(1) as workers:
        return place, np.ascontiguousarray(run.vectors(0, workers).T)
