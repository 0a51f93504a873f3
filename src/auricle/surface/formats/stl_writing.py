"""Binary STL: bare facets, three corners each."""

import numpy as np

from auricle.surface.formats.header import UNKNOWN_SPACE
from auricle.surface.formats.stl import HEADER_BYTES
from auricle.surface.mesh import Mesh

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl_bytes(mesh: Mesh, *, space: str) -> bytes:
    """Content of a binary STL file: float32 corners, unit normals (0 where there is no area).

    The axes stand in the header, as 3D Slicer writes them; nothing else of the surface does.
    """
    doubled = 2.0 * mesh.face_areas[:, None]
    facets = np.zeros(mesh.n_faces, _FACET)
    facets["normal"] = np.divide(
        mesh.face_normals, doubled, out=np.zeros_like(mesh.face_normals), where=doubled > 0
    )
    facets["corners"] = mesh.vertices[mesh.faces]
    about = "binary STL, mm" + ("" if space == UNKNOWN_SPACE else f"; SPACE={space}")
    header = about.encode().ljust(HEADER_BYTES, b"\0")
    return header + np.array(mesh.n_faces, "<u4").tobytes() + facets.tobytes()
