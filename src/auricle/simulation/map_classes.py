"""Classes of maps: kinds of cardiac map, each as a way to draw one, with what its spectrum does."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from auricle.arrays import Floats, Truths
from auricle.errors import InputError
from auricle.simulation.activation import activation_map
from auricle.simulation.foci import focal_map, random_foci
from auricle.simulation.reentry import macro_reentry, rotor_pair
from auricle.simulation.scar import ScarTissue, scar_map
from auricle.surface.fast_marching import FastMarching
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh

Parameters = Mapping[str, float]

TAIL_EXPONENTS: Mapping[str, float] = MappingProxyType(
    {
        "jump": 0.5,
        "phase singularity": 1.0,
        "crease": 1.5,
        "cone": 2.0,
        "smooth": np.inf,
    }
)
"""How fast the share of power beyond k harmonics falls, k^-s, by a map's worst singularity.

With power |f̂(κ)|² at the wavenumber κ and k = Aκ²/4π (Weyl), in two dimensions: across a jump
along a line |f̂|² ~ κ^-3, hence a tail κ^-1 = k^-½; across a crease κ^-5, k^-3/2; about a singular
point of exp(iφ) |f̂|² ~ κ^-4, k^-1; about a cone's tip κ^-6, k^-2. A smooth map's tail falls faster
than any power. To halve the error takes 2^(2/s) times the harmonics: 16, 4, 2.5, 2.
"""


@dataclass(frozen=True)
class MapClass:
    """One kind of map.

    Attributes
    ----------
    name
        Its key in `MAP_CLASSES`.
    title
        What it is, in a few words.
    singularity
        Which of `TAIL_EXPONENTS` rules its spectrum, in the end.
    parameters
        Defaults, by names that end in their unit; counts have none. They are middling clinical
        values chosen by the authors, not those of a cohort.
    drawing
        Draws a map: (mesh, rng, allowed, parameters) → `FieldMap`.
    """

    name: str
    title: str
    singularity: str
    parameters: Parameters
    drawing: Callable[[Mesh, np.random.Generator, Truths | None, Parameters], FieldMap]

    @property
    def tail_exponent(self) -> float:
        """The exponent s of the tail k^-s; infinite for a smooth map."""
        return TAIL_EXPONENTS[self.singularity]

    @property
    def is_circular(self) -> bool:
        """Whether the map's values are times within a cycle, to be fitted as cosine and sine."""
        return "cycle_length_ms" in self.parameters

    def settings(self, **changed: float) -> Parameters:
        """The parameters with some of them changed.

        Raises
        ------
        InputError
            If one is unknown or not a positive number.
        """
        for name, value in changed.items():
            if name not in self.parameters:
                have = ", ".join(self.parameters)
                raise InputError(f"{self.name} has no parameter {name!r}: choose among {have}")
            if not (value > 0 or (value == 0 and name in _MAY_BE_ZERO)) or not np.isfinite(value):
                raise InputError(f"{name} = {value}: give a positive number")
        return MappingProxyType({**self.parameters, **changed})

    def draw(
        self,
        mesh: Mesh,
        rng: np.random.Generator,
        *,
        allowed: Truths | None = None,
        **changed: float,
    ) -> FieldMap:
        """A map of this class.

        Parameters
        ----------
        mesh
            Closed if the class is circular, in one piece.
        rng
            Source of randomness.
        allowed
            Where foci, cores and scars may be centred, shape (n,); everywhere by default.
        **changed
            Parameters other than their defaults.

        Returns
        -------
        FieldMap
            Values at all vertices. Of a circular class: times in [0, cycle_length_ms); use
            `columns` to compare or project them.

        Raises
        ------
        InputError
            If a parameter is unknown or out of range, or the foci do not fit.
        SurfaceError
            If the mesh is not fit for the class.

        Examples
        --------
        >>> from auricle.surface.shapes import icosphere
        >>> ball = icosphere(radius=30.0, subdivisions=3)
        >>> times = MAP_CLASSES["activation"].draw(ball, np.random.default_rng(1), foci=1)
        >>> times.unit, float(times.values.min())
        ('ms', 0.0)
        """
        return self.drawing(mesh, rng, allowed, self.settings(**changed))

    def columns(self, field: FieldMap, **changed: float) -> Floats:
        """What of a map is to be reconstructed: its values, or cosine and sine of its phase.

        Shape (n,) or, for a circular class, (n, 2).
        """
        if not self.is_circular:
            return field.values
        phase = 2 * np.pi * field.values / self.settings(**changed)["cycle_length_ms"]
        return np.column_stack([np.cos(phase), np.sin(phase)])


_NEGLIGIBLE_BEYOND = 6.5
"""Standard deviations beyond which a Gaussian is below 1e-9 of its peak."""
_MAY_BE_ZERO = ("obstacle_radius_mm", "roughness_mm", "separation_mm")


