"""Where two runs' eigenvalues join with none missing between them."""

import numpy as np
from scipy import sparse

from auricle.spectral.factorization import factorize
from auricle.spectral.ladder import Ladder, junction

ONE_TO_FORTY = sparse.csc_array(sparse.diags_array(np.arange(1.0, 41.0)))


def ladder(values: list[float], certified: float = 0.0) -> Ladder:
    return Ladder(np.array(values), np.empty((40, len(values))), certified=certified, scale=1.0)


def test_the_lower_shift_gives_what_it_found_and_the_upper_goes_on() -> None:
    upper = factorize(ONE_TO_FORTY, 20.5)
    low, high = ladder([*range(1, 13)]), np.arange(9.0, 31.0)
    kept, first = junction(low, high, upper)
    assert np.array_equal([*low.values[:kept], *high[first:]], np.arange(1.0, 31.0))


def test_one_missing_between_them_is_no_junction() -> None:
    upper = factorize(ONE_TO_FORTY, 20.5)
    assert junction(ladder([*range(1, 10)]), np.arange(11.0, 31.0), upper) is None
    assert junction(ladder([1, 2, 4, 5, 6]), np.array([5.0, 6, *range(8, 22)]), upper) is None


def test_a_count_that_only_fits_within_a_cluster_is_no_junction() -> None:
    """Where the two could only meet between equal eigenvalues nothing says which are whose."""
    matrix = sparse.csc_array(sparse.diags_array(np.repeat([1.0, 2.0], 20)))
    upper = factorize(matrix, 2.5)
    # Below the shift lie 40: the ladder holds all twenty ones, the run four copies of the twos.
    low = ladder([1.0] * 20 + [2.0] * 18)
    assert junction(low, np.full(4, 2.0), upper) is None


def named(values: list[float]) -> np.ndarray:
    """Vectors that tell their eigenvalue."""
    return np.repeat(np.array(values)[None, :], 3, axis=0)


def test_vectors_stay_with_their_values_while_the_ladder_grows() -> None:
    rungs = Ladder(
        np.array([1.0, 2, 3, 4]), named([1, 2, 3, 4]), certified=2.5, n_certified=2, scale=1.0
    )

    def fill(columns: np.ndarray) -> None:
        columns[:] = named([3.5, 5, 6, 7])

    rungs.replace_above(1, np.array([3.5, 5, 6, 7]), fill)
    np.testing.assert_array_equal(rungs.values, [1, 2, 3, 3.5, 5, 6, 7])
    np.testing.assert_array_equal(rungs.vectors, named(list(rungs.values)))
    rungs.add(np.array([5.5, 0.5]), named([5.5, 0.5]))
    np.testing.assert_array_equal(rungs.values, [0.5, 1, 2, 3, 3.5, 5, 5.5, 6, 7])
    np.testing.assert_array_equal(rungs.vectors, named(list(rungs.values)))
    np.testing.assert_array_equal(rungs.from_value(5.2), named([5.5, 6, 7]))
