"""Tables of a cohort's page, each from the study's rows to text."""

import math
from collections.abc import Sequence

from auricle.report.tables import Table
from auricle.report.wording import number, percent, printable
from auricle.study.paper.statistics import PairedTest, Summary, summary
from auricle.study.paper.tables import (
    READING_WORDS,
    READINGS,
    CountRow,
    DecayRow,
    Values,
    taus,
)

NOTHING = "–"
METHODS = {"mha": "MHA", "qslim": "Qslim"}


def case_name(document: Values) -> str:
    """Name of a case: what tells it from the others of its study, else the file's."""
    return printable(str(document.get("case", document["name"])))


def count_table(rows: Sequence[CountRow]) -> Table:
    """Table 1: counts over all cases and placements, the printed value and the ratio beside."""
    return Table(
        "Table 1: harmonics that hold a share of the power (number, the constant one counted)",
        ("Map", "Share", "Median", "Least to most", "Cases' medians", "Printed", "Ours / printed"),
        tuple(
            (
                _map_words(row),
                percent(row.share),
                count_words(row.median),
                span_words(row.low, row.high),
                span_words(row.case_low, row.case_high),
                NOTHING if row.printed is None else f"{row.printed:,}",
                NOTHING if row.ratio is None else _ratio(row.ratio),
            )
            for row in rows
        ),
    )


def decay_table(rows: Sequence[DecayRow], caption: str) -> Table:
    """τ of both methods with the test between them, and the printed values."""
    return Table(
        caption,
        (
            "Error, counts fitted",
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
                NOTHING if row.test is None else number(row.test.ratio, digits=2),
                NOTHING if row.test is None else _p(row.test),
            )
            for row in rows
        ),
    )


def power_table(documents: Sequence[Values]) -> Table:
    """Whether the errors fall as a power of the count or as an exponential."""
    words = {error: reading for error, reading in reversed(READINGS)}
    rows = []
    for error, reading in words.items():
        for method, name in METHODS.items():
            found = [
                each
                for document in documents
                for each in document["power_laws"]
                if (each["method"], each["error"]) == (method, reading)
            ]
            if found:
                better = sum(each["power_misfit"] < each["exponential_misfit"] for each in found)
                rows.append(
                    (
                        f"{error}, {name}",
                        _with_spread(summary([each["exponent"] for each in found])),
                        *(
                            percent(math.expm1(summary([each[kind] for each in found]).median))
                            for kind in ("power_misfit", "exponential_misfit")
                        ),
                        f"{better} of {len(found)}",
                    )
                )
    return Table(
        "Power or exponential: how far each is off, typically, over all counts",
        (
            "Error",
            "Exponent b of error ∝ countᵇ",
            "Power off by",
            "Exponential off by",
            "Cases where the power is nearer",
        ),
        tuple(sorted(rows)),
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
                case_name(document),
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


def _decay_cells(row: DecayRow) -> tuple[str, ...]:
    test, (mha, qslim) = row.test, row.printed
    ours = " / ".join(NOTHING if each is None else _ratio(each) for each in row.ratios)
    tested = (NOTHING,) * 4
    if test is not None:
        tested = (
            f"{number(test.ratio, digits=2)} ({number(test.ratio_low, digits=2)} to "
            f"{number(test.ratio_high, digits=2)})",
            test.name,
            _p(test),
            number(test.effect, digits=2),
        )
    return (
        f"{row.error}, {row.counts}",
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


def count_words(value: float) -> str:
    """A count, or that it lies beyond the harmonics at hand."""
    return "beyond" if math.isinf(value) else f"{value:,.0f}"


def span_words(low: float, high: float) -> str:
    """From a least to a greatest count."""
    return count_words(low) if low == high else f"{count_words(low)} to {count_words(high)}"


def signed_percent(change: float) -> str:
    """A change in percent with its sign, to two digits.

    Examples
    --------
    >>> signed_percent(0.0312), signed_percent(-0.25), signed_percent(0.0)
    ('+3.1 %', '−25 %', '0 %')
    """
    return f"{'+' if change > 0 else ''}{percent(change)}"


def _ratio(value: float) -> str:
    return NOTHING if math.isinf(value) else number(value, digits=2)


def _with_spread(found: Summary | None) -> str:
    if found is None:
        return NOTHING
    return f"{number(found.mean)} ± {number(found.deviation)}"


def _p(test: PairedTest) -> str:
    return "< 0.001" if test.p_value < 0.001 else number(test.p_value, digits=2)


def _tau(value: float | None) -> str:
    return NOTHING if value is None else number(value)
