"""Measured maps, thinned out and rebuilt: error against the number of samples, every method.

    python benchmarks/reconstruction_real.py CELLS.csv [--seeds 5] [--vertices 10000] [--no-cells]

A clinical map of activation times and bipolar voltage (OpenEP's data set 2) and two of MRI
intensity are taken for the truth as they are; samples are taken of them without further noise.
Needs AURICLE_DATA. Every cell goes into CELLS.csv; with `--no-cells` those already there are only
reported: a section of docs/reconstruction.md and docs/figures/reconstruction_real.svg.
"""

import argparse
import csv
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import matplotlib as mpl
import numpy as np
from calibration_cells import monotone, planned_errors, relative_error
from calibration_report import points_table, ratio
from markdown_tables import Row, number, table, values_of, where
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from reconstruction_report import FOLDER, write_section

from auricle.arrays import Floats, PerMode, PerVertex
from auricle.atomic import write_whole
from auricle.sampling.bandwidth import past_tails
from auricle.sampling.baselines import BASELINES
from auricle.sampling.chamber import Chamber
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.tails import truncation_tail
from auricle.study.preparation import prepare
from auricle.surface.field import FieldMap
from auricle.surface.filling import fill_unsampled

COUNTS = (25, 50, 100, 200, 400, 800)
N_MODES = 1000
FIGURE = FOLDER / "figures" / "reconstruction_real.svg"
FIELDS = (
    "map", "unit", "deviation", "area_cm2", "design", "n", "seed", "nrmse", "predicted",
    "predicted_with_detail", "planned", "planned_from_other", "coverage95",
    "coverage95_with_detail", "length_mm", "smoothness", "noise_found", *BASELINES,
    "anatomy", "noise",
)  # fmt: skip


@dataclass(frozen=True)
class Measured:
    """A measured map: where it is, what it is called, and another patient's of the same kind."""

    title: str
    path: str
    field: str
    unit: str
    other: str | None = None


MAPS = (
    Measured("LAT", "maps/openep-dataset2/openep_ds2_lat_bip.vtk", "LAT", "ms"),
    Measured("bipolar", "maps/openep-dataset2/openep_ds2_lat_bip.vtk", "BIP_0_2mV_8bit", "mV"),
    Measured("LGE A", "meshes/lge/LA_A_lge.vtk", "scalars", "", "LGE B"),
    Measured("LGE B", "meshes/lge/LA_B_lge.vtk", "scalars", "", "LGE A"),
)


def truth(measured: Measured, data: Path, n_vertices: int) -> tuple[Chamber, PerVertex]:
    """A chamber that can be sampled where the map has a value, and the map, NaN elsewhere."""
    prepared = prepare(data / measured.path, n_vertices=n_vertices, n_modes=N_MODES)
    (field,) = (each for each in prepared.fields if each.name == measured.field)
    values = np.full(prepared.chamber.mesh.n_vertices, np.nan)
    values[: len(field.values)] = field.values
    known = prepared.chamber.accessible & np.isfinite(values)
    return replace(prepared.chamber, accessible=known), values


def cells(measured: Measured, data: Path, n_seeds: int, n_vertices: int) -> Iterator[Row]:
    """Every cell of one map."""
    chamber, values = truth(measured, data, n_vertices)
    tails = {"own": truncation_tail(chamber, values)}
    if measured.other is not None:
        (other,) = (each for each in MAPS if each.title == measured.other)
        elsewhere, theirs = truth(other, data, n_vertices)
        past = [(elsewhere, FieldMap(elsewhere.mesh, theirs, other.title))]
        tails["other"] = past_tails(past, chamber).at(0.5)
    filled = fill_unsampled(FieldMap(chamber.mesh, values, measured.title)).values
    fixed = {
        "map": measured.title,
        "unit": measured.unit,
        "deviation": chamber.rms(filled - chamber.mean(filled)),
        "area_cm2": chamber.accessible_area / 100,
        "anatomy": measured.path,
        "noise": 0,
    }
    for design, seed, order in designs(chamber, n_seeds):
        for count in COUNTS:
            sites = Sites.at_vertices(order[:count])
            row = {**fixed, "design": design, "n": count, "seed": seed}
            yield {**row, **rebuilt(chamber, sites, filled), **planned(chamber, sites, tails)}
            sys.stderr.write(f"{measured.title}: {design} {seed}, {count} samples\n")


def designs(chamber: Chamber, n_seeds: int) -> Iterator[tuple[str, int, Any]]:
    """Name, seed and order of points of every design; all are nested."""
    yield "farthest", 0, farthest_point_sampling(chamber, COUNTS[-1])
    for seed in range(n_seeds):
        rng = np.random.default_rng(1000 + seed)
        yield "random", seed, random_sampling(chamber, COUNTS[-1], rng=rng)


def planned(chamber: Chamber, sites: Sites, tails: dict[str, PerMode]) -> dict[str, Any]:
    """Error a plan with these sites predicts, from the map's own spectrum and another's."""
    errors = planned_errors(chamber, sites, {name: monotone(each) for name, each in tails.items()})
    return {"planned": errors["own", 0.0], "planned_from_other": errors.get(("other", 0.0), "")}


