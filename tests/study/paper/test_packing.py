"""Arrays packed into JSON for pictures."""

import json

import numpy as np
import pytest

from auricle.errors import FormatError, InputError
from auricle.study.paper.packing import packed, unpacked


def test_what_is_packed_comes_back_to_half_a_step(rng):
    values = 100 * rng.standard_normal((50, 3))
    back = unpacked(json.loads(json.dumps(packed(values, step=0.01))))
    assert np.abs(back - values).max() <= 0.005 + 1e-9
    assert np.array_equal(unpacked(packed(back, step=0.01)), back)


@pytest.mark.parametrize("largest", [200, 30_000, 2_000_000])
def test_whole_numbers_come_back_whole(rng, largest):
    values = rng.integers(0, largest, size=(40, 3)).astype(float)
    assert np.array_equal(unpacked(packed(values)), values)


@pytest.mark.parametrize("values", [[np.nan], [np.inf], [1e12]])
def test_what_cannot_be_packed_is_refused(values):
    with pytest.raises(InputError, match="packed"):
        packed(np.array(values))


@pytest.mark.parametrize("harm", [{"base64": "?"}, {"shape": [7]}, {"kind": "<x9"}])
def test_a_torn_array_is_refused(harm):
    with pytest.raises(FormatError, match="torn"):
        unpacked(packed(np.arange(4.0)) | harm)
