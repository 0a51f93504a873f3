import numpy as np
from scipy.ndimage import distance_transform_edt, label

from auricle.imaging.simple_points import ball_like


def ball_like_of(region):
    return ball_like(region, distance_transform_edt(region))


def euler_number(region):
    """Of the union of closed cubes' faces: voxels joined by faces, background by corners."""
    padded = np.pad(region, 1)
    n_voxels = padded.sum()
    shift = [padded.copy()]
    counts = 0
    for axes, sign in (((0,), -1), ((1,), -1), ((2,), -1)):
        joined = padded & np.roll(padded, 1, axis=axes[0])
        counts += sign * int(joined.sum())
    for first, second in ((0, 1), (0, 2), (1, 2)):
        square = padded & np.roll(padded, 1, first)
        square &= np.roll(square, 1, second)
        counts += int(square.sum())
    cube = shift[0]
    for axis in range(3):
        cube = cube & np.roll(cube, 1, axis)
    return int(n_voxels) + counts - int(cube.sum())


def test_a_ball_is_left_as_it_is():
    x, y, z = np.indices((15, 15, 15)) - 7
    ball = x**2 + y**2 + z**2 <= 36
    np.testing.assert_array_equal(ball_like_of(ball), ball)


def test_a_torus_is_cut_once_where_it_is_thinnest():
    x, y, z = np.indices((40, 40, 16)).astype(float) - np.array([20, 20, 8])[:, None, None, None]
    tube = 5.0 - 2.5 * (x > 12)
    torus = np.hypot(np.hypot(x, y) - 13.0, z) <= tube
    cut = torus & ~ball_like_of(torus)
    assert euler_number(torus) == 0
    assert euler_number(ball_like_of(torus)) == 1
    assert 0 < cut.sum() < 60
    assert np.argwhere(cut)[:, 0].min() > 20


def test_a_hollow_ball_is_opened():
    x, y, z = np.indices((21, 21, 21)) - 10
    shell = (x**2 + y**2 + z**2 <= 81) & (x**2 + y**2 + z**2 >= 25)
    opened = ball_like_of(shell)
    assert label(~np.pad(opened, 1), np.ones((3, 3, 3)))[1] == 1
    assert euler_number(opened) == 1


def test_noise_becomes_a_ball_in_topology(rng):
    opened = ball_like_of(rng.random((14, 14, 14)) < 0.8)
    assert label(opened)[1] == 1
    assert euler_number(opened) == 1
    assert label(~np.pad(opened, 1), np.ones((3, 3, 3)))[1] == 1
