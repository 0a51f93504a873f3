"""Where a result comes from: input hash and the versions of all that enters the numbers."""

import hashlib
import platform
from importlib.metadata import version
from pathlib import Path

from auricle import __version__
from auricle.study.result import Source

_LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "robust-laplacian",
    "libigl",
    "potpourri3d",
    "vtk",
    "trimesh",
)


def source_of(path: Path) -> Source:
    """Name, size and SHA-256 of a file; the folder it lies in is left out on purpose."""
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256")
    return Source(path.name, path.stat().st_size, digest.hexdigest())


def versions() -> dict[str, str]:
    """Versions of auricle, Python and the libraries that enter the numbers."""
    return {
        "auricle": __version__,
        "python": platform.python_version(),
        **{name: version(name) for name in _LIBRARIES},
    }
