"""Samples of modes: Parseval where it must hold and where it must not, and totals from probes."""

import numpy as np
import pytest

from auricle.study.paper import mode_sample
from auricle.study.paper.mode_sample import ModeSample, sampled_modes
from auricle.study.paper.operators import Operator, operator_of
from auricle.study.paper.transforms import TRANSFORMS, Transform
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import ellipsoid


@pytest.fixture(scope="module")
def uneven() -> Mesh:
    """A closed surface of 642 vertices whose cells differ."""
    smooth = ellipsoid(semi_axes=(10.0, 16.0, 24.0), subdivisions=3)
    jitter = np.random.default_rng(1).normal(scale=0.3, size=smooth.vertices.shape)
    return Mesh(smooth.vertices + jitter, smooth.faces)


@pytest.fixture(scope="module")
def operators(uneven: Mesh) -> dict[str, Operator]:
    return {each.matrix: operator_of(uneven, each.matrix, "third") for each in TRANSFORMS}


@pytest.fixture(scope="module")
def all_modes(operators: dict[str, Operator]) -> dict[str, ModeSample]:
    return {
        name: sampled_modes(operator, n_lowest=100, n_probes=6)
        for name, operator in operators.items()
    }


@pytest.mark.parametrize("transform", TRANSFORMS, ids=str)
def test_squared_coefficients_of_all_modes_add_up_to_what_was_projected(
    transform: Transform,
    uneven: Mesh,
    operators: dict[str, Operator],
    all_modes: dict[str, ModeSample],
) -> None:
    given = transform.weighted(uneven.vertices, operators[transform.matrix].areas)
    coefficients = all_modes[transform.matrix].rows @ given
    assert (coefficients**2).sum() == pytest.approx((given**2).sum(), rel=1e-12)


@pytest.mark.parametrize("transform", TRANSFORMS, ids=str)
def test_they_add_up_to_the_area_integral_for_the_area_weighted_reading_alone(
    transform: Transform,
    uneven: Mesh,
    operators: dict[str, Operator],
    all_modes: dict[str, ModeSample],
) -> None:
    areas = operators[transform.matrix].areas
    scaled = areas / areas.mean()  # the best case for the others: areas around 1
    coefficients = all_modes[transform.matrix].rows @ transform.weighted(uneven.vertices, scaled)
    integral = (scaled[:, None] * uneven.vertices**2).sum()
    is_sound = (transform.operator, transform.projection) == ("area_weighted", "weighted")
    assert np.isclose((coefficients**2).sum(), integral, rtol=1e-9) == is_sound


@pytest.mark.parametrize("transform", TRANSFORMS, ids=str)
def test_a_constant_has_one_coefficient_exactly_where_the_transform_says_so(
    transform: Transform,
    operators: dict[str, Operator],
    all_modes: dict[str, ModeSample],
) -> None:
    areas = operators[transform.matrix].areas
    given = transform.weighted(np.ones((len(areas), 1)), areas)
    others = np.abs(all_modes[transform.matrix].rows @ given)[1:]
    assert (others.max() < 1e-9 * np.linalg.norm(given)) == transform.has_constant_mode


def test_a_map_of_one_mode_has_all_its_energy_and_amplitude_there(
    all_modes: dict[str, ModeSample],
) -> None:
    sample = all_modes["as_printed"]
    power = (sample.rows @ (3.0 * sample.rows[7])) ** 2
    assert power[7] == pytest.approx(9.0)
    assert power.sum() == pytest.approx(9.0)
    assert sample.curve(np.sqrt(power)).sum() == pytest.approx(3.0, rel=1e-9)


def test_probes_stand_for_the_modes_between_them(
    uneven: Mesh,
    operators: dict[str, Operator],
    all_modes: dict[str, ModeSample],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name = "as_printed"
    monkeypatch.setattr(mode_sample, "SMALL", 100)
    sample = sampled_modes(operators[name], n_lowest=100, n_probes=5)
    assert "100 eigenvalues counted" in sample.evidence
    assert sample.n_modes == uneven.n_vertices
    assert len(sample.rows) < 0.95 * uneven.n_vertices
    matrix = operators[name].matrix
    exact_values = np.linalg.eigvalsh(matrix.toarray())
    for probe in sample.probes:
        rows = sample.rows[probe.first : probe.last]
        heights = np.einsum("kn,kn->k", rows, (matrix @ rows.T).T)
        places = np.abs(exact_values - heights[:, None]).argmin(axis=1)
        assert probe.place == pytest.approx(places.mean(), abs=5)
    centred = uneven.vertices - uneven.vertices.mean(axis=0)
    amplitude, exact = (
        each.curve(np.linalg.norm(each.rows @ centred, axis=1))
        for each in (sample, all_modes[name])
    )
    assert amplitude.sum() == pytest.approx(exact.sum(), rel=0.04)
    shares, exact_shares = (np.cumsum(each) / each.sum() for each in (amplitude, exact))
    assert np.abs(shares - exact_shares).max() < 0.04


def test_the_energy_of_a_sample_is_scaled_to_the_exact_total() -> None:
    rows = np.eye(10)[:6]
    sample = ModeSample(rows, 4, (mode_sample.Probe(7.0, 4, 6),), "")
    power = np.array([8.0, 4.0, 2.0, 1.0, 0.5, 0.5])
    curve, balance = sample.energy_curve(power, 18.0)
    assert curve[:4].tolist() == [8.0, 4.0, 2.0, 1.0]
    assert curve.sum() == pytest.approx(18.0)
    assert balance == pytest.approx(sample.curve(power).sum() / 18.0)
    assert balance != pytest.approx(1.0)
