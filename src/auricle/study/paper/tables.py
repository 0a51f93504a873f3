"""Tables of the paper over a cohort: Table 1 as ranges, τ, and the printed values beside."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.study.paper.printed import DECAYS, FEATURES, GEOMETRY
from auricle.study.paper.quality import RANGES
from auricle.study.paper.statistics import PairedTest, Summary, paired, summary

Values = Mapping[str, Any]
"""The values of one case, as `run_case` returns them."""

READINGS = (
    ("GD", "gd_from_original_mm"),
    ("GD", "gd_to_original_mm"),
    ("MSE", "mse_mm2"),
    ("MSE", "mse_nearest_from_original_mm2"),
    ("MSE", "mse_nearest_to_original_mm2"),
)
"""The paper's two errors, and how each may be read, the headline's reading first."""

READING_WORDS = {
    "gd_from_original_mm": "from the original's points to the rebuilt surface",
    "gd_to_original_mm": "from the rebuilt's points to the original surface",
    "mse_mm2": "MHA vertex by vertex, Qslim to the nearest point left",
    "mse_nearest_from_original_mm2": "from the original's points to the nearest rebuilt point",
    "mse_nearest_to_original_mm2": "from the rebuilt's points to the nearest original point",
}
"""The readings in words."""

PRINTED_SHARES = (0.85, 0.90)


@dataclass(frozen=True)
class DecayRow:
    """τ of both methods under one reading of an error.

    Attributes
    ----------
    error, reading
        ``GD`` or ``MSE``, and which reading of it.
    counts
        Which counts were fitted, one of `RANGES`.
    with_floor
        Whether a floor was fitted too.
    mha, qslim
        τ of the cases both methods have one for, harmonics or points; None without such cases.
    n_without
        Cases where an exponential could not be fitted to both.
    test
        The two compared; None with fewer than three cases.
    printed
        Mean and deviation the paper prints for MHA, then for Qslim.
    """

    error: str
    reading: str
    counts: str
    with_floor: bool
    mha: Summary | None
    qslim: Summary | None
    n_without: int
    test: PairedTest | None
    printed: tuple[tuple[float, float], tuple[float, float]]

    @property
    def ratios(self) -> tuple[float | None, float | None]:
        """Mean τ over the printed one, for MHA and for Qslim."""
        found = [
            None if ours is None else ours.mean / theirs[0]
            for ours, theirs in zip((self.mha, self.qslim), self.printed, strict=True)
        ]
        return found[0], found[1]


@dataclass(frozen=True)
class CountRow:
    """One number of Table 1.

    Attributes
    ----------
    n_foci, size
        Which map; None for the geometry.
    share
        Of the power.
    median, low, high
        Harmonics over all cases and placements; infinite where those solved for hold less than
        the share.
    n, n_beyond
        Cases and placements, and those of them that are infinite.
    case_low, case_high
        Least and greatest of the cases' own medians.
    printed
        The paper's; None for a size or share it does not have.
    """

    n_foci: int | None
    size: str | None
    share: float
    median: float
    low: float
    high: float
    n: int
    n_beyond: int
    case_low: float
    case_high: float
    printed: int | None

    @property
    def ratio(self) -> float | None:
        """Median over the printed value."""
        return None if self.printed is None else self.median / self.printed


def decay_rows(documents: Sequence[Values]) -> tuple[DecayRow, ...]:
    """τ of both methods for every reading, range of counts and floor."""
    return tuple(
        _decay_row(documents, error, reading, counts, floor)
        for error, reading in READINGS
        for counts in RANGES
        for floor in (False, True)
    )


def headline_decays(rows: Sequence[DecayRow]) -> tuple[DecayRow, ...]:
    """GD and MSE as the report reads them first: evenly spread counts, no floor."""
    headline = {error: reading for error, reading in reversed(READINGS)}
    return tuple(
        row
        for row in rows
        if headline[row.error] == row.reading and row.counts == RANGES[0] and not row.with_floor
    )


def decays_by_range(rows: Sequence[DecayRow]) -> tuple[DecayRow, ...]:
    """As `headline_decays`, for every range of counts: what τ owes to those it is fitted to."""
    readings = {row.reading for row in headline_decays(rows)}
    return tuple(row for row in rows if row.reading in readings and not row.with_floor)


def nearest_by_range(rows: Sequence[DecayRow]) -> tuple[DecayRow, ...]:
    """Of each error's ranges of counts the one whose τ come nearest to the printed two."""
    found = decays_by_range(rows)
    fitted = [row for row in found if None not in row.ratios]
    return tuple(
        min((row for row in fitted if row.error == error), key=_misfit)
        for error in dict.fromkeys(row.error for row in fitted)
    )


