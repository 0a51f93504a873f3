"""Foci placed by position: even over the area, and the same however the mesh is numbered."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.paper.foci import PROFILES, draw_places, foci_at, placed_foci, straight_foci
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import ellipsoid, icosphere, torus


def renumbered(mesh: Mesh, rng: np.random.Generator) -> tuple[Mesh, np.ndarray]:
    """The same surface with its vertices, faces and corners in another order."""
    order = rng.permutation(mesh.n_vertices)
    faces = np.argsort(order)[mesh.faces][rng.permutation(mesh.n_faces)]
    return Mesh(mesh.vertices[order], np.roll(faces, 1, axis=1)), order


def test_renumbering_the_mesh_moves_no_focus(rng: np.random.Generator) -> None:
    mesh = torus(major=20.0, minor=8.0, n_major=40, n_minor=20)
    other, order = renumbered(mesh, rng)
    arguments = {"n_foci": 3, "sigma_mm": 5.0}
    here = placed_foci(mesh, rng=np.random.default_rng(5), **arguments)
    there = placed_foci(other, rng=np.random.default_rng(5), **arguments)
    np.testing.assert_allclose(there, here[order], atol=1e-12)


def test_places_are_even_over_the_area_of_a_torus() -> None:
    # A torus holds more than half of its area on the outside: 1/2 + minor/(π·major).
    mesh = torus(major=20.0, minor=8.0, n_major=40, n_minor=20)
    places = draw_places(mesh, 400, rng=np.random.default_rng(2))
    outside = float((np.hypot(places[:, 0], places[:, 1]) > 20.0).mean())
    expected = 0.5 + 8.0 / (np.pi * 20.0)
    assert outside == pytest.approx(expected, abs=3 * np.sqrt(expected * (1 - expected) / 400))


def test_refining_the_mesh_moves_a_place_by_no_more_than_the_surface() -> None:
    coarse, fine = (ellipsoid(semi_axes=(30.0, 20.0, 25.0), subdivisions=level) for level in (3, 4))
    here, there = (draw_places(mesh, 10, rng=np.random.default_rng(8)) for mesh in (coarse, fine))
    assert np.median(np.linalg.norm(here - there, axis=1)) < 0.8


def test_the_first_places_do_not_depend_on_how_many_follow() -> None:
    sphere = icosphere(radius=10.0, subdivisions=3)
    three = draw_places(sphere, 3, rng=np.random.default_rng(4))
    one = draw_places(sphere, 1, rng=np.random.default_rng(4))
    np.testing.assert_array_equal(one, three[:1])


@pytest.mark.parametrize("profile", PROFILES)
def test_a_map_of_two_foci_is_the_sum_of_both_alone(profile: str) -> None:
    sphere = icosphere(radius=10.0, subdivisions=3)
    places = draw_places(sphere, 2, rng=np.random.default_rng(4))
    foci = foci_at(sphere, places, reach_mm=40.0)
    alone = [
        foci_at(sphere, place[None], reach_mm=40.0).map_of(1, 3.0, profile=profile)
        for place in places
    ]
    np.testing.assert_allclose(foci.map_of(2, 3.0, profile=profile), alone[0] + alone[1])
    assert foci.map_of(1, 3.0, profile=profile).max() == 1.0


def test_marched_distances_make_nearly_the_same_map() -> None:
    sphere = icosphere(radius=10.0, subdivisions=3)
    exact, marched = (
        foci_at(sphere, sphere.vertices[:1], marched=quick).map_of(1, 4.0)
        for quick in (False, True)
    )
    assert 0 < np.abs(exact - marched).max() < 0.02


def test_straight_foci_are_wider_than_those_along_a_curved_surface() -> None:
    sphere = icosphere(radius=10.0, subdivisions=3)
    places = sphere.vertices[:1]
    straight = straight_foci(sphere, places)
    np.testing.assert_allclose(straight.distances_mm.max(), 20.0)  # through the centre
    along = foci_at(sphere, places).map_of(1, 5.0)
    assert (straight.map_of(1, 5.0) >= along - 1e-12).all()


def test_a_profile_or_a_width_that_is_none_is_refused() -> None:
    sphere = icosphere(radius=10.0, subdivisions=2)
    foci = foci_at(sphere, sphere.vertices[:1], reach_mm=5.0)
    with pytest.raises(InputError, match="choose one of"):
        foci.map_of(1, 3.0, profile="square")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="positive"):
        foci.map_of(1, 0.0)
    with pytest.raises(InputError, match="positive"):
        placed_foci(sphere, n_foci=1, sigma_mm=-1.0, rng=np.random.default_rng(1))
    with pytest.raises(InputError, match="draw more places"):
        foci.map_of(2, 3.0)
