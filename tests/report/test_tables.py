"""Tables of the report, held against the case they tell."""

import csv
import io
import math
from dataclasses import replace

import numpy as np
import pytest

from auricle.report.tables import (
    HARMONICS,
    LEAST,
    PLANNED,
    SPACING,
    WAVELENGTH,
    bound_of,
    geometry_table,
    measured_error_table,
    points_table,
    quantity_table,
    signals_of,
    signals_table,
    spectrum_csv,
    surface_table,
)
from auricle.sampling.criteria import SHARES


def criteria(signal, with_constant=False):
    return [each for each in signal.criteria if each.with_constant == with_constant]


def unmet(signal, share):
    """The signal with one share, without the constant, out of reach."""
    return replace(
        signal,
        criteria=tuple(
            replace(c, need=None) if c.share == share and not c.with_constant else c
            for c in signal.criteria
        ),
    )


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


@pytest.mark.parametrize("with_constant", [False, True])
def test_counts_of_harmonics_are_those_of_the_criteria(case, with_constant):
    table = quantity_table(case, HARMONICS, with_constant=with_constant)
    assert len(table.rows) == len(signals_of(case)) == 7
    for row, signal in zip(table.rows, signals_of(case), strict=True):
        for cell, each in zip(row[1:], criteria(signal, with_constant), strict=True):
            if each.need is None:
                assert cell == f">{case.certificate.n_modes}"
            else:
                assert cell == f"{each.need.n_modes}" + ("" if each.need.trusted else "†")


def test_points_are_given_evenly_spread_and_not_for_every_map_but_the_shape(case):
    table = points_table(case)
    assert [row[0] for row in table.rows] == [
        "local activation time",
        "bipolar voltage",
        "1 focus, σ = 8 mm",
        "1 focus, σ = 16 mm",
        "2 foci, σ = 8 mm",
        "2 foci, σ = 16 mm",
    ]
    need = criteria(case.simulated[1])[1].need
    assert table.rows[3][2] == f"{need.n_planned} / {need.n_unplanned}"
    assert table.head[1:] == ("error 39 %", "error 32 %", "error 22 %", "error 10 %")


def test_a_share_out_of_reach_takes_more_than_all_harmonics_and_a_closer_spacing(case):
    missed = replace(case, fields=(unmet(case.fields[0], 0.95),), simulated=())
    bound = bound_of(case)
    assert bound.n_modes == case.certificate.n_modes
    assert quantity_table(missed, PLANNED).rows[0][3] == f">{bound.n_planned}"
    assert quantity_table(missed, SPACING).rows[0][3] == f"<{bound.planned_spacing_mm:.2g}"
    assert measured_error_table(missed).rows[0][3] == "–"


def test_the_bound_counts_points_on_the_real_surface_only(case):
    capped = replace(case, shell_area_mm2=1.25 * case.shell_area_mm2)
    assert bound_of(case).n_planned == 2 * case.certificate.n_modes
    assert bound_of(capped).n_planned == math.ceil(2 * case.certificate.n_modes / 1.25)


def test_what_the_mesh_does_not_resolve_carries_a_dagger(case):
    signal = case.fields[0]
    rough = tuple(
        replace(c, need=replace(c.need, trusted=False)) if c.need else c for c in signal.criteria
    )
    table = quantity_table(replace(case, fields=(replace(signal, criteria=rough),)), LEAST)
    assert all(cell.endswith("†") or cell.startswith(">") for cell in table.rows[0][1:])


def test_lengths_are_those_of_the_criteria_to_two_digits(case):
    need = criteria(case.geometry)[3].need
    assert float(quantity_table(case, WAVELENGTH).rows[-1][4]) == pytest.approx(
        need.wavelength_mm, rel=0.05
    )


def test_every_error_named_in_a_head_is_the_root_of_what_the_share_leaves(case):
    for share, head in zip(SHARES, quantity_table(case, HARMONICS).head[1:], strict=True):
        assert head == f"{share:.0%} of power, error {math.sqrt(1 - share):.0%}".replace("%", " %")
    with_constant = quantity_table(case, HARMONICS, with_constant=True)
    assert all("error" not in head for head in with_constant.head)


def test_the_measured_error_is_that_at_the_last_harmonic_needed(case):
    signal = case.simulated[0]
    need = criteria(signal)[1].need
    row = measured_error_table(case).rows[2]
    assert row[2] == f"{100 * signal.nrmse[need.n_modes - 1]:.2g} %"


def test_every_table_is_as_wide_as_its_head_and_names_its_unit(case):
    tables = [
        points_table(case),
        signals_table(case),
        geometry_table(case),
        surface_table(case),
        measured_error_table(case),
    ]
    for table in tables:
        assert {len(row) for row in table.rows} == {len(table.head)}
    for table in (quantity_table(case, SPACING), geometry_table(case)):
        assert table.caption.endswith(", mm")


def test_the_maps_are_told_with_unit_and_unsampled_area(case):
    time, voltage = signals_table(case).rows[:2]
    assert time[1] == "ms"
    assert time[3] == "none"
    assert voltage[1] == "mV, by its name"
    assert float(voltage[3].split()[0]) == pytest.approx(
        100 * case.fields[1].unsampled_share, rel=0.05
    )


def test_the_csv_gives_every_number_back_to_the_last_digit(case):
    table = rows(spectrum_csv(case))
    spectrum = case.fields[0].spectrum
    assert len(table) == case.certificate.n_modes
    columns = {name: np.array([float(row[name]) for row in table]) for name in table[0]}
    np.testing.assert_array_equal(columns["eigenvalue_per_mm2"], spectrum.eigenvalues)
    name = "local_activation_time"
    np.testing.assert_array_equal(columns[f"cumulative_{name}"], spectrum.cumulative())
    np.testing.assert_array_equal(
        columns[f"cumulative_with_constant_{name}"], spectrum.cumulative(with_constant=True)
    )
    np.testing.assert_allclose(
        np.cumsum(columns[f"share_{name}"]), columns[f"cumulative_{name}"], atol=1e-12
    )
    assert columns[f"share_{name}"][0] == 0.0


def test_the_csv_has_the_wavelength_of_the_criteria(case):
    need = criteria(case.geometry)[2].need
    row = rows(spectrum_csv(case))[need.n_modes - 1]
    assert int(row["harmonic"]) == need.n_modes
    assert float(row["wavelength_mm"]) == need.wavelength_mm


def test_maps_of_one_name_keep_columns_of_their_own(case):
    twice = replace(case, fields=(case.fields[0], case.fields[0]), simulated=())
    head = rows(spectrum_csv(twice))[0]
    assert "share_local_activation_time" in head
    assert "share_local_activation_time_2" in head
    assert len(head) == 3 + 3 * 3


def test_a_name_with_commas_quotes_and_line_feeds_stays_one_column(case):
    named = replace(case.fields[0], name='a,"b"\nc')
    table = rows(spectrum_csv(replace(case, fields=(named,), simulated=())))
    assert 'share_a,"b" c' in table[0]
    assert len(table) == case.certificate.n_modes
