"""The child process that decodes compressed DICOM: ``python -m auricle.imaging.dicom_child``.

Its arguments are a JSON file (paths, shape, dtype) and the ``.npy`` to write. The exit code is 3,
and the last line on standard error the cause, where a file is at fault.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import SimpleITK
from numpy.typing import NDArray

from auricle.errors import FormatError
from auricle.foreign import damaged, printable
from auricle.isolation import limit_memory

_GIBIBYTE = 1024**3


def main(arguments: Sequence[str]) -> int:
    """Decode the slices one by one into one array of HU; the exit code."""
    order, target = map(Path, arguments)
    task = json.loads(order.read_text(encoding="utf-8"))
    count, rows, columns = task["shape"]
    limit_memory(4 * _GIBIBYTE + 8 * count * rows * columns)
    slices = np.lib.format.open_memmap(
        target, mode="w+", dtype=task["dtype"], shape=(count, rows, columns)
    )
    try:
        for k, path in enumerate(task["paths"]):
            slices[k] = _decoded(Path(path), (rows, columns))
    except FormatError as fault:
        sys.stderr.write(f"\n{fault}\n")
        return fault.exit_code
    slices.flush()
    return 0


def _decoded(path: Path, shape: tuple[int, int]) -> NDArray[Any]:
    reader = SimpleITK.ImageFileReader()
    reader.SetImageIO("GDCMImageIO")
    reader.SetFileName(str(path))
    try:
        # a copy: views of SimpleITK's images dangle once the image is gone
        pixels: NDArray[Any] = SimpleITK.GetArrayFromImage(reader.Execute())
    except RuntimeError as fault:
        raise damaged(
            f"{printable(path.name)} has compressed pixels that cannot be decoded"
        ) from fault
    if pixels.size != shape[0] * shape[1]:
        raise damaged(f"{printable(path.name)} does not unpack to {shape[0]}×{shape[1]} pixels")
    return pixels.reshape(shape)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
