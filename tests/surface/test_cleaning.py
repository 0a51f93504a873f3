"""Damaged spheres clean back to the sphere, and every repair is counted."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import SurfaceError
from auricle.surface.cleaning import clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, joined, rectangle
from auricle.surface.soundness import signed_volume
from auricle.surface.soup import TriangleSoup

SPHERE = icosphere(radius=30.0, subdivisions=2)
CRUMB = icosphere(radius=5.0, subdivisions=0)
MIDDLE = 40
SEEDS = st.integers(0, 2**32 - 1)


def soup_of(mesh, **more):
    return TriangleSoup(mesh.vertices, mesh.faces, **more)


def oriented_triangles(mesh):
    """Corner positions of each face from its smallest corner on: a mesh without its numbering."""
    corners = mesh.vertices[mesh.faces].tolist()
    return sorted(min([[a, b, c], [b, c, a], [c, a, b]]) for a, b, c in corners)


def counts(cleaned):
    return {repair.name: repair.count for repair in cleaned.repairs}


def pinched_plate():
    """A plate with two holes that meet in its middle vertex: a bow-tie."""
    plate = rectangle(width=20.0, height=20.0, n_x=9, n_y=9)
    star = np.flatnonzero((plate.faces == MIDDLE).any(axis=1))
    shared = np.isin(plate.faces[star], plate.faces[star[0]]).sum(axis=1)
    opposite = star[np.flatnonzero(shared == 1)[0]]
    return plate, np.delete(plate.faces, [star[0], opposite], axis=0)


def test_a_sound_surface_is_left_alone():
    cleaned = clean(soup_of(SPHERE))
    assert cleaned.repairs == ()
    np.testing.assert_array_equal(cleaned.mesh.vertices, SPHERE.vertices)
    np.testing.assert_array_equal(cleaned.mesh.faces, SPHERE.faces)
    assert cleaned.soundness.is_closed


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.floats(0.0, 1.0))
def test_a_shuffled_turned_soup_of_separate_corners_is_the_sphere_again(seed, share):
    rng = np.random.default_rng(seed)
    faces = SPHERE.faces[rng.permutation(SPHERE.n_faces)]
    turned = rng.random(SPHERE.n_faces) < share
    faces = np.where(turned[:, None], faces[:, ::-1], faces)
    corners = SPHERE.vertices[faces].reshape(-1, 3)
    cleaned = clean(TriangleSoup(corners, np.arange(len(corners)).reshape(-1, 3)))
    assert oriented_triangles(cleaned.mesh) == oriented_triangles(SPHERE)
    expected = {"coincident vertices merged": len(corners) - SPHERE.n_vertices}
    n_turned = int(turned.sum())
    if 0 < n_turned < SPHERE.n_faces:
        expected["faces turned to agree with the others"] = min(n_turned, SPHERE.n_faces - n_turned)
    if 2 * n_turned > SPHERE.n_faces or (2 * n_turned == SPHERE.n_faces and turned[0]):
        expected["faces turned outward"] = SPHERE.n_faces
    assert counts(cleaned) == expected


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.integers(0, 40), st.integers(0, 40), st.integers(0, 20), st.booleans())
def test_each_kind_of_debris_is_counted_exactly(seed, n_copies, n_twice, n_alone, crumb):
    rng = np.random.default_rng(seed)
    mesh = joined([SPHERE, CRUMB]) if crumb else SPHERE
    copies = rng.choice(SPHERE.n_vertices, n_copies, replace=False)
    alone = rng.normal(size=(n_alone, 3)) + 100.0
    twice = rng.permuted(SPHERE.faces[rng.choice(SPHERE.n_faces, n_twice, replace=False)], axis=1)
    collapsed = twice[:, [0, 0, 1]]
    vertices = np.vstack([mesh.vertices, mesh.vertices[copies], alone])
    faces = np.concatenate([mesh.faces, twice, collapsed])
    order = rng.permutation(len(faces))
    cleaned = clean(TriangleSoup(vertices, faces[order]))
    expected = {
        "coincident vertices merged": n_copies,
        "faces with a repeated vertex dropped": n_twice,
        "duplicate faces dropped": n_twice,
        "detached pieces dropped": int(crumb),
        "isolated vertices dropped": n_alone,
    }
    found = counts(cleaned)
    assert found.pop("faces turned to agree with the others", 0) <= n_twice
    assert found == {name: count for name, count in expected.items() if count}
    assert oriented_triangles(cleaned.mesh) == oriented_triangles(SPHERE)


def test_cleaning_twice_changes_nothing_more():
    plate, faces = pinched_plate()
    once = clean(TriangleSoup(plate.vertices, faces))
    again = clean(soup_of(once.mesh))
    # The parted vertices coincide: they are merged and parted anew.
    assert list(counts(again).values()) == [1, 1]
    np.testing.assert_array_equal(again.mesh.vertices, once.mesh.vertices)
    np.testing.assert_array_equal(again.mesh.faces, once.mesh.faces)


def test_minus_zero_is_zero():
    vertices = np.array(
        [[0.0, 0, 0], [30, 0, 0], [0, 30, 0], [-0.0, 0, 0], [0, 30, 0], [-30, 0, 0]]
    )
    cleaned = clean(TriangleSoup(vertices, np.array([[0, 1, 2], [3, 4, 5]])))
    assert counts(cleaned) == {"coincident vertices merged": 2}


def test_sheets_that_touch_in_a_point_are_parted():
    plate, faces = pinched_plate()
    values = np.arange(plate.n_vertices, dtype=float)
    cleaned = clean(TriangleSoup(plate.vertices, faces, point_fields={"number": values}))
    (repair,) = cleaned.repairs
    assert str(repair) == "1 vertices joining sheets in a point split (1 vertices added)"
    assert cleaned.mesh.n_vertices == plate.n_vertices + 1
    assert cleaned.mesh.area == pytest.approx(Mesh(plate.vertices, faces).area, rel=1e-14)
    assert (cleaned.soundness.n_holes, cleaned.soundness.n_nonmanifold_vertices) == (2, 0)
    assert (cleaned.fields[0].values == MIDDLE).sum() == 2


def test_an_open_surface_is_turned_outward_as_if_its_holes_were_closed():
    bowl = Mesh(
        SPHERE.vertices, SPHERE.faces[(SPHERE.vertices[SPHERE.faces][..., 2] < 9).all(axis=1)]
    )
    cleaned = clean(TriangleSoup(bowl.vertices, bowl.faces[:, ::-1]))
    assert counts(cleaned)["faces turned outward"] == bowl.n_faces
    assert signed_volume(cleaned.mesh) == pytest.approx(signed_volume(bowl), rel=1e-12)
    flat = rectangle(width=10.0, height=10.0, n_x=5, n_y=5)
    assert clean(TriangleSoup(flat.vertices, flat.faces[:, ::-1])).repairs == ()


def test_fields_and_tags_stay_with_their_vertices_and_faces():
    rng = np.random.default_rng(4)
    mesh = joined([CRUMB, SPHERE])
    vertices = np.vstack([[[np.nan] * 3], mesh.vertices])
    faces = (mesh.faces + 1)[rng.permutation(mesh.n_faces)]
    soup = TriangleSoup(
        vertices,
        faces,
        point_fields={"position": vertices, "height": np.nan_to_num(vertices[:, 2])},
        face_tags={"first": faces[:, 0], "second": faces[:, 1]},
        units={"height": "mm"},
    )
    cleaned = clean(soup)
    assert counts(cleaned) == {
        "unused vertices without a position dropped": 1,
        "detached pieces dropped": 1,
    }
    position, height = cleaned.fields
    np.testing.assert_array_equal(position.values, cleaned.mesh.vertices)
    np.testing.assert_array_equal(height.values, cleaned.mesh.vertices[:, 2])
    assert (height.name, height.unit, position.unit) == ("height", "mm", "")
    np.testing.assert_array_equal(
        vertices[cleaned.face_tags["first"]], cleaned.mesh.vertices[cleaned.mesh.faces[:, 0]]
    )


def test_a_face_tag_stays_with_a_face_that_is_turned():
    faces = SPHERE.faces.copy()
    faces[5] = faces[5, ::-1]
    cleaned = clean(TriangleSoup(SPHERE.vertices, faces, face_tags={"row": np.arange(len(faces))}))
    assert counts(cleaned) == {"faces turned to agree with the others": 1}
    np.testing.assert_array_equal(cleaned.face_tags["row"], np.arange(len(faces)))


def test_values_that_merged_vertices_disagree_on_are_counted():
    vertices = np.vstack([SPHERE.vertices, SPHERE.vertices[:5]])
    values = np.concatenate([np.zeros(SPHERE.n_vertices), [0, 1, 1, np.nan, 0]])
    values[4] = np.nan
    cleaned = clean(TriangleSoup(vertices, SPHERE.faces, point_fields={"lat": values}))
    (repair,) = cleaned.repairs
    assert repair.count == 5
    assert repair.detail == "'lat' differed at 4, the first value was kept"
    assert np.isnan(cleaned.fields[0].values).sum() == 1


def test_infinite_values_become_unsampled_and_are_counted():
    values = np.zeros(SPHERE.n_vertices)
    values[:3] = [np.inf, -np.inf, np.nan]
    cleaned = clean(soup_of(SPHERE, point_fields={"lat": values}))
    assert counts(cleaned) == {"infinite values of 'lat' marked NaN": 2}
    assert cleaned.fields[0].sampled.sum() == SPHERE.n_vertices - 3


def test_fragments_may_be_as_broken_as_they_like():
    fan = Mesh(
        [[90, 0, 0], [91, 0, 0], [90, 1, 0], [90, -1, 0], [90, 0, 1]],
        [[0, 1, k] for k in (2, 3, 4)],
    )
    cleaned = clean(soup_of(joined([SPHERE, fan])))
    assert counts(cleaned) == {"detached pieces dropped": 1}
    assert "3 faces" in cleaned.repairs[0].detail


def test_a_fragment_that_touches_in_a_point_leaves_the_point():
    crumb = Mesh(CRUMB.vertices - CRUMB.vertices[0] + SPHERE.vertices[9], CRUMB.faces)
    cleaned = clean(soup_of(joined([crumb, SPHERE])))
    assert counts(cleaned) == {"coincident vertices merged": 1, "detached pieces dropped": 1}
    assert oriented_triangles(cleaned.mesh) == oriented_triangles(SPHERE)


def refused(vertices=SPHERE.vertices, faces=SPHERE.faces, **more):
    return TriangleSoup(np.asarray(vertices, dtype=float), np.asarray(faces), **more)


def placed(index, value):
    vertices = SPHERE.vertices.copy()
    vertices[index] = value
    return vertices


MOEBIUS = [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [4, 5, 1], [1, 5, 0]]


@pytest.mark.parametrize(
    ("soup", "cause"),
    [
        (refused(faces=np.zeros((0, 3), dtype=int)), "no triangles"),
        (refused(faces=SPHERE.faces - 1), r"faces name vertices -1…160 where there are 0…161"),
        (refused(faces=SPHERE.faces + 2), "faces name vertices 2…163"),
        (refused(placed([7, 8], np.nan)), "2 vertices of faces are NaN or infinite"),
        (refused(placed(7, np.inf)), "1 vertices of faces are NaN or infinite"),
        (refused(point_fields={"lat": np.zeros(3)}), "'lat' has 3 values on 162 vertices"),
        (refused(face_tags={"tag": np.zeros(3, dtype=int)}), "'tag' has 3 values on 320 faces"),
        (soup_of(joined([SPHERE, icosphere(radius=28.0, subdivisions=2)])), "in 2 pieces"),
        (refused(faces=np.repeat(SPHERE.faces, 3, axis=0)), "640 of 960 faces"),
        (refused(faces=SPHERE.faces[:, [0, 0, 1]]), "320 of 320 faces"),
        (refused(np.random.default_rng(1).normal(size=(6, 3)) * 30, MOEBIUS), "one-sided"),
        (refused(SPHERE.vertices / 1000), "are the units millimetres"),
        (refused(SPHERE.vertices * 1000), "are the units millimetres"),
    ],
)
def test_what_cannot_be_mended_is_refused_in_one_line(soup, cause):
    with pytest.raises(SurfaceError, match=cause) as told:
        clean(soup)
    assert "\n" not in str(told.value)
    assert ": " in str(told.value)


def test_an_edge_with_three_faces_is_refused_and_named():
    edge = SPHERE.faces[0, :2]
    vertices = np.vstack([SPHERE.vertices, [[60.0, 0, 0]]])
    faces = np.vstack([SPHERE.faces, [[*edge, SPHERE.n_vertices]]])
    with pytest.raises(SurfaceError, match=f"1 edges .* {edge.min()} and {edge.max()}"):
        clean(TriangleSoup(vertices, faces))


def test_the_scale_check_can_be_turned_off():
    tiny = soup_of(icosphere(radius=0.01, subdivisions=1))
    assert clean(tiny, check_scale=False).repairs == ()


REPAIRS = {
    "meshes/atlas/CTSSM01_LA_endo.vtk": {"faces turned outward": 24854},
    "meshes/atlas/la_endo1_Labelled.pts": {"faces turned to agree with the others": 1},
    "meshes/lasc2013-b002/gt_std_mesh.vtp": {},
    "meshes/lausm/test.vtk": {},
    "maps/openep-dataset2/openep_ds2_lat_bip.vtk": {
        "detached pieces dropped": 1,
        "vertices joining sheets in a point split": 1,
    },
}


@pytest.mark.parametrize("name", REPAIRS)
def test_real_atria_are_cleaned(real_data, name):
    cleaned = clean(read_surface(real_data / name))
    assert counts(cleaned) == REPAIRS[name]
    assert cleaned.soundness.genus == 0
    assert signed_volume(cleaned.mesh) > 20e3


def test_every_piece_is_kept_on_wish_though_none_dominates() -> None:
    sphere = icosphere(radius=30.0, subdivisions=1)
    pair = joined([sphere, Mesh(sphere.vertices + 100.0, sphere.faces)])
    soup = TriangleSoup(pair.vertices, pair.faces)
    assert clean(soup, keep_pieces=True).soundness.n_pieces == 2
    with pytest.raises(SurfaceError, match="2 pieces"):
        clean(soup)
