"""The pictures of surfaces: the right panels, colours and words."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from auricle.report.palettes import UNKNOWN
from auricle.report.pictures import (
    DISTANCE_SCALE,
    FOCUS_SCALE,
    best_view,
    fields_picture,
    foci_picture,
    reconstruction_picture,
)
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere


def panels(figure):
    return [axes for axes in figure.axes if axes.images]


def words(figure):
    FigureCanvasAgg(figure).draw()
    found = [figure.get_supxlabel(), *(t.get_text() for one in figure.legends for t in one.texts)]
    for axes in figure.axes:
        found += [axes.get_title(), axes.get_xlabel(), axes.get_ylabel()]
    return found


def is_grey(image):
    """Pixels in which red, green and blue are equal, whatever the shading."""
    colour = image[image[..., 3] == 255][:, :3].astype(int)
    return (np.ptp(colour, axis=1) <= 1).mean()


def test_the_rebuilt_surface_stands_beside_the_original_front_and_back(case):
    figure = reconstruction_picture(case)
    assert len(panels(figure)) == 2 * (1 + len(case.reconstructions))
    shown = words(figure)
    assert {"original", "50 harmonics", "AP", "PA", "distance to the original (mm)"} <= set(shown)
    (error,) = [each for each in case.geometry_errors if each.n_modes == 50]
    assert f"mean distance {error.gd_mean_mm:.2g} mm" in shown


def test_a_perfect_reconstruction_has_the_colour_of_the_smallest_distance(case):
    exact = replace(case, reconstructions={50: case.surface.vertices})
    image = panels(reconstruction_picture(exact))[1].images[0].get_array()
    colours = image[image[..., 3] == 255][:, :3]
    hue = colours / colours.max(axis=1, keepdims=True)
    band = DISTANCE_SCALE.bands[0] / DISTANCE_SCALE.bands[0].max()
    np.testing.assert_allclose(hue, np.broadcast_to(band, hue.shape), atol=0.02)


def test_too_few_harmonics_for_a_picture_leave_the_original(case):
    assert len(panels(reconstruction_picture(replace(case, reconstructions={})))) == 2


def test_each_field_has_two_views_and_a_colour_bar_with_its_unit(case):
    figure = fields_picture(case)
    assert len(panels(figure)) == 4
    shown = words(figure)
    assert "local activation time\n(ms)" in shown
    assert "bipolar voltage\n(mV, by its name)" in shown
    assert "not sampled" in shown


@pytest.mark.parametrize(("outlier", "points_on"), [(0.0, "neither"), (1e3, "max"), (-1e3, "min")])
def test_the_colour_bar_points_on_where_values_lie_beyond_it(case, outlier, points_on):
    values = np.clip(case.surface.vertices[:, 0], -20.0, 20.0)
    values[0] = outlier
    field = FieldMap(case.surface, values, "tawss")
    alone = replace(case, fields=(replace(case.fields[0], field=field),))
    (bar,) = [axes for axes in fields_picture(alone).axes if not axes.images]
    assert bar._colorbar.extend == points_on


def test_only_what_is_not_sampled_is_grey(case):
    greys = [is_grey(panel.images[0].get_array()) for panel in panels(fields_picture(case))]
    assert greys[:2] == [0, 0]
    assert 0.02 < min(greys[2:]) <= max(greys[2:]) < 0.3
    assert len(set(UNKNOWN)) == 1


def test_the_legend_does_not_name_grey_where_all_is_sampled(case):
    whole = replace(case, fields=case.fields[:1])
    assert "not sampled" not in words(fields_picture(whole))


def test_simulated_maps_stand_by_number_and_width(case):
    figure = foci_picture(case)
    assert len(panels(figure)) == 4
    titles = [axes.get_title() for axes in panels(figure)]
    assert [title.split(" (")[0] for title in titles] == [
        "1 focus, σ = 8 mm",
        "1 focus, σ = 16 mm",
        "2 foci, σ = 8 mm",
        "2 foci, σ = 16 mm",
    ]
    assert FOCUS_SCALE.label in words(figure)


def test_a_focus_is_seen_in_its_best_view():
    sphere = icosphere(radius=30.0, subdivisions=3)
    for name, place in {"PA": (0, 1, 0), "LL": (1, 0, 0), "INF": (0, 0, -1)}.items():
        squared = ((sphere.vertices - 30.0 * np.array(place)) ** 2).sum(axis=1)
        assert best_view(sphere, np.exp(-squared / 50)).name == name
