"""What the commands share: options of the same meaning, and how faults and notes are told."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from auricle.errors import AuricleError, OutputError

if TYPE_CHECKING:
    from auricle.surface.cleaning import Repair

SurfaceArgument = Annotated[
    Path,
    typer.Argument(
        metavar="SURFACE",
        help="VTP, VTK, VTU, PLY, STL, OBJ, OFF or openCARP .pts/.elem, in mm.",
        show_default=False,
    ),
]
FolderOption = Annotated[
    Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the results.")
]
FileOption = Annotated[
    Path, typer.Option("--output", "-o", metavar="FILE", help="Surface file to write.")
]
SeedOption = Annotated[int, typer.Option(min=0, help="Seed of everything random.")]


@contextmanager
def about(path: Path, *others: Path | None) -> Iterator[None]:
    """Put the file's name before a fault that names none of the files yet."""
    try:
        yield
    except AuricleError as fault:
        message = str(fault)
        named = (message.startswith(f"{each}: ") for each in (path, *others) if each is not None)
        if isinstance(fault, OutputError) or any(named):
            raise
        fault.args = (f"{path}: {message}",)
        raise


def require_folder(place: Path) -> None:
    """Refuse, before hours of work, an output folder that is a file."""
    if place.exists() and not place.is_dir():
        raise OutputError(f"{place}: is a file: name a folder for the results")


def echo_notes(repairs: "Sequence[Repair]", remarks: Sequence[str] = ()) -> None:
    """Name on standard error what was changed or should be known."""
    for note in (*repairs, *remarks):
        typer.echo(f"note: {note}", err=True)
