"""The directions of the standard views, by the axes of a patient."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.report.views import STANDARD_VIEWS, Camera

LEFT, BACK, HEAD = np.eye(3)


@pytest.mark.parametrize("view", STANDARD_VIEWS.values(), ids=STANDARD_VIEWS)
def test_every_view_has_three_unit_axes_at_right_angles(view):
    axes = np.array([view.right, view.up, view.toward])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "viewer"),
    [
        ("AP", -BACK),
        ("PA", BACK),
        ("LL", LEFT),
        ("RL", -LEFT),
        ("SUP", HEAD),
        ("INF", -HEAD),
        ("LAO 45", (LEFT - BACK) / np.sqrt(2)),
        ("RAO 30", -np.sin(np.pi / 6) * LEFT - np.cos(np.pi / 6) * BACK),
    ],
)
def test_the_viewer_stands_where_the_views_name_says(name, viewer):
    np.testing.assert_allclose(STANDARD_VIEWS[name].toward, viewer, atol=1e-12)


def test_a_millimetre_upwards_goes_up_by_its_pixels():
    camera = Camera(STANDARD_VIEWS["AP"], (1.0, 2.0, 3.0), 0.5, 10, 20)
    placed = camera.project(np.array([[1.0, 2.0, 3.0], [1.0, -1.0, 4.0]]))
    np.testing.assert_allclose(placed, [[5.0, 10.0, 0.0], [5.0, 8.0, 3.0]])


@pytest.mark.parametrize(("mm_per_pixel", "width"), [(0.0, 10), (np.nan, 10), (1.0, 0)])
def test_a_camera_without_pixels_is_refused(mm_per_pixel, width):
    with pytest.raises(InputError, match="pixel"):
        Camera(STANDARD_VIEWS["AP"], (0.0, 0.0, 0.0), mm_per_pixel, width, 10)
