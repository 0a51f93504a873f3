"""Mapping one case: a map rebuilt from samples, how sure it is, and where to sample next."""

import math
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from auricle.arrays import PerVertex, Truths
from auricle.errors import BandError, InputError
from auricle.progress import Progress, silent
from auricle.sampling.bandwidth import Bracket
from auricle.sampling.chamber import Chamber
from auricle.sampling.coverage import coverage
from auricle.sampling.cross_validation import (
    FEWEST_SAMPLES,
    PredictionError,
    cross_validated,
    from_some,
)
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.next_point import NextPoint, next_points
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.running_posterior import RunningPosterior
from auricle.sampling.samples import PlacedSamples, Samples, place
from auricle.sampling.samples_file import read_samples
from auricle.study.fitting import FittedMap, fitted_map
from auricle.study.judgement import brackets, judgement
from auricle.study.mapping_result import MappingConfig, MappingResult, Progression
from auricle.study.preparation import PreparedSurface, prepare
from auricle.study.provenance import source_of, versions
from auricle.study.result import Source

N_PREFIXES = 12
"""Numbers of samples at which the error of the samples so far is told."""


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
        needed=() if config.forbid is None else (config.forbid,),
        progress=progress,
    )
    solved = time.perf_counter()
    placed = _placed(samples, read, prepared.chamber, config)
    rebuilt = rebuilt_map(
        prepared,
        (len(read), placed),
        config,
        source=source_of(samples),
        validate=validate,
        progress=progress,
    )
    return replace(rebuilt, seconds={"prepare": solved - begin, **rebuilt.seconds})


