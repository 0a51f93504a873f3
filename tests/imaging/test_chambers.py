import numpy as np
import pytest

from auricle.imaging.chambers import ATRIUM, OTHER, TO_VENTRICLE, VENTRICLE, chambers_of
from auricle.imaging.mitral import cut_at_mitral, hinge_plane, mitral_plane
from auricle.imaging.necks import distance_basins
from auricle.imaging.veins import trim_veins

SHAPE = (110, 90, 90)
MIDDLE = np.array([45.0, 50.0, 55.0])
GRID = np.moveaxis(np.indices(SHAPE), 0, -1) - MIDDLE
VENTRICLE_AT = 38.0 * TO_VENTRICLE
LEAFLET_LENGTH, LEAFLET_RADIUS = 10.0, 6.0
ANNULUS_AT, ANNULUS_RADIUS = 16.0, 12.0


def ball(centre, radius):
    return np.linalg.norm(GRID - centre, axis=-1) <= radius


def tube(start, end, radius):
    start, end = np.asarray(start, float), np.asarray(end, float)
    way = end - start
    share = np.clip((GRID - start) @ way / (way @ way), 0.0, 1.0)
    return np.linalg.norm(GRID - start - share[..., None] * way, axis=-1) <= radius


def heart():
    """An atrium, a ventricle with open leaflets between, an appendage, two veins, an aorta."""
    height = GRID @ TO_VENTRICLE
    aside = np.linalg.norm(GRID - height[..., None] * TO_VENTRICLE, axis=-1)
    atrium = ball((0, 0, 0), 20.0) & (height <= ANNULUS_AT)
    ventricle = ball(VENTRICLE_AT, 24.0) & (height > ANNULUS_AT)
    share = np.clip((height - ANNULUS_AT) / LEAFLET_LENGTH, 0.0, 1.0)
    funnel = ANNULUS_RADIUS + share * (LEAFLET_RADIUS - ANNULUS_RADIUS)
    behind = (height > ANNULUS_AT) & (height < ANNULUS_AT + LEAFLET_LENGTH)
    leaflet = behind & (np.abs(aside - funnel) < 1.3)
    ring = (np.abs(height - ANNULUS_AT) < 1.5) & (aside > ANNULUS_RADIUS) & (aside < 21.0)
    appendage = tube((14, -8, 8), (24, -14, 14), 4.0) | ball((26, -16, 17), 9.0)
    veins = tube((-14, 5, 5), (-44, 12, 14), 5.0) | tube((12, 12, 4), (44, 38, 8), 5.0)
    aorta = tube((-10, -40, 12), (-10, -40, 34), 9.0) | tube((-10, -32, 10), (-5, -15, 5), 2.0)
    return (atrium | ventricle | appendage | veins | aorta) & ~leaflet & ~ring


@pytest.fixture(scope="module")
def parted():
    basins = distance_basins(heart(), step=1.0)
    return chambers_of(basins, int(basins.labels[45, 50, 55]) - 1, step=1.0)


@pytest.fixture(scope="module")
def annulus(parted):
    orifice = mitral_plane(parted.labels, step=1.0)
    return hinge_plane(parted.labels, orifice, middle=MIDDLE, step=1.0)


def label_at(labels, offset):
    return labels[tuple(np.round(MIDDLE + offset).astype(int))]


def test_ventricle_and_aorta_are_told_from_the_atrium_its_veins_and_its_appendage(parted):
    assert label_at(parted.labels, [0, 0, 0]) == ATRIUM
    assert label_at(parted.labels, [26, -16, 17]) == ATRIUM
    assert label_at(parted.labels, [-40, 11, 13]) == ATRIUM
    assert label_at(parted.labels, VENTRICLE_AT) == VENTRICLE
    assert label_at(parted.labels, [-10, -40, 22]) == OTHER
    assert parted.radius == pytest.approx(19.0, abs=1.5)
    assert parted.mitral_radius == pytest.approx(LEAFLET_RADIUS - 1.3, abs=1.5)
    assert 0.0 < parted.leak_radius < 3.0


def test_without_known_axes_the_widest_opening_is_the_ventricle():
    basins = distance_basins(heart(), step=1.0)
    home = int(basins.labels[45, 50, 55]) - 1
    turned = chambers_of(basins, home, step=1.0, oriented=False)
    assert label_at(turned.labels, VENTRICLE_AT) == VENTRICLE


def test_the_plane_is_found_at_the_hinges_of_open_leaflets_not_at_their_tips(parted, annulus):
    orifice = mitral_plane(parted.labels, step=1.0)
    at = [(plane.centre - MIDDLE) @ TO_VENTRICLE for plane in (orifice, annulus)]
    assert at[0] > ANNULUS_AT + 5.0
    assert at[1] == pytest.approx(ANNULUS_AT, abs=3.0)
    assert annulus.normal @ TO_VENTRICLE > np.cos(np.radians(10.0))


