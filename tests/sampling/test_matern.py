"""The Matérn prior: its scale, its limits, its shape."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.matern import matern_variances


def test_a_map_of_amplitude_one_has_variance_one_in_the_mean_over_the_surface(
    sphere_chamber: Chamber,
) -> None:
    basis = sphere_chamber.basis
    variance = np.square(basis.modes) @ matern_variances(basis, length=12.0)
    assert basis.areas @ variance / basis.area == pytest.approx(1.0, rel=1e-12)


def test_longer_maps_are_smoother_and_smoothness_counts_at_short_wavelengths(
    sphere_chamber: Chamber,
) -> None:
    basis = sphere_chamber.basis
    short, long = (matern_variances(basis, length=length) for length in (5.0, 40.0))
    assert short[1] < long[1]
    assert short[-1] > long[-1]
    rough, smooth = (matern_variances(basis, length=60.0, smoothness=nu) for nu in (0.5, 2.5))
    # Far beyond 1/ℓ the density falls as λ^-(ν + 1).
    ends = np.log(basis.eigenvalues[-1] / basis.eigenvalues[50])
    for variances, nu in ((rough, 0.5), (smooth, 2.5)):
        slope = np.log(variances[-1] / variances[50]) / ends
        assert slope == pytest.approx(-(nu + 1), rel=0.05)


@settings(max_examples=20, deadline=None)
@given(length=st.floats(1e-3, 1e4), smoothness=st.floats(0.1, 10))
def test_any_length_gives_positive_variances_but_for_the_constant(
    sphere_chamber: Chamber, length: float, smoothness: float
) -> None:
    variances = matern_variances(sphere_chamber.basis, length=length, smoothness=smoothness)
    assert variances[0] == 0.0
    assert (variances[1:] > 0).all()
    assert np.isfinite(variances).all()


@pytest.mark.parametrize(("length", "smoothness"), [(0.0, 1.5), (10.0, -1.0), (np.nan, 1.5)])
def test_lengths_and_smoothnesses_are_positive(
    sphere_chamber: Chamber, length: float, smoothness: float
) -> None:
    with pytest.raises(InputError, match="must be positive"):
        matern_variances(sphere_chamber.basis, length=length, smoothness=smoothness)
