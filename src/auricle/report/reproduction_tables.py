"""Tables of the reproduction: readings of the paper, and how near each comes to what is printed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from auricle.arrays import Floats
from auricle.report.tables import Table
from auricle.report.wording import percent
from auricle.study.paper.decay_readings import DecayReading, decay_readings, nearest_decays
from auricle.study.paper.printed import CONTRADICTIONS, DECAYS, SIZES, TABLE_1, Entry
from auricle.study.paper.reproduction import (
    LEAD,
    SOUND,
    Convention,
    Nearness,
    Values,
    growth,
    nearness,
)

N_NEAREST = 12

CHOICES: tuple[tuple[str, str], ...] = (
    ("operator", "Operator"),
    ("projection", "Projection"),
    ("dual_cell", "Dual cell"),
    ("coordinates", "Coordinates"),
    ("measure", "What accumulates"),
    ("constant", "Constant mode"),
    ("profile", "Profile of a focus"),
)
"""What a reading chooses, and its name in tables."""

MEANINGS: tuple[tuple[str, str], ...] = (
    (
        "as printed",
        "Eq. 1 to the letter: off the diagonal −wᵢⱼ/√(|vᵢ||vⱼ|), on it minus the row's sum; modes "
        "orthonormal without areas",
    ),
    (
        "symmetrised",
        "|v|^-½ · W · |v|^-½ throughout (Vallet and Lévy); modes h orthonormal without areas",
    ),
    ("area weighted", "W u = λ |v| u; modes u = |v|^-½ h orthonormal under the areas"),
    (
        "unweighted, weighted",
        "aₖ = Σ vᵢ Hᵢᵏ as printed, or each vertex times its dual area |vᵢ|; the symmetrised "
        "operator weighted by √|v| is the area-weighted one weighted, and not listed twice",
    ),
    (
        "third, voronoi",
        "the dual cell: a third of each triangle around a vertex, or its mixed Voronoi cell",
    ),
    (
        "centred, as given",
        "coordinates from their mean, or from where the scanner's origin happens to lie",
    ),
    (
        "energy, amplitude",
        "what is accumulated over all n modes: squared coefficients, or the norms of the x, y, z "
        "coefficients (for a feature: magnitudes)",
    ),
    ("constant in, out", "whether the mode of eigenvalue 0 enters the sum"),
    (
        "gaussian, raised cosine, disc",
        "the profile of a focus along the surface; gaussian in space: of the straight distance",
    ),
)
"""What the names of choices mean."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """All that the tables and the page read, found once.

    Attributes
    ----------
    documents
        Values of the cases that hold conventions, each solved under every operator; of all that
        hold conventions if there is none such.
    left_out
        Values of the other cases that hold conventions.
    """

    documents: Sequence[Values]
    left_out: Sequence[Values] = ()

    @cached_property
    def ranking(self) -> tuple[Nearness, ...]:
        """Every reading, the nearest first."""
        return nearness(self.documents)

    @cached_property
    def decays(self) -> tuple[DecayReading, ...]:
        """Every reading of τ."""
        return decay_readings(self.documents)

    def of(self, convention: Convention) -> Nearness | None:
        """A reading by its convention; None where some case could not be solved under it."""
        return next((each for each in self.ranking if each.convention == convention), None)

    def rank(self, wanted: Nearness) -> int:
        """Its place, from 1."""
        return self.ranking.index(wanted) + 1

    def growth(self, reading: Nearness) -> Floats:
        """Exponents of its counts against vertices, shape (cases, 20)."""
        return growth(self.documents, reading)


def evidence(documents: Sequence[Values]) -> Evidence | None:
    """What the cases' documents show; None if none of them holds conventions."""
    held = [each for each in documents if each.get("conventions")]
    solved = [each for each in held if not each["conventions"]["refused"]]
    # Readings are compared over the same cases: one that was not solved would else drop for all.
    if not solved:
        return Evidence(held) if held else None
    return Evidence(solved, [each for each in held if each["conventions"]["refused"]])


