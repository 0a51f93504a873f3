"""Maps beside one another: dots where they are seen, colours where something is known."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from auricle.report.maps import FOUR_SIDES, MapPanel, Marks, maps_picture, visible
from auricle.report.palettes import ColourScale
from auricle.report.rasterizer import rasterize
from auricle.report.views import STANDARD_VIEWS, cameras
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, joined

SPHERE = icosphere(radius=30.0, subdivisions=3)
SCALE = ColourScale("perceptual", (-30.0, 0.0, 30.0), "height (mm)")


@pytest.fixture(autouse=True)
def _coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures: quicker to draw."""
    monkeypatch.setattr("auricle.report.maps.RESOLUTION", 50)


def seen_from(view: str, mesh: Mesh, positions: np.ndarray) -> np.ndarray:
    (camera,) = cameras(mesh.vertices, [STANDARD_VIEWS[view]], width=200, height=200)
    return visible(rasterize(mesh, camera), mesh, positions)


def words(figure) -> list[str]:
    FigureCanvasAgg(figure).draw()
    found = [figure.get_supxlabel(), *(t.get_text() for one in figure.legends for t in one.texts)]
    for axes in figure.axes:
        found += [axes.get_title(), axes.get_xlabel(), axes.get_ylabel()]
    return found


def pictures(figure) -> list:
    return [axes for axes in figure.axes if axes.images]


@pytest.mark.parametrize(("view", "axis", "sign"), [("AP", 1, -1), ("PA", 1, 1), ("LL", 0, 1)])
def test_of_a_sphere_the_near_half_is_seen(view, axis, sign):
    """Sabotage: to drop the comparison of depths shows all of it."""
    towards = sign * SPHERE.vertices[:, axis]
    shown = seen_from(view, SPHERE, SPHERE.vertices)
    assert shown[towards > 6].all()
    assert not shown[towards < -6].any()


def test_a_surface_in_front_hides_what_is_behind_it():
    """Two balls one behind the other: from the front only the first, from behind the other."""
    behind = Mesh(0.5 * SPHERE.vertices + [0.0, 80.0, 0.0], SPHERE.faces)
    both = joined([SPHERE, behind])
    spots = np.array([[0.0, -30.0, 0.0], [0.0, 65.0, 0.0], [0.0, 95.0, 0.0]])
    assert seen_from("AP", both, spots).tolist() == [True, False, False]
    assert seen_from("PA", both, spots).tolist() == [False, False, True]


def test_a_place_outside_the_picture_is_not_seen():
    assert not seen_from("AP", SPHERE, np.array([[500.0, 0.0, 0.0], [0.0, 0.0, -900.0]])).any()


def test_dots_lie_where_the_raster_has_the_vertex():
    """The spot of a value is painted where the dot on it is put."""
    top = int(SPHERE.vertices[:, 2].argmax())
    values = np.where(np.arange(SPHERE.n_vertices) == top, 29.0, -29.0)
    figure = maps_picture(
        SPHERE,
        [MapPanel("spot", values, SCALE)],
        marks=[Marks("dot", SPHERE.vertices[[top]])],
        views=[STANDARD_VIEWS["SUP"]],
    )
    (axes,) = pictures(figure)
    image = axes.images[0].get_array().astype(float)
    (x, y), *_ = axes.collections[0].get_offsets()
    high, low = (band / band.sum() for band in (SCALE.bands[1], SCALE.bands[0]))
    pixel = image[round(float(y)), round(float(x)), :3]
    hue = pixel / pixel.sum()
    assert np.abs(hue - high).sum() < np.abs(hue - low).sum()


def test_every_panel_has_every_view_its_name_and_a_bar_with_its_unit():
    panels = [MapPanel("one", SPHERE.vertices[:, 2], SCALE), MapPanel("bare")]
    figure = maps_picture(SPHERE, panels)
    assert len(pictures(figure)) == 2 * len(FOUR_SIDES)
    assert len(figure.axes) == 2 * len(FOUR_SIDES) + 1
    assert {"one", "bare", "AP", "PA", "LL", "RL", "height\n(mm)"} <= set(words(figure))


def test_only_marks_there_are_stand_in_the_legend():
    marks = [
        Marks("samples", SPHERE.vertices[:5]),
        Marks("next points", np.empty((0, 3)), colour="#d00000", numbered=True),
    ]
    shown = words(maps_picture(SPHERE, [MapPanel("bare")], marks=marks))
    assert "samples" in shown
    assert "next points" not in shown


def test_numbers_are_those_of_the_order_given_and_only_where_seen():
    order = [int(SPHERE.vertices[:, 1].argmax()), int(SPHERE.vertices[:, 1].argmin())]
    marks = [Marks("next", SPHERE.vertices[order], numbered=True)]
    figure = maps_picture(SPHERE, [MapPanel("bare")], marks=marks)
    named = {axes.get_title(): [t.get_text() for t in axes.texts] for axes in pictures(figure)}
    assert named["AP"] == ["2"]
    assert named["PA"] == ["1"]


def test_what_grey_means_is_said_where_there_is_grey():
    holed = np.where(SPHERE.vertices[:, 2] > 10, np.nan, 0.0)
    grey = MapPanel("m", holed, SCALE, "not known")
    whole = MapPanel("m", SPHERE.vertices[:, 2], SCALE, "not known")
    assert "not known" in words(maps_picture(SPHERE, [grey]))
    assert "not known" not in words(maps_picture(SPHERE, [whole]))


def test_the_dark_inside_is_explained_where_it_is_seen():
    kept = SPHERE.vertices[SPHERE.faces][:, :, 1].max(axis=1) < 20
    numbers, faces = np.unique(SPHERE.faces[kept], return_inverse=True)
    opened = Mesh(SPHERE.vertices[numbers], faces.reshape(-1, 3))
    shut, opening = (maps_picture(each, [MapPanel("bare")]) for each in (SPHERE, opened))
    assert "inside" not in shut.get_supxlabel()
    assert "dark: the inside, seen through an opening" in opening.get_supxlabel()


def test_a_map_without_any_value_can_be_drawn():
    nothing = np.full(SPHERE.n_vertices, np.nan)
    assert "none" in words(maps_picture(SPHERE, [MapPanel("m", nothing, SCALE, "none")]))


@pytest.mark.parametrize("name", ["$x^2$ (ms)", "a" * 60, "no unit", ""])
def test_any_label_can_be_drawn(name):
    scale = ColourScale("perceptual", SCALE.boundaries, name.replace("$", r"\$"))
    words(maps_picture(SPHERE, [MapPanel("m", SPHERE.vertices[:, 2], scale)], views=FOUR_SIDES[:1]))
