"""The next point: best by the expected error, where one may go, at what way."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.live import Session
from auricle.sampling.next_point import NextPoint, Travel
from auricle.sampling.reconstruction import Hyperparameters

KNOWN = Hyperparameters(length=20.0, amplitude=30.0, noise=2.0)


def clustered(chamber: Chamber) -> Session:
    """Fifteen samples, all on the side of negative x."""
    session = Session(chamber, hyperparameters=KNOWN)
    vertices = chamber.mesh.vertices
    side = np.flatnonzero((vertices[:, 0] < -15) & chamber.accessible)
    for vertex in np.random.default_rng(6).choice(side, 15, replace=False):
        session.add(vertices[vertex], float(vertices[vertex, 1]))
    return session


def test_the_next_point_lies_where_none_is_yet_and_keeps_its_promise(
    open_chamber: Chamber,
) -> None:
    session = clustered(open_chamber)
    point = session.next_point()
    assert point.position[0] > 0
    assert open_chamber.accessible[point.vertex]
    before = session.running.mean_square_error
    session.add(point.position, float(session.mean[point.vertex]))
    drop = before - session.running.mean_square_error
    assert drop == pytest.approx(point.expected_drop, rel=1e-8)
    # The map does not change for a value that it predicts, so neither does its own deviation.
    assert session.running.predicted_nrmse == pytest.approx(point.predicted_nrmse, rel=0.1)


def test_no_other_vertex_would_do_better(open_chamber: Chamber) -> None:
    session = clustered(open_chamber)
    drops = session.running.expected_drop(KNOWN.noise**2)
    best = session.next_point()
    assert best.expected_drop == drops[open_chamber.accessible].max()


def test_only_what_is_allowed_and_accessible_is_proposed(open_chamber: Chamber) -> None:
    session = clustered(open_chamber)
    below = open_chamber.mesh.vertices[:, 2] < -25
    assert below[session.next_point(allowed=below).vertex]
    with pytest.raises(InputError, match="no vertex is both allowed and accessible"):
        session.next_point(allowed=~open_chamber.accessible)


def test_travel_makes_near_points_more_attractive(open_chamber: Chamber) -> None:
    session = clustered(open_chamber)
    start = np.array([0.0, 0.0, -30.0])
    ways = []
    points: list[NextPoint] = []
    for reach in (np.inf, 20.0, 1e-3):
        points.append(session.next_point(travel=Travel(start, reach)))
        ways.append(points[-1].travel_mm)
    assert points[0].vertex == session.next_point().vertex
    assert ways[0] > ways[1] >= ways[2]
    assert ways[2] < 10.0
    assert ways[0] == pytest.approx(np.linalg.norm(points[0].position - start))


def test_several_points_are_those_that_come_one_after_the_other(open_chamber: Chamber) -> None:
    session = clustered(open_chamber)
    planned = session.next_points(4)
    assert [point.vertex for point in session.next_points(3)] == [
        point.vertex for point in planned[:3]
    ]
    for point in planned:
        assert session.next_point().vertex == point.vertex
        session.add(point.position, -20.0)  # whatever the value
    drops = [point.expected_drop for point in planned]
    assert drops == sorted(drops, reverse=True)
    positions = np.array([point.position for point in planned])
    apart = np.linalg.norm(positions[:, None] - positions[None], axis=2)[np.triu_indices(4, 1)]
    assert apart.min() > 15.0


def test_before_the_first_sample_there_is_a_first_point(open_chamber: Chamber) -> None:
    point = Session(open_chamber).next_point()
    assert open_chamber.accessible[point.vertex]
    assert 0 < point.predicted_nrmse < 1


@pytest.mark.parametrize(("start", "reach"), [([0.0, 0.0], 1.0), ([0.0, 0.0, np.nan], 1.0)])
def test_travel_starts_somewhere(start: list[float], reach: float) -> None:
    with pytest.raises(InputError, match="start of three finite"):
        Travel(np.array(start), reach)
