"""Nearness to print: exact where the counts are printed ones, and blind to the choice of widths."""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.paper.decay_readings import decay_readings
from auricle.study.paper.printed import DECAYS, FEATURES, GEOMETRY, SHARES, SIZES, TABLE_1
from auricle.study.paper.reproduction import LEAD, SOUND, Convention, growth, nearness

WIDTHS = [2.0, 4.0, 8.0, 16.0, 32.0]
AT = (4.0, 8.0, 32.0)
"""The widths at which the made-up counts of `TRUE` are those printed."""
TRUE = LEAD
Scale = Callable[[Convention], float]


def records(scale: Scale) -> tuple[list[dict], list[dict]]:
    """Counts as printed times a factor for each convention; wrong widths are off by a factor 3."""
    geometry, features = [], []
    for measure, constant in product(("energy", "amplitude"), ("in", "out")):
        label = {
            "operator": "as_printed",
            "projection": "unweighted",
            "dual_cell": "third",
            "measure": measure,
            "constant": constant,
        }
        for coordinates in ("centred", "as given"):
            by = scale(Convention(**label, coordinates=coordinates, profile="gaussian"))
            counts = {share: by * GEOMETRY[i] for i, share in enumerate(SHARES)}
            geometry.append(label | {"coordinates": coordinates, "counts": counts})
        by = scale(Convention(**label, coordinates="centred", profile="gaussian"))
        counts = {
            share: [[by * printed_at(width, n, i) for n in (1, 2, 3)] for width in WIDTHS]
            for i, share in enumerate(SHARES)
        }
        features.append(label | {"profile": "gaussian", "counts": counts})
    return geometry, features


def printed_at(width: float, n_foci: int, share: int) -> float:
    if width in AT:
        return FEATURES[(n_foci, SIZES[AT.index(width)])][share]
    return 3.0 * FEATURES[(n_foci, "small")][share]


def document(scale: Scale, coarser: Scale | None = None) -> dict[str, Any]:
    geometry, features = records(scale)
    conventions = {
        "n_vertices": 9_000,
        "n_placements": 4,
        "focus_counts": [1, 2, 3],
        "widths_mm": WIDTHS,
        "operators": [
            {"balance": {"as_printed unweighted": 1.002}, "dual_cell": "third", "n_negative": 0}
        ],
        "refused": [],
        "geometry": geometry,
        "features": features,
        "decay": [],
    }
    if coarser:
        fewer, features = records(coarser)
        conventions["coarser"] = {
            "n_vertices": 3_000,
            "refused": [],
            "geometry": fewer,
            "features": features,
        }
    return {
        "name": "case",
        "conventions": conventions,
        "decay": decay(1.0),
        "surface_analyzed": {"n_vertices": 9_000},
        "parameters": {"shares": [0.85, 0.9]},
        "geometry": {"counts": {"0.99": 20}},
        "features": [],
        "beyond": {"resolution": []},
    }


def decay(scale: float) -> list[dict[str, Any]]:
    """τ as printed for one reading of each error, times a factor."""
    return [
        {
            "method": method,
            "error": "gd_from_original_mm" if kind == "GD" else "mse_mm2",
            "range": "even",
            "with_floor": False,
            "tau": scale * tau,
        }
        for (kind, method), (tau, _) in DECAYS.items()
    ]


def only_true(convention: Convention) -> float:
    return 1.0 if convention == TRUE else 2.0


def test_the_convention_with_the_printed_counts_is_first_at_no_distance() -> None:
    ranking = nearness([document(only_true)] * 3)
    first = ranking[0]
    assert first.convention == TRUE
    assert (first.distance, first.geometry, first.features) == pytest.approx((0, 0, 0), abs=1e-12)
    assert first.widths_mm == AT
    assert first.first_share == 1.0
    np.testing.assert_allclose(first.medians(), [entry.count for entry in TABLE_1])
    assert first.ratios(0, "geometry").tolist() == [GEOMETRY[1] / GEOMETRY[0]] * 3


def test_twice_and_half_as_many_are_the_same_distance_ln_2() -> None:
    for scale in (2.0, 0.5):
        ranking = nearness([document(lambda _, by=scale: by)])
        assert all(each.geometry == pytest.approx(np.log(2.0)) for each in ranking)


def test_the_distance_over_cases_is_the_root_mean_square_of_theirs() -> None:
    (first, *_) = nearness([document(lambda _: 1.0), document(lambda _: 2.0)])
    np.testing.assert_allclose(first.by_case, [0.0, np.log(2.0)], atol=1e-12)
    assert first.distance == pytest.approx(np.log(2.0) / np.sqrt(2))


def test_a_tie_leaves_resamples_with_both() -> None:
    ranking = nearness([document(lambda _: 1.5)] * 2)
    assert all(each.first_share == 1.0 for each in ranking)


def test_counts_that_are_three_times_as_many_on_three_times_as_many_vertices_grow_as_1() -> None:
    cases = [document(only_true, lambda c: only_true(c) / (3.0 if c == TRUE else 1.0))]
    ranking = nearness(cases)
    np.testing.assert_allclose(growth(cases, ranking[0]), 1.0)
    assert np.abs(growth(cases, ranking[-1])).max() < 1e-12
    assert np.isnan(growth([document(only_true)], ranking[0])).all()


def test_a_convention_that_one_case_lacks_is_left_out_for_all() -> None:
    lacking = document(only_true)
    held = lacking["conventions"]
    for key in ("geometry", "features"):
        held[key] = [row for row in held[key] if row["measure"] == "energy"]
    ranking = nearness([document(only_true), lacking])
    assert {each.convention.measure for each in ranking} == {"energy"}


def test_cases_without_conventions_are_passed_over_and_none_at_all_refused() -> None:
    assert len(nearness([document(only_true), {"conventions": {}}])[0].by_case) == 1
    with pytest.raises(InputError, match="convention_vertices"):
        nearness([{"conventions": {}}])


def test_cases_counted_for_other_widths_or_shares_are_refused() -> None:
    other = document(only_true)
    other["conventions"]["widths_mm"] = [1.0, *WIDTHS[1:]]
    with pytest.raises(InputError, match="different widths"):
        nearness([document(only_true), other])
    other = document(only_true)
    for row in other["conventions"]["geometry"]:
        del row["counts"]["0.85"]
    with pytest.raises(InputError, match=r"0\.85 and 0\.9"):
        nearness([other])


def test_tau_as_printed_is_at_no_distance_and_its_deviation_that_of_the_cases() -> None:
    cases = [{"decay": decay(scale)} for scale in (0.5, 1.5)]
    found = {each.kind: each for each in decay_readings(cases)}
    assert {each.distance for each in found.values()} == {0.0}
    assert found["GD"].means == pytest.approx((211.2, 173.8))
    assert found["GD"].deviations[0] == pytest.approx(211.2 / np.sqrt(2))


def test_a_reading_of_tau_that_few_cases_have_is_left_out() -> None:
    missing = decay(1.0)
    for record in missing:
        record["tau"] = None if record["error"].startswith("gd") else record["tau"]
    cases = [{"decay": each} for each in (decay(1.0), missing, missing)]
    assert {each.kind for each in decay_readings(cases)} == {"MSE"}


def test_the_lead_and_the_sound_reading_are_two() -> None:
    assert LEAD != SOUND
