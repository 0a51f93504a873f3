"""Second opinions: sampling densities that others have recommended or used.

References
----------
Williams et al., "Local activation time sampling density for atrial tachycardia contact mapping:
how much is enough?", Europace 2018. Their optimal density is the highest at which further samples
still lowered the error of an interpolated activation map markedly (a knee), with random samples.

Nairn et al., Front Physiol 2020, 575846: density at which bipolar voltage was mapped.

Fill distances, the farthest from a sample that a system colours, as reported in the clinical
studies of Authorea preprints 513229 and 470826 for CARTO 3, EnSite NavX and Rhythmia: settings in
use, not recommendations of the vendors.

Not verified: King et al. on sampling for atrial fibrillation; a journal version of Sanromán et
al., CinC 2015; the resolutions in mm of Rappel and Narayan, Chaos 2013, and Roney et al., Circ
Arrhythm Electrophysiol 2017, which the excerpts at hand do not state and which are left out here.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from auricle.errors import InputError
from auricle.sampling.criteria import lattice_spacing


@dataclass(frozen=True)
class PublishedDensity:
    """A density that a study recommends or used.

    Attributes
    ----------
    source
        Study, year.
    mechanism
        Of what kind of map.
    setting
        In what: patients, animals, simulation.
    mean_per_cm2, deviation_per_cm2
        Mean and standard deviation over the study's cases, samples per cm².
    """

    source: str
    mechanism: str
    setting: str
    mean_per_cm2: float
    deviation_per_cm2: float


@dataclass(frozen=True)
class SecondOpinion:
    """What a published density means on a surface.

    Attributes
    ----------
    published
        The density.
    n_samples, n_low, n_high
        Number of samples at its mean, and one standard deviation below and above.
    spacing_mm
        Distance of neighbours if `n_samples` form a triangular lattice.
    """

    published: PublishedDensity
    n_samples: int
    n_low: int
    n_high: int
    spacing_mm: float


_ROUNDING = 1e-9
_WILLIAMS = "Williams et al. 2018"
_PATIENTS = "left atrial tachycardia, patients"
_SHEET = "simulated sheet of 4 × 4 cm"

DENSITIES = (
    PublishedDensity(_WILLIAMS, "focal", _PATIENTS, 0.67, 0.17),
    PublishedDensity(_WILLIAMS, "macro-reentry", _PATIENTS, 1.05, 0.32),
    PublishedDensity(_WILLIAMS, "localized reentry", _PATIENTS, 1.23, 0.26),
    PublishedDensity(_WILLIAMS, "focal", _SHEET, 1.09, 0.14),
    PublishedDensity(_WILLIAMS, "reentry", _SHEET, 1.44, 0.49),
    PublishedDensity(_WILLIAMS, "spiral wave", _SHEET, 1.50, 0.34),
    PublishedDensity(_WILLIAMS, "right atrium before ablation", "pigs", 0.45, 0.13),
    PublishedDensity("Nairn et al. 2020", "bipolar voltage", "patients", 20.0, 10.0),
)
"""Published densities, as the studies state them."""

FILL_DISTANCES_MM: Mapping[str, float] = MappingProxyType(
    {
        "CARTO 3, fill threshold": 15.0,
        "CARTO 3, colour interpolation": 23.0,
        "CARTO 3, fill threshold (another group)": 5.0,
        "EnSite NavX, exterior": 20.0,
        "EnSite NavX, interior": 7.0,
        "Rhythmia": 5.0,
    }
)
"""Distance from a sample up to which maps were coloured, mm."""


def second_opinions(accessible_area: float) -> tuple[SecondOpinion, ...]:
    """How many samples each of `DENSITIES` means on an area, mm².

    Raises
    ------
    InputError
        If the area is not positive.

    Examples
    --------
    On 126 cm² activation maps of tachycardias would take 84 to 155 samples:

    >>> opinions = second_opinions(12_600.0)
    >>> opinions[0].n_samples, opinions[2].n_samples
    (85, 155)
    """
    if not accessible_area > 0:
        raise InputError(f"an area of {accessible_area} mm²: give a positive one")
    return tuple(_opinion(published, accessible_area) for published in DENSITIES)


def samples_for_fill(fill_distance: float, *, accessible_area: float) -> int:
    """Least number of samples in a triangular lattice that leave no place farther than this.

    In a triangular lattice of spacing s the farthest place is s/√3 from a sample.

    Examples
    --------
    >>> samples_for_fill(15.0, accessible_area=12_600.0)
    22
    """
    if not (fill_distance > 0 and accessible_area > 0):
        raise InputError(f"{fill_distance} mm on {accessible_area} mm²: give positive numbers")
    spacing = math.sqrt(3) * fill_distance
    return math.ceil(2 * accessible_area / (math.sqrt(3) * spacing**2) - _ROUNDING)


def _opinion(published: PublishedDensity, area: float) -> SecondOpinion:
    deviation = published.deviation_per_cm2
    low, middle, high = (
        math.ceil((published.mean_per_cm2 + offset) * area / 100 - _ROUNDING)
        for offset in (-deviation, 0.0, deviation)
    )
    return SecondOpinion(published, middle, low, high, lattice_spacing(middle, area=area))
