"""What mapping a case takes and gives: the parameters and the result of a reconstruction."""

from collections.abc import Mapping
from dataclasses import dataclass, field

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
        Standard deviation of a sample, in the values' unit; None: estimated.
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
    n_vertices: int = N_VERTICES
    n_modes: int = N_MODES
    seed: int = 1

    def __post_init__(self) -> None:
        if not 0 < self.target_nrmse < 1:
            raise InputError(f"a target error of {self.target_nrmse}: give more than 0, below 1")
        if self.noise is not None and self.noise_column is not None:
            raise InputError("the noise is given twice: as a number and as a column")
        if self.robust and self.cycle_length_ms is not None:
            raise InputError("times within a cycle are not fitted robustly: leave one of the two")
        if self.n_next < 0:
            raise InputError(f"{self.n_next} next points: ask for 0 or more")


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


@dataclass(frozen=True, eq=False)
class MappingResult:
    """A map rebuilt from samples, and everything that says how far to trust it.

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
    hyperparameters
        Of the Gaussian process.
    mean, std
        The map and its standard deviation on the surface, shape (n,), in the values' unit.
    singular
        Where times within a cycle have no direction (a phase singularity, or nothing known),
        shape (n,); nowhere for other maps.
    wavelengths
        Finest wavelength the samples support at each vertex, mm; infinite where none.
    undersampled, undersampled_share
        Vertices that do not support the map's bandwidth, shape (n,), and their share of the area.
    predicted_nrmse
        Expected error relative to the map's expected deviation from its mean.
    loo_variance
        Mean square of the standardised leave-one-out residuals.
    residuals
        Of each placed sample predicted from the others, shape (m,) or (m, 2) for cosine and sine.
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
    hyperparameters: Hyperparameters
    mean: PerVertex
    std: PerVertex
    singular: Truths
    wavelengths: PerVertex
    undersampled: Truths
    undersampled_share: float
    predicted_nrmse: float
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