def _gaussian_foci(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> FieldMap:
    """As `focal_map`, by fast marching: 0.1 s for 1 s at 10,000 vertices, the same to 0.4 %."""
    width = settings["width_mm"]
    centres = _places(mesh, rng, allowed, settings, separation=3 * width)
    marching = FastMarching(mesh)
    reach = _NEGLIGIBLE_BEYOND * width
    away = [marching.from_source([centre], reach=reach) for centre in centres]
    values = np.exp(-0.5 * (np.array(away) / width) ** 2).sum(axis=0)
    return FieldMap(mesh, values, "focal_activity")


def _discs(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> FieldMap:
    radius = settings["radius_mm"]
    centres = _places(mesh, rng, allowed, settings, separation=2 * radius)
    return focal_map(mesh, centres=centres, width=radius, profile="disc")


def _activation(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> FieldMap:
    foci = _places(mesh, rng, allowed, settings, separation=settings["separation_mm"])
    return activation_map(mesh, foci=foci, velocity=settings["velocity_mm_per_ms"])


def _macro_reentry(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> FieldMap:
    return macro_reentry(
        mesh,
        cores=_cores(mesh, rng, allowed, settings),
        cycle_length=settings["cycle_length_ms"],
        obstacle_radius=settings["obstacle_radius_mm"],
    )


def _rotor_pair(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> FieldMap:
    return rotor_pair(
        mesh,
        cores=_cores(mesh, rng, allowed, settings),
        cycle_length=settings["cycle_length_ms"],
        velocity=settings["velocity_mm_per_ms"],
    )


def _scar(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> FieldMap:
    tissue = ScarTissue(
        radius=settings["radius_mm"],
        border=settings["border_mm"],
        roughness=settings["roughness_mm"],
        correlation=settings["correlation_mm"],
    )
    centres = _places(mesh, rng, allowed, settings, separation=2 * tissue.radius)
    return scar_map(mesh, centres=centres, rng=rng, tissue=tissue)


def _places(
    mesh: Mesh,
    rng: np.random.Generator,
    allowed: Truths | None,
    settings: Parameters,
    *,
    separation: float,
) -> tuple[int, ...]:
    count = int(settings["foci"])
    if count != settings["foci"]:
        raise InputError(f"{settings['foci']} foci: give a whole number")
    return _apart(mesh, rng, allowed, count=count, separation=separation)


def _cores(
    mesh: Mesh, rng: np.random.Generator, allowed: Truths | None, settings: Parameters
) -> tuple[int, int]:
    first, second = _apart(mesh, rng, allowed, count=2, separation=settings["separation_mm"])
    return first, second


def _apart(
    mesh: Mesh,
    rng: np.random.Generator,
    allowed: Truths | None,
    *,
    count: int,
    separation: float,
) -> tuple[int, ...]:
    """As `random_foci`, by fast marching: exact distances take seconds at tens of mm."""
    free = np.ones(mesh.n_vertices, dtype=bool) if allowed is None else np.array(allowed)
    marching = FastMarching(mesh)
    drawn: list[int] = []
    while len(drawn) < count:
        if not free.any():
            raise InputError(
                f"only {len(drawn)} of {count} places fit {separation:g} mm apart: "
                "ask for fewer or closer ones"
            )
        drawn += random_foci(mesh, count=1, separation=0.0, rng=rng, allowed=free)
        free &= ~(marching.from_source(drawn[-1:], reach=separation) < separation)
        free[drawn[-1]] = False
    return tuple(drawn)


MAP_CLASSES: Mapping[str, MapClass] = MappingProxyType(
    {
        each.name: each
        for each in (
            MapClass(
                "gaussian",
                "Gaussian foci of a standard deviation",
                "smooth",
                MappingProxyType({"width_mm": 8.0, "foci": 1}),
                _gaussian_foci,
            ),
            MapClass(
                "disc",
                "discs with a sharp edge",
                "jump",
                MappingProxyType({"radius_mm": 10.0, "foci": 1}),
                _discs,
            ),
            # On a sphere the fronts of one focus meet in a point and the cone rules; on most
            # shapes they meet along lines, far from the focus, and so do those of two foci.
            MapClass(
                "activation",
                "activation times of foci at a conduction velocity",
                "crease",
                MappingProxyType({"velocity_mm_per_ms": 0.8, "foci": 1, "separation_mm": 20.0}),
                _activation,
            ),
            MapClass(
                "macro_reentry",
                "re-entry around two obstacles far apart",
                "phase singularity",
                MappingProxyType(
                    {"cycle_length_ms": 240.0, "separation_mm": 50.0, "obstacle_radius_mm": 0.0}
                ),
                _macro_reentry,
            ),
            MapClass(
                "rotor_pair",
                "two counter-rotating spiral waves",
                "phase singularity",
                MappingProxyType(
                    {"cycle_length_ms": 180.0, "velocity_mm_per_ms": 0.5, "separation_mm": 20.0}
                ),
                _rotor_pair,
            ),
            MapClass(
                "scar",
                "voltage with patches of scar of uneven boundary",
                "jump",
                MappingProxyType(
                    {
                        "radius_mm": 12.0,
                        "border_mm": 4.0,
                        "roughness_mm": 3.0,
                        "correlation_mm": 15.0,
                        "foci": 2,
                    }
                ),
                _scar,
            ),
        )
    }
)
"""Every class by its name.

A scar has a jump only at wavelengths above its border's width; below, its tail falls faster.
"""