def reproduction_tables(documents: Sequence[Values]) -> tuple[Table, ...]:
    """The tables of the study's page on the conventions; none if the cases hold none."""
    found = evidence(documents)
    if found is None:
        return ()
    return (nearest_table(found), choice_table(found), printed_table(found), decay_table(found))


def contradiction_table() -> Table:
    """Where the paper leaves open what was done."""
    return Table("What the paper prints that does not agree", ("Place", "What"), CONTRADICTIONS)


def meaning_table() -> Table:
    """What the names of choices mean."""
    return Table("The readings", ("Name", "Meaning"), MEANINGS)


def nearest_table(found: Evidence) -> Table:
    """The nearest readings, and the two that matter wherever they lie."""
    shown = list(found.ranking[:N_NEAREST])
    for convention in (LEAD, SOUND):
        reading = found.of(convention)
        if reading is not None and reading not in shown:
            shown.append(reading)
    return Table(
        f"Nearest of {len(found.ranking)} readings, over {len(found.documents)} cases: typical "
        "factor between ours and printed (1 = equal)",
        (
            "Rank",
            "Reading",
            "Widths (mm)",
            "All 20 counts",
            "Cases from – to",
            "Geometry",
            "Features",
            "Nearest in resamples",
        ),
        tuple(_nearness_row(found, each) for each in shown),
    )


def full_table(found: Evidence) -> Table:
    """Every reading, one a row."""
    return Table(
        "Every reading: typical factor between ours and printed",
        (*(name for _, name in CHOICES), "Widths (mm)", "All", "Geometry", "Features", "k₈₅–k₉₀"),
        tuple(_full_row(each) for each in found.ranking),
    )


def choice_table(found: Evidence) -> Table:
    """For every single choice the nearest reading that makes it."""
    rows = []
    for attribute, name in CHOICES:
        best: dict[str, Nearness] = {}
        for each in found.ranking:
            best.setdefault(getattr(each.convention, attribute), each)
        rows += [
            (name, option.replace("_", " "), factor(each.distance), str(found.rank(each)))
            for option, each in best.items()
        ]
    return Table(
        "How near one can come with each single choice",
        ("Choice", "Taken", "Typical factor of the nearest reading", "Its rank"),
        tuple(rows),
    )


def printed_table(found: Evidence) -> Table:
    """Table 1 beside the nearest reading, the lead and the sound one."""
    readings = named(found)
    return Table(
        "Table 1, coefficients for 85 and 90 % of the power: median over the cases (least–most)",
        ("Entry", "Printed", *readings),
        tuple(
            (entry_name(entry), str(entry.count), *(_spread(r, i) for r in readings.values()))
            for i, entry in enumerate(TABLE_1)
        ),
    )


def ratio_table(found: Evidence) -> Table:
    """How much more 90 % asks for than 85 %."""
    readings = named(found)
    rows = []
    for n_foci, size in dict.fromkeys((entry.n_foci, entry.size) for entry in TABLE_1):
        low, high = (e.count for e in TABLE_1 if (e.n_foci, e.size) == (n_foci, size))
        cells = (f"{np.median(each.ratios(n_foci, size)):.1f}" for each in readings.values())
        rows.append((map_name(n_foci, size), f"{high / low:.1f}", *cells))
    return Table(
        "Ratio of the count for 90 % to that for 85 %: median over the cases",
        ("Map", "Printed", *readings),
        tuple(rows),
    )


def growth_table(found: Evidence) -> Table:
    """Exponent of counts against the number of vertices."""
    readings = {name: found.growth(each) for name, each in named(found).items()}
    groups: tuple[tuple[str, Callable[[Entry], bool]], ...] = (
        ("geometry", lambda entry: entry.n_foci == 0),
        *((f"{size} foci", _of_size(size)) for size in SIZES),
    )
    rows = []
    for name, belongs in groups:
        columns = [belongs(entry) for entry in TABLE_1]
        cells = (_exponent(each[:, columns]) for each in readings.values())
        rows.append((name, *cells))
    return Table(
        "Growth of counts with the number of vertices, three times as many: exponent, median over "
        "cases and entries (0: does not depend on the mesh, 1: in proportion to its vertices)",
        ("Map", *readings),
        tuple(rows),
    )


