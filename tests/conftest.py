"""What many tests need: the folder of real anatomies, where there is one."""

import os
from pathlib import Path

# Nothing a test does stays in the user's cache.
os.environ["AURICLE_CACHE"] = "off"
# Small matrices are slower on several threads, and much slower when the cores are shared.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

import numpy as np  # noqa: E402
import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

# Truths are not timed: on shared cores a step takes ten times as long as on idle ones.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


@pytest.fixture(scope="session")
def real_data() -> Path:
    """The folder of real anatomies and maps; the test is skipped where there is none."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("AURICLE_DATA", beside))
    if not folder.is_dir():
        pytest.skip(f"no real anatomies at {folder}: set AURICLE_DATA")
    return folder


@pytest.fixture
def rng() -> np.random.Generator:
    """A generator with a fixed seed."""
    return np.random.default_rng(20261122)
