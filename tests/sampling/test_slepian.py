import numpy as np
import pytest

from auricle.errors import BandError
from auricle.sampling.slepian import LEAST_CONCENTRATION, slepian_functions, tail


def test_on_a_closed_surface_they_are_the_harmonics(sphere_chamber):
    functions = slepian_functions(sphere_chamber, 49)
    np.testing.assert_array_equal(functions.transform, np.eye(49))
    assert functions.n_free == functions.n_modes == 49


def test_they_are_orthonormal_over_the_accessible_area(open_chamber):
    functions = slepian_functions(open_chamber, 100)
    values = open_chamber.basis.modes[:, :100] @ functions.transform
    gram = values.T @ (open_chamber.accessible_areas[:, None] * values)
    np.testing.assert_allclose(gram, np.eye(functions.n_free), atol=1e-9)
    assert functions.concentrations.min() >= LEAST_CONCENTRATION


def test_those_left_out_are_no_more_than_the_caps_can_hold(open_chamber):
    """Shannon's number of the cap, k times its share of area, and a few at the rim."""
    functions = slepian_functions(open_chamber, 144)
    shannon = 144 * open_chamber.accessible_area / open_chamber.basis.area
    assert 0.9 * shannon < functions.n_free < 144
    assert functions.concentrations.sum() == pytest.approx(shannon, rel=0.01)


def test_a_tail_is_orthogonal_to_the_functions_and_nothing_of_theirs_is_in_it(open_chamber, rng):
    functions = slepian_functions(open_chamber, 64)
    inside = (
        open_chamber.basis.modes[:, :64] @ functions.transform @ rng.normal(size=functions.n_free)
    )
    values = inside + rng.normal(size=len(inside))
    beyond = tail(open_chamber, functions, values)
    parts = open_chamber.rms(beyond) ** 2 + open_chamber.rms(values - beyond) ** 2
    assert parts == pytest.approx(open_chamber.rms(values) ** 2, rel=1e-12)
    assert open_chamber.rms(tail(open_chamber, functions, inside)) < 1e-12
    assert (beyond[~open_chamber.accessible] == 0).all()


def test_what_is_not_known_on_caps_does_not_matter(open_chamber, rng):
    functions = slepian_functions(open_chamber, 36)
    values = rng.normal(size=642)
    unknown = np.where(open_chamber.accessible, values, np.nan)
    np.testing.assert_array_equal(
        tail(open_chamber, functions, unknown), tail(open_chamber, functions, values)
    )


@pytest.mark.parametrize("n_modes", [0, 145])
def test_more_harmonics_than_there_are_are_refused(sphere_chamber, n_modes):
    with pytest.raises(BandError, match="harmonics"):
        slepian_functions(sphere_chamber, n_modes)