def rebuilt(chamber: Chamber, sites: Sites, values: PerVertex) -> dict[str, Any]:
    """Errors of every method, and what the Gaussian process says of its own."""
    samples = sites.of(values)
    found = GaussianProcess(chamber, sites).fit(samples)
    off = np.abs(found.mean - values)

    def error(map_: Floats) -> float:
        return relative_error(chamber, map_[:, None], values[:, None])

    def covered(std: PerVertex) -> float:
        return chamber.mean((off <= 1.96 * std).astype(float))

    spread = chamber.rms(values - chamber.mean(values))
    return {
        "nrmse": error(found.mean),
        "predicted": found.predicted_nrmse,
        "predicted_with_detail": found.predicted_nrmse_with_detail(),
        "coverage95": covered(found.std),
        "coverage95_with_detail": covered(found.std_with_detail()),
        "length_mm": found.hyperparameters.length,
        "smoothness": found.hyperparameters.smoothness,
        "noise_found": found.hyperparameters.noise / spread,
        **{name: error(other(chamber, sites, samples)) for name, other in BASELINES.items()},
    }


def measure(out: Path, given: argparse.Namespace) -> None:
    """Run every map and write each cell as it comes."""
    data = Path(os.environ.get("AURICLE_DATA", "../shared/data"))
    with out.open("w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        for each in MAPS:
            for row in cells(each, data, given.seeds, given.vertices):
                writer.writerow(row)
                file.flush()


def middle(rows: Sequence[Row], name: str) -> float:
    """Median of a column over the seeds."""
    return float(np.median([number(row, name) for row in rows]))


def by_cell(rows: Sequence[Row]) -> Iterator[tuple[str, str, str, list[Row]]]:
    """Map, design, number of samples and the seeds of every cell."""
    for each in MAPS:
        for design in ("farthest", "random"):
            for n in values_of(rows, "n"):
                yield each.title, design, n, where(rows, map=each.title, design=design, n=n)


def error_table(rows: Sequence[Row]) -> str:
    """Error of every method against the number of samples."""
    lines = []
    for title, design, n, some in by_cell(rows):
        errors = {name: middle(some, name) for name in ("nrmse", *BASELINES)}
        least = min(errors.values())
        shown = [f"**{e:.3f}**" if e == least else f"{e:.3f}" for e in errors.values()]
        lines.append([title, design, n, *shown])
    return table(["map", "design", "N", "auricle", *BASELINES], lines)


def trust_table(rows: Sequence[Row]) -> str:
    """What was predicted over what came out, and coverage."""
    lines = []
    for title, design, n, some in by_cell(rows):
        predicted = [
            f"{middle(some, 'predicted'):.3f}",
            f"{middle(some, 'predicted_with_detail'):.3f}",
            f"{middle(some, 'planned'):.3f}",
            f"{middle(some, 'planned_from_other'):.3f}" if some[0]["planned_from_other"] else "–",
        ]
        covered = [
            f"{100 * middle(some, name):.0f}" for name in ("coverage95", "coverage95_with_detail")
        ]
        lines.append([title, design, n, f"{middle(some, 'nrmse'):.3f}", *predicted, *covered])
    head = [
        "map", "design", "N", "true", "predicted", "with detail", "plan", "plan, other patient",
        "95 % covers, %", "with detail, %",
    ]  # fmt: skip
    return table(head, lines)


def summary_table(rows: Sequence[Row]) -> str:
    """Prediction over truth and coverage, by map and design."""
    lines = []
    for each in MAPS:
        for design in ("farthest", "random"):
            some = where(rows, map=each.title, design=design)
            ratios = [ratio(some, name) for name in ("predicted", "predicted_with_detail")]
            covered = [
                f"{100 * np.mean([number(row, name) for row in some]):.1f}"
                for name in ("coverage95", "coverage95_with_detail")
            ]
            lines.append([each.title, design, *ratios, ratio(some, "planned"), *covered])
    every = [ratio(rows, name) for name in ("predicted", "predicted_with_detail", "planned")]
    covered = [
        f"{100 * np.mean([number(row, name) for row in rows]):.1f}"
        for name in ("coverage95", "coverage95_with_detail")
    ]
    lines.append(["all", "", *every, *covered])
    head = [
        "map", "design", "predicted/true", "with detail/true", "plan/true", "95 % covers, %",
        "with detail, %",
    ]  # fmt: skip
    return table(head, lines)


def wins(rows: Sequence[Row]) -> str:
    """Share of cells in which the map is nearer to the truth than each method's."""
    medians = [
        {name: middle(some, name) for name in ("nrmse", *BASELINES)} for *_, some in by_cell(rows)
    ]
    ratios = {name: [cell["nrmse"] / cell[name] for cell in medians] for name in BASELINES}
    shares = {name: np.mean(np.array(ratios[name]) < 1) for name in BASELINES}
    lines = [
        ["cells with a smaller error", *(f"{shares[name]:.0%}" for name in BASELINES)],
        ["median ratio", *(f"{np.median(ratios[name]):.2f}" for name in BASELINES)],
        ["least", *(f"{min(ratios[name]):.2f}" for name in BASELINES)],
        ["largest", *(f"{max(ratios[name]):.2f}" for name in BASELINES)],
    ]
    return table(["auricle against", *BASELINES], lines)


STYLES = {
    "nrmse": ("auricle", "#b2182b", "-", 2.2),
    "predicted": ("predicted", "#b2182b", ":", 1.4),
    "predicted_with_detail": ("predicted with detail", "#b2182b", "--", 1.4),
    "planned": ("plan", "#000000", "-.", 1.2),
    "thin_plate": ("thin plate", "#2166ac", "-", 1.2),
    "linear_radial": ("linear radial", "#67a9cf", "-", 1.2),
    "harmonic": ("harmonic", "#1b7837", "-", 1.2),
    "nearest": ("nearest", "#7f7f7f", "-", 1.2),
    "inverse_distance": ("inverse distance", "#bfbfbf", "-", 1.2),
}


def draw(rows: Sequence[Row]) -> None:
    """Error against the number of samples: a row a design, a column a map."""
    settings = {"svg.fonttype": "none", "svg.hashsalt": "auricle", "font.size": 9}
    with mpl.rc_context(settings):
        figure = Figure(figsize=(12, 6.4), layout="constrained")
        axes = figure.subplots(2, len(MAPS), sharex=True, sharey=True)
        for column, each in enumerate(MAPS):
            for row, design in enumerate(("farthest", "random")):
                some = where(rows, map=each.title, design=design)
                panel(axes[row, column], some, f"{each.title}, {design} points")
        for axis in axes[:, 0]:
            axis.set_ylabel("nRMSE")
        for axis in axes[1]:
            axis.set_xlabel("samples")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(STYLES), fontsize=8)
        write_whole(
            FIGURE,
            lambda place: figure.savefig(place, metadata={"Date": None, "Creator": None}),
        )