def _misfit(row: DecayRow) -> float:
    """Root mean square of ln(ours / printed) over both methods."""
    logs = [np.log(ratio) for ratio in row.ratios if ratio is not None]
    return float(np.sqrt(np.mean(np.square(logs))))


def taus(
    documents: Sequence[Values], reading: str, counts: str, *, with_floor: bool
) -> dict[str, list[float | None]]:
    """τ by method, one a case; None where no exponential could be fitted."""
    found: dict[str, list[float | None]] = {"mha": [], "qslim": []}
    for document in documents:
        by_method = {
            each["method"]: each["tau"]
            for each in document["decay"]
            if (each["error"], each["range"], each["with_floor"]) == (reading, counts, with_floor)
        }
        for method, values in found.items():
            values.append(by_method.get(method))
    return found


def count_rows(documents: Sequence[Values]) -> tuple[CountRow, ...]:
    """Table 1 over the cohort: the geometry, then every number of foci and width.

    Raises
    ------
    InputError
        If there is no case.
    """
    if not documents:
        raise InputError("no cases: the study has no table; give at least one that succeeds")
    return tuple(_geometry_rows(documents)) + tuple(_feature_rows(documents))


def counts_of(
    documents: Sequence[Values], n_foci: int, size: str, share: float
) -> list[list[float | None]]:
    """Counts of harmonics by case and placement; None where those at hand do not suffice."""
    return [
        each["counts"][f"{share:g}"]
        for document in documents
        for each in document["features"]
        if (each["n_foci"], each["size"]) == (n_foci, size)
    ]


def median(counts: Sequence[float] | Floats) -> float:
    """The median where some numbers may be infinite: of an even number, the greater if one is."""
    return float(np.quantile(counts, 0.5, method="higher" if np.isinf(counts).any() else "linear"))


def _decay_row(
    documents: Sequence[Values], error: str, reading: str, counts: str, floor: bool
) -> DecayRow:
    found = taus(documents, reading, counts, with_floor=floor)
    pairs = [
        (one, other)
        for one, other in zip(found["mha"], found["qslim"], strict=True)
        if one is not None and other is not None
    ]
    first, second = [one for one, _ in pairs], [other for _, other in pairs]
    try:
        test = paired(first, second)
    except InputError:  # too few cases to test: the row says so by having no test
        test = None
    return DecayRow(
        error=error,
        reading=reading,
        counts=counts,
        with_floor=floor,
        mha=summary(first) if first else None,
        qslim=summary(second) if second else None,
        n_without=len(documents) - len(pairs),
        test=test,
        printed=(DECAYS[error, "mha"], DECAYS[error, "qslim"]),
    )


def _geometry_rows(documents: Sequence[Values]) -> Iterator[CountRow]:
    for share in documents[0]["parameters"]["shares"]:
        found = [[document["geometry"]["counts"][f"{share:g}"]] for document in documents]
        yield _count_row(None, None, share, found)


def _feature_rows(documents: Sequence[Values]) -> Iterator[CountRow]:
    kinds = {(each["n_foci"], each["size"]): None for each in documents[0]["features"]}
    order = list(dict.fromkeys(size for _, size in kinds))
    for n_foci, size in sorted(kinds, key=lambda kind: (kind[0], order.index(kind[1]))):
        for share in documents[0]["parameters"]["shares"]:
            found = counts_of(documents, n_foci, size, share)
            yield _count_row(n_foci, size, share, found)


def _count_row(
    n_foci: int | None, size: str | None, share: float, found: Sequence[Sequence[float | None]]
) -> CountRow:
    cases = [[np.inf if count is None else count for count in case] for case in found]
    counts = np.concatenate(cases)
    medians = [median(case) for case in cases]
    return CountRow(
        n_foci=n_foci,
        size=size,
        share=share,
        median=median(counts),
        low=float(counts.min()),
        high=float(counts.max()),
        n=len(counts),
        n_beyond=int(np.isinf(counts).sum()),
        case_low=min(medians),
        case_high=max(medians),
        printed=_printed(n_foci, size, share),
    )


def _printed(n_foci: int | None, size: str | None, share: float) -> int | None:
    if share not in PRINTED_SHARES:
        return None
    pair = GEOMETRY if n_foci is None or size is None else FEATURES.get((n_foci, size))
    return None if pair is None else pair[PRINTED_SHARES.index(share)]
