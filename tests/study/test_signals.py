"""Measured errors against the promise of the spectrum."""

import numpy as np
import pytest

from auricle.spectral.harmonics import manifold_harmonics
from auricle.study.signals import analyzed_signal, measured_nrmse
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere

SPHERE = icosphere(radius=30.0, subdivisions=3)
BASIS = manifold_harmonics(SPHERE, 64)
MAP = np.exp(-((SPHERE.vertices[:, 0] - 30) ** 2) / 600) + 5.0


def test_everywhere_known_the_error_is_the_root_of_the_missing_share() -> None:
    everywhere = np.ones(SPHERE.n_vertices, dtype=bool)
    measured = measured_nrmse(BASIS, MAP, everywhere)
    promised = np.sqrt(1 - BASIS.power_spectrum(MAP).cumulative())
    np.testing.assert_allclose(measured, promised, atol=1e-7)


def test_an_offset_and_a_factor_leave_the_relative_error_alone() -> None:
    everywhere = np.ones(SPHERE.n_vertices, dtype=bool)
    np.testing.assert_allclose(
        measured_nrmse(BASIS, 3 * MAP - 70, everywhere)[1:],
        measured_nrmse(BASIS, MAP, everywhere)[1:],
        rtol=1e-6,
    )


def test_only_known_vertices_count_for_the_error_and_the_unsampled_share() -> None:
    known = SPHERE.vertices[:, 0] < 10
    field = FieldMap(SPHERE, np.where(known, MAP, np.nan), "map")
    filled = np.where(known, MAP, 5.0)
    signal = analyzed_signal(BASIS, field=field, on_shell=filled, kind="field", title="map")
    assert signal.unsampled_share == pytest.approx(1 / 3, abs=0.03)
    np.testing.assert_allclose(signal.nrmse, measured_nrmse(BASIS, filled, known))


def test_everywhere_known_a_count_for_an_error_is_the_count_for_its_share() -> None:
    field = FieldMap(SPHERE, MAP, "map")
    signal = analyzed_signal(BASIS, field=field, on_shell=MAP, kind="field", title="map")
    for promised, measured in zip(signal.criteria[:4], signal.for_error, strict=True):
        assert promised.nrmse == measured.nrmse
        assert promised.need == measured.need


def test_a_map_rougher_where_it_is_known_takes_more_for_an_error_than_its_spectrum_says() -> None:
    x = SPHERE.vertices[:, 0]
    known = x < -10
    rough = np.where(known, np.sin(SPHERE.vertices[:, 2] / 3), 0.0) + 3 * np.exp(x / 10)
    field = FieldMap(SPHERE, np.where(known, rough, np.nan), "map")
    signal = analyzed_signal(BASIS, field=field, on_shell=rough, kind="field", title="map")
    assert signal.criteria[1].need.n_modes < 20
    assert signal.for_error[1].need is None
