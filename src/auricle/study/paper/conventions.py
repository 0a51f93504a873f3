"""The conventions question: harmonics counted under every reading of the paper on one surface.

The paper leaves open which operator its modes belong to, what a dual cell is, how maps are
projected, whether coordinates are centred, whether "accumulated power" adds energies or
amplitudes, whether the constant counts, and what a focus looks like. Each combination is counted.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Literal

import numpy as np

from auricle.arrays import Floats, PerMode, PerVertex, Points
from auricle.errors import SolverError
from auricle.progress import Progress, silent
from auricle.spectral.harmonics import Harmonics
from auricle.study.paper.features import places_of
from auricle.study.paper.foci import PROFILES, foci_at, straight_foci
from auricle.study.paper.mode_sample import ModeSample, sampled_modes
from auricle.study.paper.operators import DUAL_CELLS, OPERATORS, DualCell, Operator, operator_of
from auricle.study.paper.parameters import PaperParameters
from auricle.study.paper.quality import decays, quality_of_harmonics
from auricle.study.paper.transforms import TRANSFORMS, Transform
from auricle.surface.mesh import Mesh
from auricle.surface.simplification import simplify

Measure = Literal["energy", "amplitude"]
MEASURES: tuple[Measure, ...] = ("energy", "amplitude")
CONSTANTS = ("in", "out")
COORDINATES = ("centred", "as given")

WIDTHS_MM = (2.8, 4.0, 5.7, 8.0, 11.3, 16.0, 22.6, 32.0)
"""Widths of foci, a factor of √2 apart: the paper states none, so each reading chooses among
these in `reproduction.py`."""

SHAPES = (*PROFILES, "gaussian_in_space")
"""Profiles of foci along the surface, and a Gaussian of the distance straight through space."""

PLACEMENTS = 4
"""How many placements of the foci are counted, at most; the case's own first ones."""

COARSER = 3
"""The counts are taken again on a surface of so many times fewer vertices."""
_FEWEST = 100

_N_PROBES = {"third": 14, "voronoi": 10}
_VORONOI_SHARE = 0.4
"""Of the lowest modes, how many are solved for with Voronoi cells, which change little."""
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class _Maps:
    """What is projected: a column each."""

    positions: Points
    bumps: Floats
    shape: tuple[int, int, int, int]

    @property
    def columns(self) -> Floats:
        """The constant, x, y, z, and every bump, shape (n, 4 + c)."""
        one = np.ones((len(self.positions), 1))
        return np.concatenate([one, self.positions, self.bumps], axis=1)


