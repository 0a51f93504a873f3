"""Generated atria: sound, of an adult's size, made of the parts their shape names."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.errors import InputError, SurfaceError
from auricle.simulation.anatomy import AtriumShape, Tube
from auricle.simulation.atrium import atrium
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import signed_volume, soundness


def shape_of(seed: int) -> AtriumShape:
    return AtriumShape.random(np.random.default_rng(seed))


@pytest.fixture(scope="module")
def cohort() -> dict[int, tuple[AtriumShape, Mesh]]:
    return {seed: (shape_of(seed), atrium(shape_of(seed), spacing=2.0)) for seed in range(20)}


def winding_number(mesh: Mesh, point) -> float:
    """1 inside a closed outward surface, 0 outside (Van Oosterom and Strackee 1983)."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces] - point, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    across = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a))]
    along = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return float(np.arctan2(across, along).sum() / (2 * np.pi))


def test_every_atrium_is_one_closed_outward_surface_without_handles(cohort):
    for _, mesh in cohort.values():
        report = soundness(mesh)
        assert report.is_closed
        assert report.is_manifold
        assert report.is_oriented
        assert (report.n_pieces, report.genus) == (1, 0)
        assert (report.n_zero_area_faces, report.n_duplicate_vertices) == (0, 0)
        assert signed_volume(mesh) > 0


def test_area_and_volume_are_those_of_adult_left_atria_and_vary(cohort):
    areas = np.array([mesh.area / 100 for _, mesh in cohort.values()])
    volumes = np.array([signed_volume(mesh) / 1000 for _, mesh in cohort.values()])
    assert 100 < areas.min() < areas.max() < 180
    assert 70 < volumes.min() < volumes.max() < 160
    assert np.std(areas) > 5
    assert np.std(volumes) > 5


def test_veins_and_appendage_are_where_the_shape_says_and_hollow(cohort):
    for shape, mesh in cohort.values():
        for tube in (*shape.veins, shape.appendage):
            inside, outside = tube.centre_line(np.array([0.8, 1.0 + 12.0 / tube.length]))
            assert winding_number(mesh, inside) == pytest.approx(1.0, abs=1e-6)
            assert winding_number(mesh, outside) == pytest.approx(0.0, abs=1e-6)


def test_a_vein_is_as_wide_as_the_shape_says():
    shape = shape_of(4)
    mesh = atrium(shape, spacing=1.0)
    for vein in shape.veins:
        middle, after = vein.centre_line(np.array([0.85, 0.86]))
        way = (after - middle) / np.linalg.norm(after - middle)
        offsets = mesh.vertices - middle
        ring = np.abs(offsets @ way) < 0.6
        distance = np.linalg.norm(np.cross(offsets, way), axis=1)[ring]
        near = distance < 2 * vein.radii[0]
        assert near.sum() > 20
        assert np.median(distance[near]) == pytest.approx(
            vein.radius(np.array([0.85]))[0], abs=0.35
        )


def test_the_axes_are_left_posterior_superior(cohort):
    for shape, mesh in cohort.values():
        right_superior, right_inferior, left_superior, left_inferior = shape.ostia
        assert max(right_superior[0], right_inferior[0]) < -10
        assert min(left_superior[0], left_inferior[0]) > 10
        assert (shape.ostia[:, 1] > 0).all()
        assert right_superior[2] > right_inferior[2] + 5
        assert left_superior[2] > left_inferior[2] + 5
        tip = shape.appendage.centre_line(np.array([1.0]))[0]
        assert tip[0] > 5
        assert tip[1] < -15
        assert shape.annulus_normal[0] > 0
        assert shape.annulus_normal[1] < 0
        assert shape.annulus_normal[2] < 0
        assert mesh.vertices[:, 2].min() < 0 < mesh.vertices[:, 2].max()


def test_the_mitral_annulus_is_flat(cohort):
    for shape, mesh in cohort.values():
        normal = np.array(shape.annulus_normal)
        height = mesh.vertices @ normal
        beside = np.linalg.norm(mesh.vertices - height[:, None] * normal, axis=1)
        middle = (beside < 10.0) & (height > 0)
        assert middle.sum() > 50
        np.testing.assert_allclose(height[middle], shape.annulus_depth, atol=1.5)


def test_the_native_mesh_is_fine_enough():
    mesh = atrium(shape_of(0))
    assert 25_000 < mesh.n_vertices < 60_000
    assert soundness(mesh).smallest_quality > 0.1


def test_the_surface_hardly_depends_on_the_grid():
    coarse, fine = (atrium(shape_of(2), spacing=spacing) for spacing in (1.6, 0.8))
    assert coarse.area == pytest.approx(fine.area, rel=0.01)
    assert signed_volume(coarse) == pytest.approx(signed_volume(fine), rel=0.01)


def test_one_seed_gives_one_atrium_to_the_last_bit(cohort):
    again = atrium(shape_of(3), spacing=2.0)
    assert shape_of(3) == cohort[3][0]
    assert again.vertices.tobytes() == cohort[3][1].vertices.tobytes()
    assert again.faces.tobytes() == cohort[3][1].faces.tobytes()


def test_different_seeds_give_different_anatomies(cohort):
    assert len({shape for shape, _ in cohort.values()}) == 20
    assert len({mesh.n_vertices for _, mesh in cohort.values()}) > 15


def test_parts_that_do_not_hang_together_are_refused(cohort):
    shape = cohort[0][0]
    adrift = replace(shape.veins[0], ostium=(-80.0, 0.0, 0.0))
    with pytest.raises(SurfaceError, match="one piece"):
        atrium(replace(shape, veins=(adrift, *shape.veins[1:])), spacing=2.0)


def test_parts_that_close_a_ring_are_refused(cohort):
    shape = cohort[0][0]
    arch = Tube((-15.0, 15.0, 0.0), (0.0, 1.0, 0.0), (30.0, -100.0, 0.0), 100.0, (4.0, 4.0))
    with pytest.raises(SurfaceError, match="handles"):
        atrium(replace(shape, veins=(arch, *shape.veins[1:])), spacing=2.0)


@pytest.mark.parametrize("spacing", [0.1, 5.0, np.nan])
def test_a_grid_too_fine_or_too_coarse_is_refused(spacing):
    with pytest.raises(InputError, match=r"give 0.3 to 3 mm"):
        atrium(shape_of(0), spacing=spacing)
