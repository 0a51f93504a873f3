"""The page on reproduction, as Markdown: what of the paper's numbers follows from which reading.

Every number on it is computed from the cases' documents, but for the printed ones, which
`study/paper/printed.py` holds. What is shown and what is inferred stand apart.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from auricle.arrays import Floats
from auricle.report.cohort_answers import resolution_answers
from auricle.report.reproduction_tables import (
    Evidence,
    choice_table,
    contradiction_table,
    decay_table,
    evidence,
    factor,
    full_table,
    growth_table,
    meaning_table,
    named,
    nearest_table,
    nearest_taus,
    printed_table,
    ratio_table,
)
from auricle.report.tables import Table
from auricle.report.wording import percent
from auricle.study.paper.printed import (
    ADEQUATE,
    DECAYS,
    GEOMETRY,
    N_ATRIA,
    N_PLOTTED,
    N_VERTICES,
    TABLE_1,
)
from auricle.study.paper.reproduction import LEAD, SOUND, Nearness, Values

CLOSE, FAR = float(np.log(1.25)), float(np.log(2.0))
"""Distances up to which printed numbers count as reproduced, and from which as not."""

_SAME_SIZE = 0.1
"""Of ln(vertices / the paper's): beyond it a surface is of another resolution."""

_GEOMETRY = [entry.n_foci == 0 for entry in TABLE_1]


def reproduction_markdown(documents: Sequence[Values]) -> str:
    """The page on reproduction, from the values of a study's cases.

    The same documents give the same text. Where no case holds conventions it says so.
    """
    found = evidence(documents)
    if found is None:
        return (
            "# The paper's numbers, and the readings that lead to them\n\n"
            "The conventions were left out of this study: run it with convention_vertices > 0.\n"
        )
    parts = [
        "# The paper's numbers, and the readings that lead to them",
        _opening(found),
        "## Shown",
        _list(_shown(found)),
        "## Inferred",
        _list(_inferred(found)),
        "## What the paper leaves open",
        _markdown(contradiction_table()),
        _markdown(meaning_table()),
        "## How near each reading comes",
        _method(found),
        _markdown(nearest_table(found)),
        _markdown(choice_table(found)),
        "## Table 1 beside three readings",
        _markdown(printed_table(found)),
        _markdown(ratio_table(found)),
        _markdown(growth_table(found)),
        "## Decay constants",
        _markdown(decay_table(found)),
        "## Limits",
        _list(_limits(found)),
        "## All readings",
        _markdown(full_table(found)),
    ]
    return "\n\n".join(parts) + "\n"


def _opening(found: Evidence) -> str:
    vertices = _range([each["conventions"]["n_vertices"] for each in found.documents])
    names = ", ".join(str(each["name"]) for each in found.documents)
    return (
        "Written by `auricle study`; every number but the printed ones is computed in that run. "
        f"The paper's {N_ATRIA} CTs are not public; these are {len(found.documents)} other cases "
        f"({names}), simplified to {vertices} vertices (the paper: {N_VERTICES:,}). Counts "
        "of another atrium can differ from the printed ones without any reading being wrong, so "
        "nearness is judged over all entries and cases."
    )


def _shown(found: Evidence) -> Iterator[str]:
    """Statements that the numbers of this run bear alone."""
    nearest = found.ranking[0]
    sound, lead = found.of(SOUND), found.of(LEAD)
    if sound is not None:
        yield (
            "Accumulating the *energy* of centred coordinates in the operator's own inner product, "
            f"the geometry needs {_counts(sound, 0)} coefficients for 85 % and "
            f"{_counts(sound, 1)} for 90 %, not {GEOMETRY[0]} and {GEOMETRY[1]}. "
            f"Over all of Table 1 this reading is a typical factor of {factor(sound.distance)} "
            f"from print (rank {found.rank(sound)} of {len(found.ranking)})."
        )
    if lead is not None:
        yield (
            "Eq. 1 to the letter with accumulated *amplitude* asks for "
            f"{_counts(lead, 0)} and {_counts(lead, 1)}; over all of Table 1 it is a typical "
            f"factor of {factor(lead.distance)} from print (rank {found.rank(lead)}; features "
            f"alone {factor(lead.features)}, geometry alone {factor(lead.geometry)})."
        )
    yield (
        f"The nearest reading is: {nearest.convention.label}; typical factor "
        f"{factor(nearest.distance)} (cases {factor(nearest.by_case.min())} to "
        f"{factor(nearest.by_case.max())}), geometry {_counts(nearest, 0)} and "
        f"{_counts(nearest, 1)}. It is first in {percent(nearest.first_share)} of resamples of the "
        f"cases. {_verdict(nearest)}"
    )
    yield from _geometries(found)
    yield from _measures(found)
    yield from _growths(found)
    yield from resolution_answers((*found.documents, *found.left_out))
    for each in nearest_taus(found):
        printed = " and ".join(f"{DECAYS[(each.kind, method)][0]:g}" for method in ("mha", "qslim"))
        yield (
            f"τ of {each.kind}: nearest to the printed {printed} points is {each.label}; with "
            f"{each.means[0]:.1f} and {each.means[1]:.1f}, a factor of {factor(each.distance)}."
        )


def _geometries(found: Evidence) -> Iterator[str]:
    """What comes nearest to the geometry's two counts, which no width of a focus can suit."""
    for measure in ("amplitude", "energy"):
        nearest = _nearest_geometry(found, measure)
        yield (
            f"By {measure}, the nearest to the geometry's counts alone is: "
            f"{nearest.convention.label}; {_counts(nearest, 0)} and {_counts(nearest, 1)}, a "
            f"typical factor of {factor(nearest.geometry)}."
        )


def _nearest_geometry(found: Evidence, measure: str) -> Nearness:
    own = (each for each in found.ranking if each.convention.measure == measure)
    return min(own, key=lambda each: each.geometry)


def _measures(found: Evidence) -> Iterator[str]:
    """What amplitude and energy can do at best, and the ratio of the two counts."""
    best = {
        measure: next(each for each in found.ranking if each.convention.measure == measure)
        for measure in ("energy", "amplitude")
    }
    yield (
        "The nearest reading by energy is a factor of "
        f"{factor(best['energy'].distance)} from print, the nearest by amplitude "
        f"{factor(best['amplitude'].distance)}."
    )
    printed = [
        high.count / low.count for low, high in zip(TABLE_1[::2], TABLE_1[1::2], strict=True)
    ]
    ratios = {
        name: np.median(each.counts[:, 1::2] / each.counts[:, ::2], axis=0)
        for name, each in named(found).items()
    }
    ours = "; ".join(
        f"{name.lower()}: {each.min():.1f} to {each.max():.1f}" for name, each in ratios.items()
    )
    yield (
        f"The count for 90 % is {min(printed):.1f} to {max(printed):.1f} times that for 85 % in "
        f"Table 1. Here, as medians over the cases, {ours}."
    )


def _growths(found: Evidence) -> Iterator[str]:
    parts = []
    for name, each in named(found).items():
        exponents = found.growth(each)[:, _GEOMETRY]
        known = exponents[np.isfinite(exponents)]
        if len(known):
            parts.append(f"{name.lower()}: {np.median(known):.2f}")
    if parts:
        yield (
            "With three times as many vertices on the same surface the geometry's counts grow with "
            f"the exponent {'; '.join(parts)} (0: a property of the shape, 1: of the mesh)."
        )


def _inferred(found: Evidence) -> Iterator[str]:
    """What the numbers suggest of the paper, and how far that goes."""
    nearest, lead = found.ranking[0], found.of(LEAD)
    if nearest.distance > FAR:
        yield (
            "No reading tried here leads to the printed numbers to within a factor of two; which "
            "one the authors used stays open."
        )
    else:
        yield (
            "The nearest reading is a candidate for what the authors did, not more: other readings "
            "outside this list, other atria and other foci could come as near."
        )
    amplitude = next(each for each in found.ranking if each.convention.measure == "amplitude")
    energy = next(each for each in found.ranking if each.convention.measure == "energy")
    better, worse = sorted((amplitude, energy), key=lambda each: each.distance)
    if worse.distance - better.distance > CLOSE:
        yield (
            f"The printed counts look more like accumulated {better.convention.measure} than "
            f"{worse.convention.measure}."
        )
    else:
        yield "Table 1 alone does not tell accumulated energy from accumulated amplitude here."
    yield from _inferred_of_geometry(found)
    if lead is not None:
        exponents = found.growth(lead)[:, _GEOMETRY]
        if np.isfinite(exponents).any() and np.nanmedian(exponents) > 1 / 3:
            yield (
                "If amplitudes were accumulated, the printed count for the geometry measures the "
                "tail of small coefficients, and with it the number of vertices, more than a "
                "bandwidth: with another mesh of the same atrium it would have been another."
            )
    yield (
        f"The paper takes its figure of about {ADEQUATE} adequate coefficients from Figure 1b and "
        "Table 1, that is from this count. The distance of the rebuilt surface does not depend on "
        "how power is added up and is the better ground for such a figure (the report's Figure 2)."
    )
    yield (
        "The paper's qualitative conclusions are tested as claims in the report under auricle's "
        "own reading (area weighted, energy, constant out), not under the others listed here."
    )


def _inferred_of_geometry(found: Evidence) -> Iterator[str]:
    """What the geometry's row suggests, apart from the features'."""
    amplitude, energy = (_nearest_geometry(found, each) for each in ("amplitude", "energy"))
    if amplitude.geometry > FAR or energy.geometry - amplitude.geometry < CLOSE:
        yield "The geometry's row does not tell which quantity was accumulated."
        return
    yield (
        "The geometry's row alone is met to within a factor of two by amplitude "
        f"({factor(amplitude.geometry)}) and less well by energy ({factor(energy.geometry)}): it "
        "speaks for amplitude, on two numbers."
    )
    if amplitude.features > FAR:
        yield (
            "The same reading does not meet the features' rows (a factor of "
            f"{factor(amplitude.features)}, with the widths that suit it best): either geometry "
            "and features were counted differently, or the foci were of a kind not tried here."
        )


def _verdict(nearest: Nearness) -> str:
    if nearest.distance <= CLOSE:
        return "That reproduces the table."
    if nearest.distance <= FAR:
        return "That is the order of magnitude and the shape of the table, not its digits."
    return "That does not reproduce the table."


def _method(found: Evidence) -> str:
    placements = _range([each["conventions"]["n_placements"] for each in found.documents])
    return (
        "Distance: the root mean square of ln(ours / printed) over the 20 counts of Table 1 and "
        "all cases, shown as the factor it amounts to. The widths of foci, which the paper does "
        "not state, are those that suit each reading best over all cases, three of "
        f"{len(_widths(found))} tried; counts of foci are medians over "
        f"{placements} placements. Accumulated sums run over all n coefficients: the lowest are "
        "solved for and certified complete, those above are sampled in bunches whose places in the "
        "spectrum are counted; for the energy the total is exact by Parseval's identity."
    )


def _refusals(found: Evidence) -> Iterator[str]:
    """Which operators were not solved on which cases, and what was done about it."""
    if found.left_out:
        yield f"Cases left out, since an operator was not solved: {_refused(found.left_out)}."
    elif any(each["conventions"]["refused"] for each in found.documents):
        yield f"Not solved, and left out for all cases: {_refused(found.documents)}."
    else:
        yield "Every operator was solved on every case."


def _indefinite(found: Evidence) -> Iterator[str]:
    """Where Eq. 1 to the letter was no Laplacian."""
    where = [
        f"{each['name']}, {operator['dual_cell']} ({operator['n_negative']})"
        for each in found.documents
        for operator in each["conventions"]["operators"]
        if operator["n_negative"]
    ]
    if where:
        yield (
            "Eq. 1 to the letter has negative eigenvalues, and is no Laplacian, on (their number): "
            f"{'; '.join(where)}. There intrinsic Delaunay weights took the cotangents' place."
        )


def _refused(documents: Sequence[Values]) -> str:
    return "; ".join(
        f"{each['name']}: {row['operator'].replace('_', ' ')}, {row['dual_cell']} ({row['reason']})"
        for each in documents
        for row in each["conventions"]["refused"]
    )


def _limits(found: Evidence) -> Iterator[str]:
    balances = [
        abs(balance - 1.0)
        for each in found.documents
        for operator in each["conventions"]["operators"]
        for balance in operator["balance"].values()
    ]
    yield (
        f"Of the geometry's energy, which is known exactly, the sampled spectrum holds all but "
        f"{max(balances):.1%} at worst; sums of amplitudes, which nothing else gives, rest on the "
        "same sample."
    )
    vertices = [each["conventions"]["n_vertices"] for each in found.documents]
    if max(abs(np.log(np.divide(vertices, N_VERTICES)))) > _SAME_SIZE:
        yield (
            f"Some surfaces have other than about {N_VERTICES:,} vertices: readings whose counts "
            "grow with the mesh cannot be held against print there."
        )
    edges = (min(_widths(found)), max(_widths(found)))
    if set(edges) & set(found.ranking[0].widths_mm):
        yield (
            f"The nearest reading's widths reach an end of the range tried, {edges[0]:g} to "
            f"{edges[1]:g} mm: with others it could come nearer."
        )
    yield from _indefinite(found)
    yield from _refusals(found)
    yield (
        "Voronoi cells are counted with fewer certified modes than cells of a third; beyond them "
        "the sample takes over earlier."
    )
    yield (
        f"The printed geometry row and Figure 1a (drawn up to {N_PLOTTED} coefficients) may be of "
        "one example atrium, which cannot be known; the spread over our cases is given with every "
        "count."
    )


def _widths(found: Evidence) -> Sequence[float]:
    """Widths of foci tried, mm."""
    widths: Sequence[float] = found.documents[0]["conventions"]["widths_mm"]
    return widths


def _counts(reading: Nearness, column: int) -> str:
    counts: Floats = reading.counts[:, column]
    if counts.min() == counts.max():
        return f"{counts[0]:.0f}"
    return f"{np.median(counts):.0f} (median of {_range(counts.tolist())})"


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:,.0f}" if low == high else f"{low:,.0f}–{high:,.0f}"


def _list(lines: Iterator[str]) -> str:
    return "\n".join(f"- {line}" for line in lines)


def _markdown(table: Table) -> str:
    rows = [table.head, tuple("---" for _ in table.head), *table.rows]
    cells = ("| " + " | ".join(_cell(cell) for cell in row) + " |" for row in rows)
    return f"**{table.caption}**\n\n" + "\n".join(cells)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
