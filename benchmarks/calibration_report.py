"""The tables of docs/calibration.md, from the cells that the two other programs measured.

python benchmarks/calibration_report.py CELLS.csv RECOMMENDATIONS.csv
"""

import argparse
import csv
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from markdown_tables import Row, median, number, table, values_of, where

from auricle.atomic import write_text

REPORT = Path(__file__).resolve().parents[1] / "docs" / "calibration.md"
BASELINES = ("nearest", "inverse_distance", "harmonic", "linear_radial", "thin_plate")


def coverage_table(rows: Sequence[Row]) -> str:
    """Share of the surface inside the 95 % interval, by design and number of samples."""

    def cell(some: Sequence[Row]) -> str:
        shares = [100 * number(row, "coverage95") for row in some]
        detail = [100 * number(row, "coverage95_with_detail") for row in some]
        if not some:
            return "–"
        return f"{np.mean(shares):.1f} / {np.mean(detail):.1f}"

    counts = values_of(rows, "n")
    lines = [
        [
            design,
            *(cell(where(rows, design=design, n=n)) for n in counts),
            cell(where(rows, design=design)),
        ]
        for design in values_of(rows, "design")
    ]
    lines.append(["all", *(cell(where(rows, n=n)) for n in counts), cell(rows)])
    return table(["design", *(f"N = {n}" for n in counts), "all N"], lines)


def error_table(rows: Sequence[Row], noise: str) -> str:
    """Median error of every method, by class, design and number of samples."""
    lines = []
    for name in values_of(rows, "map"):
        for design in values_of(rows, "design"):
            for n in values_of(rows, "n"):
                some = where(rows, map=name, design=design, n=n, noise=noise)
                if not some:
                    continue
                lines.append(
                    [name, design, n, f"**{median(some, 'nrmse')}**"]
                    + [median(some, each) for each in BASELINES]
                    + [ratio(some, "predicted"), ratio(some, "planned")]
                )
    head = ["map", "design", "N", "auricle", *BASELINES, "predicted/true", "planned/true"]
    return table(head, lines)


def ratio(rows: Sequence[Row], name: str) -> str:
    """Median of a predicted error over the true one, and its 10th and 90th percentile."""
    ratios = [number(row, name) / number(row, "nrmse") for row in rows]
    low, middle, high = np.quantile(ratios, [0.1, 0.5, 0.9])
    return f"{middle:.2f} ({low:.2f}–{high:.2f})"


def wins_table(rows: Sequence[Row]) -> str:
    """Share of cells in which the map is nearer to the truth than each method's."""
    lines = []
    for label, kept in _groups(rows):
        cells = _medians(kept)
        shares = [np.mean([cell["nrmse"] < cell[each] for cell in cells]) for each in BASELINES]
        all_of_them = np.mean([all(cell["nrmse"] < cell[b] for b in BASELINES) for cell in cells])
        lines.append([label, *(f"{share:.0%}" for share in shares), f"{all_of_them:.0%}"])
    return table(["cells", *BASELINES, "all at once"], lines)


def ratios_table(rows: Sequence[Row]) -> str:
    """Median ratio of the map's error to each method's."""
    lines = []
    for label, kept in _groups(rows):
        cells = _medians(kept)
        ratios = [np.median([cell["nrmse"] / cell[each] for cell in cells]) for each in BASELINES]
        lines.append([label, *(f"{ratio:.2f}" for ratio in ratios)])
    return table(["cells", *BASELINES], lines)


