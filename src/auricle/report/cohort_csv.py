"""The tables of a cohort as CSV, in numbers."""

import csv
import io
from collections.abc import Iterable, Sequence

from auricle.study.paper.tables import CountRow, DecayRow


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
