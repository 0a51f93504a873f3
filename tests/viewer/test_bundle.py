import gzip
from dataclasses import replace

import numpy as np
import pytest

from auricle.surface.distance import vertexwise_rms
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere
from auricle.surface.simplification import simplification_sequence
from auricle.viewer.approximation import COUNTS, mean_distance, point_distances
from auricle.viewer.bundle import BUNDLE_FORMAT, surface_bundle
from auricle.viewer.container import unpacked
from auricle.viewer.open_case import OpenCase


@pytest.fixture(scope="module")
def shipped(ball: OpenCase):
    return unpacked(gzip.decompress(surface_bundle(ball.prepared, name="ball")))


def shape_of(arrays, header, count):
    """The surface as the page rebuilds it: rows of integers times a scale times a coefficient."""
    factors = arrays["mode_scales"][:count, None] * arrays["coefficients_0"][:count]
    return arrays["modes"][:count].astype(float).T @ factors + header["signals"][0]["offset"]


def test_the_surface_the_page_rebuilds_is_that_of_the_harmonics_in_full_precision(ball, shipped):
    header, arrays = shipped
    surface, basis = ball.prepared.surface, ball.prepared.chamber.basis
    centre = np.asarray(header["signals"][0]["offset"])
    exact = basis.inverse(basis.transform(surface.vertices - centre)[:60]) + centre
    assert np.abs(shape_of(arrays, header, 60) - exact).max() < 2e-3


def test_the_error_shipped_is_the_distance_from_vertex_to_vertex(ball, shipped):
    header, arrays = shipped
    surface = ball.prepared.surface
    for count in (4, 20, 120):
        rms = vertexwise_rms(shape_of(arrays, header, count), surface.vertices, arrays["areas"])
        assert arrays["error_0"][count - 1] == pytest.approx(rms, rel=1e-3, abs=1e-3)


def test_the_error_and_the_share_of_power_say_the_same_of_a_closed_surface(shipped):
    header, arrays = shipped
    relative = arrays["error_1"] / header["signals"][1]["spread"]
    np.testing.assert_allclose(relative, np.sqrt(1 - arrays["share_1"]), atol=1e-6)


def test_the_same_case_gives_the_same_bytes(ball):
    first, second = (surface_bundle(ball.prepared, name="ball", n_modes=20) for _ in range(2))
    assert first == second


def test_fewer_harmonics_can_be_sent(ball):
    header, arrays = unpacked(
        gzip.decompress(surface_bundle(ball.prepared, name="ball", n_modes=20))
    )
    assert header["format"] == BUNDLE_FORMAT
    assert arrays["modes"].shape == (20, ball.prepared.surface.n_vertices)
    assert len(arrays["eigenvalues"]) == len(arrays["error_0"]) == 20


def test_a_map_without_a_spectrum_is_shipped_with_the_reason(ball):
    surface = ball.prepared.surface
    flat = FieldMap(surface, np.ones(surface.n_vertices), "flat", "")
    prepared = replace(ball.prepared, fields=(flat, *ball.prepared.fields))
    header, _ = unpacked(gzip.decompress(surface_bundle(prepared, name="ball", n_modes=10)))
    first, second = header["fields"]
    assert (first["signal"], first["fault"]) == (-1, "is constant")
    assert (second["signal"], second["unit"]) == (1, "ms")


def test_distances_are_measured_from_the_surface_to_the_level():
    ball = icosphere(radius=20.0, subdivisions=3)
    sequence = simplification_sequence(ball)
    found = point_distances(sequence, most=150)
    assert [each.count for each in found] == [*(c for c in COUNTS if c < 150), 150]
    assert found[3].gd_mm == mean_distance(ball, sequence.mesh_at(found[3].count))
    assert all(np.diff([each.gd_mm for each in found]) < 0)
