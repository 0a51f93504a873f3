"""Reproduction: how near each convention comes to the paper's printed numbers, over all cases.

Nearness is the root mean square of ln(ours / printed): 0 if all agree, ln 2 ≈ 0.69 if typically a
factor of 2 apart, whichever way. Every entry of Table 1 weighs the same. The paper states no width
of its foci; each convention is granted the three widths that suit it best over all cases, so none
is favoured by a choice of ours.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.study.paper.printed import SHARES, SIZES, TABLE_1, Entry

Values = Mapping[str, Any]

_RESAMPLES = 1_000


@dataclass(frozen=True, order=True)
class Convention:
    """One way to read the paper's counts; the attributes are those of `conventions.py`."""

    operator: str
    projection: str
    dual_cell: str
    coordinates: str
    measure: str
    constant: str
    profile: str

    @property
    def label(self) -> str:
        """In a few words."""
        cell = "Voronoi cells" if self.dual_cell == "voronoi" else "cells of a third"
        return (
            f"{self.operator.replace('_', ' ')}, {self.projection} projection, {cell}, coordinates "
            f"{self.coordinates}, {self.measure}, constant {self.constant}, "
            f"{self.profile.replace('_', ' ')} foci"
        )


LEAD = Convention("as_printed", "unweighted", "third", "centred", "amplitude", "in", "gaussian")
"""Eq. 1 to the letter and accumulated amplitude: the reading suspected from the start."""

SOUND = Convention("area_weighted", "weighted", "third", "centred", "energy", "out", "gaussian")
"""What auricle itself counts by: energy in the inner product the operator belongs to."""


@dataclass(frozen=True, eq=False)
class Nearness:
    """How near one convention comes.

    Attributes
    ----------
    convention
        Which.
    widths_mm
        Of small, medium and wide foci, as suit it best.
    counts
        Its counts, shape (cases, 20), in the order of `printed.TABLE_1`.
    distance, geometry, features
        Root mean square of ln(ours / printed): over all entries and cases, over the two of the
        geometry, and over the 18 of the features.
    by_case
        The same over all entries for each case, shape (cases,).
    first_share
        In what share of resamples of the cases no other convention came nearer.
    """

    convention: Convention
    widths_mm: tuple[float, ...]
    counts: Floats
    distance: float
    geometry: float
    features: float
    by_case: Floats
    first_share: float

    def medians(self) -> list[float]:
        """Median count over the cases, one for each entry of Table 1."""
        return [float(count) for count in np.median(self.counts, axis=0)]

    def ratios(self, n_foci: int, size: str) -> Floats:
        """Of the count for 90 % to that for 85 %, one for each case."""
        low, high = (
            next(i for i, entry in enumerate(TABLE_1) if _is(entry, n_foci, size, share))
            for share in SHARES
        )
        ratios: Floats = self.counts[:, high] / self.counts[:, low]
        return ratios


def nearness(documents: Sequence[Values], *, seed: int = 1) -> tuple[Nearness, ...]:
    """Every convention of the cases' documents, the nearest first.

    Parameters
    ----------
    documents
        Values of the cases; those without conventions are passed over, and conventions that one of
        the others could not solve.
    seed
        Of the resampling of the cases.

    Raises
    ------
    InputError
        If no case holds conventions, or they were counted for other widths or shares.
    """
    held = [each["conventions"] for each in documents if each.get("conventions")]
    if not held:
        raise InputError("no case holds conventions: run the study with convention_vertices > 0")
    if any(each["widths_mm"] != held[0]["widths_mm"] for each in held):
        raise InputError("cases were counted for different widths of foci: run them anew")
    tables = [_table(each) for each in held]
    shared = sorted(set.intersection(*(set(table) for table in tables)))
    widths = held[0]["widths_mm"]
    fitted = [_fitted(np.stack([table[key] for table in tables]), widths) for key in shared]
    squares = np.stack([each[2] for each in fitted])
    first = _first_shares(squares, np.random.default_rng(seed))
    found = [
        _nearness(key, chosen, counts, errors, share)
        for key, (chosen, counts, errors), share in zip(shared, fitted, first, strict=True)
    ]
    return tuple(sorted(found, key=lambda each: each.distance))


