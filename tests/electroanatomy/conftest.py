"""Synthetic maps whose truth is known, of the size tests need."""

from collections.abc import Callable

import numpy as np
import pytest

from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.electroanatomy.synthetic import Acquisition, synthetic_map
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import ellipsoid

CHAMBER = ellipsoid(semi_axes=(30.0, 25.0, 20.0), subdivisions=2)


def truth() -> dict[str, np.ndarray]:
    """Activation along x at 0.5 m/s, voltages that fall along z."""
    x, _, z = CHAMBER.vertices.T
    return {
        "local_activation_time": np.asarray(x / 0.5),
        "bipolar_voltage": 2.0 + z / 20.0,
        "impedance": 100.0 + x,
        "force": 10.0 + z / 10.0,
    }


def _recorded(seed: int, **options) -> ElectroanatomicMap:
    acquisition = Acquisition(**{"n_points": 12, "duration": 400.0, **options})
    rng = np.random.default_rng(seed)
    return synthetic_map(CHAMBER, truth(), acquisition=acquisition, rng=rng)


@pytest.fixture(scope="session")
def chamber() -> Mesh:
    return CHAMBER


@pytest.fixture(scope="session")
def recorded() -> Callable[..., ElectroanatomicMap]:
    """A map of the chamber by its seed and the options of its acquisition."""
    return _recorded


@pytest.fixture(scope="session")
def one_map() -> ElectroanatomicMap:
    return _recorded(1)
