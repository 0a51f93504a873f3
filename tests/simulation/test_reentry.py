"""Re-entry: how often the phase turns, about what, and how fast."""

import numpy as np
import pytest

from auricle.errors import InputError, SurfaceError
from auricle.simulation.anatomy import AtriumShape
from auricle.simulation.atrium import atrium
from auricle.simulation.reentry import macro_reentry, rotor_pair, winding_phase
from auricle.surface.geodesics import exact_geodesic_distances
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, rectangle

SPHERE = icosphere(radius=30.0, subdivisions=4)
POLES = int(SPHERE.vertices[:, 2].argmax()), int(SPHERE.vertices[:, 2].argmin())
LONGITUDE = np.arctan2(SPHERE.vertices[:, 1], SPHERE.vertices[:, 0])
CYCLE = 200.0


def wrapped(angle):
    return (np.asarray(angle) + np.pi) % (2 * np.pi) - np.pi


def turns_by_face(mesh: Mesh, phase) -> np.ndarray:
    """How often the phase turns, counter-clockwise, around each face."""
    corners = phase[mesh.faces]
    return wrapped(np.roll(corners, -1, axis=1) - corners).sum(axis=1) / (2 * np.pi)


@pytest.fixture(scope="module")
def left_atrium() -> Mesh:
    return atrium(AtriumShape.random(np.random.default_rng(1)), spacing=2.5)


def test_between_the_poles_of_a_sphere_the_phase_is_the_longitude():
    offset = wrapped(winding_phase(SPHERE, POLES) - LONGITUDE)
    away = np.abs(SPHERE.vertices[:, 2]) < 25.0
    typical = np.angle(np.exp(1j * offset[away]).mean())
    assert np.abs(wrapped(offset[away] - typical)).max() < 0.1


def test_uneven_triangles_do_not_bend_the_phase():
    """With longitudes crowded together on one side, the phase is still the longitude."""
    crowded = LONGITUDE + 0.5 * np.sin(LONGITUDE)
    radius = np.hypot(SPHERE.vertices[:, 0], SPHERE.vertices[:, 1])
    moved = [radius * np.cos(crowded), radius * np.sin(crowded), SPHERE.vertices[:, 2]]
    phase = winding_phase(Mesh(np.column_stack(moved), SPHERE.faces), POLES)
    offset = wrapped(phase - crowded)[np.abs(SPHERE.vertices[:, 2]) < 25.0]
    typical = np.angle(np.exp(1j * offset).mean())
    assert np.abs(wrapped(offset - typical)).max() < 0.1


def test_the_phase_turns_once_about_each_core_in_opposite_directions(left_atrium):
    cores = (10, 1500)
    turns = turns_by_face(left_atrium, winding_phase(left_atrium, cores))
    singular = np.flatnonzero(np.abs(turns) > 0.5)
    assert sorted(turns[singular].round(9)) == [-1.0, 1.0]
    assert np.abs(np.delete(turns, singular)).max() < 1e-9
    positive, negative = singular[np.argsort(-turns[singular])]
    assert cores[0] in left_atrium.faces[positive]
    assert cores[1] in left_atrium.faces[negative]


def test_exchanging_the_cores_turns_the_front_the_other_way():
    forth, back = winding_phase(SPHERE, POLES), winding_phase(SPHERE, POLES[::-1])
    away = np.abs(SPHERE.vertices[:, 2]) < 25.0
    assert abs(np.exp(1j * (forth + back)[away]).mean()) > 0.99
    assert abs(np.exp(1j * (forth - back)[away]).mean()) < 0.1


def test_the_front_passes_the_equator_of_a_sphere_in_one_cycle():
    times = macro_reentry(SPHERE, cores=POLES, cycle_length=CYCLE).values
    band = np.abs(SPHERE.vertices[:, 2]) < 4.0
    arcs = SPHERE.faces[band[SPHERE.faces].all(axis=1)][:, :2]
    phase_step = np.abs(wrapped(2 * np.pi * np.diff(times[arcs], axis=1)[:, 0] / CYCLE))
    angle_step = np.abs(wrapped(np.diff(LONGITUDE[arcs], axis=1)[:, 0]))
    assert phase_step.sum() == pytest.approx(angle_step.sum(), rel=0.02)


def test_times_lie_within_the_cycle_and_fill_it(left_atrium):
    for field in (
        macro_reentry(left_atrium, cores=(10, 1500), cycle_length=CYCLE),
        rotor_pair(left_atrium, cores=(10, 1500), cycle_length=CYCLE, velocity=0.5),
    ):
        assert field.values.min() >= 0
        assert field.values.max() < CYCLE
        assert np.histogram(field.values, bins=10, range=(0, CYCLE))[0].min() > 0
        assert (field.name, field.unit) == ("local_activation_time", "ms")


def test_far_from_the_cores_a_rotor_pair_moves_at_its_velocity():
    cores = (POLES[0], int(np.argmin(np.linalg.norm(SPHERE.vertices - (8.0, 0, 28.9), axis=1))))
    velocity = 0.3
    times = rotor_pair(SPHERE, cores=cores, cycle_length=CYCLE, velocity=velocity).values
    south = SPHERE.vertices[:, 2] < -5.0
    edges = SPHERE.faces[south[SPHERE.faces].all(axis=1)]
    corners = SPHERE.vertices[edges]
    steps = wrapped(2 * np.pi * (times[edges] - times[edges[:, :1]])[:, 1:] / CYCLE)
    spans = (corners - corners[:, :1])[:, 1:]
    # The gradient in each face solves spans·g = steps; its length is the slowness.
    gradients = (np.linalg.pinv(spans) @ steps[:, :, None])[:, :, 0]
    slowness = np.linalg.norm(gradients, axis=1) * CYCLE / (2 * np.pi)
    assert np.median(slowness) == pytest.approx(1 / velocity, rel=0.05)


def test_nothing_is_activated_inside_an_obstacle():
    field = macro_reentry(SPHERE, cores=POLES, cycle_length=CYCLE, obstacle_radius=8.0)
    distance = np.minimum(*(exact_geodesic_distances(SPHERE, pole) for pole in POLES))
    assert not field.sampled[distance < 7.9].any()
    assert field.sampled[distance > 8.1].all()


def test_what_cannot_turn_is_refused():
    with pytest.raises(InputError, match="two different vertices"):
        winding_phase(SPHERE, (3, 3))
    with pytest.raises(InputError, match="indices count from 0"):
        winding_phase(SPHERE, (3, 9_999))
    neighbour = int(SPHERE.faces[(SPHERE.faces == 3).any(axis=1)][0].max())
    with pytest.raises(InputError, match="neighbours"):
        winding_phase(SPHERE, (3, neighbour))
    with pytest.raises(SurfaceError, match="closed"):
        winding_phase(rectangle(width=5.0, height=5.0, n_x=5, n_y=5), (0, 24))
    with pytest.raises(InputError, match="cycle length"):
        macro_reentry(SPHERE, cores=POLES, cycle_length=0.0)
    with pytest.raises(InputError, match="velocity"):
        rotor_pair(SPHERE, cores=POLES, cycle_length=CYCLE, velocity=-1.0)
    with pytest.raises(InputError, match="radius"):
        macro_reentry(SPHERE, cores=POLES, cycle_length=CYCLE, obstacle_radius=-1.0)
