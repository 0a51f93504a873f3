"""Which fields are analysed, and what is said of the others."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.fields import chosen_fields
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere

SPHERE = icosphere(radius=30.0, subdivisions=2)
Z = SPHERE.vertices[:, 2]


def named(name: str, values: np.ndarray) -> FieldMap:
    return FieldMap(SPHERE, values, name)


SMOOTH = named("smooth", Z)
LABELS = named("labels", np.sign(Z))
UNFIT = {
    "is a vector": named("bad", SPHERE.vertices),
    "is constant": named("bad", np.full(len(Z), 3.5)),
    "holds no values": named("bad", np.full(len(Z), np.nan)),
    "is unsampled on": named("bad", np.where(Z < 12, np.nan, Z)),
}


def test_every_scalar_is_analysed_by_default() -> None:
    chosen, remarks = chosen_fields([SMOOTH, named("other", Z**2)], ())
    assert [field.name for field in chosen] == ["smooth", "other"]
    assert remarks == ()


def test_a_label_map_is_analysed_with_a_warning() -> None:
    chosen, remarks = chosen_fields([LABELS], ())
    assert chosen == (LABELS,)
    assert "label map" in remarks[0]


@pytest.mark.parametrize("cause", UNFIT)
def test_an_unfit_field_is_left_out_by_name(cause) -> None:
    chosen, remarks = chosen_fields([SMOOTH, UNFIT[cause]], ())
    assert chosen == (SMOOTH,)
    assert "'bad'" in remarks[0]
    assert cause in remarks[0]


@pytest.mark.parametrize("cause", UNFIT)
def test_an_unfit_field_asked_for_by_name_is_refused(cause) -> None:
    with pytest.raises(InputError, match=cause):
        chosen_fields([SMOOTH, UNFIT[cause]], ("smooth", "bad"))


def test_a_missing_field_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(InputError, match="'voltage': the surface has labels, smooth"):
        chosen_fields([SMOOTH, LABELS], ("voltage",))


def test_a_nearly_constant_field_far_from_zero_is_constant() -> None:
    _, remarks = chosen_fields([named("bad", 1e9 + 1e-5 * (Z > 0))], ())
    assert "is constant" in remarks[0]
