"""Statistics of a cohort: summaries and paired tests."""

import numpy as np
import pytest
from scipy import stats

from auricle.errors import InputError
from auricle.study.paper.statistics import half_widths, paired, summary


def test_a_summary_of_one_number_has_no_deviation():
    found = summary([4.0])
    assert (found.n, found.mean, found.low, found.high) == (1, 4.0, 4.0, 4.0)
    assert np.isnan(found.deviation)


def test_a_summary_of_nothing_is_refused():
    with pytest.raises(InputError, match="at least one case"):
        summary([])


def test_normal_differences_are_tested_as_scipy_does(rng):
    first = 100 + 5 * rng.standard_normal(20)
    second = first - 3 + rng.standard_normal(20)
    found = paired(first, second)
    assert found.name == "paired t"
    assert found.p_value == pytest.approx(stats.ttest_rel(first, second).pvalue, rel=1e-9)
    interval = stats.ttest_rel(first, second).confidence_interval()
    assert (found.difference_low, found.difference_high) == pytest.approx(
        (interval.low, interval.high), rel=1e-9
    )


def test_differences_far_from_normal_are_ranked(rng):
    first = 100 + rng.standard_normal(20)
    differences = np.exp(2.0 * rng.standard_normal(20))
    found = paired(first + differences, first)
    assert found.normality_p < 0.05
    assert found.name == "Wilcoxon signed-rank"
    assert found.p_value == pytest.approx(stats.wilcoxon(differences).pvalue)
    assert found.effect == pytest.approx(1.0)
    assert found.difference == pytest.approx(np.median(differences))
    assert found.difference_low < found.difference < found.difference_high


def test_the_order_of_the_pair_turns_every_sign(rng):
    first, second = 100 + rng.standard_normal((2, 12))
    one, other = paired(first, second), paired(second, first)
    assert one.p_value == pytest.approx(other.p_value)
    assert one.effect == pytest.approx(-other.effect)
    assert one.difference_low == pytest.approx(-other.difference_high)
    assert one.ratio == pytest.approx(1 / other.ratio)


def test_the_ratio_of_twice_as_much_is_two(rng):
    second = 50 + rng.random(8)
    found = paired(2 * second, second)
    assert (found.ratio_low, found.ratio, found.ratio_high) == pytest.approx((2.0, 2.0, 2.0))


@pytest.mark.parametrize(
    ("first", "second", "match"),
    [
        ([1.0, 2.0], [2.0, 3.0], "three pairs"),
        ([1.0, 2.0, 3.0], [1.0, 2.0], "three pairs"),
        ([1.0, 2.0, 0.0], [2.0, 3.0, 5.0], "not positive"),
        ([1.0, 2.0, 3.0], [2.0, 3.0, 4.0], "nothing to test"),
    ],
)
def test_pairs_that_cannot_be_tested_are_refused(first, second, match):
    with pytest.raises(InputError, match=match):
        paired(first, second)


def test_four_times_the_cases_halve_the_interval(rng):
    values = 100 + 10 * rng.standard_normal(40)
    few, many = half_widths(values, [10, 40], rng=np.random.default_rng(2))
    assert few / many == pytest.approx(2.0, rel=0.1)
    spread = values.std()
    assert few == pytest.approx(1.96 * spread / np.sqrt(10), rel=0.1)