def panel(axes: Axes, rows: Sequence[Row], title: str) -> None:
    """One panel of the figure."""
    counts = values_of(rows, "n")
    for name, (label, colour, line, width) in STYLES.items():
        heights = [middle(where(rows, n=n), name) for n in counts]
        axes.loglog([float(n) for n in counts], heights, line, color=colour, lw=width, label=label)
    axes.set_title(title, fontsize=9)
    axes.set_xticks([float(n) for n in counts], counts)
    axes.set_yticks([0.1, 0.2, 0.5, 1.0], ["0.1", "0.2", "0.5", "1"])
    axes.minorticks_off()
    axes.grid(alpha=0.3)


def about(rows: Sequence[Row]) -> str:
    """The maps, in a sentence."""
    parts = []
    for each in MAPS:
        row = where(rows, map=each.title)[0]
        unit = f" {each.unit}" if each.unit else ""
        parts.append(
            f"{each.title} (deviation {number(row, 'deviation'):.3g}{unit} over "
            f"{number(row, 'area_cm2'):.0f} cm²)"
        )
    return ", ".join(parts)


def report(rows: Sequence[Row]) -> None:
    """Write the section and the figure."""
    draw(rows)
    n_seeds = len(values_of(where(rows, design="random"), "seed"))
    text = f"""## Measured maps, thinned out

`benchmarks/reconstruction_real.py`. Maps taken for the truth: {about(rows)}.
LAT and bipolar are OpenEP's data set 2 (CARTO, native vertices), LGE A and B are MRI intensities
(10,000 vertices). They are sampled as they are, no noise added, at farthest points and at random
by area ({n_seeds} draws, medians); {N_MODES:,} harmonics. Noise and steps between vertices that a
map holds are part of the truth here, and no method can foretell those. `predicted` is
`predicted_nrmse`, `with detail` `predicted_nrmse_with_detail`; `plan` is what a plan with these
points foretells from the map's own spectrum, or from the other patient's map of the kind.

![Error against the number of samples](figures/reconstruction_real.svg)

### In short
Cells: map × design × N, medians over draws. Ratios: auricle's error over the other's.

{wins(rows)}

Prediction over true error, median (10–90 %) over N and draws, and mean coverage:

{summary_table(rows)}

Samples that each method needs for the error auricle has with 100, over 100 (farthest points; `>`:
not reached with 800):

{points_table(rows, "100")}

### Error of every method

{error_table(rows)}

### What is said of the error

{trust_table(rows)}
"""
    write_section("reconstruction_real", text)


def main() -> None:
    """Measure, then report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("cells", type=Path)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--vertices", type=int, default=10_000)
    parser.add_argument("--no-cells", action="store_true", help="only report those there are")
    given = parser.parse_args()
    if not given.no_cells:
        measure(given.cells, given)
    with given.cells.open(newline="") as file:
        report(list(csv.DictReader(file)))


if __name__ == "__main__":
    main()
