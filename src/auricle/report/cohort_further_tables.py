"""Tables beyond the paper: other maps, meshes and surfaces, and what more cases would bring."""

import math
from collections.abc import Sequence

import numpy as np

from auricle.report.cohort_tables import (
    METHODS,
    NOTHING,
    case_name,
    count_words,
    signed_percent,
    span_words,
)
from auricle.report.tables import Table
from auricle.report.wording import counted, number, percent
from auricle.study.paper.comparisons import (
    Comparison,
    recovered_comparisons,
    recovered_maps,
    resolution_comparisons,
)
from auricle.study.paper.statistics import half_widths, summary
from auricle.study.paper.tables import Values, counts_of, decay_rows, headline_decays, taus

_UNITS = {"_mm_per_ms": "mm/ms", "_mm": "mm", "_ms": "ms"}
BOOTSTRAP_SIZES = (4, 7, 14, 28, 56)


def class_table(documents: Sequence[Values]) -> Table:
    """Counts for other classes of maps, over cases and draws."""
    shares = [f"{share:g}" for share in documents[0]["parameters"]["shares"]]
    rows = []
    for number_of, record in enumerate(documents[0]["beyond"]["classes"]):
        cells = []
        for share in shares:
            records = [document["beyond"]["classes"][number_of] for document in documents]
            counts = [
                math.inf if count is None else count
                for each in records
                for count in each["counts"].get(share, [])
            ]
            closed = [each["closed_form"].get(share) for each in records]
            known = [each for each in closed if each is not None]
            cells += [
                NOTHING
                if not counts
                else f"{count_words(float(np.sort(counts)[len(counts) // 2]))} "
                f"({span_words(min(counts), max(counts))})",
                f"{np.median(known):.0f}" if known else NOTHING,
            ]
        settings = ", ".join(_setting(*each) for each in record["parameters"].items())
        rows.append((f"{record['title']} ({settings})", *cells))
    head = [
        text
        for share in shares
        for text in (f"{percent(float(share))}: median (least to most)", "closed form")
    ]
    return Table("Harmonics for other classes of maps (number)", ("Map", *head), tuple(rows))


def segmentation_table(documents: Sequence[Values]) -> Table:
    """Generated CTs: how far the segmented surface lies from the truth, and what that changes."""
    rows = []
    for document in documents:
        error = document["beyond"]["segmentation_error"]
        if error is None:
            continue
        sizes = [
            f"{each['size']} {_medians(each)} / {_medians(other)}"
            for each, other in zip(
                error["truth"]["features"], error["segmented"]["features"], strict=True
            )
        ]
        rows.append(
            (
                case_name(document),
                number(error["gd_mm"]),
                number(error["rms_mm"]),
                number(error["hausdorff_mm"]),
                f"{error['truth']['geometry']['0.99']} / {error['segmented']['geometry']['0.99']}",
                "; ".join(sizes),
            )
        )
    return Table(
        "Segmented surface against the true one (mm; harmonics, truth / segmented)",
        (
            "Case",
            "Mean distance",
            "Root mean square",
            "Largest",
            "Geometry, 99 %",
            "One focus, largest share: median count",
        ),
        tuple(rows),
    )


def resolution_table(documents: Sequence[Values]) -> Table:
    """Counts at other numbers of vertices, foci at the same places."""
    base = sorted({document["surface_analyzed"]["n_vertices"] for document in documents})
    at_base = f"{base[0]:,}" if len(base) == 1 else f"{base[0]:,} to {base[-1]:,}"
    return Table(
        f"Harmonics by resolution of the mesh, against {at_base} vertices (number; medians over "
        "cases)",
        ("Vertices, map, share", "Cases", f"At {at_base}", "At these", "Change", "Least to most"),
        tuple(
            _comparison_cells(each, f"{each.where:,}: ")
            for each in resolution_comparisons(documents)
        ),
    )


