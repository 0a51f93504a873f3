import numpy as np
import pytest
from scipy.linalg import qr

from auricle.errors import BandError, InputError
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.pivoted_qr import pivoted_qr_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.stability import stability


def test_the_points_are_the_pivots_of_lapack(atrium_chamber):
    modes = atrium_chamber.basis.modes[:, :80]
    _, pivots = qr(modes.T, pivoting=True, mode="r")
    np.testing.assert_array_equal(pivoted_qr_sampling(atrium_chamber, 80, n_modes=80), pivots[:80])


@pytest.mark.parametrize("fixture", ["sphere_chamber", "open_chamber", "atrium_chamber"])
def test_as_many_points_as_degrees_of_freedom_determine_the_map(request, fixture):
    chamber = request.getfixturevalue(fixture)
    n_free = stability(chamber, Sites.at_vertices([0]), 64).n_free
    points = pivoted_qr_sampling(chamber, n_free, n_modes=64)
    found = stability(chamber, Sites.at_vertices(points), 64)
    assert found.condition < 10
    assert chamber.accessible[points].all()


def test_points_beyond_the_pivots_are_nested_and_beat_farthest_points(atrium_chamber):
    longer = pivoted_qr_sampling(atrium_chamber, 120, n_modes=80)
    for count in (40, 80, 100):
        shorter = pivoted_qr_sampling(atrium_chamber, count, n_modes=80)
        np.testing.assert_array_equal(shorter, longer[:count])
    assert len(np.unique(longer)) == 120
    own = stability(atrium_chamber, Sites.at_vertices(longer[:100]), 80)
    spread = farthest_point_sampling(atrium_chamber, 100)
    other = stability(atrium_chamber, Sites.at_vertices(spread), 80)
    assert own.constant > 1.5 * other.constant
    assert own.noise_gain < other.noise_gain


def test_each_further_point_lowers_the_noise_gain_most(atrium_chamber):
    points = pivoted_qr_sampling(atrium_chamber, 37, n_modes=36)
    modes = atrium_chamber.basis.modes[:, :36]

    def variance(point):
        rows = modes[[*points[:36], point]]
        return np.trace(np.linalg.inv(rows.T @ rows))

    others = np.setdiff1d(np.arange(0, atrium_chamber.mesh.n_vertices, 40), points)
    assert all(variance(points[36]) <= variance(other) * (1 + 1e-9) for other in others)


def test_existing_points_are_completed_and_not_repeated(atrium_chamber):
    whole = pivoted_qr_sampling(atrium_chamber, 60, n_modes=50)
    for n_existing in (20, 55):
        existing = Sites.at_vertices(whole[:n_existing])
        rest = pivoted_qr_sampling(atrium_chamber, 60 - n_existing, n_modes=50, existing=existing)
        np.testing.assert_array_equal(rest, whole[n_existing:])


def test_a_region_that_cannot_fix_the_harmonics_is_refused(atrium_chamber):
    few = np.zeros(atrium_chamber.mesh.n_vertices, dtype=bool)
    few[:30] = True
    with pytest.raises(InputError, match="30 vertices allowed"):
        pivoted_qr_sampling(atrium_chamber, 40, n_modes=40, allowed=few)
    existing = Sites.at_vertices(np.repeat(7, 5))
    few[7] = False
    points = pivoted_qr_sampling(atrium_chamber, 10, n_modes=4, allowed=few, existing=existing)
    assert set(points) <= set(range(30)) - {7}
    with pytest.raises(BandError, match="harmonics"):
        pivoted_qr_sampling(atrium_chamber, 5, n_modes=151)
