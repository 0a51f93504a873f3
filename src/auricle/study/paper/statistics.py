"""Statistics of a cohort: means with their spread, paired tests with their assumptions checked."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from auricle.arrays import Floats
from auricle.errors import InputError

CONFIDENCE = 0.95
NORMALITY = 0.05
"""Shapiro and Wilk's p below which differences are not taken for normal."""
FEWEST_PAIRS = 3
RESAMPLES = 2_000


@dataclass(frozen=True)
class Summary:
    """Numbers of several cases in short.

    Attributes
    ----------
    n
        How many.
    mean, deviation
        Mean, and standard deviation of the sample (n - 1); NaN for one number.
    median, low, high
        Median, least and greatest.
    """

    n: int
    mean: float
    deviation: float
    median: float
    low: float
    high: float


@dataclass(frozen=True)
class PairedTest:
    """Two numbers a case compared over a cohort.

    Attributes
    ----------
    first, second
        Both in short.
    normality_p
        Of the differences (Shapiro and Wilk).
    name
        ``paired t`` where the differences may be normal, else ``Wilcoxon signed-rank``.
    p_value
        Two-sided.
    difference, difference_low, difference_high
        Mean difference, first less second, with its interval of 95 % (Student); for Wilcoxon's
        test the median difference, its interval by the bootstrap (percentiles).
    effect_name, effect
        ``Hedges' g of the differences``: mean over standard deviation, corrected for few pairs;
        for Wilcoxon's test ``rank-biserial correlation``, -1 to 1.
    ratio, ratio_low, ratio_high
        Geometric mean of first over second, with its interval of 95 %.
    """

    first: Summary
    second: Summary
    normality_p: float
    name: str
    p_value: float
    difference: float
    difference_low: float
    difference_high: float
    effect_name: str
    effect: float
    ratio: float
    ratio_low: float
    ratio_high: float


def summary(values: Sequence[float]) -> Summary:
    """Numbers in short.

    Raises
    ------
    InputError
        If there are none.

    Examples
    --------
    >>> found = summary([1.0, 2.0, 6.0])
    >>> found.mean, round(found.deviation, 4), found.median
    (3.0, 2.6458, 2.0)
    """
    if not len(values):
        raise InputError("no numbers to summarise: give at least one case")
    numbers = np.asarray(values, dtype=np.float64)
    deviation = float(numbers.std(ddof=1)) if len(numbers) > 1 else float("nan")
    return Summary(
        n=len(numbers),
        mean=float(numbers.mean()),
        deviation=deviation,
        median=float(np.median(numbers)),
        low=float(numbers.min()),
        high=float(numbers.max()),
    )


def paired(first: Sequence[float], second: Sequence[float], *, seed: int = 1) -> PairedTest:
    """Compare two positive numbers of each case.

    Parameters
    ----------
    first, second
        One number a case, in the same order.
    seed
        Of the bootstrap.

    Raises
    ------
    InputError
        If there are fewer than three pairs, a number is not positive, or all differences are the
        same, so that nothing can be tested.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> before = 100 + 10 * rng.standard_normal(12)
    >>> after = before + 20 + 5 * rng.standard_normal(12)
    >>> found = paired(after, before)
    >>> found.name, found.p_value < 0.001, 15 < found.difference < 25
    ('paired t', True, True)
    """
    one, other = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if len(one) != len(other) or len(one) < FEWEST_PAIRS:
        raise InputError(f"{len(one)} and {len(other)} numbers: give three pairs or more")
    if not (min(one.min(), other.min()) > 0 and np.isfinite([one, other]).all()):
        raise InputError("a number that is not positive has no ratio: leave its pair out")
    differences = one - other
    if np.ptp(differences) <= 1e-12 * np.abs(differences).max():
        raise InputError("all differences are the same: there is nothing to test")
    ratio, ratio_low, ratio_high = np.exp(_student_interval(np.log(one / other))).tolist()
    normality_p = float(stats.shapiro(differences).pvalue)
    tested = _student if normality_p >= NORMALITY else _wilcoxon
    name, p_value, interval, effect_name, effect = tested(differences, seed)
    return PairedTest(
        summary(one.tolist()),
        summary(other.tolist()),
        normality_p,
        name,
        p_value,
        *interval,
        effect_name,
        effect,
        ratio,
        ratio_low,
        ratio_high,
    )


def half_widths(
    values: Sequence[float], numbers: Sequence[int], *, rng: np.random.Generator
) -> list[float]:
    """How well cohorts of other sizes would know the mean: bootstrap over cases.

    Parameters
    ----------
    values
        One number a case.
    numbers
        Sizes of the cohorts to draw, with replacement.
    rng
        Source of randomness.

    Returns
    -------
    list of float
        Half of the interval that 95 % of the drawn means lie in, in the values' unit.
    """
    numbers_of = np.asarray(values, dtype=np.float64)
    tail = (1 - CONFIDENCE) / 2
    widths = []
    for n in numbers:
        means = rng.choice(numbers_of, size=(RESAMPLES, n)).mean(axis=1)
        low, high = np.quantile(means, [tail, 1 - tail])
        widths.append(float(high - low) / 2)
    return widths


_Tested = tuple[str, float, tuple[float, float, float], str, float]


def _student(differences: Floats, seed: int) -> _Tested:
    del seed
    n = len(differences)
    middle, low, high = _student_interval(differences).tolist()
    correction = 1 - 3 / (4 * (n - 1) - 1)
    effect = correction * float(differences.mean() / differences.std(ddof=1))
    p_value = float(stats.ttest_1samp(differences, 0.0).pvalue)
    return "paired t", p_value, (middle, low, high), "Hedges' g of the differences", effect


def _wilcoxon(differences: Floats, seed: int) -> _Tested:
    found = stats.wilcoxon(differences)
    ranks = stats.rankdata(np.abs(differences[differences != 0]))
    signs = np.sign(differences[differences != 0])
    effect = float((ranks * signs).sum() / ranks.sum())
    rng = np.random.default_rng(seed)
    medians = np.median(rng.choice(differences, size=(RESAMPLES, len(differences))), axis=1)
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(medians, [tail, 1 - tail]).tolist()
    ends = (float(np.median(differences)), low, high)
    p_value = float(found.pvalue)
    return "Wilcoxon signed-rank", p_value, ends, "rank-biserial correlation", effect


def _student_interval(values: Floats) -> Floats:
    """Mean and the ends of its interval, shape (3,)."""
    n = len(values)
    reach = float(stats.t.ppf(0.5 + CONFIDENCE / 2, n - 1)) * values.std(ddof=1) / np.sqrt(n)
    interval: Floats = values.mean() + np.array([0.0, -reach, reach])
    return interval