def recovered_table(documents: Sequence[Values]) -> Table:
    """Counts of maps carried to the surface rebuilt from few harmonics, with its own harmonics."""
    return Table(
        "Harmonics for a map on the surface rebuilt from harmonics (number; medians over cases)",
        (
            "Harmonics of the surface, map, share",
            "Cases",
            "On the original",
            "On the rebuilt",
            "Change",
            "Least to most",
        ),
        tuple(
            _comparison_cells(each, f"{each.where:,}: ")
            for each in recovered_comparisons(documents)
        ),
    )


def thinned_table(documents: Sequence[Values]) -> Table:
    """Harmonics, and points of Qslim without and with the map, that keep as much of a map."""
    share = documents[0]["parameters"]["shares"][-1]
    return Table(
        f"What keeps {percent(share)} of a map's power, error {percent((1 - share) ** 0.5)} of its "
        "deviation (number; medians over cases)",
        (
            "Map",
            "Harmonics",
            "Points of Qslim with the map in R⁴",
            "Points of Qslim of the geometry",
            "Surface's mean distance, in R⁴ over without",
        ),
        tuple(
            (
                f"{counted(each.n_foci, 'focus', 'foci')}, {each.size}",
                *(
                    count_words(each.counts[way])
                    for way in ("harmonics", "points_with_feature", "points")
                ),
                number(each.gd_ratio),
            )
            for each in recovered_maps(documents, share=share)
        ),
    )


def bootstrap_table(documents: Sequence[Values]) -> Table:
    """How well τ and the counts would be known from other numbers of cases."""
    rng = np.random.default_rng(1)
    rows = []
    for row in headline_decays(decay_rows(documents)):
        for method in ("mha", "qslim"):
            found = taus(documents, row.reading, row.counts, with_floor=row.with_floor)[method]
            known = [value for value in found if value is not None]
            if len(known) > 1:
                rows.append((f"τ, {row.error}, {METHODS[method]}", *_half_widths(known, rng)))
    share = documents[0]["parameters"]["shares"][-1]
    for size in dict.fromkeys(each["size"] for each in documents[0]["features"]):
        medians = [
            summary([count for case in counts_of([document], 1, size, share) for count in case
                     if count is not None] or [math.nan]).median
            for document in documents
        ]  # fmt: skip
        if len(medians) > 1 and not np.isnan(medians).any():
            rows.append((f"Harmonics, one {size} focus, {percent(share)}",
                         *_half_widths(medians, rng)))  # fmt: skip
    return Table(
        "Mean over cases (harmonics or points), and ± half of its 95 % interval for cohorts of "
        "other sizes (bootstrap)",
        ("Number", "Mean", *(f"{n} cases" for n in BOOTSTRAP_SIZES)),
        tuple(rows),
    )


def _setting(key: str, value: float) -> str:
    """A parameter of a class of maps with its unit, which ends its name."""
    for ending, unit in _UNITS.items():
        if key.endswith(ending):
            return f"{key.removesuffix(ending).replace('_', ' ')} {value:g} {unit}"
    return f"{key.replace('_', ' ')} {value:g}"


def _comparison_cells(each: Comparison, where: str) -> tuple[str, ...]:
    return (
        f"{where}{each.words}, {percent(each.share)}",
        str(each.n_cases),
        number(each.before),
        number(each.after),
        signed_percent(each.change),
        NOTHING
        if each.n_cases == 1
        else f"{signed_percent(each.change_low)} to {signed_percent(each.change_high)}",
    )


def _medians(record: Values) -> str:
    counts = record["counts"][max(record["counts"], key=float)]
    known = sorted(math.inf if count is None else count for count in counts)
    return count_words(float(known[len(known) // 2]))


def _half_widths(values: Sequence[float], rng: np.random.Generator) -> tuple[str, ...]:
    found = half_widths(values, BOOTSTRAP_SIZES, rng=rng)
    return (number(float(np.mean(values))), *(f"± {number(each, digits=2)}" for each in found))