def bars_table(cells: Sequence[Row], advised: Sequence[Row]) -> str:
    """What was asked for, what came out, and whether that is enough."""
    covered = 100 * float(np.mean([number(row, "coverage95") for row in cells]))
    lines = [_bar("95 % intervals cover 93–97 %", f"{covered:.1f} %", 93 <= covered <= 97)]
    medians = _medians(cells)
    for each in BASELINES:
        won = sum(cell["nrmse"] < cell[each] for cell in medians)
        share = 100 * won / len(medians)
        asked = f"smaller error than {each} in at least 90 % of cells"
        met = share >= 90
        lines.append(_bar(asked, f"{share:.1f} % ({won:,} of {len(medians):,})", met))
    tried = [row for row in advised if row["nrmse"]]
    if tried:
        reached = [number(row, "nrmse") <= number(row, "target") for row in tried]
        shown = 100 * float(np.mean(reached))
        where_tried = f"on {len(values_of(advised, 'anatomy'))} of {N_ATRIA} atria"
        asked = (
            "recommended number reaches the target in at least 90 % of cases not refused, "
            + where_tried
        )
        lines.append(_bar(asked, f"{shown:.1f} %", shown >= 90))
        known = [row for row in tried if row["needed"]]
        ratios = [number(row, "recommended") / number(row, "needed") for row in known]
        middle = float(np.median(ratios))
        asked = f"with at most 1.6 times the points needed (median), {where_tried}"
        lines.append(_bar(asked, f"{middle:.2f}", middle <= 1.6))
    return table(["asked", "measured", ""], lines)


def extent(cells: Sequence[Row]) -> str:
    """How much of the grid that was asked for is there, in a sentence or two."""
    counts = Counter(
        tuple(row[name] for name in ("anatomy", "map", "design", "n", "noise")) for row in cells
    )
    asked = N_ATRIA * N_CLASSES * N_DESIGNS * N_COUNTS * N_NOISES
    by_count = ", ".join(f"{per_cell(where(cells, n=n))} with {n}" for n in values_of(cells, "n"))
    seeds = f"maps a cell: {by_count} samples"
    if len(counts) == asked:
        return f"All {asked:,} cells that were asked for; {seeds}."
    return (
        f"Of {asked:,} cells asked for (6 atria × 5 classes × 4 designs × 6 numbers of samples × 3 "
        f"levels of noise, 5 maps each) {len(counts):,} were measured; {seeds}."
    )


N_ATRIA, N_CLASSES, N_DESIGNS, N_COUNTS, N_NOISES = 6, 5, 4, 6, 3


N_CHOSEN = 5
"""Maps of a cell by which the numbers of the method were chosen; those after them came later."""


def fresh(row: Row) -> bool:
    """Whether a map was drawn after the numbers of the method were chosen."""
    return int(row["seed"]) >= N_CHOSEN


def shares_won(cells: Sequence[Row], within: float = 1.0) -> list[float]:
    """By baseline, the share of cells with an error below so many times its own, %."""
    medians = _medians(cells)
    return [
        100 * float(np.mean([cell["nrmse"] < within * cell[each] for cell in medians]))
        for each in BASELINES
    ]


def about_wins(cells: Sequence[Row]) -> str:
    """What the shares of cells hide."""
    nearly = zip(BASELINES, shares_won(cells, 1.02), strict=True)
    return (
        "The numbers of the method (shares, bounds, priors) were chosen by looking at these maps, "
        "to 400 samples. Smaller, or larger by less than 2 %, the error is in "
        f"{', '.join(f'{share:.1f} % ({each})' for each, share in nearly)} of the cells. In "
        f"{undecided(cells):.1%} no method can be better: no sample met the feature, and every "
        "method gives the same map; they count as lost."
    )


def afterwards(cells: Sequence[Row], later: Sequence[Row]) -> str:
    """Shares of cells won on maps drawn after the numbers were chosen, beside the former."""
    lines = []
    for n in values_of(later, "n"):
        new, old = where(later, n=n), where(cells, n=n)
        pairs = zip(shares_won(new), shares_won(old), strict=True)
        maps = f"{per_cell(new)} / {per_cell(old)}"
        lines.append([n, maps, *(f"{one:.1f} / {other:.1f}" for one, other in pairs)])
    return table(["samples", "maps a cell", *BASELINES], lines)


def per_cell(rows: Sequence[Row]) -> str:
    """How many maps a cell has."""
    counts = Counter(
        tuple(row[name] for name in ("anatomy", "map", "design", "n", "noise")) for row in rows
    )
    least, most = min(counts.values()), max(counts.values())
    return str(most) if least == most else f"{least} to {most}"


