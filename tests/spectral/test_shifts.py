"""Shifts climb, and shares meet: what one run is not to find, its neighbour is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse

from auricle.spectral import shifts
from auricle.spectral.factorization import analyze
from auricle.spectral.shifts import (
    Factorable,
    Outlook,
    Share,
    factors_amid,
    next_share,
    number_of_shares,
)


def of(values) -> Factorable:
    matrix = sparse.csc_array(sparse.diags_array(np.asarray(values, float)))
    return Factorable(matrix, analyze(matrix))


def one_to(n: int) -> Factorable:
    return of(np.arange(1.0, n + 1))


FOOT = Outlook(end=0, height=0.0, n_below=0, density=1.0)


@given(st.integers(0, 300), st.integers(1, 2000), st.integers(20, 90), st.data())
def test_shares_meet_and_end_at_the_goal(known, more, reach, data) -> None:
    """Wherever their shifts come to lie."""
    goal, outlook = known + more, FOOT._replace(end=known)
    n_left, ends = number_of_shares(outlook, goal, reach), [known]
    while n_left:
        share = next_share(outlook, goal, n_left)
        assert share.first == ends[-1] < share.end
        n_left -= 1
        if n_left:
            n_below = data.draw(st.integers(max(share.first - 5, 0), share.end + 5))
            share = share.settled(n_below, reach)
        outlook = outlook._replace(end=share.end)
        ends.append(share.end)
        n_left = outlook.shares_left(n_left, goal, reach)
    assert ends[-1] >= goal
    assert ends == sorted(set(ends))


@pytest.mark.parametrize(("goal", "count"), [(20, 1), (40, 1), (41, 2), (160, 2), (506, 6)])
def test_as_many_shares_are_laid_as_go_at_once_or_more(goal, count) -> None:
    assert number_of_shares(FOOT, goal, 40) == count


def test_shares_are_equal_but_for_the_lowest_which_is_cheap() -> None:
    lowest = next_share(FOOT, 506, 6)
    following = next_share(FOOT._replace(end=lowest.end), 506, 5)
    sizes = [share.end - share.first for share in (lowest, following)]
    assert sizes[0] - sizes[1] == pytest.approx(shifts._MORE_AT_THE_BOTTOM, abs=1)
    assert sizes[0] + 5 * sizes[1] == pytest.approx(506, abs=5)


def test_a_settled_share_reaches_as_far_above_its_shift_as_below() -> None:
    assert Share(84, 168).settled(124, 40) == Share(84, 164)
    assert Share(84, 168).settled(400, 40) == Share(84, 480)
    assert Share(84, 168).settled(80, 40) == Share(84, 168)


def test_what_is_counted_tells_how_dense_the_spectrum_is() -> None:
    matrix = one_to(1000)
    outlook = FOOT._replace(density=7.0).after(Share(0, 80), matrix.at(40.5))
    assert outlook == Outlook(80, 40.5, 40, pytest.approx(40 / 40.5))
    same = outlook.after(Share(80, 160), matrix.at(40.5))
    assert same.density == outlook.density


@pytest.mark.parametrize("density", [0.02, 0.3, 1.0, 3.0, 50.0])
@pytest.mark.parametrize("first", [0, 300])
def test_a_shift_lies_amid_its_share_whatever_was_expected(density, first) -> None:
    outlook = Outlook(first, max(first - 40.5, 0), max(first - 41, 0), density)
    share = Share(first, first + 80)
    n_below = factors_amid(one_to(1000), share, outlook).n_below
    assert abs(n_below - (first + 40)) <= shifts._OFF * 80


def test_beside_a_cluster_wider_than_the_share_a_side_is_taken(monkeypatch) -> None:
    """And not tried for again and again."""
    values = np.concatenate([np.arange(1.0, 31.0), np.full(100, 31.0), np.arange(32.0, 200.0)])
    tried = []
    factorize = shifts.factorize

    def noted(matrix, shift, **given):
        tried.append(shift)
        return factorize(matrix, shift, **given)

    monkeypatch.setattr(shifts, "factorize", noted)
    below, above = (
        factors_amid(of(values), share, FOOT).n_below for share in (Share(0, 90), Share(60, 150))
    )
    assert below <= 30
    assert 130 <= above <= 105 + 90
    assert len(tried) <= 2 * shifts._TRIES


def test_a_shift_is_placed_above_the_last_count_even_amid_what_lies_below_it() -> None:
    """A shift before has skipped a cluster, and most of this share with it."""
    outlook = Outlook(end=80, height=100.5, n_below=100, density=1.0)
    assert factors_amid(one_to(1000), Share(60, 130), outlook).shift > 100.5
