"""A cache of harmonics by content: the same mesh is not solved twice on one machine."""

import hashlib
import json
import os
import shutil
from dataclasses import asdict
from pathlib import Path

import numpy as np
import platformdirs

from auricle import __version__
from auricle.atomic import write_text
from auricle.errors import OutputError
from auricle.progress import Progress, silent
from auricle.spectral.harmonics import Certificate, Harmonics, manifold_harmonics
from auricle.study.store import json_text, write_array
from auricle.surface.mesh import Mesh

LARGEST_BYTES = 4 * 1024**3
"""The least recently used entries beyond this size are removed."""

_ARRAYS = ("eigenvalues", "modes", "areas")


def cache_folder() -> Path | None:
    """Where the cache lies: ``AURICLE_CACHE``, or the user's cache folder; None if ``off``."""
    named = os.environ.get("AURICLE_CACHE", "")
    if named == "off":
        return None
    return Path(named) if named else Path(platformdirs.user_cache_dir("auricle")) / "harmonics"


def cached_harmonics(
    mesh: Mesh, n_modes: int, *, seed: int = 1, progress: Progress = silent
) -> Harmonics:
    """`manifold_harmonics` of a mesh, from the cache where it has been solved before.

    An entry is found by the SHA-256 of the vertices, the faces, the number of harmonics, the seed
    and auricle's version, so that it holds exactly the digits a new solution would have. A
    cache that cannot be written is gone without; an entry that is damaged is solved again.

    Raises
    ------
    InputError, SolverError
        As `manifold_harmonics`.
    """
    folder = cache_folder()
    if folder is None:
        return manifold_harmonics(mesh, n_modes, seed=seed, progress=progress)
    entry = folder / _key(mesh, n_modes, seed)
    found = _read(entry)
    if found is None:
        found = manifold_harmonics(mesh, n_modes, seed=seed, progress=progress)
        _write(found, entry)
    progress("harmonics", found.n_modes, found.n_modes)
    return found


def _key(mesh: Mesh, n_modes: int, seed: int) -> str:
    digest = hashlib.sha256(f"auricle {__version__} {n_modes} {seed} ".encode())
    for array in (mesh.vertices, mesh.faces):
        digest.update(str(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _read(entry: Path) -> Harmonics | None:
    """What an entry holds; None if it is absent, torn or not what it says."""
    sidecar = entry / "harmonics.json"
    try:
        document = json.loads(sidecar.read_text(encoding="utf-8"))
        arrays = {name: np.load(entry / f"{name}.npy", allow_pickle=False) for name in _ARRAYS}
        if document["sha256"] != _digests(arrays):
            return None
        certificate = document["certificate"] | {
            "retries": tuple(document["certificate"]["retries"])
        }
        os.utime(sidecar)
        return Harmonics(
            **arrays, laplacian=document["laplacian"], certificate=Certificate(**certificate)
        )
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _write(basis: Harmonics, entry: Path) -> None:
    arrays = {name: getattr(basis, name) for name in _ARRAYS}
    document = {
        "laplacian": basis.laplacian,
        "certificate": asdict(basis.certificate),
        "sha256": _digests(arrays),
    }
    try:
        for name, array in arrays.items():
            write_array(entry / f"{name}.npy", array)
        write_text(entry / "harmonics.json", json_text(document))
    except OutputError:
        return
    _shrink(entry.parent)


def _digests(arrays: dict[str, np.ndarray]) -> dict[str, str]:
    return {
        name: hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()
        for name, array in arrays.items()
    }


def _shrink(folder: Path) -> None:
    """Remove the entries used longest ago until the rest fits in `LARGEST_BYTES`."""
    entries = sorted(folder.glob("*/harmonics.json"), key=_last_use, reverse=True)
    total = 0
    for sidecar in entries:
        total += sum(_size(part) for part in sidecar.parent.iterdir())
        if total > LARGEST_BYTES:
            shutil.rmtree(sidecar.parent, ignore_errors=True)


def _last_use(sidecar: Path) -> float:
    try:
        return sidecar.stat().st_mtime
    except FileNotFoundError:  # removed by another process meanwhile
        return 0.0


def _size(part: Path) -> int:
    try:
        return part.stat().st_size
    except FileNotFoundError:
        return 0
