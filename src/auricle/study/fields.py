"""Which of a surface's fields are analysed, and why another is not."""

from collections.abc import Sequence

import numpy as np

from auricle.errors import InputError
from auricle.surface.field import FieldMap

LARGEST_UNSAMPLED_SHARE = 0.5
_FEW_LABELS = 12


def chosen_fields(
    available: Sequence[FieldMap], names: Sequence[str]
) -> tuple[tuple[FieldMap, ...], tuple[str, ...]]:
    """The fields to analyse, and remarks on those left out or doubtful.

    Named fields must all be there and fit for analysis; without names every scalar field is
    taken, and one that is constant, unsampled or a vector is left out with a remark.

    Raises
    ------
    InputError
        If a named field is missing, constant, a vector, or sampled on too little of the surface.
    """
    by_name = {field.name: field for field in available}
    missing = [name for name in names if name not in by_name]
    if missing:
        have = ", ".join(sorted(by_name)) or "none"
        raise InputError(f"no field named {missing[0]!r}: the surface has {have}")
    chosen, remarks = [], []
    for field in [by_name[name] for name in names] or available:
        fault = unfitness(field)
        if fault and names:
            raise InputError(f"field {field.name!r} {fault}: choose another field")
        if fault:
            remarks.append(f"field {field.name!r} {fault} and was left out")
            continue
        chosen.append(field)
        if _is_label(field):
            remarks.append(
                f"field {field.name!r} looks like a label map: the spectrum of its jumps falls "
                "slowly, and no number of points reaches a small error at a jump"
            )
    return tuple(chosen), tuple(remarks)


def unfitness(field: FieldMap) -> str:
    """Why a field has no spectrum worth computing; empty if it has."""
    if field.values.ndim != 1:
        return "is a vector"
    known = field.values[field.sampled]
    if not known.size:
        return "holds no values (all NaN)"
    spread, size = float(np.ptp(known)), float(np.abs(known).max())
    if spread <= 1e-12 * size:
        return "is constant"
    if known.size < (1 - LARGEST_UNSAMPLED_SHARE) * field.values.size:
        return f"is unsampled on {1 - known.size / field.values.size:.0%} of the vertices"
    return ""


def _is_label(field: FieldMap) -> bool:
    known = field.values[field.sampled]
    return len(np.unique(known)) <= _FEW_LABELS and bool((known == np.rint(known)).all())
