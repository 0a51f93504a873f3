"""Bandwidth foretold: from a class, from past maps, from the samples so far."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.bandwidth import (
    bracket,
    class_tails,
    closed_form_modes,
    left_out_coverage,
    past_tails,
)
from auricle.sampling.chamber import Chamber
from auricle.sampling.tails import Tails, truncation_tail
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh

GAUSSIAN = MAP_CLASSES["gaussian"]


@pytest.mark.parametrize("share", [0.85, 0.90, 0.95])
def test_drawn_gaussian_foci_need_what_the_closed_form_says(fine_chamber, rng, share):
    tails = class_tails(fine_chamber, GAUSSIAN, n_draws=12, rng=rng, width_mm=5.0)
    expected = closed_form_modes(GAUSSIAN, area=fine_chamber.basis.area, share=share, width_mm=5.0)
    assert tails.modes_for_power(share) == pytest.approx(expected, rel=0.10)


def test_discs_need_what_the_closed_form_says_within_its_stated_accuracy(fine_chamber, rng):
    disc = MAP_CLASSES["disc"]
    tails = class_tails(fine_chamber, disc, n_draws=8, rng=rng, radius_mm=15.0)
    expected = closed_form_modes(disc, area=fine_chamber.basis.area, share=0.85, radius_mm=15.0)
    assert tails.modes_for_power(0.85) == pytest.approx(expected, rel=0.5)


def test_there_is_no_closed_form_for_a_scar():
    assert closed_form_modes(MAP_CLASSES["scar"], area=1e4, share=0.9) is None


@pytest.mark.parametrize("name", MAP_CLASSES)
def test_every_class_has_tails_that_fall(sphere_chamber, rng, name):
    tails = class_tails(sphere_chamber, MAP_CLASSES[name], n_draws=3, rng=rng)
    assert tails.squared_errors.shape == (3, sphere_chamber.basis.n_modes)
    assert (np.diff(tails.squared_errors, axis=1) <= 1e-12).all()
    assert (tails.at(0.9) >= tails.at(0.5)).all()


def test_obstacles_of_reentry_do_not_count(fine_chamber):
    """Nothing is activated there, so the singular points do not cost anything."""
    reentry = MAP_CLASSES["macro_reentry"]
    full, without = (
        class_tails(
            fine_chamber,
            reentry,
            n_draws=4,
            rng=np.random.default_rng(1),
            obstacle_radius_mm=radius,
        ).modes_for_power(0.99)
        for radius in (0.0, 8.0)
    )
    assert without < 0.8 * full


def test_maps_are_centred_where_one_can_sample(cut_chamber, rng):
    tails = class_tails(cut_chamber, GAUSSIAN, n_draws=10, rng=rng, width_mm=4.0)
    assert tails.squared_errors[:, 0].max() < 1.1


def test_scaling_the_chamber_and_the_map_leaves_the_tail(sphere_chamber):
    large = scaled(sphere_chamber, 3.0)
    one, other = (
        class_tails(each, GAUSSIAN, n_draws=3, rng=np.random.default_rng(2), width_mm=width)
        for each, width in ((sphere_chamber, 8.0), (large, 24.0))
    )
    assert np.allclose(one.squared_errors, other.squared_errors, atol=1e-9)


def scaled(chamber: Chamber, factor: float) -> Chamber:
    basis = chamber.basis
    grown = type(basis)(
        basis.eigenvalues / factor**2,
        basis.modes / factor,
        basis.areas * factor**2,
        basis.laplacian,
        basis.certificate,
    )
    return Chamber(
        Mesh(chamber.mesh.vertices * factor, chamber.mesh.faces), grown, chamber.accessible
    )


def test_past_maps_of_the_same_chamber_are_carried_over_unchanged(sphere_chamber, rng):
    fields = [GAUSSIAN.draw(sphere_chamber.mesh, rng, width_mm=8.0) for _ in range(3)]
    tails = past_tails([(sphere_chamber, field) for field in fields], sphere_chamber)
    expected = [truncation_tail(sphere_chamber, field.values) for field in fields]
    assert np.allclose(tails.squared_errors, expected)


def test_past_maps_keep_their_wavelength_on_a_larger_chamber(sphere_chamber, rng):
    """Foci of 8 mm seen on a small chamber foretell those of 8 mm on one of twice the area."""
    large = scaled(sphere_chamber, np.sqrt(2.0))
    past = [
        (sphere_chamber, GAUSSIAN.draw(sphere_chamber.mesh, rng, width_mm=9.0)) for _ in range(6)
    ]
    foretold = past_tails(past, large).modes_for_power(0.9)
    actual = class_tails(large, GAUSSIAN, n_draws=6, rng=rng, width_mm=9.0).modes_for_power(0.9)
    assert foretold == pytest.approx(actual, rel=0.2)
    assert foretold > 1.5 * past_tails(past, sphere_chamber).modes_for_power(0.9)


def test_beyond_the_past_harmonics_the_tail_stays_where_it_was(sphere_chamber, rng):
    large = scaled(sphere_chamber, 2.0)
    past = [(sphere_chamber, MAP_CLASSES["scar"].draw(sphere_chamber.mesh, rng))]
    small = past_tails([(large, FieldMap(large.mesh, past[0][1].values, "scar"))], sphere_chamber)
    known = truncation_tail(large, past[0][1].values)
    assert small.squared_errors[0, 0] == pytest.approx(known[3])
    assert np.all(small.squared_errors[0, 36:] == known[-1])


def test_left_out_maps_of_one_kind_are_covered_as_often_as_foretold():
    rng = np.random.default_rng(3)
    slopes = rng.uniform(0.8, 1.2, size=40)
    tails = Tails(np.arange(1.0, 3000.0) ** -slopes[:, None], "drawn")
    for quantile in (0.5, 0.9):
        coverage = left_out_coverage(tails, 0.98, quantile=quantile)
        assert coverage == pytest.approx(quantile, abs=0.05)


def test_a_map_unlike_the_others_is_not_covered():
    slopes = np.array([2.0, 2.0, 2.0, 0.6])
    tails = Tails(np.arange(1.0, 3000.0) ** -slopes[:, None], "drawn")
    assert left_out_coverage(tails, 0.9, quantile=0.9) == 0.75
    with pytest.raises(InputError, match="at least three"):
        left_out_coverage(Tails(tails.squared_errors[:2], "two"), 0.9, quantile=0.5)


def linear_posterior(chamber: Chamber, n_samples: int, rng) -> tuple[np.ndarray, ...]:
    """A band-limited map, and the posterior of its coefficients given samples at random."""
    k = chamber.basis.n_modes
    prior = np.where(np.arange(k) < 100, 1.0, 1e-9) / (1.0 + np.arange(k) / 5) ** 2
    truth = np.sqrt(prior) * rng.normal(size=k)
    modes = chamber.basis.modes[rng.choice(np.flatnonzero(chamber.accessible), n_samples)]
    noise = 0.05 * np.sqrt((modes**2 @ prior).mean())
    values = modes @ truth + noise * rng.normal(size=n_samples)
    gain = np.linalg.solve(modes * prior @ modes.T + noise**2 * np.eye(n_samples), modes * prior).T
    return truth, gain @ values, np.diag(prior) - gain @ (modes * prior)


def test_the_bracket_holds_the_truth_and_closes_with_the_samples(sphere_chamber, rng):
    held, closings = 0, {25: [], 400: []}
    for n_samples, closing in closings.items():
        for _ in range(80):
            truth, mean, covariance = linear_posterior(sphere_chamber, n_samples, rng)
            (found,) = bracket(mean, covariance, shares=[0.9])
            (actual,) = bracket(truth, np.zeros(len(truth)), shares=[0.9])
            held += found.lower <= 1.1 * actual.lower and actual.upper <= 1.1 * found.upper
            closing.append(found.closing)
    assert held >= 120  # of 160; 82 % are held
    assert np.median(closings[400]) < 1.2 < np.median(closings[25])


def test_the_bracket_of_a_known_map_is_what_its_spectrum_says(fine_chamber):
    values = np.exp(fine_chamber.mesh.vertices[:, 0] / 12)
    coefficients = fine_chamber.basis.transform(values)
    spectrum = fine_chamber.basis.power_spectrum(values)
    for found in bracket(coefficients, np.zeros(len(coefficients))):
        assert found.lower == found.upper == spectrum.modes_for_power(found.share)
        assert found.closing == 1.0


def test_the_upper_end_is_the_expected_power_of_draws_where_one_can_sample(cut_chamber):
    rng = np.random.default_rng(5)
    _, mean, covariance = linear_posterior(cut_chamber, 60, rng)
    modes, areas = cut_chamber.basis.modes, cut_chamber.accessible_areas
    gram = modes.T @ (areas[:, None] * modes)
    draws = rng.multivariate_normal(mean, covariance, size=400, method="eigh").T
    maps = modes @ draws
    deviation = maps - areas @ maps / areas.sum()
    varying = (areas @ deviation**2).mean()
    for found in bracket(mean, covariance, gram=gram):
        beyond = [
            (areas @ (modes[:, k:] @ draws[k:]) ** 2).mean() / varying
            for k in (found.upper - 3, found.upper + 2)
        ]
        assert beyond[0] > 1 - found.share > beyond[1]


def test_the_bracket_with_a_gram_is_the_measured_error_of_the_map(cut_chamber):
    values = np.exp(cut_chamber.mesh.vertices[:, 0] / 12)
    coefficients = cut_chamber.basis.transform(values)
    modes = cut_chamber.basis.modes
    gram = modes.T @ (cut_chamber.accessible_areas[:, None] * modes)
    tail = Tails(truncation_tail(cut_chamber, modes @ coefficients)[None], "one")
    for found in bracket(coefficients, np.zeros(len(coefficients)), gram=gram):
        assert found.lower == found.upper == tail.modes_for_power(found.share)


def test_what_has_no_bandwidth_is_refused(sphere_chamber, rng):
    with pytest.raises(InputError, match="constant"):
        bracket(np.array([1.0, 0.0]), np.zeros(2))
    with pytest.raises(InputError, match="variance of shape"):
        bracket(np.ones(3), np.zeros(2))
    with pytest.raises(InputError, match="no past maps"):
        past_tails([], sphere_chamber)
    with pytest.raises(InputError, match="at least one map"):
        class_tails(sphere_chamber, GAUSSIAN, n_draws=0, rng=rng)
    with pytest.raises(InputError, match="no parameter"):
        class_tails(sphere_chamber, GAUSSIAN, n_draws=1, rng=rng, size=3.0)
