"""The shape of a left atrium in numbers: its body, veins, appendage and mitral annulus.

Axes as in DICOM: x to the patient's left, y to posterior, z to superior; the origin is the middle
of the body. Sizes follow textbook anatomy of the adult left atrium in general; they are not
measurements of any patient or cohort.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from auricle.arrays import Floats, Points

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Bump:
    """A low-order swelling of the body: a Legendre polynomial of the angle to an axis.

    Attributes
    ----------
    degree
        Degree of the polynomial.
    axis
        Unit vector, in coordinates where the body is a ball.
    height
        Displacement on the axis, mm; outward if positive.
    """

    degree: int
    axis: Vector
    height: float


@dataclass(frozen=True)
class Tube:
    """A bending tube of changing radius: a pulmonary vein, the appendage or one of its lobes.

    Attributes
    ----------
    ostium
        Where the centre line leaves its parent, mm.
    direction
        Unit vector of the centre line there.
    bend
        How far the tip lies off the straight line, mm.
    length
        From the ostium to the tip, before bending, mm.
    radii
        Radius at equal steps from ostium to tip, mm; linear in between.
    """

    ostium: Vector
    direction: Vector
    bend: Vector
    length: float
    radii: tuple[float, ...]

    def centre_line(self, fractions: Floats) -> Points:
        """Positions at `fractions` of the length, shape (m, 3), mm; negative ones upstream."""
        share = np.asarray(fractions)[:, None]
        along = self.length * share * np.asarray(self.direction)
        aside = np.maximum(share, 0.0) ** 2 * np.asarray(self.bend)
        line: Points = np.asarray(self.ostium) + along + aside
        return line

    def radius(self, fractions: Floats) -> Floats:
        """Radius at `fractions` of the length, shape (m,), mm."""
        return np.interp(fractions, np.linspace(0.0, 1.0, len(self.radii)), self.radii)


@dataclass(frozen=True)
class AtriumShape:
    """All that `auricle.simulation.atrium.atrium` needs to know of one anatomy.

    Attributes
    ----------
    semi_axes
        Of the body along x, y and z, mm.
    bumps
        Swellings of the body.
    veins
        Right superior, right inferior, left superior and left inferior pulmonary vein, cut
        off flat at their tips.
    appendage
        The appendage: stem, neck and main lobe.
    lobes
        Further lobes of the appendage.
    annulus_normal
        Unit vector out of the body across the mitral annulus.
    annulus_depth
        Distance of the annulus' plane from the origin, mm.
    """

    semi_axes: Vector
    bumps: tuple[Bump, ...]
    veins: tuple[Tube, Tube, Tube, Tube]
    appendage: Tube
    lobes: tuple[Tube, ...]
    annulus_normal: Vector
    annulus_depth: float

    @property
    def ostia(self) -> Points:
        """Middles of the vein ostia, in the order of `veins`, shape (4, 3), mm."""
        places: Points = np.array([vein.ostium for vein in self.veins])
        return places

    @classmethod
    def random(cls, rng: np.random.Generator) -> Self:
        """Draw an anatomy about a middling one; every choice is bounded.

        Examples
        --------
        >>> shape = AtriumShape.random(np.random.default_rng(0))
        >>> (shape.ostia[:, 0] > 0).tolist()  # right, right, left, left; x runs to the left
        [False, False, True, True]
        """
        semi_axes = np.array(_SEMI_AXES) * _about_one(0.09, rng) * _about_one(0.06, rng, 3)
        right_superior, right_inferior, left_superior, left_inferior, appendage = (
            _varied(tube, semi_axes, rng) for tube in (*_VEINS, _APPENDAGE)
        )
        normal = _near(_ANNULUS_NORMAL, 0.06, rng)
        reach = float(np.linalg.norm(semi_axes * normal))
        return cls(
            semi_axes=vector(semi_axes),
            bumps=tuple(_random_bump(degree, rng) for degree in _BUMP_DEGREES),
            veins=(right_superior, right_inferior, left_superior, left_inferior),
            appendage=appendage,
            lobes=_random_lobes(appendage, rng),
            annulus_normal=vector(normal),
            annulus_depth=reach * rng.uniform(0.60, 0.68),
        )


def vector(values: ArrayLike) -> Vector:
    """Three plain numbers."""
    x, y, z = np.asarray(values, dtype=np.float64).tolist()
    return x, y, z


_SEMI_AXES = (30.0, 22.0, 27.0)
_ANNULUS_NORMAL = (0.42, -0.52, -0.74)
_BUMP_DEGREES = (2, 3, 3, 4, 4, 5)
_VEIN_RADII = (9.4, 7.8, 7.0, 6.6, 6.4)

# The ostia of these are on the unit ball, to be stretched with the body.
_VEINS = (
    Tube((-0.80, 0.22, 0.56), (-0.86, 0.06, 0.50), (0.0, 2.0, 5.0), 20.0, _VEIN_RADII),
    Tube((-0.80, 0.58, -0.14), (-0.80, 0.56, -0.20), (0.0, 4.0, -4.0), 17.0, _VEIN_RADII),
    Tube((0.70, 0.36, 0.62), (0.72, 0.26, 0.64), (4.0, 3.0, 3.0), 20.0, _VEIN_RADII),
    Tube((0.78, 0.62, -0.04), (0.78, 0.62, -0.10), (3.0, 4.0, -4.0), 17.0, _VEIN_RADII),
)
_APPENDAGE = Tube(
    (0.76, -0.54, 0.36),
    (0.70, -0.40, 0.60),
    (-20.0, -13.0, -18.0),
    26.0,
    (8.6, 7.0, 9.4, 9.8, 8.6, 6.2),
)


def _varied(tube: Tube, semi_axes: Points, rng: np.random.Generator) -> Tube:
    size = _about_one(0.1, rng)
    return replace(
        tube,
        ostium=vector(semi_axes * _near(tube.ostium, 0.06, rng)),
        direction=vector(_near(tube.direction, 0.08, rng)),
        bend=vector(tube.bend + rng.uniform(-4.0, 4.0, 3)),
        length=float(tube.length * _about_one(0.15, rng)),
        radii=tuple(float(size * radius) for radius in tube.radii),
    )


def _random_bump(degree: int, rng: np.random.Generator) -> Bump:
    axis = rng.normal(size=3)
    return Bump(degree, vector(axis / np.linalg.norm(axis)), rng.uniform(-1.2, 1.2))


def _random_lobes(appendage: Tube, rng: np.random.Generator) -> tuple[Tube, ...]:
    """One or two lobes that leave the appendage sideways, beyond its neck."""
    lobes = []
    for fraction in rng.permutation([0.5, 0.72])[: rng.integers(1, 3)]:
        before, middle, after = appendage.centre_line(fraction + np.array([-0.05, 0.0, 0.05]))
        aside = np.cross(after - before, rng.normal(size=3))
        lobes.append(
            Tube(
                ostium=vector(middle),
                direction=vector(aside / np.linalg.norm(aside)),
                bend=vector(rng.uniform(-3.0, 3.0, 3)),
                length=rng.uniform(8.0, 12.0),
                radii=(7.0, 6.6, 5.0),
            )
        )
    return tuple(lobes)


def _near(direction: Vector, spread: float, rng: np.random.Generator) -> Points:
    """Turn `direction` by moving each of its components by `spread` at most."""
    moved: Points = np.asarray(direction) + spread * rng.uniform(-1.0, 1.0, 3)
    return moved / np.linalg.norm(moved)


def _about_one(spread: float, rng: np.random.Generator, size: int | None = None) -> Floats:
    factor: Floats = 1.0 + spread * np.asarray(rng.uniform(-1.0, 1.0, size))
    return factor
