"""The truth of a phantom: a distance that is a distance, round hearts that differ."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.simulation.ct_atrium import STUB, patient_atrium, stub_end
from auricle.simulation.phantom_truth import Truth, truth_surface
from auricle.surface.distance import point_to_surface
from auricle.surface.soundness import signed_volume, soundness

OFFSET = np.array([4.0, -160.0, -640.0])


def truth_of(seed: int, **options) -> Truth:
    return Truth(patient_atrium(np.random.default_rng(seed), **options), OFFSET)


@pytest.fixture(scope="module")
def truth() -> Truth:
    return truth_of(3)


@pytest.fixture(scope="module")
def surface(truth):
    return truth_surface(truth, spacing=0.8)


@pytest.fixture(scope="module")
def beside(surface):
    """Places within some millimetres of the endocardium."""
    rng = np.random.default_rng(0)
    chosen = surface.vertices[rng.integers(surface.n_vertices, size=1500)]
    return chosen + rng.normal(0.0, 0.8, chosen.shape)


@pytest.fixture(scope="module")
def cohort():
    return [truth_of(seed) for seed in range(24)]


def test_the_distance_is_that_to_the_surface(truth, surface, beside):
    found = truth.distance(beside)
    exact = point_to_surface(beside, surface)
    near = exact < 2.0
    assert near.sum() > 1000
    off = np.abs(np.abs(found[near]) - exact[near])
    assert np.median(off) < 0.01
    assert np.percentile(off, 95) < 0.06


def test_the_distance_falls_by_one_a_millimetre(truth, beside):
    step = 1e-3
    slope = np.column_stack(
        [
            (truth.distance(beside + step * way) - truth.distance(beside - step * way)) / (2 * step)
            for way in np.eye(3)
        ]
    )
    steepness = np.linalg.norm(slope, axis=1)
    # But for the rims of the cut veins and creases, where no one direction is nearest.
    assert (np.abs(steepness - 1.0) < 0.1).mean() > 0.98


def test_the_vertices_of_the_true_surface_are_at_distance_zero(truth, surface):
    distance = np.abs(truth.distance(surface.vertices))
    assert np.percentile(distance, 95) < 0.05
    assert distance.max() < 0.6


def test_inside_is_negative_and_outside_positive(truth):
    atrium = truth.atrium
    assert truth.distance(truth.seed[None])[0] < -12
    for vein in atrium.veins:
        end, way = stub_end(vein)
        within, beyond = truth.distance(np.array([end - 3 * way, end + 3 * way]) + OFFSET)
        assert within < -1.5
        assert beyond == pytest.approx(3.0, abs=0.1)
    across = truth.mitral_centre + np.array([[-4.0], [4.0]]) * truth.mitral_normal
    np.testing.assert_allclose(truth.distance(across), [-4.0, 4.0], atol=0.5)


def test_a_stub_is_twelve_millimetres_of_centre_line(truth):
    for vein in truth.atrium.veins:
        end, way = stub_end(vein)
        line = vein.centre_line(np.linspace(0.0, 1.0, 2001))
        before = line[(line - end) @ way < 0]
        assert np.linalg.norm(np.diff(before, axis=0), axis=1).sum() == pytest.approx(
            STUB, abs=0.05
        )


def test_landmarks_are_left_posterior_superior(cohort):
    for truth in cohort:
        ostia = truth.ostia - truth.seed
        assert (ostia[:2, 0] < -10).all()
        assert (ostia[2:, 0] > 10).all()
        assert (truth.mitral_normal * (1, -1, -1) > 0.2).all()
        tip = truth.appendage_tip - truth.seed
        assert tip[0] > 5
        assert tip[1] < -14
        assert (truth.distance(truth.ostia) < 0).all()


def test_patients_differ_as_patients_do(cohort):
    volumes = [signed_volume(truth_surface(truth, spacing=3.0)) / 1000 for truth in cohort]
    assert 55 < min(volumes) < 75
    assert 130 < max(volumes) < 175
    assert np.std(volumes) > 15
    assert len({round(volume, 3) for volume in volumes}) == len(cohort)


@pytest.mark.parametrize("veins", ["four", "common_left", "fifth"])
def test_every_variant_is_one_closed_surface_without_handles(veins):
    counts = {"four": 4, "common_left": 3, "fifth": 5}
    for seed in range(3):
        truth = truth_of(seed, veins=veins)
        report = soundness(truth_surface(truth, spacing=2.0))
        assert report.is_closed
        assert report.is_manifold
        assert (report.n_pieces, report.genus) == (1, 0)
        assert len(truth.ostia) == counts[veins]


def test_the_annulus_grows_with_the_atrium():
    small, large = truth_of(2, scale=0.8), truth_of(2, scale=1.25)
    assert large.mitral_radius / small.mitral_radius == pytest.approx(1.25 / 0.8)
    ratio = np.cbrt(
        signed_volume(truth_surface(large, spacing=2.0))
        / signed_volume(truth_surface(small, spacing=2.0))
    )
    # Not quite so much as the rest: stubs are 12 mm long and seams rounded in every patient.
    assert ratio == pytest.approx(1.25 / 0.8, rel=0.03)


def test_a_common_trunk_carries_what_two_veins_carried():
    four, trunk = truth_of(5).atrium.veins, truth_of(5, veins="common_left").atrium.veins
    assert trunk[:2] == four[:2]
    assert trunk[2].radii[0] ** 2 == pytest.approx(four[2].radii[0] ** 2 + four[3].radii[0] ** 2)


def test_a_fifth_vein_stands_apart_from_its_neighbours():
    for seed in range(6):
        truth = truth_of(seed, veins="fifth")
        middle = truth.atrium.veins[1]
        others = (truth.atrium.veins[0], *truth.atrium.veins[2:])
        end, _ = stub_end(middle)
        without = Truth(replace(truth.atrium, veins=others), OFFSET)
        assert without.distance(end[None] + OFFSET)[0] > middle.radii[2] + 1.0
        assert middle.radii[0] < 0.5 * min(vein.radii[0] for vein in others) + 0.8
