"""openCARP's pair of text files: positions in micrometres (``.pts``) and elements (``.elem``).

Beside them lie fields, one number a node (``.dat``). Formats after the openCARP user's manual.
"""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Faces, Floats, Integers
from auricle.errors import FormatError
from auricle.surface.formats.header import (
    Header,
    count_of,
    damaged,
    require_bytes,
    shown,
    within_limits,
)
from auricle.surface.formats.number_text import rows_of_numbers
from auricle.surface.soup import TriangleSoup

MICROMETRES_PER_MM = 1000.0
ELEMENT_TAG = "elemTag"
_SMALLEST_RECORD = {".pts": len("0 0 0\n"), ".elem": len("Tr 0 0 0\n")}


def read_opencarp(path: Path) -> TriangleSoup:
    """Read the pair that `path`, a ``.pts`` or ``.elem`` file, belongs to, and its fields.

    Positions are turned from micrometres into mm. ``STEM.dat`` becomes the field STEM;
    ``STEM_NAME.dat`` and ``STEM.NAME.dat`` become NAME.

    Raises
    ------
    FormatError
        If the partner is missing, counts and lines disagree, an element is not a triangle, or a
        field has not one number a node.
    """
    points, elements = _partner(path, ".pts"), _partner(path, ".elem")
    positions = _numbers(_records(points), points.name, columns=3)
    faces, tags = _triangles(_records(elements), elements.name)
    Header(len(positions), len(faces))
    return TriangleSoup(
        positions / MICROMETRES_PER_MM,
        faces,
        point_fields={
            name: _values(file, len(positions)) for name, file in _field_files(path).items()
        },
        face_tags={} if tags is None else {ELEMENT_TAG: tags},
        remarks=("positions turned from micrometres, openCARP's unit, into mm",),
    )


def _partner(path: Path, suffix: str) -> Path:
    """Find the file of this pair with `suffix`, whatever its case."""
    for file in sorted(path.parent.iterdir()):
        if file.stem == path.stem and file.suffix.lower() == suffix:
            return file
    raise FormatError(
        f"lacks its partner {path.stem}{suffix}: openCARP surfaces are a .pts and an .elem file"
    )


def _records(path: Path) -> list[bytes]:
    """Lines of a file that begins with their count."""
    within_limits(path, path.name)
    with path.open("rb") as file:
        first = file.readline()
        count = count_of(first.strip(), f"lines of {path.name}")
        needed = count * _SMALLEST_RECORD[path.suffix.lower()] - 1
        left = path.stat().st_size - len(first)
        require_bytes(f"{count:,} lines of {path.name}", needed=needed, left=left)
        lines = [line for line in file if line.strip()]
    if len(lines) != count:
        raise damaged(f"announces {count:,} lines of {path.name} and holds {len(lines):,}")
    return lines


def _numbers(
    lines: list[bytes], name: str, *, columns: int, dtype: type = np.float64
) -> NDArray[Any]:
    """Numbers of the table in a file of this name, shape (lines, columns)."""
    if not lines:
        return np.empty((0, columns), dtype)
    try:
        table = rows_of_numbers(lines, encoding="ascii", dtype=dtype)
    except ValueError as fault:
        raise damaged(f"holds a line that is not {columns} numbers in {name} ({fault})") from fault
    if table.shape[1] != columns:
        raise damaged(f"holds lines of {table.shape[1]} numbers, not {columns}, in {name}")
    return table


def _triangles(lines: list[bytes], name: str) -> tuple[Faces, Integers | None]:
    """Vertex indices and, where the lines have them, tags."""
    kinds = Counter(line.split(None, 1)[0] for line in lines)
    triangles = kinds.pop(b"Tr", 0)
    if kinds:
        others = ", ".join(f"{count} {shown(kind)}" for kind, count in kinds.most_common(3))
        raise FormatError(
            f"holds {others} elements, not only triangles (Tr): extract its surface first"
        )
    tagged = bool(triangles) and len(lines[0].split()) > 4
    rows = [line.split(None, 1)[-1] for line in lines]
    table = _numbers(rows, name, columns=4 if tagged else 3, dtype=np.int64)
    return table[:, :3], table[:, 3] if tagged else None


def _field_files(path: Path) -> dict[str, Path]:
    """Find the fields of this pair by name, leaving out those of a pair with a longer stem."""
    files = sorted(path.parent.iterdir())
    longer = [
        file.stem
        for file in files
        if file.suffix.lower() == ".pts" and _is_within(path.stem, file.stem)
    ]
    found: dict[str, Path] = {}
    for file in files:
        if file.suffix.lower() != ".dat" or _owned(longer, file.stem):
            continue
        if file.stem == path.stem or _is_within(path.stem, file.stem):
            name = file.stem[len(path.stem) + 1 :] or path.stem
            if name in found:
                raise FormatError(
                    f"has two files of the field {name!r}, {found[name].name} and {file.name}: "
                    "remove one"
                )
            found[name] = file
    return found


def _is_within(stem: str, longer: str) -> bool:
    return len(longer) > len(stem) + 1 and longer.startswith((f"{stem}_", f"{stem}."))


def _owned(stems: Sequence[str], stem: str) -> bool:
    return any(stem == owner or _is_within(owner, stem) for owner in stems)


def _values(path: Path, nodes: int) -> Floats:
    within_limits(path, path.name)
    with path.open("rb") as file:
        lines = [line for line in file if line.strip()]
    if len(lines) != nodes:
        raise damaged(f"holds {len(lines):,} values in {path.name} for {nodes:,} nodes")
    values: Floats = _numbers(lines, path.name, columns=1)[:, 0]
    return values