def convention_counts(
    mesh: Mesh,
    *,
    parameters: PaperParameters,
    harmonics: Harmonics | None = None,
    places: Sequence[Points] | None = None,
    progress: Progress = silent,
) -> dict[str, Any]:
    """Modes for each share of the power of geometry and foci, under every convention.

    Parameters
    ----------
    mesh
        A closed surface in one piece, simplified as the case is.
    parameters
        Of the study; where `convention_vertices` is below `n_vertices`, the surface is simplified
        to it first.
    harmonics
        The surface's area-weighted harmonics, where they are at hand: they are not solved for
        again.
    places
        Of the foci, a placement each, shape (most foci, 3), mm; drawn on the surface by default.
    progress
        Told the stages.

    Returns
    -------
    dict
        JSON-able. ``operators``: what was solved, with its certificate and ``balance``, the
        sampled energy of the geometry over the exact one by projection. ``refused``: operators
        that could not be solved, and why. ``geometry``: a record each of operator, dual_cell,
        projection, coordinates, measure, constant and counts, by share. ``features``: the same
        without coordinates and with profile; counts by share are medians over placements, a row
        for each of ``widths_mm`` with a number for each of ``focus_counts``. ``decay``: τ of the
        surface rebuilt from the modes of Eq. 1 as printed, records as `quality.decays` has them.
        ``coarser``: geometry and features again on a third of the vertices, with dual cells of a
        third: what a bandwidth is does not change.
    """
    if parameters.convention_vertices < parameters.n_vertices:
        mesh, harmonics = simplify(mesh, parameters.convention_vertices), None
    drawn = places or places_of(mesh, parameters)
    document = _counted(mesh, drawn, parameters, DUAL_CELLS, harmonics=harmonics, progress=progress)
    n_coarser = mesh.n_vertices // COARSER
    if n_coarser >= _FEWEST:
        fewer = replace(parameters, n_modes=max(parameters.n_modes // COARSER, 10))
        progress("conventions on fewer vertices", 0, 1)
        coarser = _counted(simplify(mesh, n_coarser), drawn, fewer, ("third",))
        document["coarser"] = {
            key: coarser[key] for key in ("n_vertices", "refused", "geometry", "features")
        }
    return document


def _counted(
    mesh: Mesh,
    places: Sequence[Points],
    parameters: PaperParameters,
    cells: Sequence[DualCell],
    *,
    harmonics: Harmonics | None = None,
    progress: Progress = silent,
) -> dict[str, Any]:
    maps = _maps(mesh, places, parameters)
    document: dict[str, Any] = {
        "n_vertices": mesh.n_vertices,
        "n_placements": maps.shape[0],
        "focus_counts": list(range(1, maps.shape[1] + 1)),
        "widths_mm": list(WIDTHS_MM),
        "operators": [],
        "refused": [],
        "geometry": [],
        "features": [],
        "decay": [],
    }
    solved = list(product(OPERATORS, cells))
    for done, (name, cell) in enumerate(solved):
        progress("conventions", done, len(solved))
        operator = operator_of(mesh, name, cell)
        at_hand = harmonics if (name, cell) == ("symmetrised", "third") else None
        try:
            sample = _sample(operator, parameters, at_hand)
        except SolverError as fault:
            document["refused"].append({"operator": name, "dual_cell": cell, "reason": str(fault)})
            continue
        _count(document, operator, sample, maps, parameters.shares)
        if (name, cell) == ("as_printed", "third") and len(cells) > 1:
            document["decay"] = _decay_as_printed(sample, mesh, parameters)
    return document


def modes_for_share(curve: PerMode, share: float, *, with_constant: bool) -> int:
    """Least number of leading modes that hold a share of the sum of a curve, shape (n,).

    Without the constant mode it still counts as one of them, but nothing of the sum is its.

    Examples
    --------
    >>> curve = np.array([6.0, 2.0, 1.0, 1.0])
    >>> [modes_for_share(curve, 0.75, with_constant=within) for within in (True, False)]
    [2, 3]
    """
    accumulated = np.cumsum(curve)
    if not with_constant:
        accumulated = accumulated - curve[0]
    reached = accumulated >= share * (1 - _ROUNDING) * accumulated[-1]
    return int(reached.argmax()) + 1


def _maps(mesh: Mesh, places: Sequence[Points], parameters: PaperParameters) -> _Maps:
    """Maps of 1, 2, … foci at every placement, profile and width, in this order of columns."""
    chosen = places[:PLACEMENTS]
    counts = range(1, max(parameters.focus_counts) + 1)
    columns = []
    for each in chosen:
        foci = foci_at(mesh, each, marched=True)
        straight = straight_foci(mesh, each)
        for count in counts:
            columns += [
                foci.map_of(count, width, profile=profile)
                for profile in PROFILES
                for width in WIDTHS_MM
            ]
            columns += [straight.map_of(count, width) for width in WIDTHS_MM]
    shape = (len(chosen), len(counts), len(SHAPES), len(WIDTHS_MM))
    return _Maps(mesh.vertices, np.stack(columns, axis=1), shape)


def _sample(
    operator: Operator, parameters: PaperParameters, harmonics: Harmonics | None
) -> ModeSample:
    share = 1.0 if operator.dual_cell == "third" else _VORONOI_SHARE
    return sampled_modes(
        operator,
        n_lowest=max(int(share * parameters.n_modes), 10),
        n_probes=_N_PROBES[operator.dual_cell],
        seed=parameters.seed,
        harmonics=harmonics,
    )


def _count(
    document: dict[str, Any],
    operator: Operator,
    sample: ModeSample,
    maps: _Maps,
    shares: Sequence[float],
) -> None:
    """Add what one operator's modes say to the document."""
    balances = {}
    for transform in TRANSFORMS:
        if transform.matrix != operator.name:
            continue
        label = {
            "operator": transform.operator,
            "dual_cell": operator.dual_cell,
            "projection": transform.projection,
        }
        given = transform.weighted(maps.columns, operator.areas)
        spectra = _Spectra(sample, sample.rows @ given, given)
        for row, balance in _geometry(spectra, transform, operator.areas, maps, shares):
            document["geometry"].append(label | row)
            balances[f"{transform.operator} {transform.projection}"] = round(balance, 4)
        document["features"] += [label | row for row in _features(spectra, maps, shares)]
    document["operators"].append(_evidence(operator, sample) | {"balance": balances})


def _decay_as_printed(
    sample: ModeSample, mesh: Mesh, parameters: PaperParameters
) -> list[dict[str, Any]]:
    """τ of the errors of a surface rebuilt from modes that are orthonormal without areas."""
    centre = mesh.vertices.mean(axis=0)
    coefficients = sample.rows[: sample.n_lowest] @ (mesh.vertices - centre)
    rebuilt = {
        count: Mesh(sample.rows[:count].T @ coefficients[:count] + centre, mesh.faces)
        for count in parameters.fitted_counts
        if count <= sample.n_lowest
    }
    return decays({"mha": quality_of_harmonics(mesh, rebuilt)}, parameters.fitted_counts)


def _evidence(operator: Operator, sample: ModeSample) -> dict[str, Any]:
    return {
        "operator": operator.name,
        "dual_cell": operator.dual_cell,
        "weights": operator.pair.kind,
        "n_negative": operator.n_negative,
        "n_lowest": sample.n_lowest,
        "n_probed": len(sample.rows) - sample.n_lowest,
        "certificate": sample.evidence,
    }


@dataclass(frozen=True, eq=False)
class _Spectra:
    """Coefficients of all maps under one transform."""

    sample: ModeSample
    coefficients: Floats
    given: Floats

    def curve(self, columns: slice | Sequence[int], measure: Measure) -> tuple[PerMode, float]:
        """Energy or amplitude of every mode for the map that these columns are the components of.

        Amplitude is the norm of the components' coefficients. With the sampled total of the
        energy over the exact one.
        """
        power = (self.coefficients[:, columns] ** 2).sum(axis=1)
        return self._curve(power, float((self.given[:, columns] ** 2).sum()), measure)

    def shifted_curve(self, shift: Floats, measure: Measure) -> tuple[PerMode, float]:
        """The same of the positions less a shift, shape (3,), mm."""
        coefficients = self.coefficients[:, 1:4] - np.outer(self.coefficients[:, 0], shift)
        given = self.given[:, 1:4] - np.outer(self.given[:, 0], shift)
        return self._curve((coefficients**2).sum(axis=1), float((given**2).sum()), measure)

    def _curve(self, power: PerMode, total: float, measure: Measure) -> tuple[PerMode, float]:
        energy, balance = self.sample.energy_curve(power, total)
        if measure == "energy":
            return energy, balance
        return self.sample.curve(np.sqrt(power)), balance


def _geometry(
    spectra: _Spectra,
    transform: Transform,
    areas: PerVertex,
    maps: _Maps,
    shares: Sequence[float],
) -> Iterator[tuple[dict[str, Any], float]]:
    """Counts for the positions, and the sampled energy over the exact one."""
    weights = areas if transform.projection == "weighted" else None
    centre = np.average(maps.positions, axis=0, weights=weights)
    for coordinates, measure in product(COORDINATES, MEASURES):
        shift = centre if coordinates == "centred" else np.zeros(3)
        curve, balance = spectra.shifted_curve(shift, measure)
        for constant in CONSTANTS:
            counts = {
                f"{share:g}": modes_for_share(curve, share, with_constant=constant == "in")
                for share in shares
            }
            row = {
                "coordinates": coordinates,
                "measure": measure,
                "constant": constant,
                "counts": counts,
            }
            yield row, balance


def _features(spectra: _Spectra, maps: _Maps, shares: Sequence[float]) -> Iterator[dict[str, Any]]:
    """Counts for the foci: medians over placements."""
    n_maps = maps.bumps.shape[1]
    for measure in MEASURES:
        found = np.empty((len(CONSTANTS), len(shares), n_maps))
        for column in range(n_maps):
            curve, _ = spectra.curve([4 + column], measure)
            for (i, constant), (j, share) in product(enumerate(CONSTANTS), enumerate(shares)):
                found[i, j, column] = modes_for_share(curve, share, with_constant=constant == "in")
        shaped = found.reshape(len(CONSTANTS), len(shares), *maps.shape)
        medians = np.median(shaped, axis=2)
        for (i, constant), (k, profile) in product(enumerate(CONSTANTS), enumerate(SHAPES)):
            yield {
                "measure": measure,
                "constant": constant,
                "profile": profile,
                "counts": {
                    f"{share:g}": medians[i, j, :, k].T.tolist() for j, share in enumerate(shares)
                },
            }
