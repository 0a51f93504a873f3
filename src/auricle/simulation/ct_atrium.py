"""The left atrium of a phantom: its anatomy, and the true distance to its endocardium."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from auricle.arrays import Floats, Points
from auricle.simulation.anatomy import AtriumShape, Tube, Vector, vector
from auricle.simulation.atrium import LOBE_BLEND, VEIN_BLEND, body_distance, tube_fractions
from auricle.simulation.ct_block import Block, Box, Grid
from auricle.simulation.ct_shapes import Sweep, sweep, tree
from auricle.simulation.implicit import Coordinates, half_space_distance, smooth_minimum

STUB = 12.0
"""Length of a vein that belongs to the atrium, from its ostium along the centre line, mm."""
_REACH = VEIN_BLEND + 4.0
_STEP = 1.5
"""mm between the nodes of a tube."""
_SLOPE_STEP = 0.05
"""mm between the places of a difference quotient."""
_LEAST_SLOPE = 0.5
"""In the crease between two parts the field has no direction: its slope is taken to be this."""
_SIZES = (0.9, 1.17)
"""Least and greatest size of a patient's atrium: 60 to 160 ml with the spread of shapes."""


@dataclass(frozen=True)
class PhantomAtrium:
    """A left atrium about the origin, LPS mm: body, appendage and vein stubs.

    Attributes
    ----------
    shape
        Body, appendage and annulus.
    veins
        The pulmonary veins of this patient, cranial before caudal, right before left.
    """

    shape: AtriumShape
    veins: tuple[Tube, ...]

    @property
    def box(self) -> Box:
        """Where it lies."""
        reach = np.asarray(self.shape.semi_axes) * 1.1
        boxes = [sweep.box for sweep in (*self._stubs, *self._lobes)]
        low = np.min([-reach, *(low for low, _ in boxes)], axis=0)
        return low, np.max([reach, *(high for _, high in boxes)], axis=0)

    @property
    def annulus_centre(self) -> Points:
        """Middle of the mitral annulus, mm."""
        return self.shape.annulus_depth * self.annulus_normal

    @property
    def annulus_normal(self) -> Points:
        """Unit vector across the annulus to the ventricle."""
        return np.asarray(self.shape.annulus_normal)

    @property
    def annulus_radius(self) -> float:
        """Radius of the mitral orifice: three quarters of the flat of the body, mm."""
        semi_axes = np.asarray(self.shape.semi_axes)
        height = self.shape.annulus_depth / np.linalg.norm(semi_axes * self.annulus_normal)
        return float(0.72 * np.cbrt(semi_axes.prod()) * np.sqrt(1.0 - height**2))

    def distance(self, block: Block) -> Grid:
        """Implicit distance at voxels: zero on the endocardium, its slope 1 but for the seams."""
        return self._field(
            block.coordinates, lambda tube: tube.distance(block).astype(np.float64)
        ).astype(np.float32)

    def distance_at(self, points: Points) -> Floats:
        """Signed distance to the endocardium, shape (m,), mm, negative inside.

        The distance along the field's gradient to its zero, found by Newton steps: within a few
        per cent of the distance to the nearest point out to 2 mm, and a lower bound further off.
        """
        field: Floats = self._field_at(points)
        slope = self._slope_at(points)
        steepness = np.maximum(np.linalg.norm(slope, axis=1), _LEAST_SLOPE)
        way = slope / steepness[:, None]
        distance: Floats = field / steepness
        near = np.abs(distance) < 4.0
        for _ in range(3):
            rest = self._field_at(points[near] - distance[near, None] * way[near])
            distance[near] += rest / steepness[near]
        return distance

    def _slope_at(self, points: Points) -> Points:
        columns = [
            self._field_at(points + step) - self._field_at(points - step)
            for step in np.eye(3) * _SLOPE_STEP
        ]
        slope: Points = np.column_stack(columns) / (2.0 * _SLOPE_STEP)
        return slope

    def _field_at(self, points: Points) -> Floats:
        x, y, z = np.asarray(points, dtype=np.float64).T
        return self._field((x, y, z), lambda tube: tube.distance_at(points))

    def _field(self, at: Coordinates, distance_to: Callable[[Sweep], Floats]) -> Floats:
        field = body_distance(self.shape, at)
        for vein, stub in zip(self.veins, self._stubs, strict=True):
            cut, tangent = stub_end(vein)
            tube = np.maximum(distance_to(stub), half_space_distance(at, cut, tangent))
            field = smooth_minimum(field, tube, blend=VEIN_BLEND)
        for lobe in self._lobes:
            field = smooth_minimum(field, distance_to(lobe), blend=LOBE_BLEND)
        return field

    @cached_property
    def _stubs(self) -> tuple[Sweep, ...]:
        return tuple(tube_sweep(vein) for vein in self.veins)

    @cached_property
    def _lobes(self) -> tuple[Sweep, ...]:
        return tuple(tube_sweep(tube) for tube in (self.shape.appendage, *self.shape.lobes))


def tube_sweep(tube: Tube, *, reach: float = _REACH) -> Sweep:
    """The tube from half a radius upstream of its ostium to its tip."""
    every = tube_fractions(tube)
    fractions = np.linspace(every[0], 1.0, max(int(np.ptp(every) * tube.length / _STEP), 4))
    return sweep(tube.centre_line(fractions), tube.radius(fractions), reach=reach)


