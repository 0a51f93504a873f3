"""Threads side by side: results in order, progress heard, and an end when the caller wants one."""

import time
from concurrent.futures import CancelledError
from threading import Event

import numpy as np
import pytest

from auricle.spectral.harmonics import manifold_harmonics
from auricle.spectral.workers import Workers
from auricle.surface.shapes import icosphere


class GivenUpError(Exception):
    """What a caller raises to cancel."""


def test_results_come_in_the_order_of_the_items() -> None:
    def slow_first(item: int) -> int:
        time.sleep(0.05 if item == 0 else 0.0)
        return 10 * item

    with Workers(2) as workers:
        assert workers.each(slow_first, range(5)) == [0, 10, 20, 30, 40]


def test_an_error_of_the_work_reaches_the_caller_even_a_timeout() -> None:
    def fails(error: type[Exception]) -> None:
        raise error

    with Workers(1) as workers:
        for error in (ValueError, TimeoutError):
            with pytest.raises(error):
                workers.result(workers.submit(fails, error))


def test_progress_is_repeated_while_work_goes_on() -> None:
    heard = []
    enough = Event()

    def progress(stage: str, done: float, total: float) -> None:
        heard.append((stage, done, total))
        if len(heard) == 4:
            enough.set()

    with Workers(1, progress) as workers:
        workers.report("harmonics", 3, 7)
        workers.result(workers.submit(enough.wait, 30))
    assert heard == [("harmonics", 3, 7)] * len(heard)
    assert len(heard) >= 4


def test_work_under_way_ends_when_the_caller_gives_up() -> None:
    def forever(workers: Workers) -> None:
        while True:
            workers.pause()
            time.sleep(0.001)

    workers = Workers(1)
    endless = workers.submit(forever, workers)
    with pytest.raises(GivenUpError), workers:
        raise GivenUpError
    with pytest.raises(CancelledError):
        endless.result()


@pytest.mark.parametrize("threads", [1, 2])
def test_harmonics_are_cancelled_between_two_steps_of_a_run(threads) -> None:
    """The whole takes many times as long as what is left after the caller has had enough."""
    sphere = icosphere(radius=30.0, subdivisions=5)
    began = 0.0

    def progress(*_: object) -> None:
        nonlocal began
        if time.perf_counter() - began > 0.4:
            raise GivenUpError

    began = time.perf_counter()
    with pytest.raises(GivenUpError):
        manifold_harmonics(sphere, 1000, threads=threads, progress=progress)
    ended = time.perf_counter()
    assert ended - began < 0.4 + 2.0


def test_the_digits_do_not_depend_on_the_number_of_threads() -> None:
    sphere = icosphere(radius=30.0, subdivisions=4)
    one = manifold_harmonics(sphere, 300, threads=1)
    for threads in (2, 3):
        other = manifold_harmonics(sphere, 300, threads=threads)
        assert np.array_equal(one.eigenvalues, other.eigenvalues)
        assert np.array_equal(one.modes, other.modes)
        assert one.certificate == other.certificate
