"""Tables: the numbers of a case in rows of text, and its spectrum in rows of numbers."""

import csv
import io
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from auricle.report.labels import unit_of
from auricle.report.wording import number, percent, printable, signal_words
from auricle.sampling.criteria import SHARES, Criterion, Need, Shell, need
from auricle.spectral.weyl import weyl_wavelength
from auricle.study.result import CaseResult, Signal
from auricle.surface.soundness import Soundness

DAGGER = "†"
"""Marks what asks for more harmonics than the mesh resolves."""

_NOTHING = "–"


@dataclass(frozen=True)
class Table:
    """A table of text.

    Attributes
    ----------
    caption
        What it shows, with the unit if one holds for all of it.
    head
        Names of the columns.
    rows
        Cells, as many a row as there are columns; the first names the row.
    """

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Quantity:
    """One of the numbers of a `Need`, and how it is written.

    Attributes
    ----------
    attribute
        Its name in `Need`.
    caption
        What it is, with its unit.
    rises
        Whether it grows with the number of harmonics; else it falls.
    digits
        Significant digits shown; 0 shows a whole number in full.
    """

    attribute: str
    caption: str
    rises: bool = True
    digits: int = 0

    def of(self, found: Need) -> str:
        """The number a need holds."""
        value = getattr(found, self.attribute)
        return number(value, digits=self.digits) if self.digits else f"{value:,}"

    def text(self, criterion: Criterion, bound: Need) -> str:
        """The number a criterion asks for, or that it lies beyond what `bound` asks for."""
        if criterion.need is None:
            return (">" if self.rises else "<") + self.of(bound)
        return self.of(criterion.need) + ("" if criterion.need.trusted else DAGGER)


HARMONICS = Quantity("n_modes", "Harmonics that hold the share of power, the constant one counted")
LEAST = Quantity("n_least", "Points that sampling theory demands at least")
PLANNED = Quantity("n_planned", "Points to plan, evenly spread")
UNPLANNED = Quantity("n_unplanned", "Points to plan, taken wherever the catheter happens to be")
SPACING = Quantity(
    "planned_spacing_mm", "Distance between evenly spread points, mm", rises=False, digits=2
)
DENSITY = Quantity("density_per_cm2", "Least density: harmonics per cm²", digits=2)
NYQUIST = Quantity(
    "nyquist_spacing_mm", "Nyquist spacing: half the wavelength, mm", rises=False, digits=2
)
WAVELENGTH = Quantity("wavelength_mm", "Equivalent wavelength, mm", rises=False, digits=2)


def signals_of(result: CaseResult) -> tuple[Signal, ...]:
    """Every map of a case: those measured, those simulated, and the geometry last."""
    return (*result.fields, *result.simulated, result.geometry)


def bound_of(result: CaseResult) -> Need:
    """What all the harmonics solved for ask for: a need that is not reached asks for more."""
    shell = Shell(result.shell_area_mm2, result.analyzed.area_mm2, result.n_shell_vertices)
    return need(result.certificate.n_modes, shell)


def criteria_of(signal: Signal, *, with_constant: bool = False) -> tuple[Criterion, ...]:
    """The readings of a map without (or with) the constant harmonic, by share."""
    return tuple(each for each in signal.criteria if each.with_constant == with_constant)


def spread_of(signal: Signal, result: CaseResult) -> float:
    """Area-weighted standard deviation of a map on the shell, in its unit: errors relate to it."""
    return math.sqrt(signal.spectrum.varying_total / result.shell_area_mm2)


def points_table(result: CaseResult) -> Table:
    """Points to plan for the maps at each error, evenly spread / not."""
    bound = bound_of(result)
    return _by_share(
        (*result.fields, *result.simulated) or (result.geometry,),
        "Points to plan: evenly spread / taken wherever the catheter happens to be",
        [f"error {percent(math.sqrt(1 - share))}" for share in SHARES],
        lambda _, each: f"{PLANNED.text(each, bound)} / {UNPLANNED.text(each, bound)}",
        readings=lambda signal: signal.for_error,
    )


def quantity_table(result: CaseResult, quantity: Quantity, *, with_constant: bool = False) -> Table:
    """One quantity for every map at each share of the power, the paper's Table 1 among them."""
    bound = bound_of(result)
    constant = "; the constant harmonic's power counted" if with_constant else ""
    return _by_share(
        signals_of(result),
        quantity.caption + constant,
        [_share_head(share, with_constant=with_constant) for share in SHARES],
        lambda _, each: quantity.text(each, bound),
        lambda signal: criteria_of(signal, with_constant=with_constant),
    )


def measured_error_table(result: CaseResult) -> Table:
    """Error measured on the real surface, where sampled, at the count of each share."""
    return _by_share(
        signals_of(result),
        "Measured error of the map rebuilt from those harmonics, where it was sampled, "
        "of its standard deviation",
        [_share_head(share) for share in SHARES],
        _measured_error,
    )


def signals_table(result: CaseResult) -> Table:
    """What is known of each map besides its criteria."""
    return Table(
        "The maps",
        (
            "Map",
            "Unit",
            "Standard deviation",
            "Area not sampled",
            "Power in the harmonics solved",
            "Share of the constant harmonic",
            "Harmonics for 90 %, closed form",
        ),
        tuple(_signal_row(signal, result) for signal in signals_of(result)),
    )


