"""Tables of a cohort's page, each from the study's rows to text."""

import csv
import io
import math
from collections.abc import Iterable, Sequence

import numpy as np

from auricle.report.tables import Table
from auricle.report.wording import number, percent, printable
from auricle.study.paper.claims import Claim
from auricle.study.paper.statistics import PairedTest, Summary, half_widths, summary
from auricle.study.paper.tables import (
    READINGS,
    CountRow,
    DecayRow,
    Values,
    counts_of,
    decay_rows,
    headline_decays,
    taus,
)

READING_WORDS = {
    "gd_from_original_mm": "from the original's points to the rebuilt surface",
    "gd_to_original_mm": "from the rebuilt's points to the original surface",
    "mse_mm2": "MHA vertex by vertex, Qslim to the nearest point left",
    "mse_nearest_from_original_mm2": "from the original's points to the nearest rebuilt point",
    "mse_nearest_to_original_mm2": "from the rebuilt's points to the nearest original point",
}
BOOTSTRAP_SIZES = (4, 7, 14, 28, 56)
_NOTHING = "–"


def count_table(rows: Sequence[CountRow]) -> Table:
    """Table 1: counts over all cases and placements, the printed value and the ratio beside."""
    return Table(
        "Table 1: harmonics that hold a share of the power (number, the constant one counted)",
        ("Map", "Share", "Median", "Least to most", "Cases' medians", "Printed", "Ratio"),
        tuple(
            (
                _map_words(row),
                percent(row.share),
                _count(row.median),
                _span(row.low, row.high),
                _span(row.case_low, row.case_high),
                _NOTHING if row.printed is None else f"{row.printed:,}",
                _NOTHING if row.ratio is None else _ratio(row.ratio),
            )
            for row in rows
        ),
    )


def decay_table(rows: Sequence[DecayRow], caption: str) -> Table:
    """τ of both methods with the test between them, and the printed values."""
    return Table(
        caption,
        (
            "Error",
            "MHA, harmonics",
            "Qslim, points",
            "MHA / Qslim (95 %)",
            "Test",
            "p",
            "Effect",
            "Printed MHA",
            "Printed Qslim",
            "Ours / printed",
        ),
        tuple(_decay_cells(row) for row in rows),
    )


def reading_table(rows: Sequence[DecayRow]) -> Table:
    """How τ hangs on what the paper does not say: reading, counts, floor."""
    return Table(
        "τ by what the paper does not state, mean ± deviation over cases (harmonics or points)",
        ("Error and reading", "Counts fitted", "Floor", "MHA", "Qslim", "MHA / Qslim", "p"),
        tuple(
            (
                f"{row.error}: {READING_WORDS[row.reading]}",
                row.counts,
                "fitted" if row.with_floor else "0",
                _with_spread(row.mha),
                _with_spread(row.qslim),
                _NOTHING if row.test is None else number(row.test.ratio, digits=2),
                _NOTHING if row.test is None else _p(row.test),
            )
            for row in rows
        ),
    )


def assumption_table(rows: Sequence[DecayRow]) -> Table:
    """The tests in full: what was assumed, and whether it holds."""
    return Table(
        "The paired tests: assumptions and size of the difference (harmonics or points)",
        (
            "Error",
            "Cases",
            "Differences normal? (Shapiro and Wilk p)",
            "Test taken",
            "Difference (95 %)",
            "Effect",
        ),
        tuple(
            (
                row.error,
                str(row.test.first.n),
                number(row.test.normality_p, digits=2),
                row.test.name,
                f"{number(row.test.difference)} ({number(row.test.difference_low)} to "
                f"{number(row.test.difference_high)})",
                f"{number(row.test.effect, digits=2)} ({row.test.effect_name})",
            )
            for row in rows
            if row.test is not None
        ),
    )


def claim_table(found: Sequence[Claim]) -> Table:
    """The paper's findings, each confirmed or refuted."""
    return Table(
        "The paper's findings as claims",
        ("What the paper says", "Here", "The numbers", "What would confirm it"),
        tuple(
            (f"“{each.words}” ({each.place})", each.outcome.value, each.evidence, each.criterion)
            for each in found
        ),
    )


def case_table(documents: Sequence[Values]) -> Table:
    """The cases: what they are, and their main numbers."""
    headline = {error: reading for error, reading in reversed(READINGS)}
    found = {
        error: taus(documents, headline[error], "even", with_floor=False) for error in ("GD", "MSE")
    }
    rows = []
    for place, document in enumerate(documents):
        shell = document["shell"]
        rows.append(
            (
                printable(document["name"]),
                document["kind"],
                f"{document['surface_as_read']['n_vertices']:,}",
                f"{document['surface_analyzed']['n_vertices']:,}",
                number(shell["area_mm2"] / 100),
                str(len(shell["cap_areas_mm2"])),
                *(
                    _tau(found[error][method][place])
                    for error in ("GD", "MSE")
                    for method in ("mha", "qslim")
                ),
            )
        )
    head = ("Case", "Kind", "Vertices read", "Analysed", "Area, cm²", "Holes capped")
    return Table(
        "The cases, with their τ (harmonics or points)",
        (*head, "GD MHA", "GD Qslim", "MSE MHA", "MSE Qslim"),
        tuple(rows),
    )


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
                _NOTHING
                if not counts
                else f"{_count(float(np.sort(counts)[len(counts) // 2]))} "
                f"({_span(min(counts), max(counts))})",
                f"{np.median(known):.0f}" if known else _NOTHING,
            ]
        settings = ", ".join(f"{key} {value:g}" for key, value in record["parameters"].items())
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
                printable(document["name"]),
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
    rows = []
    for document in documents:
        for finer in document["beyond"]["resolution"]:
            for each in finer["features"]:
                (base,) = (
                    record
                    for record in document["features"]
                    if (record["n_foci"], record["size"]) == (1, each["size"])
                )
                rows.append(
                    (
                        printable(document["name"]),
                        f"{each['size']}, σ = {each['sigma_mm']:g} mm",
                        f"{document['surface_analyzed']['n_vertices']:,}: {_medians(base)}",
                        f"{finer['n_vertices']:,}: {_medians(each)}",
                    )
                )
    return Table(
        "Harmonics for one focus by resolution: median at the largest share (number)",
        ("Case", "Focus", "Vertices: count", "Vertices: count"),
        tuple(rows),
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
                rows.append((f"τ, {row.error}, {_METHODS[method]}", *_half_widths(known, rng)))
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
        "Mean over cases, and ± half of its 95 % interval for cohorts of other sizes (bootstrap)",
        ("Number", "Mean", *(f"{n} cases" for n in BOOTSTRAP_SIZES)),
        tuple(rows),
    )


