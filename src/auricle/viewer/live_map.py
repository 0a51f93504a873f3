"""A live map: samples taken, taken back and taken again, the map and its judgement kept current."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from auricle.arrays import Floats, PerVertex
from auricle.errors import InputError
from auricle.sampling.gaussian_process import (
    FEWEST_SAMPLES,
    LENGTH_SHARE,
    GaussianProcess,
    NoisePrior,
)
from auricle.sampling.live import Session
from auricle.sampling.locator import Locator
from auricle.sampling.next_point import NextPoint
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.samples import PlacedSamples, Samples, place
from auricle.sampling.sites import Sites
from auricle.study.fitting import fitted_map
from auricle.study.judgement import Judgement, judgement
from auricle.study.mapping_result import MappingConfig
from auricle.study.preparation import PreparedSurface

MOST_STEPS = 8
"""Samples taken or taken back one by one; more at once are quicker started anew."""
REFITS = (5, 10)
"""Numbers of samples at which hyper-parameters are fitted anew; then whenever these double."""


@dataclass(frozen=True)
class Aim:
    """What is being mapped, and how well it is to be known.

    Attributes
    ----------
    name, unit
        Of the values.
    target_nrmse
        Error at which sampling is enough.
    noise
        Standard deviation of a sample in that unit; None if unknown.
    cycle_length
        Period of activation times that wrap round, ms; None of other maps.
    """

    name: str = "value"
    unit: str = ""
    target_nrmse: float = 0.1
    noise: float | None = None
    cycle_length: float | None = None

    @property
    def config(self) -> MappingConfig:
        """The same for `auricle.study.mapping`; raises InputError if a number is out of range."""
        return MappingConfig(
            value=self.name,
            noise=self.noise,
            cycle_length_ms=self.cycle_length,
            target_nrmse=self.target_nrmse,
        )


@dataclass(frozen=True, eq=False)
class TakenSample:
    """A sample on the surface: its site (one), value, and how far off the surface it lay, mm."""

    site: Sites
    value: float
    distance: float


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The samples of one moment, to be judged while others may come.

    Attributes
    ----------
    prepared
        The surface.
    aim
        What is mapped.
    samples
        Those taken.
    n_left_out
        How many of those handed in could not be used.
    """

    prepared: PreparedSurface
    aim: Aim
    samples: tuple[TakenSample, ...]
    n_left_out: int

    def placed(self) -> PlacedSamples:
        """The samples, those of one place merged."""
        chamber = self.prepared.chamber
        sites = _together([each.site for each in self.samples])
        values = np.array([each.value for each in self.samples])
        read = Samples(
            sites.positions(chamber.mesh), values, name=self.aim.name, unit=self.aim.unit
        )
        return place(read, chamber, cycle_length=self.aim.cycle_length)

    def judged(self) -> tuple[float, Judgement]:
        """Predicted error (NaN if nothing is known) and judgement, as `auricle reconstruct` has it.

        Raises
        ------
        InputError
            If there is no sample.
        """
        placed = self.placed()
        process = GaussianProcess(
            self.prepared.chamber, placed.sites, noise_shape=placed.noise_shape
        )
        fitted = fitted_map(process, placed, self.aim.config)
        found = judgement(
            fitted,
            placed,
            n_read=len(self.samples) + self.n_left_out,
            target_nrmse=self.aim.target_nrmse,
        )
        known = not fitted.reconstruction.knows_nothing
        return fitted.predicted_nrmse if known else math.nan, found

    def first(self, count: int) -> "Snapshot":
        """The first so many of the samples."""
        return replace(self, samples=self.samples[:count])


