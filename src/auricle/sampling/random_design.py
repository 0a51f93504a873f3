"""Random sampling: points drawn uniformly over the area, as an unplanned study's at best."""

import numpy as np

from auricle.arrays import Integers, Truths
from auricle.sampling.candidates import candidates
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites


def random_sampling(
    chamber: Chamber,
    count: int,
    *,
    rng: np.random.Generator,
    allowed: Truths | None = None,
    existing: Sites | None = None,
) -> Integers:
    """Vertices drawn one after the other, each with a chance in proportion to its area.

    Without replacement and nested: from a generator in the same state the first points of a
    longer design are a shorter one. Existing points are not drawn again and have no other effect.

    Parameters
    ----------
    chamber
        Where to sample.
    count
        How many points to draw.
    rng
        Where chance comes from.
    allowed
        Which vertices may be chosen, shape (n,); only accessible ones ever are.
    existing
        Points taken already.

    Returns
    -------
    Integers
        Vertex indices in the order drawn, shape (count,).

    Raises
    ------
    InputError
        If fewer than `count` vertices are allowed.

    References
    ----------
    Efraimidis and Spirakis 2006, "Weighted random sampling with a reservoir": waiting times that
    are exponential with rates as the weights end in the order of such draws.
    """
    choice = np.flatnonzero(candidates(chamber, count, allowed=allowed, existing=existing))
    waiting = rng.exponential(size=chamber.mesh.n_vertices)[choice] / chamber.basis.areas[choice]
    drawn: Integers = choice[np.argsort(waiting, kind="stable")[:count]]
    return drawn
