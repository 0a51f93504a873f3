"""Collapse sequences: every level is what simplification gives, and files bring it back."""

import time

import numpy as np
import pytest

from auricle.errors import FormatError, InputError, SurfaceError
from auricle.surface.collapse_sequence import CollapseSequence
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, torus
from auricle.surface.simplification import (
    simplification_sequence,
    simplify,
    simplify_with_fields,
)
from auricle.surface.topology import genus

RING = torus(major=20.0, minor=8.0, n_major=40, n_minor=22)
SPHERE = icosphere(radius=30.0, subdivisions=4)
HEIGHT = FieldMap(SPHERE, np.where(SPHERE.vertices[:, 0] > 5, np.nan, SPHERE.vertices[:, 2]), "z")


@pytest.mark.parametrize("n_vertices", [RING.n_vertices - 1, 500, 77, 12])
def test_a_level_is_what_simplification_gives_to_the_last_digit(n_vertices):
    level, alone = simplification_sequence(RING).mesh_at(n_vertices), simplify(RING, n_vertices)
    assert np.array_equal(level.vertices, alone.vertices)
    assert np.array_equal(level.faces, alone.faces)


def test_fields_of_a_level_are_what_simplification_gives():
    sequence = simplification_sequence(SPHERE, fields=[HEIGHT], weight=2.0)
    mesh, (field,) = simplify_with_fields(SPHERE, [HEIGHT], 300, weight=2.0)
    (level,) = sequence.fields_at(300)
    assert np.array_equal(level.values, field.values, equal_nan=True)
    assert np.array_equal(level.mesh.vertices, mesh.vertices)


def test_the_full_surface_is_the_first_level():
    sequence = simplification_sequence(SPHERE, fields=[HEIGHT])
    assert sequence.mesh_at(SPHERE.n_vertices) is SPHERE
    assert sequence.fields_at(10**6) == (HEIGHT,)
    assert sequence.error_at(SPHERE.n_vertices) == 0.0


def test_vertices_that_no_collapse_touched_stay_where_they_were():
    level = simplification_sequence(RING).mesh_at(RING.n_vertices - 1)
    before, after = ({tuple(v) for v in mesh.vertices} for mesh in (RING, level))
    assert len(before & after) >= RING.n_vertices - 2


def test_the_coarsest_torus_is_near_the_smallest_there_is():
    """No torus has fewer than seven vertices."""
    sequence = simplification_sequence(RING)
    assert 7 <= sequence.n_least <= 12
    assert genus(sequence.mesh_at(sequence.n_least).faces) == 1
    with pytest.raises(SurfaceError, match=f"ask for {sequence.n_least} or more"):
        sequence.mesh_at(sequence.n_least - 1)


def test_errors_rise_from_nothing_and_tell_the_distance_within_a_factor():
    sequence = simplification_sequence(RING)
    assert sequence.errors[0] == 0.0
    assert (np.diff(sequence.errors) > -1e-9).all()
    for n_vertices in (600, 300, 100):
        ratio = sequence.error_at(n_vertices) / sequence.distance_at(n_vertices).rms
        assert 1.0 < ratio < 4.0


def test_the_error_is_a_length():
    larger = simplification_sequence(Mesh(8.0 * RING.vertices, RING.faces))
    assert larger.error_at(200) == pytest.approx(
        8.0 * simplification_sequence(RING).error_at(200), rel=1e-12
    )


def test_a_level_of_ten_thousand_vertices_comes_at_once():
    sequence = simplification_sequence(icosphere(radius=30.0, subdivisions=6))
    sequence.mesh_at(10_000)
    started = time.process_time()
    for _ in range(5):
        sequence.mesh_at(10_000)
    assert (time.process_time() - started) / 5 < 0.05


def test_a_file_brings_every_level_back(tmp_path):
    sequence = simplification_sequence(SPHERE, fields=[HEIGHT], weight=3.0)
    sequence.save(tmp_path / "levels.npz")
    read = CollapseSequence.load(tmp_path / "levels.npz")
    assert read.n_least == sequence.n_least
    for n_vertices in (2000, 100, 4):
        one, other = sequence.fields_at(n_vertices)[0], read.fields_at(n_vertices)[0]
        assert np.array_equal(one.values, other.values, equal_nan=True)
        assert np.array_equal(one.mesh.vertices, other.mesh.vertices)
        assert np.array_equal(one.mesh.faces, other.mesh.faces)
        assert (other.name, other.unit) == ("z", "")


def test_a_collapse_takes_few_bytes(tmp_path):
    simplification_sequence(SPHERE).save(tmp_path / "levels.npz")
    assert (tmp_path / "levels.npz").stat().st_size < 100 * SPHERE.n_vertices


def test_other_files_are_refused(tmp_path):
    text, arrays = tmp_path / "text.npz", tmp_path / "arrays.npz"
    text.write_text("levels")
    np.savez(arrays, kept=np.arange(3))
    for path in (text, arrays):
        with pytest.raises(FormatError, match="not a collapse sequence"):
            CollapseSequence.load(path)
    with pytest.raises(InputError, match="cannot be read"):
        CollapseSequence.load(tmp_path / "none.npz")


def test_fewer_than_four_vertices_have_no_level():
    with pytest.raises(InputError, match="give 4 or more"):
        simplification_sequence(SPHERE).mesh_at(3)
