"""Tails: the error that harmonics leave, measured where one can sample."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import BandError, InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.tails import Tails, first_within, truncation_tail


@pytest.fixture
def bumps(fine_chamber: Chamber) -> np.ndarray:
    """A map with all frequencies: exponentials of the coordinates, and some noise."""
    x, y, z = fine_chamber.mesh.vertices.T / 10
    return np.exp(x) + np.sin(2 * y * z) + 0.1 * np.random.default_rng(1).normal(size=len(x))


def test_on_a_closed_chamber_the_tail_is_what_the_spectrum_leaves(fine_chamber, bumps):
    shares = fine_chamber.basis.power_spectrum(bumps).cumulative()
    assert np.abs(truncation_tail(fine_chamber, bumps) - (1 - shares)).max() < 1e-12


@pytest.mark.parametrize("n_modes", [1, 7, 60, 256])
def test_the_tail_is_the_squared_nrmse_of_the_truncated_map(cut_chamber, bumps, n_modes):
    basis = cut_chamber.basis
    truncated = basis.inverse(basis.transform(bumps)[:n_modes])
    tail = truncation_tail(cut_chamber, bumps)
    assert tail[n_modes - 1] == pytest.approx(cut_chamber.nrmse(truncated, bumps) ** 2, rel=1e-9)


@given(factor=st.floats(0.01, 100), offset=st.floats(-1e4, 1e4))
def test_neither_unit_nor_offset_of_the_map_matters(sphere_chamber, factor, offset):
    values = np.exp(sphere_chamber.mesh.vertices[:, 0] / 10)
    one = truncation_tail(sphere_chamber, values)
    other = truncation_tail(sphere_chamber, factor * values + offset)
    assert np.allclose(other, one, atol=1e-9)


def test_the_errors_of_columns_add_up(sphere_chamber):
    x, y, _ = sphere_chamber.mesh.vertices.T / 10
    columns = np.column_stack([np.exp(x), 3 * np.exp(y)])
    variances = [sphere_chamber.rms(c - sphere_chamber.mean(c)) ** 2 for c in columns.T]
    tails = [truncation_tail(sphere_chamber, column) for column in columns.T]
    expected = (variances[0] * tails[0] + variances[1] * tails[1]) / sum(variances)
    assert np.allclose(truncation_tail(sphere_chamber, columns), expected)


def test_what_lies_on_the_caps_does_not_count_by_itself(cut_chamber, fine_chamber):
    """A change at the pole is an error of the closed chamber, and hardly one of the cut one."""
    z = fine_chamber.mesh.vertices[:, 2]
    smooth = np.exp(fine_chamber.mesh.vertices[:, 0] / 20)
    spoilt = np.where(z > 28.0, smooth + 2.0, smooth)
    closed, cut = (truncation_tail(c, spoilt)[100] for c in (fine_chamber, cut_chamber))
    assert cut < 0.2 * closed


def test_unsampled_vertices_are_left_out(fine_chamber, bumps):
    hidden = fine_chamber.mesh.vertices[:, 0] > 25.0
    holed = np.where(hidden, np.nan, bumps)
    tail = truncation_tail(fine_chamber, holed)
    assert np.isfinite(tail).all()
    assert not np.allclose(tail, truncation_tail(fine_chamber, bumps))
    same = truncation_tail(fine_chamber, bumps, known=~hidden)
    assert tail[30] == pytest.approx(same[30], rel=0.3)


def test_a_constant_map_has_no_tail(sphere_chamber):
    with pytest.raises(InputError, match="constant"):
        truncation_tail(sphere_chamber, np.full(sphere_chamber.mesh.n_vertices, 1e6))


def test_the_count_is_that_from_which_on_the_bound_holds():
    tail = np.array([1.0, 0.04, 0.2, 0.05, 0.01])
    assert first_within(tail, 0.05) == 4
    assert first_within(tail, 1.0) == 1
    with pytest.raises(BandError, match="solve for more"):
        first_within(tail, 0.001)


def test_quantiles_of_maps_are_ordered_and_read_mode_by_mode():
    tails = Tails(np.outer([1.0, 2.0, 4.0], [1.0, 0.1, 0.01]), "three")
    assert np.allclose(tails.at(0.5), [2.0, 0.2, 0.02])
    assert tails.modes_for_power(0.9, quantile=0.0) == 2
    assert tails.modes_for_power(0.9, quantile=1.0) == 3
    assert (tails.n_maps, tails.n_modes) == (3, 3)


@pytest.mark.parametrize("rows", [np.zeros((0, 3)), np.array([1.0, 2.0]), np.array([[np.nan]])])
def test_tails_that_are_none_are_refused(rows):
    with pytest.raises(InputError, match="tail"):
        Tails(rows, "nothing")


def test_quantiles_and_shares_out_of_range_are_refused():
    tails = Tails(np.array([[1.0, 0.1]]), "one")
    with pytest.raises(InputError, match="quantile"):
        tails.at(1.5)
    with pytest.raises(InputError, match="share"):
        tails.modes_for_power(0.0)
