"""A triangle soup: what a file held, before anyone vouches for it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from auricle.arrays import Faces, Floats, Integers, Points


@dataclass(frozen=True, eq=False)
class TriangleSoup:
    """Vertices, triangles and fields exactly as read; nothing is checked but the shapes.

    Attributes
    ----------
    vertices
        Shape (n, 3), mm.
    faces
        Shape (f, 3); may hold anything, negative indices included.
    point_fields
        Values at vertices by name, each of shape (n,) or (n, c).
    face_tags
        Whole-number labels at faces by name, each of shape (f,) (``elemTag`` of openCARP).
    units
        Unit by field name, where the file says.
    space
        ``LPS``, ``RAS`` or ``unknown``: what the file says of its axes.
    remarks
        What the reader did on the way that the user should know, one phrase each.
    """

    vertices: Points
    faces: Faces
    point_fields: Mapping[str, Floats] = field(default_factory=lambda: MappingProxyType({}))
    face_tags: Mapping[str, Integers] = field(default_factory=lambda: MappingProxyType({}))
    units: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    space: str = "unknown"
    remarks: tuple[str, ...] = ()
