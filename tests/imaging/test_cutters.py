import numpy as np
import pytest
from scipy.ndimage import label

from auricle.errors import InputError
from auricle.imaging.cutters import BallCutter, DiscCutter
from auricle.imaging.segmentation import SegmentationOptions, segment
from auricle.imaging.start import start_of
from auricle.simulation.phantom import PhantomOptions, phantom

COARSE = SegmentationOptions(step=2.0)


@pytest.fixture(scope="module")
def patient():
    return phantom(PhantomOptions(preset="tiny", seed=1))


@pytest.fixture(scope="module")
def whole(patient):
    return segment(patient.volume, COARSE)


@pytest.mark.parametrize("step", [0.7, 1.0, 3.0])
def test_nothing_grows_through_a_disc_however_it_is_turned(rng, step):
    nodes = np.indices((21, 21, 21)).reshape(3, -1).T * step
    for normal in rng.normal(size=(20, 3)):
        wall = DiscCutter(nodes.mean(axis=0), normal, 1e3).bars(nodes, step=step)
        pieces, n_pieces = label(~wall.reshape(21, 21, 21))
        sides = np.sign((nodes - nodes.mean(axis=0)) @ normal).reshape(21, 21, 21)
        assert n_pieces >= 2
        for piece in range(1, n_pieces + 1):
            assert len(np.unique(sides[pieces == piece])) == 1


def test_a_disc_ends_at_its_rim():
    disc = DiscCutter([0.0, 0, 0], [0, 0, 5], 4.0)
    assert disc.bars(np.array([[3.9, 0, 0], [4.1, 0, 0]]), step=1.0).tolist() == [True, False]


@pytest.mark.parametrize(
    "made",
    [
        lambda: BallCutter([0, 0, 0], 0.0),
        lambda: BallCutter([0, 0, np.nan], 1.0),
        lambda: DiscCutter([0, 0, 0], [0, 0, 0], 1.0),
        lambda: DiscCutter([0, 0], [0, 0, 1], 1.0),
        lambda: DiscCutter([0, 0, 0], [0, 0, 1], np.inf),
    ],
)
def test_a_cutter_without_size_or_place_is_refused(made):
    with pytest.raises(InputError, match="give"):
        made()


def test_what_lies_behind_a_disc_is_left_out_and_what_lies_before_it_stays(patient, whole):
    vein = next(branch for branch in whole.branches if branch.kind == "vein")
    outward = vein.ostium - whole.seed.position
    disc = DiscCutter(vein.ostium, outward, 15.0)
    cut = segment(
        patient.volume, SegmentationOptions(step=2.0, cutters=(disc,)), start=start_of_whole(whole)
    )
    nodes = np.indices(cut.image.shape).reshape(3, -1).T
    points = cut.image.points_at(nodes)
    behind = ((points - vein.ostium) @ outward > 0) & (
        np.linalg.norm(points - vein.ostium, axis=1) < 10.0
    )
    was, now = whole.mask.voxels.ravel(), cut.mask.voxels.ravel()
    assert was[behind].sum() > 50
    assert now[behind].sum() < 0.1 * was[behind].sum()
    far = np.linalg.norm(points - vein.ostium, axis=1) > 20.0
    assert (was[far] != now[far]).mean() < 0.005
    assert not (now & disc.bars(points, step=2.0)).any()


def start_of_whole(whole):
    from auricle.imaging.start import Start

    return Start(whole.seed, whole.image)


def test_a_start_at_hand_changes_nothing_but_the_time(patient, whole):
    lower = SegmentationOptions(step=2.0, lower=whole.thresholds.lower + 20.0)
    start = start_of(patient.volume, COARSE)
    from_start = segment(patient.volume, lower, start=start)
    afresh = segment(patient.volume, lower)
    np.testing.assert_array_equal(from_start.mask.voxels, afresh.mask.voxels)
    assert from_start.reasons == afresh.reasons