def growth(documents: Sequence[Values], like: Nearness) -> Floats:
    """How counts grow with the number of vertices: the exponent, for each case and entry.

    0: a property of the shape or map, as a bandwidth is; 1: as many times more as vertices. Shape
    (cases, 20); NaN where a case was not counted on fewer vertices, or with the dual cells asked
    for only there.
    """
    exponents = []
    for each in documents:
        held = each.get("conventions")
        if not held:
            continue
        coarser = _table(held["coarser"] | _grid(held)) if held.get("coarser") else {}
        fine, coarse = _table(held).get(like.convention), coarser.get(like.convention)
        if fine is None or coarse is None:
            exponents.append(np.full(len(TABLE_1), np.nan))
            continue
        ratio = np.log(held["n_vertices"] / held["coarser"]["n_vertices"])
        places = [held["widths_mm"].index(width) for width in like.widths_mm]
        exponents.append(np.log(_chosen(fine, places) / _chosen(coarse, places)) / ratio)
    return np.array(exponents)


def _grid(held: Values) -> dict[str, Any]:
    return {key: held[key] for key in ("widths_mm", "focus_counts")}


def _is(entry: Entry, n_foci: int, size: str, share: str) -> bool:
    return (entry.n_foci, entry.size, entry.share) == (n_foci, size, share)


def _table(held: Values) -> dict[Convention, Floats]:
    """Counts of one case by convention: for each width, the 20 entries if it were that wide."""
    geometry = {
        (*_transform(row), row["coordinates"], row["measure"], row["constant"]): row["counts"]
        for row in held["geometry"]
    }
    table = {}
    for row in held["features"]:
        for coordinates in ("centred", "as given"):
            key = (*_transform(row), coordinates, row["measure"], row["constant"])
            table[Convention(*key, row["profile"])] = _entries(geometry[key], row["counts"], held)
    return table


def _transform(row: Values) -> tuple[str, str, str]:
    return row["operator"], row["projection"], row["dual_cell"]


def _entries(geometry: Values, features: Values, held: Values) -> Floats:
    """Shape (widths, 20)."""
    if any(share not in geometry for share in SHARES):
        raise InputError(f"the cases were not counted at {' and '.join(SHARES)}: run them anew")
    columns = [
        np.full(len(held["widths_mm"]), float(geometry[entry.share]))
        if entry.n_foci == 0
        else np.array(features[entry.share])[:, held["focus_counts"].index(entry.n_foci)]
        for entry in TABLE_1
    ]
    return np.stack(columns, axis=1)


def _fitted(counts: Floats, widths: Sequence[float]) -> tuple[tuple[float, ...], Floats, Floats]:
    """Widths that suit best, the counts with them, and the squared ln(ours/printed) of each.

    `counts` has shape (cases, widths, 20); counts and squares come back as (cases, 20).
    """
    printed = np.array([entry.count for entry in TABLE_1])
    squares = np.log(counts / printed) ** 2
    by_size = [
        squares[:, :, [entry.size == size for entry in TABLE_1]].sum(axis=(0, 2)) for size in SIZES
    ]
    best = min(
        combinations(range(len(widths)), len(SIZES)),
        key=lambda places: sum(by_size[i][place] for i, place in enumerate(places)),
    )
    chosen = np.stack([_chosen(each, best) for each in counts])
    kept = np.stack([_chosen(each, best) for each in squares])
    return tuple(widths[place] for place in best), chosen, kept


def _chosen(table: Floats, places: Sequence[int]) -> Floats:
    """Of a table of shape (widths, 20), each entry at its size's width."""
    rows = [places[SIZES.index(entry.size)] if entry.n_foci else 0 for entry in TABLE_1]
    chosen: Floats = table[rows, range(len(TABLE_1))]
    return chosen


def _first_shares(squares: Floats, rng: np.random.Generator) -> Floats:
    """How often each convention is nearest when the cases are drawn again with replacement."""
    by_case = squares.mean(axis=2)
    n_cases = by_case.shape[1]
    weights = rng.multinomial(n_cases, np.full(n_cases, 1 / n_cases), size=_RESAMPLES)
    sums = by_case @ weights.T
    nearest = sums <= sums.min(axis=0) * (1 + 1e-12)
    shares: Floats = nearest.mean(axis=1)
    return shares


def _nearness(
    convention: Convention, widths: tuple[float, ...], counts: Floats, squares: Floats, first: float
) -> Nearness:
    geometry = np.array([entry.n_foci == 0 for entry in TABLE_1])
    return Nearness(
        convention=convention,
        widths_mm=widths,
        counts=counts,
        distance=float(np.sqrt(squares.mean())),
        geometry=float(np.sqrt(squares[:, geometry].mean())),
        features=float(np.sqrt(squares[:, ~geometry].mean())),
        by_case=np.sqrt(squares.mean(axis=1)),
        first_share=float(first),
    )
