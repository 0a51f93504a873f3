"""Printed: every number the paper gives, with its place.

"Quantitative Spectral Criteria for Cardiac Navigation Sampling Rate using Manifold Harmonics
Analysis".
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

GEOMETRY = (250, 960)
"""Table 1: coefficients for 85 and 90 % of the power of the geometry."""

FEATURES: Mapping[tuple[int, str], tuple[int, int]] = MappingProxyType(
    {
        (1, "small"): (217, 531),
        (1, "medium"): (135, 413),
        (1, "wide"): (18, 163),
        (2, "small"): (104, 238),
        (2, "medium"): (39, 188),
        (2, "wide"): (17, 90),
        (3, "small"): (67, 163),
        (3, "medium"): (17, 76),
        (3, "wide"): (25, 95),
    }
)
"""Table 1: coefficients for 85 and 90 % of the power, by number of foci and size.

The abstract prints 271 for 217.
"""

DECAYS: Mapping[tuple[str, str], tuple[float, float]] = MappingProxyType(
    {
        ("GD", "mha"): (211.2, 89.0),
        ("GD", "qslim"): (173.8, 19.7),
        ("MSE", "mha"): (70.5, 17.0),
        ("MSE", "qslim"): (392.6, 214.1),
    }
)
"""Section 3 and abstract: decay constant τ, points, mean and deviation over seven atria."""

SHARES = ("0.85", "0.9")
"""Table 1, Section 3: 85 and 90 % of the power."""

N_ATRIA = 7
N_VERTICES = 10_000
"""Section 3, Geometry Segmentation: seven CTs; meshes reduced to 10,000 vertices by Qslim."""

N_PLOTTED = 500
"""Section 3, MHA of Atrial Geometry: Figure 1a leaves out coefficients from 500 to 10,000 "because
of their extremely low power"."""

ADEQUATE = 250
"""Section 3: "about 250 coefficients can be an adequate number … in this case"."""


@dataclass(frozen=True)
class Entry:
    """One count of Table 1.

    Attributes
    ----------
    n_foci, size
        0 and ``geometry``, or the number of foci and ``small``, ``medium`` or ``wide``.
    share
        Of the power, as a key of `SHARES`.
    count
        Coefficients, as printed.
    """

    n_foci: int
    size: str
    share: str
    count: int


TABLE_1 = tuple(
    Entry(n_foci, size, share, count)
    for (n_foci, size), counts in [((0, "geometry"), GEOMETRY), *FEATURES.items()]
    for share, count in zip(SHARES, counts, strict=True)
)
"""All 20 counts of Table 1."""

SIZES = ("small", "medium", "wide")

CONTRADICTIONS = (
    (
        "Abstract against Table 1",
        "The abstract gives 271–531 points for small foci, Table 1 gives 217–531 for one small "
        "focus. The table is used here.",
    ),
    (
        "Abstract and Section 3 against Table 1",
        "Counts are said to increase with the size of the focus; in Table 1 they fall from small "
        "to wide for one and two foci.",
    ),
    (
        "Eq. 1",
        "cotan(β + cotan(α)) is printed; cot α + cot β is meant.",
    ),
    (
        "Eq. 1 against its source",
        "The diagonal is minus the sum of the row's other entries after these were divided by "
        "√(|vᵢ||vⱼ|). In the symmetrised operator of Vallet and Lévy it is Wᵢᵢ/|vᵢ|: another "
        "matrix wherever neighbouring dual cells differ.",
    ),
    (
        "Eq. 1, its diagonal",
        "With that diagonal the matrix can have negative eigenvalues where the angles opposite an "
        "edge exceed 180° together and dual cells differ: it is then no Laplacian.",
    ),
    (
        "Section 2, projection",
        "a_k = Σ vᵢ Hᵢᵏ has no areas, while the operator has them.",
    ),
    (
        "Figure 1a against Table 1",
        "Coefficients beyond 500 are said to be of extremely low power, yet 960 are printed for "
        "90 % of the geometry's.",
    ),
)
"""Where the paper contradicts itself or leaves open what was done: place, and what."""
