"""The child process of `isolation`: ``python -m auricle.surface.formats.child KIND PATH OUT``.

KIND is the suffix of a surface file, PATH the file, OUT the archive to write. The exit code is 3,
and the last line on standard error the cause, where the file is at fault.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from auricle.errors import FormatError
from auricle.isolation import limit_memory
from auricle.surface.formats.soup_archive import save_soup
from auricle.surface.soup import TriangleSoup

_GIBIBYTE = 1024**3
_BYTES_PER_BYTE = 20


def main(arguments: Sequence[str]) -> int:
    """Parse one file and write its soup; the exit code."""
    kind, source, target = arguments
    path = Path(source)
    limit_memory(4 * _GIBIBYTE + _BYTES_PER_BYTE * path.stat().st_size)
    try:
        soup, cells = _parser(kind)(path, kind)
    except FormatError as fault:
        sys.stderr.write(f"\n{fault}\n")
        return fault.exit_code
    save_soup(Path(target), soup, cells)
    return 0


def _parser(kind: str) -> Callable[[Path, str], tuple[TriangleSoup, int]]:
    """Load only the library that this kind needs."""
    if kind in (".vtk", ".vtp", ".vtu"):
        from auricle.surface.formats.vtk_parsing import parse_vtk

        return parse_vtk
    from auricle.surface.formats.trimesh_parsing import parse_with_trimesh

    return parse_with_trimesh


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
