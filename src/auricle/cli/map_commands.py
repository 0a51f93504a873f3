"""Commands on vendors' exports: into plain files, and their analysis.

Everything heavy is imported when a command runs, so that help comes at once.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from auricle.cli.options import FolderOption, about, require_folder

if TYPE_CHECKING:
    from auricle.electroanatomy.points_csv import PointTable
    from auricle.study.map_study import MapStudyConfig

ExportArgument = Annotated[
    Path,
    typer.Argument(
        metavar="EXPORT",
        help="CARTO 3 or EnSite folder or zip, OpenEP .mat, openCARP .pts, or a CSV of points.",
        show_default=False,
    ),
]
ColumnOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="WHAT=COLUMN:UNIT",
        help="Of a CSV: position=X,Y,Z:mm, local_activation_time=LAT:ms, bipolar_voltage=…:mV; "
        "repeatable.",
        show_default=False,
    ),
]
DelimiterOption = Annotated[str, typer.Option(metavar="CHARACTER", help="Of a CSV's columns.")]
DecimalOption = Annotated[str, typer.Option(metavar="CHARACTER", help="Decimal mark of a CSV.")]


def import_export(
    export: ExportArgument,
    output: FolderOption,
    column: ColumnOption = None,
    delimiter: DelimiterOption = ",",
    decimal: DecimalOption = ".",
    all_channels: Annotated[
        bool,
        typer.Option(
            "--all-channels", help="Keep every channel, not only mapping and reference ones."
        ),
    ] = False,
) -> None:
    """A mapping system's export as plain files: VTP, CSV, NPZ, JSON.

    Writes summary.json and, of each map, surface.vtp with the system's own values, points.csv and
    electrograms.npz with electrograms.json into DIR. Names of people, dates and identifiers stay
    behind; what was left out is named and counted.

    Example: `auricle import study.zip -o study`
    """
    from auricle.cli.progress import progress_bars
    from auricle.study.exports import export_source, read_export
    from auricle.study.imported_study import write_study

    require_folder(output)
    with about(export), progress_bars() as progress:
        progress("read export", 0, 1)
        table = point_table(column or [], delimiter, decimal)
        study = read_export(export, table=table, all_channels=all_channels)
        progress("read export", 1, 1)
        source = export_source(export, study.system)
        document = write_study(study, output, source=source, progress=progress)
    echo_left_out(study.remarks, {one["name"]: one["left_out"] for one in document["maps"]})
    typer.echo(f"{study.system}, {len(study.maps)} maps:")
    for one in document["maps"]:
        typer.echo(f"  {_map_line(one)}")
    typer.echo(str(output / "summary.json"))


def analyze_maps(
    export: Path, output: Path, config: "MapStudyConfig", *, column: list[str]
) -> None:
    """Analyse an export, write its report and say the answers: `auricle analyze EXPORT`."""
    from auricle.cli.progress import progress_bars
    from auricle.report.study_page import study_answers, write_map_study
    from auricle.study.map_analysis import analyze_export

    with about(export), progress_bars() as progress:
        table = point_table(column, ",", ".")
        result = analyze_export(export, config, table=table, progress=progress)
        written = write_map_study(result, output, progress=progress)
    echo_left_out(result.remarks, {one.name: list(one.remarks) for one in result.maps})
    for answer in study_answers(result):
        typer.echo(answer)
    typer.echo(str(written))


def point_table(columns: list[str], delimiter: str, decimal: str) -> "PointTable | None":
    """How a table is written, from WHAT=COLUMN:UNIT each; None if nothing is named."""
    if not columns:
        return None
    from auricle.electroanatomy.points_csv import PointTable

    named, units = {}, {}
    for text in columns:
        what, found, rest = text.partition("=")
        column, colon, unit = rest.rpartition(":")
        if not (found and colon and column):
            raise typer.BadParameter(f"{text!r}: give WHAT=COLUMN:UNIT", param_hint="--column")
        named[what.strip()], units[what.strip()] = column, unit.strip()
    axes = [name.strip() for name in named.pop("position", "").split(",")]
    if len(axes) != 3 or not all(axes):
        raise typer.BadParameter("give position=X,Y,Z:mm", param_hint="--column")
    return PointTable(
        position=(axes[0], axes[1], axes[2]),
        units=units,
        values=named,
        delimiter=delimiter,
        decimal=decimal,
    )


def echo_left_out(of_study: tuple[str, ...], by_map: dict[str, list[str]]) -> None:
    """Name on standard error what was left out of a study and of its maps."""
    for remark in of_study:
        typer.echo(f"note: {remark}", err=True)
    for name, remarks in by_map.items():
        for remark in remarks:
            typer.echo(f"note: {name}: {remark}", err=True)


def _map_line(one: dict[str, object]) -> str:
    surface, points = one["surface"], one["points"]
    drawn = "no surface"
    if isinstance(surface, dict):
        drawn = f"{surface['n_vertices']:,} vertices, {surface['n_faces']:,} faces"
    count = points["n_points"] if isinstance(points, dict) else 0
    return f"{one['name']}: {drawn}; {count:,} points, {one['n_electrograms']:,} with electrograms"
