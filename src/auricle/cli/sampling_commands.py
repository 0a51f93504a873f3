"""Commands on samples: how many and where, the map rebuilt from them, where to go next.

Everything heavy is imported when a command runs, so that help comes at once.
"""

from pathlib import Path
from typing import Annotated

import typer

from auricle.cli.options import (
    FolderOption,
    SeedOption,
    SurfaceArgument,
    about,
    echo_notes,
    require_folder,
)

SamplesArgument = Annotated[
    Path,
    typer.Argument(
        metavar="SAMPLES",
        help="CSV with a header and columns x, y, z (mm, the surface's frame) and the values.",
        show_default=False,
    ),
]
ValueOption = Annotated[str, typer.Option(metavar="COLUMN", help="Column of the values.")]
ColumnsOption = Annotated[
    str,
    typer.Option(
        metavar="X,Y,Z", help="Columns of the positions, if not x,y,z.", show_default=False
    ),
]
NoiseOption = Annotated[
    float | None,
    typer.Option(
        metavar="NUMBER",
        help="Standard deviation of a sample, in the values' unit. Default: estimated.",
        show_default=False,
    ),
]
NoiseColumnOption = Annotated[
    str | None,
    typer.Option(metavar="COLUMN", help="Column of standard deviations.", show_default=False),
]
CycleOption = Annotated[
    float | None,
    typer.Option(
        metavar="MS",
        help="Cycle length of a re-entry: activation times are then fitted round the circle.",
        show_default=False,
    ),
]
DistanceOption = Annotated[
    float, typer.Option(metavar="MM", help="Farthest a sample may lie off the surface.")
]
RobustOption = Annotated[
    bool,
    typer.Option(
        "--robust", help="Isolated samples that contradict all their neighbours count less."
    ),
]
TargetOption = Annotated[
    float,
    typer.Option(metavar="SHARE", help="Error to reach, as a share of the map's deviation."),
]
VerticesOption = Annotated[int, typer.Option("--vertices", "-n", help="Vertices to simplify to.")]
ModesOption = Annotated[int, typer.Option("--modes", "-k", help="Harmonics to solve.")]


def plan(
    surface: SurfaceArgument,
    output: FolderOption,
    map_class: Annotated[
        str | None,
        typer.Option(
            "--class",
            metavar="NAME",
            help="Class of maps: gaussian, disc, activation, macro_reentry, rotor_pair, scar.",
            show_default=False,
        ),
    ] = None,
    parameter: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="A parameter of the class, as in velocity_mm_per_ms=0.6; repeatable.",
            show_default=False,
        ),
    ] = None,
    gaussian: Annotated[
        float | None,
        typer.Option(
            metavar="MM", help="Gaussian foci of this standard deviation.", show_default=False
        ),
    ] = None,
    field: Annotated[
        str | None,
        typer.Option("--map", metavar="FIELD", help="A map like this field's.", show_default=False),
    ] = None,
    bandwidth: Annotated[
        int | None,
        typer.Option(metavar="K", help="A map of so many harmonics.", show_default=False),
    ] = None,
    target: TargetOption = 0.1,
    noise: Annotated[
        float,
        typer.Option(metavar="SHARE", help="Noise of a sample, as a share of the map's deviation."),
    ] = 0.0,
    unplanned: Annotated[
        bool,
        typer.Option(
            "--unplanned", help="The points will be taken wherever the catheter happens to be."
        ),
    ] = False,
    points: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Place this many instead of those recommended.", show_default=False
        ),
    ] = None,
    existing: Annotated[
        Path | None,
        typer.Option(metavar="CSV", help="Positions of samples taken already.", show_default=False),
    ] = None,
    design: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="How points are chosen: farthest, pivoted_qr, a_optimal, d_optimal.",
        ),
    ] = "farthest",
    cycle_length: CycleOption = None,
    vertices: VerticesOption = 10_000,
    modes: ModesOption = 500,
    seed: SeedOption = 1,
) -> None:
    """How many points a kind of map needs on a surface, and where.

    Writes report.html, points.csv (in the order to take them), result.json and figures into DIR.

    Example: `auricle plan atrium.vtp --gaussian 8 --target 0.1 -o plan`
    """
    from auricle.cli.progress import progress_bars
    from auricle.report.plan_page import plan_answer, write_plan
    from auricle.study.planning import PlanConfig, checked_design, plan_surface

    require_folder(output)
    with about(surface, existing), progress_bars() as progress:
        config = PlanConfig(
            map_class="gaussian" if gaussian is not None and map_class is None else map_class,
            parameters=_parameters(parameter or [], gaussian),
            field=field,
            cycle_length_ms=cycle_length,
            bandwidth=bandwidth,
            target_nrmse=target,
            noise_ratio=noise,
            acquisition="unplanned" if unplanned else "planned",
            n_samples=points,
            design=checked_design(design),
            n_vertices=vertices,
            n_modes=modes,
            seed=seed,
        )
        result = plan_surface(surface, config, existing=existing, progress=progress)
        written = write_plan(result, output, progress=progress)
    echo_notes(result.prepared.repairs, (*result.prepared.remarks, *result.remarks))
    typer.echo(plan_answer(result))
    typer.echo(str(written))


