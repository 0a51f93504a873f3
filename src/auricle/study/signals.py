"""One map through the whole procedure: shell, spectrum, criteria, measured error."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from auricle.arrays import Floats, PerMode, PerVertex, Truths
from auricle.sampling.criteria import Shell, criteria, error_criteria
from auricle.spectral.harmonics import Harmonics
from auricle.study.result import Signal
from auricle.surface.field import FieldMap

_NO_DETAILS: Mapping[str, float] = MappingProxyType({})


def measured_nrmse(basis: Harmonics, values: Floats, where: Truths) -> PerMode:
    """Error of the first 1 … k harmonics of a map, measured where it is known, shape (k,).

    Area-weighted root mean square of map minus reconstruction over the vertices in `where`,
    relative to the map's area-weighted standard deviation there. On a closed surface sampled
    everywhere it equals √(1 − cumulative power).
    """
    columns = values.reshape(len(values), -1)
    coefficients = basis.transform(columns)
    weights = (basis.areas * where)[:, None] / basis.areas[where].sum()
    deviation = columns - (weights * columns).sum(axis=0)
    scale = np.sqrt((weights * deviation**2).sum())
    errors = np.empty(basis.n_modes)
    residual = columns.copy()
    for mode in range(basis.n_modes):
        residual -= np.outer(basis.modes[:, mode], coefficients[mode])
        errors[mode] = np.sqrt((weights * residual**2).sum())
    nrmse: PerMode = errors / scale
    return nrmse


def analyzed_signal(
    basis: Harmonics,
    *,
    field: FieldMap,
    on_shell: Floats,
    kind: str,
    title: str,
    details: Mapping[str, float] = _NO_DETAILS,
) -> Signal:
    """Everything read off one map.

    Parameters
    ----------
    basis
        Harmonics of the closed shell.
    field
        The map on the analysed surface, whose vertices are the first of the shell's.
    on_shell
        The map on every vertex of the shell: filled where unsampled, continued over the caps.
    kind, title, details
        As `Signal` has them.
    """
    known = np.zeros(len(on_shell), dtype=bool)
    known[: field.mesh.n_vertices] = field.sampled
    spectrum = basis.power_spectrum(on_shell)
    shell = Shell(basis.area, field.mesh.area, len(basis.areas))
    nrmse = measured_nrmse(basis, on_shell, known)
    return Signal(
        name=field.name,
        title=title,
        kind=kind,
        field=field,
        spectrum=spectrum,
        criteria=criteria(spectrum, shell),
        for_error=error_criteria(nrmse, shell),
        nrmse=nrmse,
        unsampled_share=_unsampled_share(field, basis.areas[: field.mesh.n_vertices]),
        details=details,
    )


def _unsampled_share(field: FieldMap, areas: PerVertex) -> float:
    return float(areas[~field.sampled].sum() / areas.sum())
