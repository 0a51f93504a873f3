"""Holes closed by discs: topology, flat lids, sizes, and what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from auricle.errors import SurfaceError
from auricle.surface.capping import cap_holes
from auricle.surface.cleaning import clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, joined, rectangle, torus
from auricle.surface.soundness import soundness, triangle_quality

SPHERE = icosphere(radius=10.0, subdivisions=3)
SEEDS = st.integers(0, 2**32 - 1)


def tube(*, radius, n_around, n_along):
    """Open cylinder about z of nearly equilateral triangles, outward."""
    step = 2 * radius * np.sin(np.pi / n_around)
    row, column = np.divmod(np.arange(n_around * (n_along + 1)), n_around)
    angle = 2 * np.pi * (column + row / 2) / n_around
    height = row * step * np.sqrt(3) / 2
    vertices = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
    below = np.arange(n_around * n_along)
    beside = below - below % n_around + (below + 1) % n_around
    faces = [
        np.column_stack([below, beside, below + n_around]),
        np.column_stack([beside, beside + n_around, below + n_around]),
    ]
    return Mesh(vertices, np.concatenate(faces))


def opened(mesh, n_faces):
    """The mesh without its first `n_faces` faces that are joined at its first vertex."""
    order = np.argsort(~(mesh.faces == 0).any(axis=1), kind="stable")
    first = order[0]
    shared = np.isin(mesh.faces, mesh.faces[first]).sum(axis=1)
    nearest = np.argsort(-shared, kind="stable")[:n_faces]
    return Mesh(mesh.vertices, np.delete(mesh.faces, nearest, axis=0))


def polygon_area(n, radius):
    return 0.5 * n * radius**2 * np.sin(2 * np.pi / n)


@pytest.mark.parametrize("n_around", [3, 4, 5, 6, 13, 40, 200])
def test_flat_lids_have_the_area_of_their_polygon(n_around):
    mesh = tube(radius=5.0, n_around=n_around, n_along=8)
    capped = cap_holes(mesh, largest_share=1.0)
    lid = polygon_area(n_around, 5.0)
    assert capped.cap_areas == pytest.approx((lid, lid), rel=1e-9)
    around = 2 * n_around * 5.0 * np.sin(np.pi / n_around)
    assert capped.hole_perimeters == pytest.approx((around, around), rel=1e-12)
    found = soundness(capped.mesh)
    assert found.is_closed
    assert found.is_manifold
    assert found.genus == 0
    assert found.volume_mm3 > 0
    height, ends = capped.mesh.vertices[~capped.original][:, 2], mesh.vertices[[0, -1], 2]
    np.testing.assert_allclose(np.abs(height[:, None] - ends).min(axis=1), 0.0, atol=1e-9)


def test_the_original_comes_first_and_unchanged():
    mesh = tube(radius=5.0, n_around=24, n_along=30)
    capped = cap_holes(mesh)
    np.testing.assert_array_equal(capped.mesh.vertices[capped.original], mesh.vertices)
    np.testing.assert_array_equal(capped.mesh.faces[capped.original_faces], mesh.faces)
    caps = capped.mesh.faces[~capped.original_faces]
    assert capped.mesh.face_areas[~capped.original_faces].sum() == pytest.approx(
        sum(capped.cap_areas), rel=1e-12
    )
    assert set(np.unique(caps)) >= set(range(mesh.n_vertices, capped.mesh.n_vertices))


def test_triangles_of_a_lid_are_as_large_as_those_around_it_and_as_good():
    mesh = tube(radius=5.0, n_around=60, n_along=40)
    capped = cap_holes(mesh)
    made_up = ~capped.original_faces
    areas = capped.mesh.face_areas[made_up] / mesh.face_areas.mean()
    assert 0.8 < areas.mean() < 1.25
    assert triangle_quality(capped.mesh)[made_up].min() > 0.8


def test_inside_a_fine_rim_triangles_grow_to_the_size_of_the_surface():
    fine = tube(radius=5.0, n_around=120, n_along=60)
    long = Mesh(fine.vertices * np.array([1.0, 1.0, 30.0]), fine.faces)
    same, grown = cap_holes(fine), cap_holes(long)
    n_same, n_grown = (capped.mesh.n_vertices - fine.n_vertices for capped in (same, grown))
    assert n_grown < n_same / 3
    assert sum(grown.cap_areas) == pytest.approx(sum(same.cap_areas), rel=1e-9)
    assert triangle_quality(grown.mesh)[~grown.original_faces].min() > 0.3


@pytest.mark.parametrize("n_faces", [1, 2])
@pytest.mark.parametrize("mesh", [SPHERE, torus(major=20.0, minor=6.0, n_major=18, n_minor=10)])
def test_a_hole_of_one_or_two_faces_is_closed_and_handles_stay(mesh, n_faces):
    torn = opened(mesh, n_faces)
    capped = cap_holes(torn)
    assert soundness(torn).n_holes == 1
    assert soundness(capped.mesh).genus == soundness(mesh).genus
    assert capped.mesh.n_vertices == mesh.n_vertices + 1
    assert capped.mesh.area == pytest.approx(mesh.area, rel=2e-3)


def test_half_a_sphere_gets_a_third_of_its_area():
    south = (SPHERE.vertices[SPHERE.faces][:, :, 2] <= 1e-9).all(axis=1)
    kept, faces = np.unique(SPHERE.faces[south], return_inverse=True)
    capped = cap_holes(Mesh(SPHERE.vertices[kept], faces.reshape(-1, 3)))
    # The icosphere's equator is no row of edges: the rim wavers about it.
    assert sum(capped.cap_areas) / capped.mesh.area == pytest.approx(1 / 3, abs=0.03)


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.integers(3, 60), st.floats(0.0, 2.0), st.floats(0.0, 0.5))
def test_any_rim_is_closed_within_its_hull(seed, n_around, unevenness, waviness):
    rng = np.random.default_rng(seed)
    mesh = tube(radius=5.0, n_around=n_around, n_along=8)
    steps = np.exp(unevenness * rng.normal(size=n_around))
    angle = 2 * np.pi * np.cumsum(steps) / steps.sum()
    radius = 5.0 * np.exp(waviness * rng.normal(size=n_around))
    vertices = mesh.vertices.copy()
    top = slice(mesh.n_vertices - n_around, None)
    vertices[top, :2] = (radius * [np.cos(angle), np.sin(angle)]).T
    vertices[top, 2] += waviness * rng.normal(size=n_around) * 5
    turn = Rotation.random(rng=rng).as_matrix()
    capped = cap_holes(Mesh(vertices @ turn.T, mesh.faces), largest_share=1.0)
    found = soundness(capped.mesh)
    assert (found.is_closed, found.is_manifold, found.genus) == (True, True, 0)
    new = capped.mesh.vertices[~capped.original] @ turn
    above = new[new[:, 2] > vertices[mesh.n_vertices // 2, 2]]
    assert (above <= vertices[top].max(axis=0) + 1e-9).all()
    assert (above >= vertices[top].min(axis=0) - 1e-9).all()


def cone_over(rim):
    """Open cone from a rim in the plane z = 0 to a tip far above it."""
    low = np.arange(len(rim))
    faces = np.column_stack([low, np.roll(low, -1), np.full(len(rim), len(rim))])
    return Mesh(np.vstack([np.column_stack([rim, np.zeros(len(rim))]), [[0, 0, 30.0]]]), faces)


@pytest.mark.parametrize("bulge", [1e-3, 0.0])
def test_a_rim_may_fold_back_along_one_long_step(bulge):
    back = np.linspace(5.0, -5.0, 20)
    capped = cap_holes(cone_over(np.column_stack([back, bulge * (25 - back**2)])))
    assert soundness(capped.mesh).is_closed
    assert capped.cap_areas[0] == pytest.approx(bulge * 500 / 3, rel=0.01)


def test_vertices_of_a_rim_may_all_but_coincide():
    angle = np.sort(np.concatenate([np.linspace(0, 6, 20), np.linspace(1, 1 + 1e-12, 6)]))
    capped = cap_holes(cone_over(5 * np.column_stack([np.cos(angle), np.sin(angle)])))
    assert soundness(capped.mesh).is_closed


def test_a_very_long_rim_is_coarse_inside_rather_than_enormous(monkeypatch):
    mesh = tube(radius=5.0, n_around=300, n_along=4)
    monkeypatch.setattr("auricle.surface.capping.MOST_RINGS", 12)
    capped = cap_holes(mesh, largest_share=1.0)
    assert soundness(capped.mesh).is_closed
    # The full hexagonal lattice on 300 steps has 8400 points.
    assert capped.mesh.n_vertices - mesh.n_vertices < 2 * 2100


def test_a_closed_surface_comes_back_as_it_is():
    capped = cap_holes(SPHERE)
    assert capped.mesh is SPHERE
    assert capped.cap_areas == capped.hole_perimeters == ()
    assert capped.original.all()
    assert capped.original_faces.all()


def test_a_flat_sheet_is_refused():
    with pytest.raises(SurfaceError, match="make up 50% of the surface, more than 40%"):
        cap_holes(rectangle(width=9.0, height=5.0, n_x=10, n_y=6))


def test_unsound_surfaces_are_refused():
    pinched = Mesh(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]], [[0, 1, 2], [0, 3, 4]]
    )
    with pytest.raises(SurfaceError, match="1 vertices join sheets in a point"):
        cap_holes(pinched)
    with pytest.raises(SurfaceError, match="2 pieces"):
        cap_holes(joined([SPHERE, tube(radius=5.0, n_around=9, n_along=9)]))


@pytest.mark.parametrize(
    ("name", "n_holes"),
    [
        ("meshes/atlas/CTSSM01_LA_endo.vtk", 6),
        ("maps/openep-dataset2/openep_ds2_lat_bip.vtk", 7),
    ],
)
def test_real_atria_are_closed(real_data, name, n_holes):
    mesh = clean(read_surface(real_data / name)).mesh
    capped = cap_holes(mesh)
    found = soundness(capped.mesh)
    assert len(capped.cap_areas) == n_holes
    assert found.is_closed
    assert found.is_manifold
    assert found.genus == 0
    assert 0.05 < sum(capped.cap_areas) / capped.mesh.area < 0.2
    assert capped.mesh.n_vertices < 1.4 * mesh.n_vertices