def reconstruct(
    surface: SurfaceArgument,
    samples: SamplesArgument,
    output: FolderOption,
    value: ValueOption = "LAT",
    columns: ColumnsOption = "",
    noise: NoiseOption = None,
    noise_column: NoiseColumnOption = None,
    cycle_length: CycleOption = None,
    max_distance: DistanceOption = 5.0,
    robust: RobustOption = False,
    target: TargetOption = 0.1,
    count: Annotated[int, typer.Option(metavar="N", help="Next points to propose.")] = 5,
    vertices: VerticesOption = 10_000,
    modes: ModesOption = 500,
    seed: SeedOption = 1,
) -> None:
    """The map that scattered samples stand for, how sure it is, and whether they are enough.

    Writes report.html, map.vtp, samples.csv, next_points.csv, result.json and figures into DIR.

    Example: `auricle reconstruct atrium.vtp samples.csv --value LAT -o map`
    """
    from auricle.cli.progress import progress_bars
    from auricle.report.map_page import map_answer, write_map
    from auricle.study.mapping import map_samples
    from auricle.study.mapping_result import MappingConfig

    require_folder(output)
    with about(surface, samples), progress_bars() as progress:
        config = MappingConfig(
            value=value,
            noise_column=noise_column,
            columns=_columns(columns),
            noise=noise,
            cycle_length_ms=cycle_length,
            max_distance_mm=max_distance,
            robust=robust,
            target_nrmse=target,
            n_next=count,
            n_vertices=vertices,
            n_modes=modes,
            seed=seed,
        )
        result = map_samples(surface, samples, config, progress=progress)
        written = write_map(result, output, progress=progress)
    echo_notes(result.prepared.repairs, (*result.prepared.remarks, *result.remarks))
    typer.echo(map_answer(result))
    typer.echo(str(written))


def propose(
    surface: SurfaceArgument,
    samples: SamplesArgument,
    count: Annotated[int, typer.Option(metavar="N", help="How many.")] = 1,
    value: ValueOption = "LAT",
    columns: ColumnsOption = "",
    noise: NoiseOption = None,
    cycle_length: CycleOption = None,
    max_distance: DistanceOption = 5.0,
    target: TargetOption = 0.1,
    vertices: VerticesOption = 10_000,
    modes: ModesOption = 500,
    seed: SeedOption = 1,
) -> None:
    """Where to sample next: the points that lower the error most, as CSV on standard output.

    Whether the samples are enough already is said on standard error.

    Example: `auricle next atrium.vtp samples.csv --count 3 > next.csv`
    """
    from auricle.cli.progress import progress_bars
    from auricle.report.map_page import map_answer, next_points_csv
    from auricle.study.mapping import map_samples
    from auricle.study.mapping_result import MappingConfig

    with about(surface, samples), progress_bars() as progress:
        config = MappingConfig(
            value=value,
            columns=_columns(columns),
            noise=noise,
            cycle_length_ms=cycle_length,
            max_distance_mm=max_distance,
            target_nrmse=target,
            n_next=count,
            n_vertices=vertices,
            n_modes=modes,
            seed=seed,
        )
        result = map_samples(surface, samples, config, progress=progress, validate=False)
    echo_notes((), result.remarks)
    typer.echo(map_answer(result), err=True)
    typer.echo(next_points_csv(result), nl=False)


def _columns(text: str) -> dict[str, str]:
    """Names of the columns of positions from a list with commas."""
    if not text:
        return {}
    names = [name.strip() for name in text.split(",")]
    if len(names) != 3 or not all(names):
        raise typer.BadParameter(f"{text!r}: give three names", param_hint="--columns")
    return dict(zip("xyz", names, strict=True))


def _parameters(settings: list[str], gaussian: float | None) -> dict[str, float]:
    """Parameters of a class from NAME=VALUE, and the width of Gaussian foci."""
    found = {} if gaussian is None else {"width_mm": gaussian}
    for setting in settings:
        name, _, value = setting.partition("=")
        try:
            found[name.strip()] = float(value)
        except ValueError as fault:
            raise typer.BadParameter(
                f"{setting!r}: give NAME=NUMBER", param_hint="--parameter"
            ) from fault
    return found