def _paragraph(words: str) -> str:
    return textwrap.fill(" ".join(words.split()), 100, break_on_hyphens=False)


def undecided(cells: Sequence[Row]) -> float:
    """Share of cells in which the methods do not differ: no sample met what the map shows."""
    apart = [
        max(abs(cell["nrmse"] / cell[each] - 1) for each in BASELINES) for cell in _medians(cells)
    ]
    return float(np.mean(np.array(apart) < _SAME))


_SAME = 1e-6


def _bar(asked: str, measured: str, met: bool) -> list[str]:
    return [asked, measured, "met" if met else "**not met**"]


def _groups(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    groups = [("all", list(rows))]
    for column in ("map", "design", "noise", "n", "anatomy"):
        groups += [
            (f"{column} {value}", where(rows, **{column: value}))
            for value in values_of(rows, column)
        ]
    return groups


def _medians(rows: Sequence[Row]) -> list[dict[str, float]]:
    """Medians over the seeds of every cell: anatomy, class, design, number, noise."""
    cells: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        key = tuple(row[name] for name in ("anatomy", "map", "design", "n", "noise"))
        cells.setdefault(key, []).append(row)
    return [
        {
            name: float(np.median([number(row, name) for row in some]))
            for name in ("nrmse", *BASELINES)
        }
        for some in cells.values()
    ]


def points_table(rows: Sequence[Row], n: str) -> str:
    """How many times the samples each method needs for the error that auricle has at n."""
    counts = [float(each) for each in values_of(rows, "n")]
    lines = []
    for name in values_of(rows, "map"):
        cells = []
        for method in BASELINES:
            ratios = [
                _points_for(curve, counts, target) / float(n)
                for curve, target in _curves(where(rows, map=name, design="farthest"), method, n)
            ]
            middle = float(np.median(ratios))
            cells.append(f"{middle:.1f}" if np.isfinite(middle) else f"> {counts[-1] / float(n):g}")
        lines.append([name, *cells])
    return table(["map", *BASELINES], lines)


def _curves(rows: Sequence[Row], method: str, n: str) -> Iterable[tuple[list[float], float]]:
    whole = len(values_of(rows, "n"))
    keys = {(row["anatomy"], row["noise"], row["seed"]) for row in rows}
    for anatomy, noise, seed in sorted(keys):
        some = where(rows, anatomy=anatomy, noise=noise, seed=seed)
        ordered = sorted(some, key=lambda row: float(row["n"]))
        if len(ordered) < whole:
            continue
        (own,) = where(some, n=n)
        yield [number(row, method) for row in ordered], number(own, "nrmse")


def _points_for(curve: Sequence[float], counts: Sequence[float], target: float) -> float:
    """Number of samples at which a falling curve reaches an error, by log-log interpolation."""
    falling = np.minimum.accumulate(curve)
    if falling[-1] > target:
        return np.inf
    return float(np.exp(np.interp(-np.log(target), -np.log(falling), np.log(counts))))


def recommendation_table(rows: Sequence[Row]) -> str:
    """How often the recommended number reached the target, and how many points were needed."""
    lines = []
    for quantile in values_of(rows, "quantile"):
        for label, kept in (
            ("all", where(rows, quantile=quantile)),
            *((name, where(rows, quantile=quantile, map=name)) for name in values_of(rows, "map")),
        ):
            lines.append([quantile, label, *_recommended(kept)])
    head = [
        "quantile", "map", "cases", "unreachable said", "target reached", "within 1.1 × target",
        "recommended / needed, median (10–90 %)", "unreachable but met",
    ]  # fmt: skip
    return table(head, lines)


def _recommended(rows: Sequence[Row]) -> list[str]:
    tried = [row for row in rows if row["nrmse"]]
    refused = [row for row in rows if row["reason"]]
    reached = _share(tried, lambda row: number(row, "nrmse") <= number(row, "target"))
    nearly = _share(tried, lambda row: number(row, "nrmse") <= 1.1 * number(row, "target"))
    ratios = [number(row, "recommended") / number(row, "needed") for row in tried if row["needed"]]
    spread = "–"
    if ratios:
        low, middle, high = np.quantile(ratios, [0.1, 0.5, 0.9])
        spread = f"{middle:.2f} ({low:.2f}–{high:.2f})"
    met = _share(refused, lambda row: bool(row["needed"]))
    return [str(len(rows)), f"{len(refused) / max(len(rows), 1):.0%}", reached, nearly, spread, met]


def _share(rows: Sequence[Row], holds: Callable[[Row], bool]) -> str:
    return f"{np.mean([holds(row) for row in rows]):.0%}" if rows else "–"


def main() -> None:
    """Write the report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("cells", type=Path)
    parser.add_argument("recommendations", type=Path)
    given = parser.parse_args()
    with given.cells.open(newline="") as file:
        rows = list(csv.DictReader(file))
    cells = [row for row in rows if not fresh(row)]
    later = [row for row in rows if fresh(row)]
    with given.recommendations.open(newline="") as file:
        advised = list(csv.DictReader(file))
    anatomies = ", ".join(
        f"{name} ({float(where(cells, anatomy=name)[0]['area_cm2']):.0f} cm²)"
        for name in values_of(cells, "anatomy")
    )
    about = f"""
Written by `benchmarks/calibration_report.py` from {len(cells):,} maps rebuilt by
`benchmarks/calibration_cells.py` and {len(advised):,} of `benchmarks/recommendation_cells.py`
(on {", ".join(values_of(advised, "anatomy"))}; {len(values_of(advised, "seed"))} maps a case).
Maps are simulated on real left atria: {anatomies}, simplified to 3,000 vertices; 750 harmonics.
{extent(cells)} Designs: farthest points, pivoted QR, random by area, and `catheter`: a 20-pole star
put down at random. Noise: 0, 5 and 20 % of the map's deviation, not told to the method. Error:
nRMSE over the area that can be sampled.
"""
    text = f"""# Calibration

{_paragraph(about)}

## The bars

{bars_table(cells, advised)}

{_paragraph(about_wins(cells))}

Share of the cells with a smaller error, %, on maps drawn afterwards / on the maps above:

{afterwards(cells, later)}

## Does the 95 % interval cover 95 %?
Share of the area inside mean ± 1.96 deviations, %: `std` / `std_with_detail`, mean over the maps.
The second counts what is fitted as noise, beyond the noise put on, as detail of the map.

{coverage_table(cells)}

By class and by noise, all designs and numbers:

{table(["", "std", "with detail"], _coverage_by(cells))}

## Against what mapping systems do
Share of cells (anatomy × class × design × N × noise, median over seeds) with a smaller error than
each:

{wins_table(cells)}

Median ratio of auricle's error to each method's, in the same cells:

{ratios_table(cells)}

Samples that each method needs for the error auricle has with 100, over 100 (farthest points,
median; `>`: not reached with {values_of(where(cells, design="farthest"), "n")[-1]}):

{points_table(cells, "100")}

## The recommended number of points (`auricle plan`)
Fresh maps, sampled at as many farthest points as recommended; "needed" is the first number of a
ladder (steps of 1.4) at which that very map meets the target. Targets 10, 20 and 30 %, noise 0, 5
and 20 %.

{recommendation_table(advised)}

## Errors
Median nRMSE over anatomies and seeds at 5 % noise. Predicted: by the fitted process; planned:
before any sample, from other maps of the class. Ratios: median (10–90 %).

{error_table(cells, "0.05")}
"""
    write_text(REPORT, text)


def _coverage_by(rows: Sequence[Row]) -> list[list[str]]:
    lines = []
    for column in ("map", "noise"):
        for value in values_of(rows, column):
            some = where(rows, **{column: value})
            plain = np.mean([100 * number(row, "coverage95") for row in some])
            detail = np.mean([100 * number(row, "coverage95_with_detail") for row in some])
            lines.append([f"{column} {value}", f"{plain:.1f}", f"{detail:.1f}"])
    return lines


if __name__ == "__main__":
    main()