def rebuilt_map(
    prepared: PreparedSurface,
    samples: tuple[int, PlacedSamples],
    config: MappingConfig,
    *,
    source: Source,
    validate: bool = True,
    progress: Progress = silent,
) -> MappingResult:
    """As `map_samples`, of samples that lie on a surface already.

    Parameters
    ----------
    prepared
        The surface.
    samples
        How many there were, and those that could be placed on it.
    config
        The parameters; those of reading files and solving for harmonics are only recorded.
    source
        Where the samples come from.
    validate, progress
        As `map_samples`.

    Raises
    ------
    InputError
        If a parameter is at fault.
    """
    begin = time.perf_counter()
    chamber, placed = prepared.chamber, samples[1]
    progress("rebuild map", 1, 5)
    process = GaussianProcess(chamber, placed.sites, noise_shape=placed.noise_shape)
    fitted = fitted_map(process, placed, config)
    found, known = fitted.reconstruction, not fitted.reconstruction.knows_nothing
    progress("rebuild map", 2, 5)
    n = prepared.surface.n_vertices
    judged = judgement(fitted, placed, n_read=samples[0], target_nrmse=config.target_nrmse)
    progress("rebuild map", 3, 5)
    ahead = _next(fitted, prepared, config)
    progress("rebuild map", 4, 5)
    progression = _progression(fitted, placed, progress) if known else Progression.nothing()
    around = coverage(chamber, placed.sites)
    progress("rebuild map", 5, 5)
    mean, std, singular = _on_surface(fitted, n)
    drops = np.cumsum([point.expected_drop for point in ahead])
    validation = _validation(fitted, config, progress) if validate else {}
    return MappingResult(
        prepared=prepared,
        config=config,
        samples_source=source,
        placed=placed,
        knows_nothing=not known,
        hyperparameters=found.hyperparameters if known else None,
        noise_fitted=fitted.noise if known else math.nan,
        noise_stated=fitted.stated,
        mean=mean,
        std=std,
        singular=singular,
        wavelengths=judged.wavelengths[:n] if known else np.full(n, np.inf),
        undersampled=judged.undersampled[:n],
        undersampled_share=judged.undersampled_share,
        predicted_nrmse=fitted.predicted_nrmse if known else math.nan,
        smooth_nrmse=fitted.smooth_nrmse if known else math.nan,
        loo_variance=found.standardized_variance if known else math.nan,
        residuals=fitted.residuals if known else np.full(len(placed), np.nan),
        doubted=fitted.doubted,
        brackets=_brackets(found) if known else (),
        coverage=around,
        verdict=judged.verdict,
        next_points=ahead,
        next_nrmse=fitted.nrmse_after(drops) if known else np.full(len(ahead), np.nan),
        progression=progression,
        cross_validation=validation,
        remarks=_remarks(fitted, placed, config),
        versions=versions(),
        seconds={"rebuild": time.perf_counter() - begin},
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


def _on_surface(fitted: FittedMap, n: int) -> tuple[PerVertex, PerVertex, Truths]:
    """Map, deviation and singular places at the surface's own vertices; NaN if nothing is known."""
    nowhere = np.zeros(n, dtype=bool)
    if fitted.reconstruction.knows_nothing:
        return np.full(n, np.nan), np.full(n, np.nan), nowhere
    if fitted.circular is None:
        return fitted.reconstruction.mean[:n], fitted.std[:n], nowhere
    return fitted.circular.time[:n], fitted.std[:n], fitted.circular.singular[:n]


def _brackets(found: Reconstruction) -> tuple[Bracket, ...]:
    """Brackets at the usual shares; none if the map is as good as constant."""
    try:
        return brackets(found)
    except (BandError, InputError):
        return ()


def _next(
    fitted: FittedMap, prepared: PreparedSurface, config: MappingConfig
) -> tuple[NextPoint, ...]:
    if not config.n_next:
        return ()
    found, chamber = fitted.reconstruction, prepared.chamber
    allowed = None if config.forbid is None else prepared.allowed_by(config.forbid)
    k = len(found.posterior.prior_variances)
    values = found.values.reshape(len(found.values), -1)[:, 0]
    gram = chamber.accessible_gram[:k, :k]
    running = RunningPosterior.of(chamber, gram, found.posterior, values)
    # Detail that the harmonics do not carry blurs what a sample says of them, as noise does.
    noise_variance = (fitted.noise / fitted.unit) ** 2 + found.detail_variance
    return next_points(running, config.n_next, noise_variance, allowed=allowed)


def _progression(fitted: FittedMap, placed: PlacedSamples, progress: Progress) -> Progression:
    """Predicted error of the first so many samples, in the order of the file."""
    found = fitted.reconstruction
    order = np.argsort(placed.kept, kind="stable")
    first = min(5, len(order))
    counts = np.unique(np.rint(np.geomspace(first, len(order), N_PREFIXES)).astype(np.int64))
    errors = []
    for index, count in enumerate(counts.tolist()):
        progress("error so far", index, len(counts))
        part = from_some(fitted.process, found.values, found.hyperparameters, order[:count])
        errors.append(fitted.nrmse_of(part))
    progress("error so far", len(counts), len(counts))
    return Progression(counts, np.array(errors))


def _validation(
    fitted: FittedMap, config: MappingConfig, progress: Progress
) -> Mapping[str, PredictionError]:
    found = fitted.reconstruction
    if len(found.values) < FEWEST_SAMPLES or found.knows_nothing:
        return {}
    return cross_validated(
        fitted.process,
        found.values,
        found.hyperparameters,
        rng=np.random.default_rng(config.seed),
        progress=progress,
    )


def _remarks(fitted: FittedMap, placed: PlacedSamples, config: MappingConfig) -> tuple[str, ...]:
    remarks = list(placed.remarks)
    if fitted.reconstruction.knows_nothing:
        cause = "fewer than five samples" if len(placed) < 5 else "all equal or all in one place"
        remarks.append(
            f"nothing is known of the map ({cause}): no map, no error and no uncertainty is given, "
            "only where to go on"
        )
    elif fitted.stated is None and fitted.smooth_nrmse <= config.target_nrmse < (
        fitted.predicted_nrmse
    ):
        remarks.append(
            f"what was fitted as noise ({fitted.noise:.3g}{_unit(placed)}) counts as detail of the "
            "map, as no noise was stated: state that of a sample, if it is known, and only the "
            "rest counts"
        )
    if len(fitted.doubted):
        remarks.append(
            f"{len(fitted.doubted)} of {len(placed)} samples contradict all their neighbours and "
            "count less"
        )
    return tuple(remarks)


def _unit(placed: PlacedSamples) -> str:
    return f" {placed.unit}" if placed.unit else ""
