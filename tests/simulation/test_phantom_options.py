"""Options of a phantom: what is asked for is possible, and every hard case can be had."""

from dataclasses import fields

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.simulation.phantom_options import HOSTILE, PRESETS, PhantomOptions, hostile


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"preset": "huge"}, "no preset “huge”: give tiny"),
        ({"veins": "six"}, "no veins “six”: give four"),
        ({"seed": -1}, "a seed of -1: give 0 or more"),
        ({"scale": 3.0}, "scale of 3.0: give 0.7 to 1.4"),
        ({"noise": -1.0}, "noise of -1.0: give 0 to 200"),
        ({"blur": np.nan}, "blur of nan: give 0 to 3"),
        ({"wall": 0.0}, "wall of 0.0: give 0.3 to 5"),
    ],
)
def test_what_cannot_be_had_is_refused_with_what_can(options, told):
    with pytest.raises(InputError, match=told):
        PhantomOptions(**options)


def test_every_preset_covers_the_same_chest():
    for counts, spacing in PRESETS.values():
        assert np.multiply(counts, spacing) == pytest.approx([204.8, 204.8, 150.0])


def test_every_hard_case_changes_options_that_exist():
    names = {field.name for field in fields(PhantomOptions)}
    plain = PhantomOptions(preset="tiny", seed=4)
    for case, changes in HOSTILE.items():
        assert set(changes) <= names
        hard = hostile(case, plain)
        assert (hard.preset, hard.seed) == ("tiny", 4)
        assert (hard == plain) == (case == "nominal")


def test_an_unknown_case_is_refused():
    with pytest.raises(InputError, match="no hard case “easy”: give nominal"):
        hostile("easy", PhantomOptions())
