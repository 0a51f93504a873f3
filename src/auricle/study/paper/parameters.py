"""The parameters of the paper's study, the same for every case of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Self

from auricle.errors import InputError

EVEN_COUNTS = (10, *range(50, 1001, 50))
"""From 10 to 1,000 as the paper has it, in even steps, which it does not state."""
CLOSE_COUNTS = (15, 20, 30, 40, 70)
"""Where the errors fall most; for the curves, and for τ from counts in a geometric row."""


@dataclass(frozen=True)
class PaperParameters:
    """What one case of the study depends on; the defaults are the paper's where it states one.

    Attributes
    ----------
    n_vertices
        Vertices to simplify the surface to. The paper: 10,000.
    n_modes
        Harmonics to solve for, the constant one included.
    coefficient_counts, point_counts
        Numbers of harmonics, and of points left by Qslim, at which errors are measured.
    fitted_counts
        Those of them that τ is fitted to.
    pictured_counts
        Those whose surfaces are kept, as in the paper's Figures 3 and 4.
    focus_widths_mm
        Standard deviations of small, medium and wide foci, mm. The paper states none.
    focus_counts
        How many foci at once.
    feature_counts
        Numbers of harmonics, and of points left by Qslim with and without the map in its quadric,
        at which the error of the focal maps is measured.
    feature_weight_mm
        How many mm one standard deviation of a map counts for in the quadric. The paper states
        none.
    placements
        How many times foci of each number are placed anew.
    shares
        Shares of the power that harmonics are counted for, ascending.
    curve_widths_mm
        Further widths of one focus, for the curve of counts against width, mm.
    class_draws
        How many maps of each further class (disc, activation, re-entry, scar) are drawn.
    convention_vertices
        Vertices at which the conventions are compared; 0 leaves them out.
    finer_vertices
        Further numbers of vertices to analyse the surface at, where it has so many.
    recovered_counts
        Numbers of harmonics from which the surface is rebuilt to analyse the focal maps on that.
    accept_check
        Whether a segmented CT whose verdict is ``check`` enters the study.
    surfaces_kept
        Whether the surfaces that pictures need are kept in the result.
    seed
        Of the places of foci, of the classes' maps and of the eigensolver.

    Raises
    ------
    InputError
        If a number is out of range.
    """

    n_vertices: int = 10_000
    n_modes: int = 1_000
    coefficient_counts: tuple[int, ...] = tuple(sorted((*EVEN_COUNTS, *CLOSE_COUNTS)))
    point_counts: tuple[int, ...] = tuple(sorted((*EVEN_COUNTS, *CLOSE_COUNTS)))
    fitted_counts: tuple[int, ...] = EVEN_COUNTS
    pictured_counts: tuple[int, ...] = (50, 250, 500)
    focus_widths_mm: tuple[float, ...] = (4.0, 8.0, 16.0)
    focus_counts: tuple[int, ...] = (1, 2, 3)
    feature_counts: tuple[int, ...] = (20, 50, 100, 150, 250, 500, 1000)
    feature_weight_mm: float = 1.0
    placements: int = 20
    shares: tuple[float, ...] = (0.85, 0.90)
    curve_widths_mm: tuple[float, ...] = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0)
    class_draws: int = 5
    convention_vertices: int = 10_000
    finer_vertices: tuple[int, ...] = ()
    recovered_counts: tuple[int, ...] = (250,)
    accept_check: bool = False
    surfaces_kept: bool = True
    seed: int = 1

    def __post_init__(self) -> None:
        if self.n_vertices < 100 or min(self.finer_vertices, default=100) < 100:
            raise InputError("fewer than 100 vertices are too few for an analysis: ask for more")
        if not 10 <= self.n_modes < self.n_vertices:
            raise InputError(f"{self.n_modes} harmonics: ask for 10 or more, fewer than vertices")
        if len(set(self.fitted_counts)) < 4 or min(self.fitted_counts) < 4:
            raise InputError("τ is fitted to at least four counts of 4 or more: give more")
        if not all(0 < share < 1 for share in self.shares) or not self.shares:
            raise InputError("shares of the power lie between 0 and 1: correct them")
        if self.convention_vertices < 0 or self.seed < 0:
            raise InputError("seed and convention_vertices count from 0: correct them")
        self._require_foci()

    def _require_foci(self) -> None:
        if self.placements < 1 or self.class_draws < 0 or min(self.focus_counts, default=1) < 1:
            raise InputError("placements and numbers of foci count from 1: correct them")
        if not self.feature_weight_mm > 0:
            raise InputError("feature_weight_mm is a positive number of mm: correct it")
        if min((*self.focus_widths_mm, *self.curve_widths_mm), default=1.0) <= 0:
            raise InputError("a focus's width is a positive number of mm: correct it")
        if list(self.focus_widths_mm) != sorted(set(self.focus_widths_mm)):
            raise InputError("focus_widths_mm: give them from small to wide, each once")

    @property
    def sizes(self) -> tuple[str, ...]:
        """Names of the widths: the paper's for three, else ``σ = … mm``."""
        if len(self.focus_widths_mm) == 3:
            return ("small", "medium", "wide")
        return tuple(f"σ = {width:g} mm" for width in self.focus_widths_mm)

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Self:
        """Parameters from a table of a settings file; what it does not name keeps its default.

        Raises
        ------
        InputError
            If a key is unknown, or a value of the wrong kind or out of range; the key is named.

        Examples
        --------
        >>> PaperParameters.from_table({"placements": 5, "focus_widths_mm": [4, 8, 16]}).placements
        5
        """
        defaults = {each.name: each.default for each in fields(cls)}
        for key in table:
            if key not in defaults:
                raise InputError(f"no parameter {key!r}: choose from {', '.join(defaults)}")
        return cls(**{key: _like(defaults[key], value, key) for key, value in table.items()})

    @classmethod
    def tiny(cls, **changed: Any) -> Self:
        """Parameters for tests: some seconds a case, everything still there."""
        small = cls(
            n_vertices=600,
            n_modes=120,
            coefficient_counts=(10, 20, 30, 50, 70, 100),
            point_counts=(30, 40, 50, 70, 100, 200),
            fitted_counts=(30, 50, 70, 100),
            pictured_counts=(50, 100),
            feature_counts=(20, 50, 100),
            placements=3,
            curve_widths_mm=(8.0, 16.0),
            class_draws=1,
            convention_vertices=300,
            recovered_counts=(100,),
        )
        return replace(small, **changed)


def _like(default: Any, value: Any, key: str) -> Any:
    """A value of the kind its default is of."""
    if isinstance(default, tuple):
        if not isinstance(value, list | tuple):
            raise InputError(f"{key}: give a list")
        whole = all(isinstance(each, int) for each in default) and key.endswith(
            ("counts", "vertices")
        )
        return tuple(_like(1 if whole else 1.0, each, key) for each in value)
    if isinstance(default, bool):
        if not isinstance(value, bool):
            raise InputError(f"{key} = {value!r}: give true or false")
        return value
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{key} = {value!r}: give a number")
    if isinstance(default, int):
        if value != int(value):
            raise InputError(f"{key} = {value!r}: give a whole number")
        return int(value)
    return float(value)