def count_csv(rows: Sequence[CountRow]) -> str:
    """Table 1 as CSV; infinite: more than the harmonics solved for."""
    head = (
        "n_foci", "size", "share", "median", "low", "high", "n", "n_beyond",
        "case_median_low", "case_median_high", "printed", "ratio",
    )  # fmt: skip
    return _csv(
        head,
        (
            (
                row.n_foci, row.size or "geometry", row.share, row.median, row.low, row.high, row.n,
                row.n_beyond, row.case_low, row.case_high, row.printed, row.ratio,
            )
            for row in rows
        ),
    )  # fmt: skip


def decay_csv(rows: Sequence[DecayRow]) -> str:
    """τ of every reading as CSV, in harmonics or points."""
    head = (
        "error", "reading", "counts", "with_floor", "n", "mha_mean", "mha_deviation", "qslim_mean",
        "qslim_deviation", "ratio", "ratio_low", "ratio_high", "test", "p_value", "effect",
        "effect_name", "normality_p", "printed_mha", "printed_qslim",
    )  # fmt: skip
    return _csv(head, (_decay_record(row) for row in rows))


_METHODS = {"mha": "MHA", "qslim": "Qslim"}


def _decay_record(row: DecayRow) -> tuple[object, ...]:
    test = row.test
    tested: tuple[object, ...] = (None,) * 7
    if test is not None:
        tested = (
            test.ratio, test.ratio_low, test.ratio_high, test.name, test.p_value, test.effect,
            test.effect_name,
        )  # fmt: skip
    return (
        row.error, row.reading, row.counts, row.with_floor, row.mha.n if row.mha else 0,
        *((row.mha.mean, row.mha.deviation) if row.mha else (None, None)),
        *((row.qslim.mean, row.qslim.deviation) if row.qslim else (None, None)),
        *tested, None if test is None else test.normality_p, row.printed[0][0], row.printed[1][0],
    )  # fmt: skip


def _csv(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(head)
    for row in rows:
        writer.writerow(["" if cell is None else cell for cell in row])
    return file.getvalue()


def _decay_cells(row: DecayRow) -> tuple[str, ...]:
    test, (mha, qslim) = row.test, row.printed
    ours = " / ".join(_NOTHING if each is None else _ratio(each) for each in row.ratios)
    tested = (_NOTHING,) * 4
    if test is not None:
        tested = (
            f"{number(test.ratio, digits=2)} ({number(test.ratio_low, digits=2)} to "
            f"{number(test.ratio_high, digits=2)})",
            test.name,
            _p(test),
            number(test.effect, digits=2),
        )
    return (
        row.error,
        _with_spread(row.mha),
        _with_spread(row.qslim),
        *tested,
        f"{mha[0]:g} ± {mha[1]:g}",
        f"{qslim[0]:g} ± {qslim[1]:g}",
        ours,
    )


def _map_words(row: CountRow) -> str:
    if row.n_foci is None:
        return "Geometry"
    return f"{row.n_foci} {'focus' if row.n_foci == 1 else 'foci'}, {row.size}"


def _count(value: float) -> str:
    return "beyond" if math.isinf(value) else f"{value:,.0f}"


def _span(low: float, high: float) -> str:
    return _count(low) if low == high else f"{_count(low)} to {_count(high)}"


def _ratio(value: float) -> str:
    return _NOTHING if math.isinf(value) else number(value, digits=2)


def _with_spread(found: Summary | None) -> str:
    if found is None:
        return _NOTHING
    return f"{number(found.mean)} ± {number(found.deviation)}"


def _p(test: PairedTest) -> str:
    return "< 0.001" if test.p_value < 0.001 else number(test.p_value, digits=2)


def _tau(value: float | None) -> str:
    return _NOTHING if value is None else number(value)


def _medians(record: Values) -> str:
    counts = record["counts"][max(record["counts"], key=float)]
    known = sorted(math.inf if count is None else count for count in counts)
    return _count(float(known[len(known) // 2]))


def _half_widths(values: Sequence[float], rng: np.random.Generator) -> tuple[str, ...]:
    found = half_widths(values, BOOTSTRAP_SIZES, rng=rng)
    return (number(float(np.mean(values))), *(f"± {number(each, digits=2)}" for each in found))
