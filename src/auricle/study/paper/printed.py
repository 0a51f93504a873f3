"""Printed: every number the paper gives, with its place.

"Quantitative Spectral Criteria for Cardiac Navigation Sampling Rate using Manifold Harmonics
Analysis".
"""

from collections.abc import Mapping
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
