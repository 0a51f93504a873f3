"""Focal feature maps: bumps of known width around chosen vertices, and the modes they need."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from auricle.arrays import PerVertex, Truths
from auricle.errors import InputError
from auricle.surface.field import FieldMap
from auricle.surface.geodesics import distances_from
from auricle.surface.mesh import Mesh

Profile = Literal["gaussian", "disc"]

_NEGLIGIBLE = 1e-9
"""Share of its peak below which a Gaussian counts as 0."""


def focal_map(
    mesh: Mesh, *, centres: Sequence[int], width: float, profile: Profile = "gaussian"
) -> FieldMap:
    """Feature map with a bump of height 1 around each centre.

    With the distance d along the surface from a centre and σ = `width`, the Gaussian bump is
    exp(-d²/2σ²), and 0 where that falls below 1e-9. The bumps are added: their maximum would
    have a crease between two foci, and a crease, not the width, would decide how many modes
    the map needs. Distances are exact: those of the heat method are blurred near the centre,
    which changed maps on 1 mm edges by 2 to 5 % of their standard deviation.

    Parameters
    ----------
    mesh
        The surface.
    centres
        Vertex indices, at least one.
    width
        Standard deviation of the Gaussian, or radius of the disc, mm.
    profile
        ``gaussian``, or ``disc``: 1 up to `width`, 0 beyond.

    Returns
    -------
    FieldMap
        Named ``focal_activity``, without a unit.

    Raises
    ------
    InputError
        If there is no centre, an index is out of range, the width is not positive or the
        profile is unknown.

    Examples
    --------
    >>> from auricle.surface.shapes import rectangle
    >>> sheet = rectangle(width=20.0, height=20.0, n_x=5, n_y=5)
    >>> one = focal_map(sheet, centres=[12], width=5.0).values
    >>> float(one[12]), bool(np.isclose(one[13], np.exp(-0.5)))
    (1.0, True)
    """
    if not len(centres):
        raise InputError("no centres: give at least one vertex")
    if not width > 0:
        raise InputError(f"a width of {width} mm: give a positive one")
    if profile not in ("gaussian", "disc"):
        raise InputError(f"profile {profile!r}: choose gaussian or disc")
    bump = _gaussian if profile == "gaussian" else _disc
    values = np.sum([bump(mesh, centre, width) for centre in centres], axis=0)
    return FieldMap(mesh, values, name="focal_activity")


def random_foci(
    mesh: Mesh,
    *,
    count: int,
    rng: np.random.Generator,
    separation: float,
    allowed: Truths | None = None,
) -> tuple[int, ...]:
    """Vertices at random, evenly over the area, no two closer along the surface than allowed.

    Parameters
    ----------
    mesh
        The surface.
    count
        How many; the first ones drawn do not depend on how many follow.
    rng
        Source of randomness.
    separation
        Smallest distance along the surface between two of them, mm; 0 asks only that they
        be different vertices.
    allowed
        Where they may lie, shape (n,); everywhere by default.

    Returns
    -------
    tuple of int
        Vertex indices in the order drawn.

    Raises
    ------
    InputError
        If so many do not fit (each stays where it was drawn, so a cleverer arrangement may),
        or a number is negative.
    """
    if count < 0 or separation < 0:
        raise InputError(f"{count} foci {separation} mm apart: give numbers of at least 0")
    chance = np.bincount(
        mesh.faces.ravel(), np.repeat(mesh.face_areas, 3), minlength=mesh.n_vertices
    )
    if allowed is not None:
        chance = np.where(allowed, chance, 0.0)
    drawn: list[int] = []
    while len(drawn) < count:
        if not chance.any():
            raise InputError(
                f"only {len(drawn)} of {count} foci fit {separation} mm apart: "
                "ask for fewer or closer ones"
            )
        drawn.append(int(rng.choice(mesh.n_vertices, p=chance / chance.sum())))
        chance[_closer_than(mesh, drawn[-1], separation)] = 0.0
    return tuple(drawn)


def gaussian_modes_for_power(*, area: float, width: float, share: float) -> float:
    """Number of modes, the constant one apart, that hold a share of a Gaussian focus' power.

    k = -A·ln(1 - p)/(4πσ²) for a focus much narrower than the surface: the focus' energy at
    wavenumber κ goes as exp(-σ²κ²); modes are evenly many over κ², by Weyl's law k = Aκ²/4π;
    so the share of the energy beyond κ is exp(-σ²κ²) = 1 - p. Foci that do not overlap need
    no more modes than one.

    Parameters
    ----------
    area
        Of the surface, mm².
    width
        Standard deviation of the focus, mm.
    share
        Power to be held, strictly between 0 and 1; the best nRMSE is √(1 - share).

    Returns
    -------
    float
        Not rounded.

    Raises
    ------
    InputError
        If an argument is out of range.

    Examples
    --------
    >>> round(gaussian_modes_for_power(area=11310.0, width=4.0, share=0.9), 1)
    129.5
    """
    _check_power(area, width, share)
    return float(-area * np.log1p(-share) / (4.0 * np.pi * width**2))


def gaussian_width_for_modes(*, area: float, modes: float, share: float) -> float:
    """Width of the narrowest Gaussian focus of which `modes` modes hold a share of the power, mm.

    The inverse of `gaussian_modes_for_power`, with the same conditions and errors.

    Examples
    --------
    >>> width = gaussian_width_for_modes(area=12000.0, modes=200.0, share=0.9)
    >>> round(gaussian_modes_for_power(area=12000.0, width=width, share=0.9), 9)
    200.0
    """
    _check_power(area, modes, share)
    return float(np.sqrt(-area * np.log1p(-share) / (4.0 * np.pi * modes)))


def _gaussian(mesh: Mesh, centre: int, width: float) -> PerVertex:
    reach = width * np.sqrt(-2.0 * np.log(_NEGLIGIBLE))
    distance = distances_from(mesh, centre, reach=reach)
    bump: PerVertex = np.exp(-0.5 * (distance / width) ** 2)
    return bump


def _disc(mesh: Mesh, centre: int, width: float) -> PerVertex:
    inside = np.isfinite(distances_from(mesh, centre, reach=width))
    return inside.astype(np.float64)


def _closer_than(mesh: Mesh, centre: int, separation: float) -> Truths:
    """Vertices nearer to `centre` than the separation, and `centre` itself."""
    closer: Truths = np.arange(mesh.n_vertices) == centre
    if separation > 0:
        closer = closer | (distances_from(mesh, centre, reach=separation) < separation)
    return closer


def _check_power(area: float, scale: float, share: float) -> None:
    if not (area > 0 and scale > 0):
        raise InputError(f"an area of {area} with {scale}: give positive numbers")
    if not 0 < share < 1:
        raise InputError(f"a power share of {share}: give more than 0 and less than 1")
