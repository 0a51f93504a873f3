"""What is to be mapped: a class of maps drawn on the chamber, a map of its own, or a bandwidth."""

from dataclasses import dataclass

import numpy as np

from auricle.errors import InputError
from auricle.progress import Progress
from auricle.sampling.bandwidth import class_tails
from auricle.sampling.tails import Tails, truncation_tail
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.plan_result import PlanConfig
from auricle.study.preparation import PreparedSurface
from auricle.surface.field import FieldMap

N_DRAWS = 20
"""Maps of a class drawn to learn its bandwidth."""


@dataclass(frozen=True, eq=False)
class Wanted:
    """What is to be mapped.

    Attributes
    ----------
    words
        What it is.
    tails
        How the error of such maps falls with the harmonics.
    example
        One of them, on the surface; None for a bandwidth.
    """

    words: str
    tails: Tails
    example: FieldMap | None


def wanted(prepared: PreparedSurface, config: PlanConfig, progress: Progress) -> Wanted:
    """What the parameters say is to be mapped, on this chamber.

    Raises
    ------
    InputError
        If there is no such field, it does not vary, or maps of the class cannot be drawn here.
    """
    chamber = prepared.chamber
    if config.map_class is not None:
        return _class_maps(prepared, config, progress)
    if config.field is not None:
        return _field_map(prepared, config)
    bandwidth = config.bandwidth or 1
    tail = np.where(np.arange(1, chamber.basis.n_modes + 1) < bandwidth, 1.0, 0.0)
    words = f"a map of {bandwidth} harmonics"
    return Wanted(words, Tails(tail[None], words), None)


def _class_maps(prepared: PreparedSurface, config: PlanConfig, progress: Progress) -> Wanted:
    """Maps of the class drawn on this chamber, one of them to look at."""
    chamber, map_class = prepared.chamber, MAP_CLASSES[str(config.map_class)]
    rows = []
    for index, rng in enumerate(np.random.default_rng(config.seed).spawn(N_DRAWS)):
        progress("draw maps of the class", index, N_DRAWS)
        tails = class_tails(chamber, map_class, n_draws=1, rng=rng, **config.parameters)
        rows.append(tails.squared_errors[0])
    progress("draw maps of the class", N_DRAWS, N_DRAWS)
    rng = np.random.default_rng(config.seed).spawn(1)[0]
    drawn = map_class.draw(chamber.mesh, rng, allowed=chamber.accessible, **config.parameters)
    example = FieldMap(
        prepared.surface, drawn.values[: prepared.surface.n_vertices], drawn.name, drawn.unit
    )
    settings = map_class.settings(**config.parameters)
    told = ", ".join(_parameter_words(name, value) for name, value in settings.items())
    words = f"{map_class.title} ({told})"
    source = f"{N_DRAWS} maps drawn on this surface: {words}"
    return Wanted(words, Tails(np.array(rows), source), example)


def _parameter_words(name: str, value: float) -> str:
    """A parameter as it is read: its name, the number and the unit its name ends in.

    >>> _parameter_words("width_mm", 8.0), _parameter_words("velocity_mm_per_ms", 0.8)
    ('width 8 mm', 'velocity 0.8 mm/ms')
    """
    for ending, unit in (("_mm_per_ms", "mm/ms"), ("_mm", "mm"), ("_ms", "ms")):
        if name.endswith(ending):
            return f"{name.removesuffix(ending).replace('_', ' ')} {value:g} {unit}"
    return f"{name.replace('_', ' ')} {value:g}"


def _field_map(prepared: PreparedSurface, config: PlanConfig) -> Wanted:
    found = prepared.field(str(config.field))
    if not found.sampled.any():
        raise InputError(f"field {found.name!r} has no values: choose a field that was sampled")
    if not np.ptp(found.values[found.sampled]) > 0:
        raise InputError(f"field {found.name!r} is constant: choose one that varies")
    chamber = prepared.chamber
    columns = found.values[:, None]
    if config.cycle_length_ms is not None:
        phase = 2 * np.pi * found.values / config.cycle_length_ms
        columns = np.column_stack([np.cos(phase), np.sin(phase)])
    on_shell = np.full((chamber.mesh.n_vertices, columns.shape[1]), np.nan)
    on_shell[: len(columns)] = columns
    tail = truncation_tail(chamber, on_shell)
    words = f"a map like {found.name}"
    return Wanted(words, Tails(tail[None], f"the map {found.name} on this surface"), found)
