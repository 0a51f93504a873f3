"""Mapping one case: a map rebuilt from samples, how sure it is, and where to sample next."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex, Truths
from auricle.errors import BandError, InputError
from auricle.progress import Progress, silent
from auricle.sampling.bandwidth import Bracket, bracket
from auricle.sampling.chamber import Chamber
from auricle.sampling.circular import CircularReconstruction, fit_circular
from auricle.sampling.coverage import coverage
from auricle.sampling.cross_validation import (
    FEWEST_SAMPLES,
    PredictionError,
    cross_validated,
)
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.local_nyquist import LocalNyquist, local_nyquist, modal_transfer
from auricle.sampling.next_point import NextPoint, next_points
from auricle.sampling.optimal_design import Prior
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.robust import fit_robustly
from auricle.sampling.running_posterior import RunningPosterior
from auricle.sampling.samples import PlacedSamples, Samples, place
from auricle.sampling.samples_file import read_samples
from auricle.sampling.stopping import Evidence, verdict
from auricle.study.mapping_result import MappingConfig, MappingResult, Progression
from auricle.study.preparation import PreparedSurface, prepare
from auricle.study.provenance import source_of, versions

N_PREFIXES = 12
"""Numbers of samples at which the error of the samples so far is told."""


@dataclass(frozen=True, eq=False)
class _Fitted:
    """What the fit of either kind of map gives."""

    process: GaussianProcess
    reconstruction: Reconstruction
    circular: CircularReconstruction | None
    doubted: Integers


def map_samples(
    surface: Path,
    samples: Path,
    config: MappingConfig | None = None,
    *,
    validate: bool = True,
    progress: Progress = silent,
) -> MappingResult:
    """Rebuild a map from scattered samples, say how sure it is, and where to sample next.

    Parameters
    ----------
    surface
        A surface file.
    samples
        A CSV file of positions and values in the surface's frame.
    config
        The parameters.
    validate
        Whether to leave samples out and predict them, by this method and the usual ones: it takes
        longer than all else.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If a file or a parameter is at fault, or no sample lies on the surface.
    SolverError
        If the harmonics miss their certificate.
    """
    config = config or MappingConfig()
    read = read_samples(
        samples, columns=config.columns, value=config.value, noise=config.noise_column
    )
    begin = time.perf_counter()
    prepared = prepare(
        surface,
        n_vertices=config.n_vertices,
        n_modes=config.n_modes,
        seed=config.seed,
        progress=progress,
    )
    solved = time.perf_counter()
    progress("rebuild map", 0, 4)
    chamber = prepared.chamber
    placed = _placed(samples, read, chamber, config)
    fitted = _fitted(
        GaussianProcess(chamber, placed.sites, noise_shape=placed.noise_shape), placed, config
    )
    found = fitted.reconstruction
    progress("rebuild map", 1, 4)
    nyquist = _nyquist(fitted)
    brackets = _brackets(found)
    aimed = _aimed(found, config.target_nrmse)
    undersampled = _undersampled(nyquist, aimed, prepared)
    progress("rebuild map", 2, 4)
    ahead = _next(found, config.n_next)
    progress("rebuild map", 3, 4)
    validation = _validation(fitted, placed, config) if validate else {}
    progress("rebuild map", 4, 4)
    n = prepared.surface.n_vertices
    mean, std, singular = _on_surface(fitted, n)
    share = chamber.mean(undersampled.astype(float))
    judged = verdict(
        Evidence(
            n_samples=len(placed),
            knows_nothing=found.knows_nothing,
            target_nrmse=config.target_nrmse,
            predicted_nrmse=found.predicted_nrmse,
            bracket=aimed,
            undersampled_share=share,
            loo_variance=found.standardized_variance,
        )
    )
    return MappingResult(
        prepared=prepared,
        config=config,
        samples_source=source_of(samples),
        placed=placed,
        hyperparameters=found.hyperparameters,
        mean=mean,
        std=std,
        singular=singular,
        wavelengths=nyquist.wavelengths[:n],
        undersampled=undersampled[:n],
        undersampled_share=share,
        predicted_nrmse=found.predicted_nrmse,
        loo_variance=found.standardized_variance,
        residuals=found.leave_one_out[0],
        doubted=fitted.doubted,
        brackets=brackets,
        coverage=coverage(chamber, placed.sites),
        verdict=judged,
        next_points=ahead,
        next_nrmse=_errors_after(found, ahead),
        progression=_progression(fitted, placed),
        cross_validation=validation,
        remarks=_remarks(fitted, placed),
        versions=versions(),
        seconds={"prepare": solved - begin, "rebuild": time.perf_counter() - solved},
    )


def _placed(path: Path, samples: Samples, chamber: Chamber, config: MappingConfig) -> PlacedSamples:
    """The samples on the surface; a fault names their file."""
    try:
        return place(
            samples,
            chamber,
            max_distance=config.max_distance_mm,
            cycle_length=config.cycle_length_ms,
        )
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault


def _fitted(process: GaussianProcess, placed: PlacedSamples, config: MappingConfig) -> _Fitted:
    noise = config.noise if config.noise is not None else placed.noise_level
    nobody = np.zeros(0, dtype=np.int64)
    if config.cycle_length_ms is not None:
        circular = fit_circular(process, placed.values, config.cycle_length_ms, noise=noise)
        return _Fitted(process, circular.components, circular, nobody)
    if config.robust:
        robust = fit_robustly(process, placed.values, noise=noise)
        return _Fitted(process, robust.reconstruction, None, robust.doubted)
    return _Fitted(process, process.fit(placed.values, noise=noise), None, nobody)


def _on_surface(fitted: _Fitted, n: int) -> tuple[PerVertex, PerVertex, Truths]:
    """Map, deviation and singular places at the surface's own vertices."""
    circular = fitted.circular
    if circular is None:
        found = fitted.reconstruction
        return found.mean[:n], found.std[:n], np.zeros(n, dtype=bool)
    return circular.time[:n], circular.std[:n], circular.singular[:n]


