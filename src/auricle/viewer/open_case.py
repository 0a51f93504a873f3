"""What of a case is open in the page: a surface with its harmonics, and recordings on it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from auricle.electroanatomy.points import UNITS
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.sampling.samples import Samples
from auricle.study.map_analysis import used_positions
from auricle.study.preparation import PreparedSurface
from auricle.study.result import Source


@dataclass(frozen=True, eq=False)
class Recording:
    """Samples of one quantity, in the order they were taken.

    Attributes
    ----------
    samples
        Positions, values, name and unit.
    cycle_length
        Period of activation times that wrap round, ms; None of others.
    """

    samples: Samples
    cycle_length: float | None = None

    def described(self) -> Mapping[str, Any]:
        """Name, unit, number of samples and cycle length."""
        return {
            "name": self.samples.name,
            "unit": self.samples.unit,
            "n_samples": len(self.samples),
            "cycle_length_ms": self.cycle_length,
        }


@dataclass(frozen=True, eq=False)
class OpenCase:
    """A surface in the page.

    Attributes
    ----------
    name
        Shown as its title; never a person's.
    prepared
        The surface, closed, with its harmonics and the fields of its file.
    recordings
        What was measured on it, if anything.
    remarks
        What its reader should know.
    """

    name: str
    prepared: PreparedSurface
    recordings: tuple[Recording, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def views(self) -> tuple[str, ...]:
        """It can be explored, and points planned and taken on it."""
        return ("explore", "plan")

    def described(self) -> Mapping[str, Any]:
        """Its name, size, fields and recordings."""
        prepared = self.prepared
        return {
            "case": {
                "name": self.name,
                "space": prepared.space,
                "n_vertices": prepared.surface.n_vertices,
                "n_modes": prepared.chamber.basis.n_modes,
                "fields": [
                    {"name": each.name, "unit": each.unit}
                    for each in prepared.fields
                    if each.values.ndim == 1
                ],
                "recordings": [each.described() for each in self.recordings],
                "remarks": list(self.remarks),
            }
        }


@dataclass(frozen=True, eq=False)
class OpenStudy:
    """A vendor's export in the page: the maps to choose from.

    Attributes
    ----------
    study
        As read.
    source
        What its file is known by.
    chosen
        Number of the map that is open, from 1.
    """

    study: ElectroanatomicStudy
    source: Source
    chosen: int

    @property
    def views(self) -> tuple[str, ...]:
        """The chosen map is a case, which has the views."""
        return ()

    def described(self) -> Mapping[str, Any]:
        """Names of the maps, how many points each has, and which one is open."""
        maps = [
            {"number": number, "name": one.name, "n_points": len(one.points), "opens": opens(one)}
            for number, one in enumerate(self.study.maps, start=1)
        ]
        return {"study": {"system": self.study.system, "chosen": self.chosen, "maps": maps}}


def opens(one: ElectroanatomicMap) -> bool:
    """Whether a map has a surface to show."""
    return one.surface is not None and len(one.surface.faces) > 0


def recordings_of(one: ElectroanatomicMap) -> tuple[Recording, ...]:
    """What the points of a map recorded, in the order of their numbers, which is that of time."""
    points = one.points.chosen(one.points.included)
    points = points.chosen(np.argsort(points.identifiers, kind="stable"))
    told = one.cycle_length
    cycle = told if math.isfinite(told) and told > 0 else None
    found = []
    for name in points.recorded:
        values = getattr(points, name)
        there = np.isfinite(values)
        samples = Samples(used_positions(points)[there], values[there], name=name, unit=UNITS[name])
        found.append(Recording(samples, cycle if name == "local_activation_time" else None))
    return tuple(found)
