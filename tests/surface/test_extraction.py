import numpy as np
import pytest
from scipy.special import elliprg

from auricle.errors import InputError, SurfaceError
from auricle.surface.extraction import extract_surface
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import soundness

SEMI_AXES = np.array([12.0, 16.0, 20.0])
AREA = 4 * np.pi * elliprg(*(np.roll(SEMI_AXES, -1) * np.roll(SEMI_AXES, -2)) ** 2)
VOLUME = 4 / 3 * np.pi * SEMI_AXES.prod()


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6.0)


def ellipsoid_surface(spacing=(1.0, 1.0, 1.0), shift=(0.0, 0.0, 0.0), **options) -> Mesh:
    low = -25.0 + np.array([0.13, 0.29, 0.41])
    axes = [np.arange(start, 25.0, step) for start, step in zip(low, spacing, strict=True)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    radius = np.sqrt(sum((c / a) ** 2 for c, a in zip((x, y, z), SEMI_AXES, strict=True)))
    origin = tuple(low + shift)
    return extract_surface(7.0 - 3.0 * radius, level=4.0, spacing=spacing, origin=origin, **options)


def relative_radius(mesh: Mesh):
    return np.linalg.norm(mesh.vertices / SEMI_AXES, axis=1)


@pytest.mark.parametrize("passes", [0, 20])
def test_a_convex_surface_is_a_little_too_small_and_by_less_than_one_percent(passes):
    mesh = ellipsoid_surface(smoothing_passes=passes)
    assert 0.99 < mesh.area / AREA < 1.0
    assert 0.99 < volume(mesh) / VOLUME < 1.0


def test_area_and_volume_converge_at_second_order():
    coarse, fine = (ellipsoid_surface((h, h, h), smoothing_passes=0) for h in (2.0, 1.0))
    assert 3.2 < (AREA - coarse.area) / (AREA - fine.area) < 4.8
    assert 3.2 < (VOLUME - volume(coarse)) / (VOLUME - volume(fine)) < 4.8


def test_vertices_lie_on_the_level_set_of_a_grid_with_unequal_spacing():
    mesh = ellipsoid_surface((0.8, 1.0, 1.4), smoothing_passes=0)
    assert np.abs(relative_radius(mesh) - 1.0).max() < 0.003


def test_smoothing_takes_the_grid_off_without_shrinking():
    rough, smooth = (ellipsoid_surface(smoothing_passes=n) for n in (0, 20))
    np.testing.assert_array_equal(rough.faces, smooth.faces)
    assert abs(volume(smooth) / volume(rough) - 1.0) < 0.001
    assert np.abs(relative_radius(smooth) - 1.0).max() < 0.004
    assert soundness(smooth).smallest_quality > 10 * soundness(rough).smallest_quality


def test_a_wide_pass_band_leaves_the_surface_as_it_is():
    plain = ellipsoid_surface(smoothing_passes=0)
    passed = ellipsoid_surface(smoothing_passes=20, pass_band=2.0)
    assert np.abs(plain.vertices - passed.vertices).max() < 1e-3


def test_the_origin_moves_the_surface_and_nothing_else():
    shift = np.array([1e5, -2e5, 3e5])
    here, there = ellipsoid_surface(), ellipsoid_surface(shift=shift)
    np.testing.assert_array_equal(here.faces, there.faces)
    np.testing.assert_allclose(there.vertices - shift, here.vertices, atol=1e-9)


@pytest.mark.parametrize("sigma", [0, 1])
def test_fields_full_of_ties_give_closed_manifold_surfaces_without_flat_faces(rng, sigma):
    field = np.zeros((20, 20, 20))
    field[1:-1, 1:-1, 1:-1] = rng.integers(-1, 2, size=(18, 18, 18))
    if sigma:
        field = np.round(sum(np.roll(field, 1, axis=axis) for axis in range(3)))
        field[[0, -1]] = field[:, [0, -1]] = field[:, :, [0, -1]] = 0
    mesh = extract_surface(
        field, level=0.0, spacing=(1, 1, 1), origin=(0, 0, 0), smoothing_passes=0
    )
    report = soundness(mesh)
    assert report.is_closed
    assert report.is_manifold
    assert report.is_oriented
    assert report.n_zero_area_faces == 0
    assert report.n_duplicate_vertices == 0


def test_a_value_equal_to_the_level_lies_outside():
    field = np.zeros((5, 5, 5))
    field[2, 2, 2] = 1.0
    mesh = extract_surface(
        field, level=0.0, spacing=(1, 1, 1), origin=(0, 0, 0), smoothing_passes=0
    )
    assert mesh.n_vertices == 6
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - 2.0, axis=1), 0.99, atol=0.001)


def test_two_regions_give_two_pieces():
    field = np.full((12, 6, 6), -1.0)
    field[2:4, 2:4, 2:4] = field[8:10, 2:4, 2:4] = 1.0
    mesh = extract_surface(field, level=0.0, spacing=(1, 1, 1), origin=(0, 0, 0))
    assert soundness(mesh).n_pieces == 2


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("end", [0, -1])
def test_a_surface_that_leaves_the_grid_is_refused(axis, end):
    field = np.full((6, 6, 6), -1.0)
    field[2:4, 2:4, 2:4] = 1.0
    np.moveaxis(field, axis, 0)[end, 3, 3] = 1.0
    with pytest.raises(SurfaceError, match="the surface leaves the grid: enlarge it"):
        extract_surface(field, level=0.0, spacing=(1, 1, 1), origin=(0, 0, 0))


def test_a_field_below_the_level_is_refused():
    with pytest.raises(SurfaceError, match="lower the level"):
        extract_surface(np.zeros((5, 5, 5)), level=0.0, spacing=(1, 1, 1), origin=(0, 0, 0))


@pytest.mark.parametrize(
    ("field", "options"),
    [
        (np.zeros((5, 5)), {}),
        (np.zeros((5, 5, 2)), {}),
        (np.full((5, 5, 5), np.nan), {}),
        (np.zeros((5, 5, 5)), {"spacing": (1, -1, 1)}),
        (np.zeros((5, 5, 5)), {"smoothing_passes": -1}),
        (np.zeros((5, 5, 5)), {"pass_band": 0.0}),
    ],
)
def test_what_is_no_field_or_no_option_is_refused(field, options):
    with pytest.raises(InputError, match=r": (give|fill)"):
        extract_surface(
            field, **({"level": 0.0, "spacing": (1, 1, 1), "origin": (0, 0, 0)} | options)
        )
