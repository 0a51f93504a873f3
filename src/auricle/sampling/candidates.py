"""Candidates: the vertices a design may choose from."""

import numpy as np

from auricle.arrays import Truths
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites


def candidates(
    chamber: Chamber, count: int, *, allowed: Truths | None = None, existing: Sites | None = None
) -> Truths:
    """Which vertices are accessible, allowed and not yet sampled, shape (n,).

    Raises
    ------
    InputError
        If `allowed` is not one truth a vertex, `count` is less than 1, or there are fewer
        candidates than that.
    """
    chosen = chamber.accessible.copy()
    if allowed is not None:
        region = np.asarray(allowed)
        if region.shape != chosen.shape or region.dtype != np.bool_:
            raise InputError("`allowed` must be one truth a vertex of the chamber")
        chosen &= region
    if existing is not None:
        chosen[existing.corners[existing.weights == 1.0]] = False
    if count < 1:
        raise InputError(f"{count} points asked for: ask for at least one")
    if count > chosen.sum():
        raise InputError(
            f"{count} points asked for and {int(chosen.sum())} vertices allowed: "
            "ask for fewer, allow more of the surface or refine its mesh"
        )
    return chosen