def stub_end(vein: Tube) -> tuple[Points, Points]:
    """Where the stub of a vein is cut: a point of the plane and its normal, downstream."""
    fractions = np.linspace(0.0, 1.0, 101)
    line = vein.centre_line(fractions)
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = float(np.interp(STUB, lengths, fractions))
    before, cut, after = vein.centre_line(at + np.array([-0.01, 0.0, 0.01]))
    return cut, (after - before) / np.linalg.norm(after - before)


def patient_atrium(
    rng: np.random.Generator, *, veins: str = "four", scale: float = 1.0
) -> PhantomAtrium:
    """A random left atrium with four veins, a common left trunk or a fifth, right middle vein.

    Parameters
    ----------
    rng
        Source of the anatomy.
    veins
        "four", "common_left" or "fifth".
    scale
        Of everything, the annulus included, besides the patient's own size.
    """
    shape = AtriumShape.random(rng)
    size = np.clip(np.exp(rng.normal(0.03, 0.075)), *_SIZES)
    shape = scaled_shape(shape, float(scale * size))
    right_superior, right_inferior, left_superior, left_inferior = shape.veins
    variants: dict[str, tuple[Tube, ...]] = {
        "four": shape.veins,
        "common_left": (
            right_superior,
            right_inferior,
            _trunk(left_superior, left_inferior, shape.semi_axes),
        ),
        "fifth": (
            _turned(right_superior, (0.0, -0.15, 0.3)),
            _middle(right_superior, right_inferior, shape.semi_axes),
            _turned(right_inferior, (0.0, 0.15, -0.3)),
            *shape.veins[2:],
        ),
    }
    return PhantomAtrium(shape, variants[veins])


def scaled_shape(shape: AtriumShape, scale: float) -> AtriumShape:
    """The same anatomy, larger or smaller."""
    right_superior, right_inferior, left_superior, left_inferior = (
        _scaled(vein, scale) for vein in shape.veins
    )
    return AtriumShape(
        semi_axes=vector(scale * np.asarray(shape.semi_axes)),
        bumps=tuple(replace(bump, height=scale * bump.height) for bump in shape.bumps),
        veins=(right_superior, right_inferior, left_superior, left_inferior),
        appendage=_scaled(shape.appendage, scale),
        lobes=tuple(_scaled(lobe, scale) for lobe in shape.lobes),
        annulus_normal=shape.annulus_normal,
        annulus_depth=scale * shape.annulus_depth,
    )


def pulmonary_tree(veins: tuple[Tube, ...], rng: np.random.Generator) -> Sweep:
    """The veins in full length, each with two branches that taper into the lung."""
    tubes = []
    for vein in veins:
        tubes.append(tube_sweep(vein, reach=4.0))
        before, tip = vein.centre_line(np.array([0.97, 1.0]))
        ahead = (tip - before) / np.linalg.norm(tip - before)
        aside = np.cross(ahead, rng.normal(size=3))
        aside /= np.linalg.norm(aside)
        tubes += [_branch(tip, ahead + sign * 0.5 * aside, vein.radii[-1], rng) for sign in (-1, 1)]
    return tree(tubes)


def _branch(start: Points, way: Points, radius: float, rng: np.random.Generator) -> Sweep:
    share = np.linspace(0.0, 1.0, 12)
    straight = start + 36.0 * share[:, None] * way / np.linalg.norm(way)
    bent = straight + share[:, None] ** 2 * rng.uniform(-7.0, 7.0, 3)
    return sweep(bent, radius * np.linspace(0.85, 0.3, 12))


def _scaled(tube: Tube, scale: float) -> Tube:
    return replace(
        tube,
        ostium=vector(scale * np.asarray(tube.ostium)),
        bend=vector(scale * np.asarray(tube.bend)),
        length=scale * tube.length,
        radii=tuple(scale * radius for radius in tube.radii),
    )


def _between(first: Tube, second: Tube, semi_axes: Vector) -> Tube:
    """The tube midway between two, from the ellipsoid of the body, with the radii of the first."""
    way = np.add(first.direction, second.direction)
    middle = np.add(first.ostium, second.ostium) / 2
    return replace(
        first,
        ostium=vector(middle / np.linalg.norm(middle / np.asarray(semi_axes))),
        direction=vector(way / np.linalg.norm(way)),
        bend=vector(np.add(first.bend, second.bend) / 2),
        length=(first.length + second.length) / 2,
    )


def _trunk(first: Tube, second: Tube, semi_axes: Vector) -> Tube:
    """A vein that carries the flow of both: its section is as large as theirs together."""
    pairs = zip(first.radii, second.radii, strict=True)
    radii = tuple(float(np.hypot(a, b)) for a, b in pairs)
    return replace(_between(first, second, semi_axes), radii=radii)


def _middle(first: Tube, second: Tube, semi_axes: Vector) -> Tube:
    """A small vein between two."""
    middle = _between(first, second, semi_axes)
    return replace(middle, radii=tuple(0.45 * radius for radius in middle.radii))


def _turned(tube: Tube, aside: Vector) -> Tube:
    """A vein that makes room for another."""
    way = np.add(tube.direction, aside)
    return replace(tube, direction=vector(way / np.linalg.norm(way)))