def test_the_cut_leaves_nothing_of_the_atrium_beyond_the_plane_but_the_appendage(parted, annulus):
    cut = cut_at_mitral(parted.labels, annulus, step=1.0)
    height = (GRID + MIDDLE - annulus.centre) @ annulus.normal
    beyond = (cut == ATRIUM) & (height > 1.0)
    aside = np.linalg.norm(
        GRID - np.outer(GRID.reshape(-1, 3) @ TO_VENTRICLE, TO_VENTRICLE).reshape(GRID.shape),
        axis=-1,
    )
    assert not (beyond & (aside < ANNULUS_RADIUS)).any()
    assert label_at(cut, [26, -16, 17]) == ATRIUM
    assert ((cut > 0) == (parted.labels > 0)).all()


@pytest.mark.parametrize("stub", [6.0, 12.0])
def test_veins_are_cut_a_stub_from_the_body_and_the_appendage_is_kept(parted, annulus, stub):
    labels = cut_at_mitral(parted.labels, annulus, step=1.0)
    found = trim_veins(labels == ATRIUM, labels, radius=parted.radius, step=1.0, stub=stub)
    assert [branch.kind for branch in found.branches[:3]] == ["appendage", "vein", "vein"]
    assert max((branch.volume_ml for branch in found.branches[3:]), default=0.0) < 1.0
    kept = GRID[found.atrium]
    right = kept[kept[:, 0] < -20.0]
    axis = np.array([-30.0, 7.0, 9.0]) / np.linalg.norm([-30.0, 7.0, 9.0])
    assert (right @ axis).max() == pytest.approx(19.5 + stub, abs=2.5)
    assert found.atrium[tuple(np.round(MIDDLE + np.array([30, -19, 20])).astype(int))]
    assert not (found.atrium & found.beyond).any()
    radii = [branch.radius for branch in found.branches[1:3]]
    np.testing.assert_allclose(radii, 5.0, atol=1.0)


def test_without_known_axes_no_branch_is_called_the_appendage(parted):
    found = trim_veins(
        parted.labels == ATRIUM,
        parted.labels,
        radius=parted.radius,
        step=1.0,
        oriented=False,
    )
    assert {branch.kind for branch in found.branches} == {"vein"}


def test_a_branch_too_large_for_a_vein_is_a_leak_and_cut_at_the_body():
    chamber = ball((0, 0, 0), 20.0) | tube((-15, 0, 0), (-25, 0, 0), 4.0) | ball((-40, 0, 0), 23.0)
    atrium = chamber & (GRID[..., 0] > -44)
    found = trim_veins(atrium, np.zeros_like(atrium), radius=20.0, step=1.3)
    leak = found.branches[0]
    assert (leak.kind, len(found.branches)) == ("leak", 1)
    assert leak.volume_ml > 40.0
    assert GRID[found.atrium][:, 0].min() > -23.0


def test_a_nub_beside_a_leak_goes_with_it_and_one_elsewhere_stays():
    """As where contrast is unevenly mixed: part of the structure is joined by a way of its own."""
    chamber = ball((0, 0, 0), 20.0) | tube((-15, 0, 0), (-25, 0, 0), 4.0) | ball((-40, 0, 0), 23.0)
    gap = tube((-22, 8, 0), (-33, 8, 0), 1.5) & (GRID[..., 0] > -30)
    beside = tube((-17, 11, 0), (-31, 11, 0), 2.5)
    away = tube((0, 0, 17), (0, 0, 30), 2.5)
    atrium = (chamber | beside | away) & (GRID[..., 0] > -44) & ~gap
    found = trim_veins(atrium, np.zeros_like(atrium), radius=20.0, step=1.3)
    assert [branch.kind for branch in found.branches].count("leak") == 1
    kept = GRID[found.atrium]
    assert kept[:, 0].min() > -23.0
    assert kept[:, 2].max() > 25.0


def test_a_short_neck_to_another_chamber_is_cut_near_the_body():
    chamber = ball((0, 0, 0), 20.0) | tube((-15, 0, 0), (-25, 0, 0), 5.0)
    labels = np.where(ball((-44, 0, 0), 16.0), OTHER, np.where(chamber, ATRIUM, 0))
    found = trim_veins(labels == ATRIUM, labels, radius=20.0, step=1.3)
    assert found.branches == ()
    assert GRID[found.atrium][:, 0].min() > -24.0
    alone = trim_veins(labels == ATRIUM, np.zeros_like(labels), radius=20.0, step=1.3)
    assert GRID[alone.atrium][:, 0].min() < -25.0


def test_chambers_that_hardly_touch_have_no_plane():
    labels = np.zeros((20, 20, 20), dtype=np.int8)
    labels[:10], labels[12:] = ATRIUM, VENTRICLE
    assert mitral_plane(labels, step=1.0) is None
    labels[10:12, 5:7, 5:7] = ATRIUM
    assert mitral_plane(labels, step=1.0) is None
