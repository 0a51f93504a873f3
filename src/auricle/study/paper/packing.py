"""Arrays in JSON: rounded to whole steps and packed, for pictures and not for numbers."""

import base64
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError, InputError

_KINDS = ("<u1", "<i2", "<i4")


def packed(values: Floats, *, step: float = 1.0) -> dict[str, Any]:
    """An array rounded to multiples of `step`, as JSON can hold it: the same bytes every time.

    Raises
    ------
    InputError
        If a value is not finite or too large for its step.

    Examples
    --------
    >>> unpacked(packed(np.array([[0.26, -3.0]]), step=0.01)).tolist()
    [[0.26, -3.0]]
    """
    whole = np.rint(np.asarray(values, dtype=np.float64) / step)
    if not np.isfinite(whole).all() or np.abs(whole).max(initial=0.0) >= 2**31:
        raise InputError(f"values cannot be packed in steps of {step}: give finite, smaller ones")
    kind = next(
        each
        for each in _KINDS
        if np.iinfo(each).min <= whole.min(initial=0) and whole.max(initial=0) <= np.iinfo(each).max
    )
    content = base64.b64encode(np.ascontiguousarray(whole.astype(kind)).tobytes())
    return {
        "shape": list(whole.shape),
        "kind": kind,
        "step": step,
        "base64": content.decode("ascii"),
    }


def unpacked(document: Mapping[str, Any]) -> Floats:
    """The array that `packed` made a document of, to half a step.

    Raises
    ------
    FormatError
        If the document is not whole.
    """
    try:
        content = base64.b64decode(document["base64"], validate=True)
        flat = np.frombuffer(content, dtype=np.dtype(document["kind"]))
        values: Floats = flat.astype(np.float64).reshape(document["shape"])
    except (KeyError, ValueError, TypeError) as fault:
        raise FormatError("a packed array is torn: run the case again") from fault
    # A step as 0.01 is not exact: dividing by 100 gives back the nearest decimal number.
    step = float(document["step"])
    inverse = round(1.0 / step)
    scaled: Floats = (
        values / inverse if inverse and math.isclose(1.0 / step, inverse) else values * step
    )
    return scaled
