"""Parameters of the paper's study."""

import dataclasses
import json
import pickle

import pytest

from auricle.errors import InputError
from auricle.study.paper.parameters import PaperParameters


def test_the_defaults_are_the_papers():
    parameters = PaperParameters()
    assert parameters.n_vertices == 10_000
    assert parameters.pictured_counts == (50, 250, 500)
    assert parameters.shares == (0.85, 0.90)
    assert parameters.focus_counts == (1, 2, 3)
    assert parameters.sizes == ("small", "medium", "wide")
    assert min(parameters.coefficient_counts) == 10
    assert max(parameters.coefficient_counts) == 1_000


def test_a_table_changes_what_it_names_and_no_more():
    changed = PaperParameters.from_table({"n_modes": 500, "focus_widths_mm": [3, 6]})
    assert changed == dataclasses.replace(
        PaperParameters(), n_modes=500, focus_widths_mm=(3.0, 6.0)
    )
    assert changed.sizes == ("σ = 3 mm", "σ = 6 mm")


def test_parameters_go_to_workers_and_into_json():
    parameters = PaperParameters.tiny(seed=7)
    assert pickle.loads(pickle.dumps(parameters)) == parameters
    back = PaperParameters.from_table(json.loads(json.dumps(dataclasses.asdict(parameters))))
    assert back == parameters


@pytest.mark.parametrize(
    ("table", "match"),
    [
        ({"vertices": 5}, "no parameter 'vertices'"),
        ({"placements": 1.5}, "placements"),
        ({"placements": "five"}, "placements"),
        ({"accept_check": 1}, "accept_check"),
        ({"seed": True}, "seed"),
        ({"focus_counts": 3}, "focus_counts: give a list"),
        ({"focus_counts": [1.5]}, "focus_counts"),
        ({"focus_counts": [0]}, "numbers of foci"),
        ({"n_vertices": 50}, "100"),
        ({"n_modes": 20_000}, "harmonics"),
        ({"fitted_counts": [10, 20, 30]}, "four counts"),
        ({"shares": [0.9, 1.0]}, "between 0 and 1"),
        ({"focus_widths_mm": [8.0, 4.0]}, "from small to wide"),
        ({"focus_widths_mm": [-1.0]}, "positive"),
        ({"seed": -1}, "seed"),
    ],
)
def test_a_table_that_is_wrong_is_refused_by_name(table, match):
    with pytest.raises(InputError, match=match):
        PaperParameters.from_table(table)
