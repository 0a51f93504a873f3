"""The command that opens the live page, or writes the page that can be sent.

Everything heavy is imported when a command runs, so that help comes at once.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from auricle.cli.options import echo_notes
from auricle.errors import InputError

if TYPE_CHECKING:
    from auricle.viewer.opening import Detail
    from auricle.viewer.workspace import Workspace

ViewedArgument = Annotated[
    Path,
    typer.Argument(
        metavar="PATH",
        help="A surface, a CT, a mapping system's export, or a folder that a command wrote.",
        show_default=False,
    ),
]


def view(
    path: ViewedArgument,
    export: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.html",
            help="Write the page with its data inside and end; it needs no network.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int, typer.Option(metavar="N", min=0, max=65535, help="Where to listen; 0: any free port.")
    ] = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open it in the browser.")
    ] = True,
    upload_limit: Annotated[
        int, typer.Option(metavar="MB", min=1, help="Largest file that may be dropped on the page.")
    ] = 1024,
    vertices: Annotated[
        int, typer.Option("--vertices", "-n", help="Vertices to simplify to.")
    ] = 10_000,
    modes: Annotated[
        int | None,
        typer.Option(
            "--modes",
            "-k",
            help="Harmonics to solve. Default: 500; 250 for --export.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Look at it: a page to explore, plan and map on, served on this machine only.

    The address that is printed works once, for one browser; Ctrl-C ends. With --export the page
    is written as one file that can be sent and opens anywhere.

    Example: `auricle view atrium.vtp --export page.html -k 100`
    """
    from auricle.viewer.opening import Detail

    if export is not None:
        _write_page(path, export, Detail(vertices, modes or 250))
        return
    _serve(path, Detail(vertices, modes or 500), port=port, browser=browser, limit=upload_limit)


def _serve(path: Path, detail: "Detail", *, port: int, browser: bool, limit: int) -> None:
    from auricle.viewer.server import serve

    def ready(address: str) -> None:
        typer.echo(address)
        typer.echo("Ctrl-C ends it. Nothing leaves this machine.", err=True)
        if browser:
            typer.launch(address)

    serve(
        lambda folder: _opened(path, detail, folder),
        port=port,
        largest_upload=limit * 1024**2,
        ready=ready,
    )


def _write_page(path: Path, target: Path, detail: "Detail") -> None:
    from auricle.atomic import write_text
    from auricle.viewer.built_page import exported_page
    from auricle.viewer.bundle import surface_bundle
    from auricle.viewer.open_case import OpenCase

    if target.suffix.lower() not in (".html", ".htm"):
        raise typer.BadParameter(f"{target}: give a name that ends in .html", param_hint="--export")
    with TemporaryDirectory(prefix="auricle-") as folder:
        case = _opened(path, detail, Path(folder)).find(OpenCase)
    if case is None:
        raise InputError(f"{path}: holds no surface to export: open it with auricle view")
    bundle = surface_bundle(case.prepared, name=case.name, remarks=case.remarks)
    write_text(target, exported_page(bundle))
    typer.echo(str(target))


def _opened(path: Path, detail: "Detail", folder: Path) -> "Workspace":
    from auricle.cli.progress import progress_bars
    from auricle.viewer.open_case import OpenCase
    from auricle.viewer.opening import open_path
    from auricle.viewer.workspace import Workspace

    workspace = Workspace(folder)
    with progress_bars() as progress:
        open_path(workspace, path, detail, progress=progress)
    case = workspace.find(OpenCase)
    if case is not None:
        echo_notes(case.prepared.repairs, case.remarks)
    return workspace
