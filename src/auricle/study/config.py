"""The parameters of an analysis, in one frozen place."""

from dataclasses import dataclass

from auricle.errors import InputError


@dataclass(frozen=True)
class AnalysisConfig:
    """What the user may choose about one analysis; every default is the paper's where it has one.

    Attributes
    ----------
    n_vertices
        Vertices to simplify the surface to; a smaller surface is left alone. The paper: 10,000.
    n_modes
        Harmonics to solve for.
    fields
        Names of the fields to analyse; empty means every field on the surface.
    focus_widths_mm
        Standard deviations of the simulated Gaussian foci, mm, from small to wide.
    focus_counts
        How many foci at once.
    seed
        Seed of the simulated foci's places and of the eigensolver's start.
    """

    n_vertices: int = 10_000
    n_modes: int = 1_000
    fields: tuple[str, ...] = ()
    focus_widths_mm: tuple[float, ...] = (4.0, 8.0, 16.0)
    focus_counts: tuple[int, ...] = (1, 2, 3)
    seed: int = 1

    def __post_init__(self) -> None:
        if self.n_vertices < 100:
            raise InputError(f"{self.n_vertices} vertices are too few for an analysis: ask for 100")
        if self.n_modes < 2:
            raise InputError(f"{self.n_modes} harmonics show no spectrum: ask for at least 2")
        if min(self.focus_widths_mm, default=1.0) <= 0:
            raise InputError("a focus's width is a positive number of mm")
        if min(self.focus_counts, default=1) < 1:
            raise InputError("a map has at least one focus")
