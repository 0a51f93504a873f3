"""The child process of `openep`: ``python -m auricle.electroanatomy.formats.openep_child IN OUT``.

IN is a ``.mat`` file, OUT the archive to write: the numbers of OpenEP's ``userdata`` by dotted
path, transposed as MATLAB shows them. The exit code is 3, and the last line on standard error the
cause, where the file is at fault.
"""

import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.electroanatomy.formats.openep_layout import ALTERNATIVES, NUMBERS, ROOT
from auricle.errors import FormatError
from auricle.isolation import limit_memory
from auricle.surface.formats.header import damaged

_GIBIBYTE = 1024**3
_MOST_ARRAY_BYTES = 2 * _GIBIBYTE
_MOST_EXPANSION = 1000
_FREE = 16 * 1024**2
_HDF5 = b"MATLAB 7.3"
_MOST_LINKS = 1_000_000
Lookup = Callable[[str], NDArray[Any] | None]


def main(arguments: Sequence[str]) -> int:
    """Parse one file and write its numbers; the exit code."""
    source, target = map(Path, arguments)
    limit_memory(4 * _GIBIBYTE + 20 * source.stat().st_size)
    try:
        arrays = dict(_arrays(source))
    except FormatError as fault:
        sys.stderr.write(f"\n{fault}\n")
        return fault.exit_code
    with target.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)
    return 0


def _arrays(path: Path) -> Iterator[tuple[str, NDArray[np.float64]]]:
    with path.open("rb") as file:
        is_hdf5 = file.read(len(_HDF5)) == _HDF5
    lookup = _hdf5_lookup(path) if is_hdf5 else _level_5_lookup(path)
    for name in NUMBERS:
        for place in (name, *ALTERNATIVES.get(name, ())):
            found = lookup(place)
            if found is not None:
                yield name, np.asarray(found, np.float64)
                break


def _level_5_lookup(path: Path) -> Lookup:
    """Numbers of a file of version 5 to 7, read by scipy."""
    from scipy.io import loadmat

    root = loadmat(path, variable_names=[ROOT], mat_dtype=True).get(ROOT)
    if root is None:
        raise FormatError(f"holds no variable {ROOT}: save OpenEP's structure under this name")

    def lookup(place: str) -> NDArray[Any] | None:
        value: Any = root
        for part in place.split("."):
            names = getattr(getattr(value, "dtype", None), "names", None)
            if names is None or part not in names or value.size != 1:
                return None
            value = value[part].flat[0]
        return value if isinstance(value, np.ndarray) and value.dtype.kind in "biuf" else None

    return lookup


def _hdf5_lookup(path: Path) -> Lookup:
    """Numbers of a file of version 7.3, read by h5py; nothing outside the file is followed."""
    import h5py  # type: ignore[import-untyped]

    file = h5py.File(path, "r")
    size = path.stat().st_size
    _refuse_links_outwards(file, h5py)
    if ROOT not in file:
        raise FormatError(f"holds no variable {ROOT}: save OpenEP's structure under this name")

    def lookup(place: str) -> NDArray[Any] | None:
        found = file.get(f"{ROOT}/{place.replace('.', '/')}")
        if not isinstance(found, h5py.Dataset) or found.dtype.kind not in "biuf":
            return None
        if found.attrs.get("MATLAB_empty", 0) or found.shape is None:
            return np.empty((0, 0))
        _require_own(found, size)
        values: NDArray[Any] = found[()].T
        return values

    return lookup


def _refuse_links_outwards(file: Any, h5py: Any) -> None:
    groups, seen = [file], 0
    while groups:
        group = groups.pop()
        for name in group:
            seen += 1
            link = group.get(name, getlink=True)
            if not isinstance(link, h5py.HardLink):
                raise FormatError("holds links, some leading out of the file: do not use it")
            if seen > _MOST_LINKS:
                raise damaged("holds groups without end")
            if name != "#refs#" and group.get(name, getclass=True) is h5py.Group:
                groups.append(group[name])


def _require_own(found: Any, size: int) -> None:
    """Refuse numbers kept in other files, and more of them than the file can hold."""
    if found.external or found.is_virtual:
        raise FormatError("keeps numbers in other files: do not use it")
    if found.nbytes > min(_MOST_ARRAY_BYTES, _FREE + _MOST_EXPANSION * size):
        raise damaged(f"announces an array of {found.nbytes:,} bytes")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