def _nyquist(fitted: _Fitted) -> LocalNyquist:
    found, chamber = fitted.reconstruction, fitted.process.chamber
    noise = max(found.hyperparameters.noise, 1e-6 * found.hyperparameters.amplitude)
    prior = Prior(found.posterior.prior_variances, noise)
    relative = np.square(fitted.process.noise_shape)
    transfer = modal_transfer(chamber, fitted.process.sites, prior, relative_noise=relative)
    return local_nyquist(chamber, transfer)


def _brackets(found: Reconstruction) -> tuple[Bracket, ...]:
    """Brackets at the usual shares; none if the map is as good as constant."""
    try:
        return _bracket(found, None)
    except (BandError, InputError):
        return ()


def _aimed(found: Reconstruction, target: float) -> Bracket | None:
    try:
        return _bracket(found, 1 - target**2)[0]
    except (BandError, InputError):
        return None


def _bracket(found: Reconstruction, share: float | None) -> tuple[Bracket, ...]:
    """Brackets of a map; of cosine and sine together their wider ends."""
    means = found.coefficient_mean.reshape(len(found.coefficient_mean), -1)
    k = len(means)
    gram = found.chamber.accessible_gram[:k, :k]
    covariance = found.posterior.covariance.matrix
    shares = {} if share is None else {"shares": [share]}
    columns = [bracket(mean, covariance, gram=gram, **shares) for mean in means.T]
    return tuple(
        Bracket(parts[0].share, min(p.lower for p in parts), max(p.upper for p in parts))
        for parts in zip(*columns, strict=True)
    )


def _undersampled(
    nyquist: LocalNyquist, aimed: Bracket | None, prepared: PreparedSurface
) -> Truths:
    """Accessible vertices that do not support the bandwidth; all if it is beyond the harmonics."""
    accessible = prepared.chamber.accessible
    if aimed is None or aimed.upper > nyquist.edges[-1]:
        return accessible
    coarse: Truths = nyquist.undersampled(aimed.upper) & accessible
    return coarse


def _next(found: Reconstruction, count: int) -> tuple[NextPoint, ...]:
    if not count:
        return ()
    chamber, posterior = found.chamber, found.posterior
    k = len(posterior.prior_variances)
    values = found.values.reshape(len(found.values), -1)[:, 0]
    running = RunningPosterior.of(chamber, chamber.accessible_gram[:k, :k], posterior, values)
    return next_points(running, count, found.hyperparameters.noise**2)


def _errors_after(found: Reconstruction, points: tuple[NextPoint, ...]) -> Floats:
    """Predicted error once each of the points, and those before it, is taken, shape (c,)."""
    now = found.chamber.mean(found.variance)
    left = 1 - np.cumsum([point.expected_drop for point in points]) / now
    errors: Floats = found.predicted_nrmse * np.sqrt(np.maximum(left, 0.0))
    return errors


def _progression(fitted: _Fitted, placed: PlacedSamples) -> Progression:
    """Predicted error of the first so many samples, in the order of the file."""
    chamber, found = fitted.process.chamber, fitted.reconstruction
    order = np.argsort(placed.kept, kind="stable")
    first = min(5, len(order))
    counts = np.unique(np.rint(np.geomspace(first, len(order), N_PREFIXES)).astype(np.int64))
    errors = []
    for count in counts.tolist():
        some = order[:count]
        part = GaussianProcess(
            chamber,
            placed.sites[some],
            noise_shape=placed.noise_shape[some],
            n_modes=fitted.process.n_modes,
        )
        errors.append(part.given(found.values[some], found.hyperparameters).predicted_nrmse)
    return Progression(counts, np.array(errors))


def _validation(
    fitted: _Fitted, placed: PlacedSamples, config: MappingConfig
) -> Mapping[str, PredictionError]:
    found = fitted.reconstruction
    if len(placed) < FEWEST_SAMPLES or found.knows_nothing:
        return {}
    return cross_validated(
        found.chamber,
        placed.sites,
        found.values,
        found.hyperparameters,
        rng=np.random.default_rng(config.seed),
        noise_shape=placed.noise_shape,
    )


def _remarks(fitted: _Fitted, placed: PlacedSamples) -> tuple[str, ...]:
    remarks = list(placed.remarks)
    if fitted.reconstruction.knows_nothing:
        remarks.append(
            f"{len(placed)} samples, or all equal, or all in one place: nothing can be said of "
            "the map away from them, and the numbers of error are guesses"
        )
    if len(fitted.doubted):
        remarks.append(
            f"{len(fitted.doubted)} of {len(placed)} samples contradict all their neighbours and "
            "count less"
        )
    return tuple(remarks)