def decay_table(found: Evidence) -> Table:
    """The nearest readings of τ beside the printed ones."""
    rows = []
    for kind in ("GD", "MSE"):
        printed = [DECAYS[(kind, method)] for method in ("mha", "qslim")]
        cells = (f"{mean:g} ± {deviation:g}" for mean, deviation in printed)
        rows.append((f"{kind}, printed", *cells, "", ""))
        readings = [each for each in found.decays if each.kind == kind]
        rows += [_decay_row(each) for each in readings[:4]]
    return Table(
        "Decay constant τ, points: mean ± deviation over the cases, nearest readings first",
        ("Reading", "Harmonics", "Qslim", "Cases", "Typical factor"),
        tuple(rows),
    )


def named(found: Evidence) -> dict[str, Nearness]:
    """The nearest reading, the lead and the sound one, by the names of their columns."""
    readings = {"Nearest": found.ranking[0]}
    for name, convention in (("Eq. 1, amplitude", LEAD), ("Area weighted, energy", SOUND)):
        reading = found.of(convention)
        if reading is not None:
            readings[name] = reading
    return readings


def nearest_taus(found: Evidence) -> tuple[DecayReading, ...]:
    """The nearest reading of GD's τ and of MSE's."""
    return nearest_decays(found.decays)


def factor(distance: float) -> str:
    """A distance as the factor it typically is.

    >>> factor(float(np.log(2.0)))
    '2.00'
    """
    return f"{np.exp(distance):.2f}" if distance < np.log(100) else f"{np.exp(distance):.0f}"


def map_name(n_foci: int, size: str) -> str:
    """What a row of Table 1 is of."""
    return size if n_foci == 0 else f"{n_foci} {'focus' if n_foci == 1 else 'foci'}, {size}"


def entry_name(entry: Entry) -> str:
    """A count of Table 1 in words."""
    return f"{map_name(entry.n_foci, entry.size)}, {percent(float(entry.share))}"


def _of_size(size: str) -> Callable[[Entry], bool]:
    return lambda entry: entry.size == size


def _nearness_row(found: Evidence, each: Nearness) -> tuple[str, ...]:
    return (
        str(found.rank(each)),
        each.convention.label,
        _widths(each),
        factor(each.distance),
        f"{factor(each.by_case.min())} – {factor(each.by_case.max())}",
        factor(each.geometry),
        factor(each.features),
        percent(each.first_share),
    )


def _full_row(each: Nearness) -> tuple[str, ...]:
    choices = (str(getattr(each.convention, name)).replace("_", " ") for name, _ in CHOICES)
    low, high = each.medians()[:2]
    return (
        *choices,
        _widths(each),
        factor(each.distance),
        factor(each.geometry),
        factor(each.features),
        f"{low:.0f}–{high:.0f}",
    )


def _widths(each: Nearness) -> str:
    return ", ".join(f"{width:g}" for width in each.widths_mm)


def _spread(reading: Nearness, column: int) -> str:
    counts = reading.counts[:, column]
    return f"{np.median(counts):.0f} ({counts.min():.0f}–{counts.max():.0f})"


def _exponent(exponents: Floats) -> str:
    known = exponents[np.isfinite(exponents)]
    return f"{np.median(known):.2f}" if len(known) else "not measured"


def _decay_row(each: DecayReading) -> tuple[str, ...]:
    cells = (
        f"{mean:.1f} ± {deviation:.1f}"
        for mean, deviation in zip(each.means, each.deviations, strict=True)
    )
    n_cases = " and ".join(str(count) for count in dict.fromkeys(each.n_cases))
    return (f"{each.kind}: {each.label}", *cells, n_cases, factor(each.distance))
