"""Counts on other surfaces of the same atria beside those on the surface analysed."""

import math

import pytest

from auricle.study.paper.comparisons import (
    count_reaching,
    recovered_comparisons,
    recovered_maps,
    resolution_comparisons,
)


def focus(size, counts, n_foci=1):
    return {"size": size, "sigma_mm": 4.0, "n_foci": n_foci, "counts": {"0.9": counts}}


def document(before, finer, *, geometry=(10, 10), thinned=()):
    """A case with its counts for one small focus at 10,000 vertices and at finer ones."""
    return {
        "parameters": {"shares": [0.85, 0.9]},
        "geometry": {"counts": {"0.99": geometry[0]}},
        "features": [focus("small", before), focus("small", [1, 1, 1], n_foci=2)],
        "thinned_features": list(thinned),
        "beyond": {
            "resolution": [
                {
                    "n_vertices": n,
                    "geometry": {"0.99": geometry[1]},
                    "features": [focus("small", counts)],
                }
                for n, counts in finer.items()
            ],
            "recovered": [
                {"count": n, "features": [focus("small", counts)]} for n, counts in finer.items()
            ],
        },
    }


def test_changes_are_taken_case_by_case_of_medians_over_placements():
    found = resolution_comparisons(
        [
            document([90, 100, 300], {30_000: [90, 110, 300], 100_000: [100, 120, 200]}),
            document([200, 200, 200], {30_000: [190, 190, 190]}, geometry=(10, 11)),
        ]
    )
    assert [(each.where, each.words, each.n_cases) for each in found] == [
        (30_000, "geometry", 2),
        (30_000, "one small focus, σ = 4 mm", 2),
        (100_000, "geometry", 1),
        (100_000, "one small focus, σ = 4 mm", 1),
    ]
    coarse = found[1]
    assert (coarse.before, coarse.after) == (150, 150)
    assert (coarse.change_low, coarse.change_high) == pytest.approx((-0.05, 0.10))
    assert coarse.change == pytest.approx(0.025)
    assert found[0].change_high == pytest.approx(0.1)
    assert found[3].change == pytest.approx(0.2)


def test_a_count_beyond_the_harmonics_at_hand_is_not_compared():
    found = recovered_comparisons(
        [
            document([None, None, 300], {250: [100, 100, 100]}),
            document([100, 100, 100], {250: [100, 110, 120]}),
        ]
    )
    (one,) = found
    assert (one.where, one.n_cases, one.change) == (250, 1, pytest.approx(0.1))


def test_a_count_is_read_between_those_measured_on_lines_of_the_logarithms():
    counts, errors = [20, 50, 100], [1.0, 0.4, 0.2]
    assert count_reaching(counts, errors, 0.4) == pytest.approx(50)
    assert 50 < count_reaching(counts, errors, 0.3) < 100
    assert count_reaching(counts, errors, 0.2) == pytest.approx(100)
    assert count_reaching(counts, errors, 2.0) == 20
    assert math.isinf(count_reaching(counts, errors, 0.1))


def test_harmonics_and_points_for_the_same_error_stand_side_by_side():
    def record(factor):
        return {
            "size": "small",
            "sigma_mm": 4.0,
            "n_foci": 1,
            "counts": [10, 1000],
            "nrmse": {
                "harmonics": [1.0, 0.01],
                "points": [10.0, 1.0],
                "points_with_feature": [0.5 * factor, 0.005 * factor],
            },
            "gd_mm": {"points": [1.0, 0.1], "points_with_feature": [1.2, 0.11]},
        }

    cases = [document([1], {}, thinned=[record(factor)]) for factor in (0.8, 1.0, 1.5)]
    (row,) = recovered_maps(cases, share=0.99)
    assert row.counts["harmonics"] == pytest.approx(100)
    assert row.counts["points_with_feature"] == pytest.approx(50)
    assert math.isinf(row.counts["points"])
    assert row.gd_ratio == pytest.approx(1.2)
