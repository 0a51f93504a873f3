"""A triangle soup as an uncompressed ``.npz``: what the child process hands to its parent."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.surface.soup import TriangleSoup

_CAPTION = "caption"


def save_soup(path: Path, soup: TriangleSoup, cells: int) -> None:
    """Write `soup`, and the number of cells its parser saw."""
    caption = {
        "cells": cells,
        "fields": list(soup.point_fields),
        "tags": list(soup.face_tags),
        "units": dict(soup.units),
        "space": soup.space,
        "remarks": soup.remarks,
    }
    arrays: dict[str, NDArray[Any]] = {"vertices": soup.vertices, "faces": soup.faces}
    arrays[_CAPTION] = np.frombuffer(json.dumps(caption).encode(), np.uint8)
    arrays.update({f"field {i}": values for i, values in enumerate(soup.point_fields.values())})
    arrays.update({f"tag {i}": labels for i, labels in enumerate(soup.face_tags.values())})
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


def load_soup(path: Path) -> tuple[TriangleSoup, int]:
    """Read what `save_soup` wrote; nothing in it can run code."""
    with np.load(path, allow_pickle=False) as arrays:
        caption = json.loads(arrays[_CAPTION].tobytes())
        soup = TriangleSoup(
            vertices=np.asarray(arrays["vertices"], np.float64),
            faces=np.asarray(arrays["faces"], np.int64),
            point_fields={
                name: np.asarray(arrays[f"field {i}"], np.float64)
                for i, name in enumerate(caption["fields"])
            },
            face_tags={
                name: np.asarray(arrays[f"tag {i}"], np.int64)
                for i, name in enumerate(caption["tags"])
            },
            units=caption["units"],
            space=caption["space"],
            remarks=tuple(caption["remarks"]),
        )
    return soup, caption["cells"]
