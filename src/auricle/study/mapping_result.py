"""What mapping a case takes and gives: the parameters and the result of a reconstruction."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex, Truths
from auricle.errors import InputError
from auricle.sampling.bandwidth import Bracket
from auricle.sampling.coverage import Coverage
from auricle.sampling.cross_validation import PredictionError
from auricle.sampling.next_point import NextPoint
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.samples import PlacedSamples
from auricle.sampling.stopping import Verdict
from auricle.study.preparation import N_MODES, N_VERTICES, PreparedSurface
from auricle.study.result import Source


@dataclass(frozen=True)
class MappingConfig:
    """How samples are read and a map is rebuilt from them.

    Attributes
    ----------
    value, noise_column
        Names of the columns with the values and, if there is one, their standard deviations.
    columns
        Names of the columns with the positions, where they are not x, y and z.
    noise
        Standard deviation of a sample, in the values' unit; None: not known.
    cycle_length_ms
        Period of activation times that wrap round.
    max_distance_mm
        How far off the surface a sample may lie.
    robust
        Whether isolated samples that contradict their neighbours count less.
    target_nrmse
        Error at which sampling is enough.
    n_next
        How many next points to propose.
    forbid
        Name of a field of the surface: no next point where it is not 0.
    n_vertices, n_modes
        Vertices to simplify to, harmonics to solve for.
    seed
        Of everything random.
    """

    value: str = "LAT"
    noise_column: str | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    noise: float | None = None
    cycle_length_ms: float | None = None
    max_distance_mm: float = 5.0
    robust: bool = False
    target_nrmse: float = 0.1
    n_next: int = 5
    forbid: str | None = None
    n_vertices: int = N_VERTICES
    n_modes: int = N_MODES
    seed: int = 1

    def __post_init__(self) -> None:
        if not 0 < self.target_nrmse < 1:
            raise InputError(f"a target error of {self.target_nrmse}: give more than 0, below 1")
        if self.noise is not None and not 0 <= self.noise < math.inf:
            raise InputError(f"a noise of {self.noise}: give 0 or a positive number")
        if self.noise is not None and self.noise_column is not None:
            raise InputError("the noise is given twice: as a number and as a column: give one")
        _require_positive(self.cycle_length_ms, "a cycle length of {} ms")
        _require_positive(self.max_distance_mm, "a distance of {} mm off the surface")
        if self.robust and self.cycle_length_ms is not None:
            raise InputError("times within a cycle are not fitted robustly: leave one of the two")
        if self.n_next < 0:
            raise InputError(f"{self.n_next} next points: ask for 0 or more")


def _require_positive(value: float | None, words: str) -> None:
    if value is not None and not 0 < value < math.inf:
        raise InputError(f"{words.format(value)}: give a positive number")


@dataclass(frozen=True, eq=False)
class Progression:
    """How the error fell as the samples came, in the order of the file.

    Attributes
    ----------
    counts
        Numbers of samples, shape (p,).
    predicted_nrmse
        Error predicted with so many, under the hyper-parameters of all, shape (p,).
    """

    counts: Integers
    predicted_nrmse: Floats

    @classmethod
    def nothing(cls) -> "Progression":
        """Of samples that say nothing."""
        return cls(np.empty(0, np.int64), np.empty(0))


@dataclass(frozen=True, eq=False)
class MappingResult:
    """A map rebuilt from samples, and everything that says how far to trust it.

    Where `knows_nothing` is true there is no map and no number on it: what would depend on a
    guess is NaN, None or empty.

    Attributes
    ----------
    prepared
        The surface.
    config
        The parameters.
    samples_source
        The file of samples.
    placed
        The samples on the surface.
    knows_nothing
        Whether the samples (fewer than five, all equal, all in one place) say nothing of the map.
    hyperparameters
        Of the Gaussian process; of a re-entry, for cosine and sine. None if nothing is known.
    noise_fitted, noise_stated
        Noise of a sample as fitted and as stated (None if it is not), root mean square over the
        samples not doubted, in the values' unit. What is fitted beyond what is stated counts as
        detail of the map too fine for the samples, in `std` and `predicted_nrmse`.
    mean, std
        The map and its standard deviation on the surface, shape (n,), in the values' unit.
    singular
        Where times within a cycle have no direction (a phase singularity, or nothing known),
        shape (n,); nowhere for other maps.
    wavelengths
        Finest wavelength the samples support at each vertex, mm; infinite where none.
    undersampled, undersampled_share
        Vertices that do not support the map's bandwidth, shape (n,), and their share of the area.
    predicted_nrmse, smooth_nrmse
        Expected error relative to the map's expected deviation from its mean; and the same if all
        that was fitted as noise is noise, and none of it detail.
    loo_variance
        Mean square of the standardised leave-one-out residuals.
    residuals
        Of each placed sample minus what the others predict there, shape (m,), in the values' unit.
    doubted
        Indices of placed samples that count less (`robust`).
    brackets
        Of the bandwidth, by share of the power.
    coverage
        Of the surface by the samples.
    verdict
        Enough, or not yet and why.
    next_points, next_nrmse
        Where to sample next, best first, and the error predicted once each is taken, shape (c,).
    progression
        Error as the samples came.
    cross_validation
        Errors of this and of the usual methods on samples left out; empty if there are too few.
    remarks, versions, seconds
        What to know besides; versions; wall time by stage.
    """

    prepared: PreparedSurface
    config: MappingConfig
    samples_source: Source
    placed: PlacedSamples
    knows_nothing: bool
    hyperparameters: Hyperparameters | None
    noise_fitted: float
    noise_stated: float | None
    mean: PerVertex
    std: PerVertex
    singular: Truths
    wavelengths: PerVertex
    undersampled: Truths
    undersampled_share: float
    predicted_nrmse: float
    smooth_nrmse: float
    loo_variance: float
    residuals: Floats
    doubted: Integers
    brackets: tuple[Bracket, ...]
    coverage: Coverage
    verdict: Verdict
    next_points: tuple[NextPoint, ...]
    next_nrmse: Floats
    progression: Progression
    cross_validation: Mapping[str, PredictionError]
    remarks: tuple[str, ...]
    versions: Mapping[str, str]
    seconds: Mapping[str, float]