def geometry_table(result: CaseResult) -> Table:
    """How far the surface rebuilt from few harmonics lies from the analysed one."""
    return Table(
        "Distance of the rebuilt surface from the analysed one, mm",
        ("Harmonics", "Mean (GD)", "Root mean square", "95th percentile", "Largest (Hausdorff)"),
        tuple(
            (
                f"{error.n_modes:,}",
                number(error.gd_mean_mm),
                number(error.rms_mm),
                number(error.gd_percentile_95_mm),
                number(error.hausdorff_mm),
            )
            for error in result.geometry_errors
        ),
    )


def surface_table(result: CaseResult) -> Table:
    """Size and soundness of the surface as cleaned and as analysed."""
    return Table(
        "Counts and measures",
        ("", "Cleaned", "Analysed"),
        tuple(
            (name, text(result.original), text(result.analyzed)) for name, text in _SOUNDNESS_ROWS
        ),
    )


def spectrum_csv(result: CaseResult) -> str:
    """The spectrum of every map as CSV, one row a harmonic, numbers at full precision.

    Columns: ``harmonic`` (from 1, the constant one), ``eigenvalue_per_mm2``, ``wavelength_mm``
    (Weyl's, as in the criteria), and for each map, by its name: ``share_…`` (its power over that
    of all harmonics but the constant; 0 for the constant), ``cumulative_…`` (the sum of these so
    far) and ``cumulative_with_constant_…`` (power so far over all power, the constant's included).
    """
    signals = (result.geometry, *result.fields, *result.simulated)
    counts = range(1, len(result.geometry.spectrum.power) + 1)
    columns: dict[str, Iterable[object]] = {
        "harmonic": counts,
        "eigenvalue_per_mm2": result.geometry.spectrum.eigenvalues.tolist(),
        "wavelength_mm": [weyl_wavelength(k, area=result.shell_area_mm2) for k in counts],
    }
    for key, signal in zip(_unique_keys(signals), signals, strict=True):
        spectrum = signal.spectrum
        shares = spectrum.power / spectrum.varying_total
        shares[: spectrum.n_constant] = 0.0
        columns[f"share_{key}"] = shares.tolist()
        columns[f"cumulative_{key}"] = spectrum.cumulative().tolist()
        columns[f"cumulative_with_constant_{key}"] = spectrum.cumulative(
            with_constant=True
        ).tolist()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return text.getvalue()


def _by_share(
    signals: Iterable[Signal],
    caption: str,
    head: list[str],
    cell: Callable[[Signal, Criterion], str],
    readings: Callable[[Signal], Iterable[Criterion]] = criteria_of,
) -> Table:
    rows = tuple(
        (signal_words(signal), *(cell(signal, each) for each in readings(signal)))
        for signal in signals
    )
    return Table(caption, ("Map", *head), rows)


def _share_head(share: float, *, with_constant: bool = False) -> str:
    """A share of power and, unless the constant's power blurs it, the error it stands for."""
    power = f"{percent(share)} of power"
    return power if with_constant else f"{power}, error {percent(math.sqrt(1 - share))}"


def _measured_error(signal: Signal, criterion: Criterion) -> str:
    if criterion.need is None:
        return _NOTHING
    return percent(float(signal.nrmse[criterion.need.n_modes - 1]))


def _signal_row(signal: Signal, result: CaseResult) -> tuple[str, ...]:
    spectrum = signal.spectrum
    expected = signal.details.get("expected_modes_90")
    unit = "none" if signal.kind == "simulated" else printable(unit_of(signal.field))
    return (
        signal_words(signal),
        unit or "not stated",
        number(spread_of(signal, result)),
        percent(signal.unsampled_share) if signal.unsampled_share else "none",
        percent(float(spectrum.cumulative()[-1])),
        percent(spectrum.constant_power / spectrum.total),
        _NOTHING if expected is None else number(expected),
    )


def _volume(found: Soundness) -> str:
    return "open" if found.volume_mm3 is None else f"{number(found.volume_mm3 / 1000)} ml"


_SOUNDNESS_ROWS: tuple[tuple[str, Callable[[Soundness], str]], ...] = (
    ("Vertices", lambda found: f"{found.n_vertices:,}"),
    ("Triangles", lambda found: f"{found.n_faces:,}"),
    ("Area", lambda found: f"{number(found.area_mm2 / 100)} cm²"),
    ("Volume", _volume),
    ("Pieces", lambda found: f"{found.n_pieces:,}"),
    ("Holes", lambda found: f"{found.n_holes:,}"),
    ("Handles (genus)", lambda found: _NOTHING if found.genus is None else f"{found.genus:,}"),
    ("Median edge", lambda found: f"{number(found.edge_length_mm)} mm"),
    ("Slivers (quality below 0.05)", lambda found: f"{found.n_slivers:,}"),
    (
        "Quality of the worst triangle (1: equilateral)",
        lambda f: number(f.smallest_quality, digits=2),
    ),
    ("Negative cotangent weights", lambda found: percent(found.negative_weight_share)),
)


def _unique_keys(signals: Iterable[Signal]) -> Iterator[str]:
    """Names of the maps, told apart by a number where two are the same."""
    taken: set[str] = set()
    for signal in signals:
        name = printable(signal.name)
        key, copies = name, 1
        while key in taken:
            copies += 1
            key = f"{name}_{copies}"
        taken.add(key)
        yield key
