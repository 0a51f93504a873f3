"""A live map follows its samples, and is judged as `auricle reconstruct` would."""

import math

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.progress import silent
from auricle.sampling.samples import Samples
from auricle.study.mapping import rebuilt_map
from auricle.viewer.container import unpacked
from auricle.viewer.endpoints import Call, Work
from auricle.viewer.live_map import Aim, LiveMap
from auricle.viewer.live_routes import add, begin, go_to, judge, play, review, state
from auricle.viewer.open_case import OpenCase, Recording
from auricle.viewer.workspace import Workspace


def values_at(positions: np.ndarray) -> np.ndarray:
    x, y, z = positions.T / 20.0
    return 40.0 + 20.0 * x + 10.0 * y * z


@pytest.fixture
def scattered(rng: np.random.Generator) -> Samples:
    directions = rng.standard_normal((60, 3))
    positions = 20.5 * directions / np.linalg.norm(directions, axis=1)[:, None]
    return Samples(positions, values_at(positions), name="LAT", unit="ms")


@pytest.fixture
def live(ball: OpenCase, scattered: Samples) -> LiveMap:
    found = LiveMap(ball.prepared, Aim("LAT", "ms"))
    found.load(scattered)
    return found


def test_a_study_begins_with_nothing_known_and_ends_with_the_map(
    ball: OpenCase, live: LiveMap
) -> None:
    assert live.n_taken == 0
    assert live.knows_nothing
    assert np.isnan(live.map()[0]).all()
    live.redo(60)
    assert live.refit()
    truth = values_at(ball.prepared.surface.vertices)
    assert np.sqrt(np.mean((live.map()[0] - truth) ** 2)) < 0.05 * truth.std()
    assert live.predicted_nrmse() < 0.1


def test_undo_and_redo_give_the_same_map_again(live: LiveMap) -> None:
    live.redo(30)
    live.refit()
    before = live.map()
    for steps in (1, 3, 20):
        live.undo(steps)
        assert live.n_taken == 30 - steps
        assert not np.allclose(live.map()[0], before[0], atol=1e-6)
        live.redo(steps)
        assert np.allclose(live.map()[0], before[0], rtol=1e-6)
        assert np.allclose(live.map()[1], before[1], rtol=1e-6)


def test_a_new_sample_puts_those_taken_back_out_of_reach(live: LiveMap) -> None:
    live.redo(10)
    live.undo(4)
    assert live.n_ahead == 54
    live.add(np.array([0.0, 0.0, 20.0]), 41.0)
    assert (live.n_taken, live.n_ahead) == (7, 0)
    live.redo(5)
    assert live.n_taken == 7


def test_a_sample_off_the_surface_changes_nothing(live: LiveMap) -> None:
    live.redo(10)
    live.undo(2)
    for position, value in (([0, 0, 90.0], 1.0), ([0, 0, math.nan], 1.0), ([0, 0, 20.0], math.inf)):
        with pytest.raises(InputError):
            live.add(np.array(position), value)
    assert (live.n_taken, live.n_ahead) == (8, 52)


@pytest.mark.parametrize("cycle", [None, 150.0])
def test_the_judgement_is_that_of_the_command(
    ball: OpenCase, scattered: Samples, cycle: float | None
) -> None:
    live = LiveMap(ball.prepared, Aim("LAT", "ms", cycle_length=cycle))
    live.load(scattered)
    live.redo(60)
    error, found = live.snapshot.judged()
    placed = live.snapshot.placed()
    command = rebuilt_map(
        ball.prepared, (60, placed), live.aim.config, source=ball.prepared.source, validate=False
    )
    assert error == command.predicted_nrmse
    assert found.verdict == command.verdict
    n = len(command.wavelengths)
    assert np.array_equal(found.wavelengths[:n], command.wavelengths)


def test_times_that_wrap_are_mapped_round_the_circle(ball: OpenCase, scattered: Samples) -> None:
    live = LiveMap(ball.prepared, Aim("LAT", "ms", cycle_length=30.0))
    live.load(Samples(scattered.positions, scattered.values % 30.0, name="LAT", unit="ms"))
    live.redo(60)
    live.refit()
    time, deviation = live.map()
    truth = values_at(ball.prepared.surface.vertices)
    wrong = np.abs((time - truth + 15.0) % 30.0 - 15.0)
    assert np.median(wrong) < 1.0
    assert (time >= 0).all()
    assert (time < 30).all()
    assert (deviation <= 30 / math.sqrt(12)).all()


@pytest.fixture
def workspace(ball: OpenCase, scattered: Samples, tmp_path) -> Workspace:
    case = OpenCase("ball.vtp", ball.prepared, (Recording(scattered),))
    found = Workspace(tmp_path)
    found.open("ball.vtp", (case,))
    return found


def post(workspace: Workspace, document: str) -> Call:
    return Call(workspace, body=document.encode())


def test_the_page_sees_the_map_follow_a_click(workspace: Workspace) -> None:
    header, arrays = unpacked(begin(post(workspace, '{"name": "LAT", "unit": "ms"}')))
    assert header["n_taken"] == 0
    assert "mean" not in arrays
    rng = np.random.default_rng(3)
    for index in range(6):
        place = rng.standard_normal(3)
        place *= 20 / np.linalg.norm(place)
        text = f'{{"position": {place.tolist()}, "value": {values_at(place[None])[0]}}}'
        header, arrays = unpacked(add(post(workspace, text)))
        assert header["n_taken"] == index + 1
        unpacked(judge(post(workspace, "{}")))
    header, arrays = unpacked(state(Call(workspace)))
    assert arrays["mean"].shape == (642,)
    before = arrays["mean"]
    _, arrays = unpacked(add(post(workspace, '{"position": [0, 0, 20], "value": 90}')))
    assert np.abs(arrays["mean"] - before).max() > 1.0
    _, arrays = unpacked(go_to(post(workspace, '{"n_taken": 6}')))
    assert np.allclose(arrays["mean"], before, rtol=1e-5)


@pytest.mark.parametrize(
    "document",
    [
        "[]",
        "{",
        '{"position": [0, 0], "value": 1}',
        '{"position": [0, 0, "20"], "value": 1}',
        '{"position": [0, 0, 20]}',
        '{"position": [0, 0, 20], "value": "1"}',
        '{"position": [0, 0, 20], "value": true}',
        '{"position": [0, 0, 20], "value": NaN}',
    ],
)
def test_a_request_that_is_no_sample_is_refused(workspace: Workspace, document: str) -> None:
    with pytest.raises(InputError):
        add(post(workspace, document))


def test_a_study_played_back_says_when_it_was_enough(workspace: Workspace) -> None:
    header, _ = unpacked(play(post(workspace, '{"recording": 0, "target_nrmse": 0.2}')))
    assert (header["name"], header["unit"]) == ("LAT", "ms")
    assert (header["n_taken"], header["n_ahead"]) == (0, 60)
    work = review(post(workspace, "{}"))
    assert isinstance(work, Work)
    found = work.run(silent)
    steps = found["steps"]
    assert [steps[0]["n_samples"], steps[-1]["n_samples"]] == [5, 60]
    assert not steps[0]["enough"]
    assert steps[-1]["enough"]
    assert 5 < found["enough_from"] < 60
    go_to(post(workspace, '{"n_taken": 60}'))
    last, _ = unpacked(judge(post(workspace, "{}")))
    assert last["predicted_nrmse"] == steps[-1]["predicted_nrmse"]


def test_a_recording_that_is_not_there_is_refused(workspace: Workspace) -> None:
    with pytest.raises(InputError, match="which recording"):
        play(post(workspace, '{"recording": 1}'))
