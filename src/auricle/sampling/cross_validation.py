"""Cross-validation: how well each method predicts samples that were kept from it."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.errors import InputError
from auricle.sampling.baselines import BASELINES, Interpolator
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.reconstruction import Hyperparameters
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


def cross_validated(
    chamber: Chamber,
    sites: Sites,
    values: Floats,
    hyperparameters: Hyperparameters,
    *,
    rng: np.random.Generator,
    noise_shape: Floats | None = None,
) -> Mapping[str, PredictionError]:
    """Errors of the Gaussian process and of every baseline on the same samples left out.

    The samples are dealt into `N_FOLDS` folds at random; each fold is predicted from the others.
    The process keeps the hyper-parameters given, which were fitted to all samples: they are three
    numbers, so that this favours it by little.

    Parameters
    ----------
    chamber, sites
        Where the samples are.
    values
        Shape (m,), or (m, c) for maps of several columns: the errors are then of all together.
    hyperparameters
        Of the process.
    rng
        Deals the folds.
    noise_shape
        As `GaussianProcess` takes it.

    Returns
    -------
    Mapping
        By name: ``gaussian_process`` and the names of `BASELINES`.

    Raises
    ------
    InputError
        If there are fewer than `FEWEST_SAMPLES`, or they are all equal.
    """
    if len(sites) < FEWEST_SAMPLES:
        raise InputError(
            f"{len(sites)} samples are too few to leave some out: take {FEWEST_SAMPLES} at least"
        )
    columns = values.reshape(len(values), -1)
    spread = float(np.sqrt(np.square(columns - columns.mean(axis=0)).sum(axis=1).mean()))
    if not spread > 0:
        raise InputError("all samples are equal: there is nothing to predict")
    folds = np.array_split(rng.permutation(len(sites)), N_FOLDS)

    def process(seen: Integers) -> Floats:
        shape = None if noise_shape is None else noise_shape[seen]
        fitted = GaussianProcess(chamber, sites[seen], noise_shape=shape)
        return fitted.given(values[seen], hyperparameters).mean

    predictors = {OURS: process, **dict(_baselines(chamber, sites, values))}
    return {
        name: _error(predictor, folds, sites, values, spread)
        for name, predictor in predictors.items()
    }


def _baselines(chamber: Chamber, sites: Sites, values: Floats) -> Iterator[tuple[str, Predictor]]:
    def predictor(interpolate: Interpolator) -> Predictor:
        return lambda seen: interpolate(chamber, sites[seen], values[seen])

    for name, interpolate in BASELINES.items():
        yield name, predictor(interpolate)


def _error(
    predictor: Predictor, folds: list[Integers], sites: Sites, values: Floats, spread: float
) -> PredictionError:
    squares = []
    for fold in folds:
        seen = np.setdiff1d(np.arange(len(sites)), fold)
        off = sites[fold].of(predictor(seen)) - values[fold]
        squares.append(np.square(off.reshape(len(fold), -1)).sum(axis=1))
    rms = float(np.sqrt(np.concatenate(squares).mean()))
    return PredictionError(rms, rms / spread)