class LiveMap:
    """Samples in their order, some of them taken, and the map of those.

    Taken back samples are kept and can be taken again; a new one puts them out of reach. A
    recorded study to be played back is such a row of samples, none of them taken yet.

    Parameters
    ----------
    prepared
        The surface.
    aim
        What is mapped.

    Attributes
    ----------
    n_left_out
        How many samples handed in could not be used.
    """

    def __init__(self, prepared: PreparedSurface, aim: Aim) -> None:
        _ = aim.config
        self.prepared = prepared
        self.aim = aim
        self.n_left_out = 0
        self._row: list[TakenSample] = []
        self._taken = 0
        self._sessions: tuple[Session, ...] = ()
        self._fitted_at = 0
        self._locator = Locator(prepared.chamber.mesh)
        self._jump(0)

    @property
    def n_taken(self) -> int:
        """Number of samples the map rests on."""
        return self._taken

    @property
    def n_ahead(self) -> int:
        """Number of samples that can be taken again."""
        return len(self._row) - self._taken

    @property
    def knows_nothing(self) -> bool:
        """Whether the samples say too little for there to be a map."""
        return not self._fitted_at or all(each.knows_nothing for each in self._sessions)

    @property
    def samples(self) -> tuple[TakenSample, ...]:
        """Those taken, in their order."""
        return tuple(self._row[: self._taken])

    @property
    def positions(self) -> Floats:
        """Where on the surface they lie, shape (N, 3), mm."""
        if not self._taken:
            return np.empty((0, 3))
        return _together([each.site for each in self.samples]).positions(self.prepared.chamber.mesh)

    @property
    def snapshot(self) -> Snapshot:
        """The samples taken, to be judged elsewhere."""
        return Snapshot(self.prepared, self.aim, self.samples, self.n_left_out)

    @property
    def row(self) -> Snapshot:
        """All samples of the row, as if all were taken."""
        return replace(self.snapshot, samples=tuple(self._row))

    def add(self, position: Floats, value: float) -> None:
        """Take a new sample, after those taken; what was taken back is dropped.

        Raises
        ------
        InputError
            If it does not lie on the accessible surface, or is not finite; all is then as it was.
        """
        sample = self._on_surface(position, value)
        del self._row[self._taken :]
        self._row.append(sample)
        self.redo()

    def undo(self, count: int = 1) -> None:
        """Take back the last samples, as many as there are of so many."""
        self.go_to(self._taken - count)

    def redo(self, count: int = 1) -> None:
        """Take again what was taken back, or the next of a study, as many as there are."""
        self.go_to(self._taken + count)

    def go_to(self, count: int) -> None:
        """Let the map rest on the first so many samples of the row."""
        count = min(max(count, 0), len(self._row))
        if abs(count - self._taken) > MOST_STEPS or not count:
            self._jump(count)
        while self._taken > count:
            for session in self._sessions:
                session.undo()
            self._taken -= 1
        while self._taken < count:
            sample = self._row[self._taken]
            for session, value in zip(self._sessions, self._components(sample.value), strict=True):
                session.add_at(sample.site, value)
            self._taken += 1
        if count < FEWEST_SAMPLES:
            self._fitted_at = 0

    def load(self, samples: Samples) -> None:
        """A row of samples in place of all others, none of them taken yet.

        Raises
        ------
        InputError
            If none of them lies on the accessible surface; all is then as it was.
        """
        placed = place(samples, self.prepared.chamber, cycle_length=self.aim.cycle_length)
        order = np.argsort(placed.kept, kind="stable")
        self._row = [
            TakenSample(placed.sites[[at]], float(placed.values[at]), float(placed.distances[at]))
            for at in order.tolist()
        ]
        self.n_left_out = len(samples) - int(placed.counts.sum())
        self._jump(0)

    def refit(self) -> bool:
        """Fit the hyper-parameters anew if so many samples have come that it is time to."""
        if not _is_due(self._taken, self._fitted_at):
            return False
        for session in self._sessions:
            session.refit()
        self._fitted_at = self._taken
        return True

    def map(self) -> tuple[PerVertex, PerVertex]:
        """Map and standard deviation on the surface, shape (n,); NaN if nothing is known."""
        n = self.prepared.surface.n_vertices
        if self.knows_nothing or not self._taken:
            return np.full(n, np.nan), np.full(n, np.nan)
        means = [session.mean[:n] for session in self._sessions]
        stds = [session.std[:n] for session in self._sessions]
        cycle = self.aim.cycle_length
        if cycle is None:
            return means[0], stds[0]
        cosine, sine = means
        time = np.mod(np.arctan2(sine, cosine) * cycle / (2 * math.pi), cycle)
        # Small errors move the phase by their part across the mean; large ones know nothing.
        spread = np.hypot(*stds) / math.sqrt(2) / np.maximum(np.hypot(cosine, sine), 1e-9)
        return time, np.minimum(spread * cycle / (2 * math.pi), cycle / math.sqrt(12))

    def predicted_nrmse(self) -> float:
        """Expected error of the map relative to its deviation; NaN if nothing is known."""
        if self.knows_nothing or not self._taken:
            return math.nan
        running = [session.running for session in self._sessions]
        error = sum(each.mean_square_error for each in running)
        return math.sqrt(error / sum(each.variation for each in running))

    def next_point(self) -> NextPoint:
        """Where to sample next."""
        return self._sessions[0].next_point()

    def described(self) -> Mapping[str, Any]:
        """What there is but the arrays, ready for JSON."""
        error = self.predicted_nrmse()
        return {
            "name": self.aim.name,
            "unit": self.aim.unit,
            "target_nrmse": self.aim.target_nrmse,
            "noise": self.aim.noise,
            "cycle_length_ms": self.aim.cycle_length,
            "n_taken": self.n_taken,
            "n_ahead": self.n_ahead,
            "n_left_out": self.n_left_out,
            "knows_nothing": self.knows_nothing,
            "predicted_nrmse": error if math.isfinite(error) else None,
        }

    def _jump(self, count: int) -> None:
        """Start anew with the first so many samples, under the hyper-parameters there are."""
        chamber = self.prepared.chamber
        diameter = math.sqrt(chamber.basis.area / math.pi)
        assumed = Hyperparameters(LENGTH_SHARE * diameter, 1.0, 0.05)
        known = [each.hyperparameters if self._fitted_at else assumed for each in self._sessions]
        columns = np.array([self._components(each.value) for each in self._row[:count]])
        sites = _together([each.site for each in self._row[:count]]) if count else None
        sessions = []
        for index in range(len(self._components(0.0))):
            start = known[index] if known else assumed
            session = Session(chamber, hyperparameters=start, noise_prior=self._noise_prior())
            if sites is not None:
                session.add_all(sites, columns[:, index])
            sessions.append(session)
        self._sessions, self._taken = tuple(sessions), count

    def _noise_prior(self) -> NoisePrior | None:
        noise, cycle = self.aim.noise, self.aim.cycle_length
        if not noise:
            return None
        return NoisePrior(noise if cycle is None else noise * 2 * math.pi / (cycle * math.sqrt(2)))

    def _components(self, value: float) -> tuple[float, ...]:
        """What of a value is mapped: itself, or cosine and sine of its phase."""
        cycle = self.aim.cycle_length
        if cycle is None:
            return (value,)
        phase = 2 * math.pi * value / cycle
        return math.cos(phase), math.sin(phase)

    def _on_surface(self, position: Floats, value: float) -> TakenSample:
        spot = np.asarray(position, dtype=float).reshape(-1)
        if spot.shape != (3,) or not np.isfinite(spot).all() or not math.isfinite(value):
            raise InputError("a sample is three finite mm and a finite value: give those")
        site, distance = self._locator.nearest(spot)
        if distance > self.aim.config.max_distance_mm:
            raise InputError(
                f"the sample lies {distance:.1f} mm off the surface: leave it out, or check its "
                "frame"
            )
        if not self.prepared.chamber.accessible[site.nearest_vertices[0]]:
            raise InputError("the sample lies over a hole that was closed: place it on the wall")
        return TakenSample(site, value, distance)


def _is_due(n_samples: int, fitted_at: int) -> bool:
    """Whether hyper-parameters fitted to so many samples are to be fitted anew.

    >>> [n for n in range(50) if _is_due(n, n - 1)]
    [5, 10, 20, 40]
    >>> _is_due(33, 12), _is_due(12, 33), _is_due(4, 0)
    (True, False, False)
    """
    if n_samples < REFITS[0]:
        return False
    steps = [*REFITS]
    while steps[-1] <= n_samples:
        steps.append(2 * steps[-1])
    return any(fitted_at < step <= n_samples for step in steps)


def _together(sites: list[Sites]) -> Sites:
    return Sites(
        np.concatenate([each.corners for each in sites]),
        np.concatenate([each.weights for each in sites]),
    )
