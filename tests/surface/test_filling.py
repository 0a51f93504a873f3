"""Harmonic filling: exact on linear fields, bounded by its data, and honest about gaps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.surface.capping import cap_holes
from auricle.surface.cleaning import clean
from auricle.surface.field import FieldMap
from auricle.surface.filling import extend_over_caps, fill_unsampled
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, joined, rectangle

PLATE = rectangle(width=10.0, height=8.0, n_x=21, n_y=17)
SPHERE = icosphere(radius=30.0, subdivisions=3)
SEEDS = st.integers(0, 2**32 - 1)


def inside(mesh):
    x, y, _ = mesh.vertices.T
    return (x > 0) & (x < x.max()) & (y > 0) & (y < y.max())


def gapped(values, gap):
    lacking = values.copy()
    lacking[gap] = np.nan
    return lacking


def bowl():
    """The part of a sphere below a plane: open, with one round rim."""
    low = (SPHERE.vertices[SPHERE.faces][:, :, 2] < 20).all(axis=1)
    kept, faces = np.unique(SPHERE.faces[low], return_inverse=True)
    return Mesh(SPHERE.vertices[kept], faces.reshape(-1, 3))


def test_a_linear_field_is_rebuilt_from_its_border():
    values = np.column_stack([PLATE.vertices @ [3.0, -1.0, 0.0] + 1e4, PLATE.vertices[:, 1]])
    filled = fill_unsampled(
        FieldMap(PLATE, gapped(values, inside(PLATE)), "v", "mV"), largest_share=0.95
    )
    np.testing.assert_allclose(filled.values, values, rtol=0, atol=1e-9)
    assert (filled.name, filled.unit) == ("v", "mV")


def test_a_harmonic_function_is_rebuilt_with_second_order():
    errors = []
    for n in (11, 21, 41):
        mesh = rectangle(width=2.0, height=1.0, n_x=2 * n - 1, n_y=n)
        x, y, _ = mesh.vertices.T
        exact = np.exp(x) * np.sin(y)
        field = FieldMap(mesh, gapped(exact, inside(mesh)), "u")
        errors.append(np.abs(fill_unsampled(field, largest_share=1.0).values - exact).max())
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(rates, 2.0, atol=0.2)


@settings(max_examples=20, deadline=None)
@given(SEEDS, st.floats(0.05, 0.45), st.floats(-3, 3), st.floats(-1e3, 1e3))
def test_filled_values_stay_in_range_and_follow_units(seed, share, log_scale, shift):
    rng = np.random.default_rng(seed)
    crumpled = Mesh(SPHERE.vertices * rng.uniform(0.7, 1.3, (SPHERE.n_vertices, 1)), SPHERE.faces)
    values = gapped(rng.normal(size=SPHERE.n_vertices), rng.random(SPHERE.n_vertices) < share)
    filled = fill_unsampled(FieldMap(crumpled, values, "v"), largest_share=0.9).values
    known = np.isfinite(values)
    np.testing.assert_array_equal(filled[known], values[known])
    assert values[known].min() <= filled.min()
    assert filled.max() <= values[known].max()
    scale = 10.0**log_scale
    other = fill_unsampled(FieldMap(crumpled, values * scale + shift, "v"), largest_share=0.9)
    np.testing.assert_allclose(other.values, filled * scale + shift, rtol=1e-9, atol=1e-9 * scale)


def test_one_value_everywhere_is_kept_everywhere():
    values = np.full(SPHERE.n_vertices, 7.0)
    filled = fill_unsampled(FieldMap(SPHERE, gapped(values, slice(0, 100)), "v"))
    np.testing.assert_array_equal(filled.values, values)


def test_a_field_without_gaps_comes_back_as_it_is():
    field = FieldMap(SPHERE, SPHERE.vertices, "position", "mm")
    assert fill_unsampled(field) is field


def test_each_column_keeps_what_it_knows():
    values = SPHERE.vertices.copy()
    values[:40, 0] = np.nan
    values[30:70, 1] = np.nan
    filled = fill_unsampled(FieldMap(SPHERE, values, "v")).values
    np.testing.assert_array_equal(filled[np.isfinite(values)], values[np.isfinite(values)])
    assert np.isfinite(filled).all()


def test_far_from_the_origin_and_at_any_size_the_filling_is_the_same():
    values = gapped(SPHERE.vertices[:, 2], SPHERE.vertices[:, 0] > 5)
    here = fill_unsampled(FieldMap(SPHERE, values, "v")).values
    for scale, shift in ((1.0, 1e6), (1e-6, 0.0), (1e6, 0.0)):
        moved = Mesh(SPHERE.vertices * scale + shift, SPHERE.faces)
        there = fill_unsampled(FieldMap(moved, values, "v")).values
        np.testing.assert_allclose(there, here, rtol=0, atol=1e-6)


def test_the_share_that_lacks_values_is_measured_by_area():
    x = np.concatenate([np.linspace(0, 4, 81), [7.0, 10.0]])
    plate = rectangle(width=10.0, height=2.0, n_x=83, n_y=3)
    vertices = plate.vertices.copy()
    vertices[:, 0] = np.tile(x, 3)
    uneven = Mesh(vertices, plate.faces)
    few_but_large = FieldMap(uneven, gapped(vertices[:, 0], vertices[:, 0] > 4), "lat", "ms")
    with pytest.raises(InputError, match="'lat' lacks values on 45% of the surface, more than 40%"):
        fill_unsampled(few_but_large, largest_share=0.4)
    many_but_small = FieldMap(uneven, gapped(vertices[:, 0], vertices[:, 0] < 3.9), "lat", "ms")
    assert fill_unsampled(many_but_small, largest_share=0.4).sampled.all()


def test_nothing_is_filled_from_nothing():
    with pytest.raises(InputError, match="'lat' has no values"):
        fill_unsampled(FieldMap(SPHERE, np.full(SPHERE.n_vertices, np.nan), "lat"))
    half = SPHERE.vertices[:, :2] * [1.0, np.nan]
    with pytest.raises(InputError, match="'two' has no values"):
        fill_unsampled(FieldMap(SPHERE, half, "two"), largest_share=1.0)


def test_a_piece_without_values_is_refused():
    pair = joined([SPHERE, SPHERE])
    values = gapped(np.ones(pair.n_vertices), slice(SPHERE.n_vertices, None))
    with pytest.raises(InputError, match="no values on a piece of 642 vertices"):
        fill_unsampled(FieldMap(pair, values, "lat"), largest_share=0.6)


def test_over_a_flat_cap_a_linear_field_continues_linearly():
    mesh = bowl()
    vertices = mesh.vertices.copy()
    capped = cap_holes(mesh)
    rim = np.setdiff1d(capped.mesh.faces[~capped.original_faces], np.flatnonzero(~capped.original))
    vertices[rim, 2] = 18.0
    capped = cap_holes(Mesh(vertices, mesh.faces))
    linear = capped.mesh.vertices @ [2.0, -3.0, 0.0] + 50
    field = FieldMap(Mesh(vertices, mesh.faces), linear[capped.original], "v", "ms")
    extended = extend_over_caps(capped, field)
    assert extended.mesh is capped.mesh
    np.testing.assert_array_equal(extended.values[capped.original], linear[capped.original])
    np.testing.assert_allclose(extended.values, linear, rtol=0, atol=1e-8)


def test_gaps_of_the_original_are_filled_with_the_caps():
    mesh = bowl()
    capped = cap_holes(mesh)
    values = gapped(mesh.vertices[:, [0, 2]], slice(0, 60))
    extended = extend_over_caps(capped, FieldMap(mesh, values, "v"))
    assert extended.values.shape == (capped.mesh.n_vertices, 2)
    assert extended.sampled.all()
    with pytest.raises(InputError, match="lacks values on"):
        extend_over_caps(capped, FieldMap(mesh, values, "v"), largest_share=0.01)


def test_a_field_of_another_mesh_cannot_be_extended():
    capped = cap_holes(bowl())
    with pytest.raises(InputError, match="before its holes were closed"):
        extend_over_caps(capped, FieldMap(SPHERE, SPHERE.vertices[:, 0], "v"))


def test_a_real_map_is_filled_within_its_range(real_data):
    cleaned = clean(read_surface(real_data / "maps/openep-dataset2/openep_ds2_lat_bip.vtk"))
    capped = cap_holes(cleaned.mesh)
    lacking = np.random.default_rng(2).random(cleaned.mesh.n_vertices) < 0.1
    for complete in cleaned.fields:
        field = FieldMap(cleaned.mesh, gapped(complete.values, lacking), complete.name)
        filled = fill_unsampled(field)
        extended = extend_over_caps(capped, field)
        lowest, highest = np.nanmin(field.values), np.nanmax(field.values)
        for whole in (filled, extended):
            assert whole.sampled.all()
            assert lowest <= whole.values.min()
            assert whole.values.max() <= highest
