"""Cross-validation: how well each method predicts samples that were kept from it."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.sampling.baselines import BASELINES, Interpolator
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.reconstruction import Hyperparameters, Reconstruction
from auricle.sampling.sites import Sites

N_FOLDS = 10
FEWEST_SAMPLES = 20
"""With fewer, a fold's error says nothing."""
OURS = "gaussian_process"

Predictor = Callable[[Integers], Floats]
"""From the indices of the samples it may see to the map, shape (n,) or (n, c)."""


@dataclass(frozen=True)
class PredictionError:
    """Errors of samples predicted from others.

    Attributes
    ----------
    rms
        Root mean square, in the values' unit.
    relative
        The same over the samples' standard deviation; noise is part of it.
    """

    rms: float
    relative: float


def from_some(
    process: GaussianProcess, values: Floats, hyperparameters: Hyperparameters, seen: Integers
) -> Reconstruction:
    """The map that some of the samples give under the hyper-parameters of all.

    Each keeps the noise it has among all.

    Parameters
    ----------
    process
        On the sites of all samples.
    values
        Of all, shape (m,) or (m, c).
    hyperparameters
        Fitted to all.
    seen
        Indices of those used.
    """
    shape = process.noise_shape[seen]
    part = GaussianProcess(
        process.chamber, process.sites[seen], noise_shape=shape, n_modes=process.n_modes
    )
    # A process takes the noise as the root mean square over its own samples.
    level = hyperparameters.noise * math.sqrt(np.square(shape).mean())
    return part.given(values[seen], replace(hyperparameters, noise=level))


def cross_validated(
    process: GaussianProcess,
    values: Floats,
    hyperparameters: Hyperparameters,
    *,
    rng: np.random.Generator,
    progress: Progress = silent,
) -> Mapping[str, PredictionError]:
    """Errors of the Gaussian process and of every baseline on the same samples left out.

    The samples are dealt into `N_FOLDS` folds at random; each fold is predicted from the others.
    The process keeps the hyper-parameters given, which were fitted to all samples: they are three
    numbers, so that this favours it by little.

    Parameters
    ----------
    process
        On the sites of the samples.
    values
        Shape (m,), or (m, c) for maps of several columns: the errors are then of all together.
    hyperparameters
        Of the process.
    rng
        Deals the folds.
    progress
        Told the folds predicted.

    Returns
    -------
    Mapping
        By name: ``gaussian_process`` and the names of `BASELINES`.

    Raises
    ------
    InputError
        If there are fewer than `FEWEST_SAMPLES`, or they are all equal.
    """
    n_samples = len(process.sites)
    if n_samples < FEWEST_SAMPLES:
        raise InputError(
            f"{n_samples} samples are too few to leave some out: take {FEWEST_SAMPLES} at least"
        )
    columns = values.reshape(len(values), -1)
    spread = float(np.sqrt(np.square(columns - columns.mean(axis=0)).sum(axis=1).mean()))
    if not spread > 0:
        raise InputError("all samples are equal: there is nothing to predict")
    folds = np.array_split(rng.permutation(n_samples), N_FOLDS)

    def predicted(seen: Integers) -> Floats:
        return from_some(process, values, hyperparameters, seen).mean

    predictors: dict[str, Predictor] = {
        OURS: predicted,
        **dict(_baselines(process.chamber, process.sites, values)),
    }
    squares: dict[str, list[Floats]] = {name: [] for name in predictors}
    for index, fold in enumerate(folds):
        progress("leave samples out", index, N_FOLDS)
        seen = np.setdiff1d(np.arange(n_samples), fold)
        for name, predictor in predictors.items():
            off = process.sites[fold].of(predictor(seen)) - values[fold]
            squares[name].append(np.square(off.reshape(len(fold), -1)).sum(axis=1))
    progress("leave samples out", N_FOLDS, N_FOLDS)
    rms = {name: float(np.sqrt(np.concatenate(each).mean())) for name, each in squares.items()}
    return {name: PredictionError(error, error / spread) for name, error in rms.items()}


def _baselines(chamber: Chamber, sites: Sites, values: Floats) -> Iterator[tuple[str, Predictor]]:
    def predictor(interpolate: Interpolator) -> Predictor:
        return lambda seen: interpolate(chamber, sites[seen], values[seen])

    for name, interpolate in BASELINES.items():
        yield name, predictor(interpolate)
