"""The cache of harmonics: the same digits, never a damaged entry, never in the way."""

import numpy as np
import pytest

from auricle.errors import SolverError
from auricle.study import basis_cache
from auricle.study.basis_cache import cached_harmonics
from auricle.surface.shapes import icosphere

BALL = icosphere(radius=10.0, subdivisions=3)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    monkeypatch.setenv("AURICLE_CACHE", str(folder))
    return folder


def unsolvable(*_, **__):
    raise SolverError("solved again")


def test_the_second_time_nothing_is_solved_and_every_digit_is_the_same(cache, monkeypatch):
    first = cached_harmonics(BALL, 16)
    monkeypatch.setattr(basis_cache, "manifold_harmonics", unsolvable)
    second = cached_harmonics(BALL, 16)
    assert (first.modes == second.modes).all()
    assert (first.eigenvalues == second.eigenvalues).all()
    assert first.certificate == second.certificate
    assert len(list(cache.iterdir())) == 1


@pytest.mark.parametrize(
    "other",
    [
        lambda: cached_harmonics(BALL, 9),
        lambda: cached_harmonics(BALL, 16, seed=2),
        lambda: cached_harmonics(icosphere(radius=10.1, subdivisions=3), 16),
    ],
)
def test_another_question_is_solved_anew(cache, monkeypatch, other):
    cached_harmonics(BALL, 16)
    monkeypatch.setattr(basis_cache, "manifold_harmonics", unsolvable)
    with pytest.raises(SolverError, match="solved again"):
        other()


@pytest.mark.parametrize("part", ["modes.npy", "harmonics.json"])
def test_a_damaged_entry_is_solved_again(cache, part):
    first = cached_harmonics(BALL, 16)
    (place,) = cache.glob(f"*/{part}")
    content = bytearray(place.read_bytes())
    content[len(content) // 2] ^= 0xFF
    place.write_bytes(content)
    again = cached_harmonics(BALL, 16)
    assert (first.modes == again.modes).all()


def test_a_cache_that_cannot_be_written_is_gone_without(tmp_path, monkeypatch):
    place = tmp_path / "file"
    place.write_text("")
    monkeypatch.setenv("AURICLE_CACHE", str(place))
    assert cached_harmonics(BALL, 4).n_modes == 4


def test_the_entries_used_longest_ago_make_room(cache, monkeypatch):
    monkeypatch.setattr(basis_cache, "LARGEST_BYTES", 200_000)
    for n_modes in (9, 16, 25):
        cached_harmonics(BALL, n_modes)
    sizes = [sum(part.stat().st_size for part in entry.iterdir()) for entry in cache.iterdir()]
    assert 0 < sum(sizes) <= 200_000
    kept = {np.load(place).shape[1] for place in cache.glob("*/modes.npy")}
    assert 25 in kept


def test_off_writes_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("AURICLE_CACHE", "off")
    monkeypatch.chdir(tmp_path)
    cached_harmonics(BALL, 4)
    assert not list(tmp_path.iterdir())
