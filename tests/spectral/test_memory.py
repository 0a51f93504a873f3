"""Memory that is left: read from what the system says, and too little of it refused."""

from pathlib import Path

import pytest

from auricle.errors import InputError
from auricle.spectral import memory
from auricle.spectral.harmonics import manifold_harmonics
from auricle.spectral.memory import memory_left, require_memory
from auricle.surface.shapes import icosphere


@pytest.fixture
def told(tmp_path: Path) -> Path:
    (tmp_path / "meminfo").write_text("MemTotal: 9000 kB\nMemAvailable:    4000 kB\n")
    return tmp_path


def test_what_the_system_says_is_available_is_what_is_left(told) -> None:
    assert memory_left(system=told / "meminfo", group=told / "none") == 4000 * 1024


@pytest.mark.parametrize(
    ("most", "used"),
    [
        ("memory.max", "memory.current"),
        ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes"),
    ],
)
def test_a_container_leaves_its_limit_less_what_it_uses(told, most, used) -> None:
    (told / most).parent.mkdir(exist_ok=True)
    (told / most).write_text("3000\n")
    (told / used).write_text("1000\n")
    assert memory_left(system=told / "meminfo", group=told) == 2000


def test_a_container_without_a_limit_leaves_what_the_system_does(told) -> None:
    (told / "memory.max").write_text("max\n")
    (told / "memory.current").write_text("1000\n")
    assert memory_left(system=told / "meminfo", group=told) == 4000 * 1024


def test_where_nothing_is_known_nothing_is_refused(monkeypatch) -> None:
    monkeypatch.setattr(memory, "memory_left", lambda: None)
    require_memory(2**80, "modes")


@pytest.mark.parametrize("count", [20, 2000])
def test_harmonics_that_cannot_fit_are_refused_before_they_start(monkeypatch, count) -> None:
    monkeypatch.setattr(memory, "memory_left", lambda: 2**20)
    with pytest.raises(InputError, match=rf"{count} harmonics of 2562 vertices need .* are free: "):
        manifold_harmonics(icosphere(radius=30.0, subdivisions=4), count)
