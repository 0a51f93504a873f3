"""Features of electrograms on signals whose answer is known."""

import math

import numpy as np
import pytest

from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.features.activation import (
    annotated_activation_time,
    bipolar_activation,
    unipolar_activation,
)
from auricle.electroanatomy.features.cycle_length import cycle_length
from auricle.electroanatomy.features.entropy import sample_entropy
from auricle.electroanatomy.features.fractionation import (
    complex_fractionated_interval,
    deflections,
)
from auricle.electroanatomy.features.spectrum import (
    activity_envelope,
    dominant_frequency,
    organisation_index,
    power_spectrum,
    regularity_index,
)
from auricle.electroanatomy.features.voltage import peak_to_peak_voltage
from auricle.electroanatomy.synthetic import downstroke, ricker
from auricle.errors import InputError

RATE = 1000.0
TIME = np.arange(8000) / RATE


def train(period_ms: float, width_ms: float = 3.0) -> np.ndarray:
    """Bipolar activations, one every period."""
    phase = (TIME * 1000.0 + period_ms / 2) % period_ms - period_ms / 2
    return ricker(phase / width_ms)


def spikes(period_ms: float) -> np.ndarray:
    """One upright pulse, so one deflection, every period."""
    phase = TIME * 1000.0 % period_ms - period_ms / 2
    return np.exp(-((phase / 2.0) ** 2))


@pytest.mark.parametrize("seed", range(10))
def test_annotated_times_of_a_synthetic_map_are_the_truth(seed, recorded) -> None:
    """Without noise to the sample; with 0.01 mV of it, to 2 ms."""
    for noise, tolerance in ((0.0, 0.0), (0.01, 2.0)):
        for signal in recorded(seed, noise=noise).electrograms.values():
            for method in ("bipolar", "unipolar")[: 2 if signal.unipolar else 1]:
                found = annotated_activation_time(signal, method=method)
                assert abs(found - signal.local_activation_time) <= tolerance + 1e-9


@pytest.mark.parametrize("seed", range(10))
def test_voltages_of_a_synthetic_map_are_the_truth(seed, recorded) -> None:
    one = recorded(seed, noise=0.0)
    for row, signal in one.electrograms.items():
        found = peak_to_peak_voltage(signal.channel(signal.bipolar), sampling_rate=RATE)
        # Peaks between samples: a pulse of 3 ms at 1 kHz loses up to 3 % of its trough
        assert found == pytest.approx(one.points.bipolar_voltage[row], rel=0.03)


def test_an_electrogram_without_the_channel_or_the_annotation_has_no_time() -> None:
    bare = Electrogram(np.zeros((50, 1)), RATE, ("a",), bipolar="a")
    assert math.isnan(annotated_activation_time(bare, method="unipolar"))
    assert math.isnan(annotated_activation_time(bare, method="bipolar"))
    with pytest.raises(InputError, match="method"):
        annotated_activation_time(bare, method="wavelet")


def test_only_the_window_of_interest_counts() -> None:
    samples = ricker((np.arange(400.0) - 100) / 3) + 2 * ricker((np.arange(400.0) - 300) / 3)
    signal = Electrogram(
        samples[:, None],
        RATE,
        ("a",),
        bipolar="a",
        reference_annotation=120.0,
        window_of_interest=(-50.0, 50.0),
    )
    assert annotated_activation_time(signal, method="bipolar") == -20.0


@pytest.mark.parametrize("place", [60, 100, 139])
def test_marks_stand_where_the_pulse_was_put_whatever_its_sign(place) -> None:
    time = np.arange(200.0) - place
    assert unipolar_activation(downstroke(time / 4), sampling_rate=RATE) == place
    assert bipolar_activation(-ricker(time / 3), sampling_rate=RATE) == place


@pytest.mark.parametrize("period", [125.0, 160.0, 250.0])
def test_the_dominant_frequency_of_a_rhythm_is_its_rate(period) -> None:
    envelope = activity_envelope(train(period), sampling_rate=RATE)
    found = dominant_frequency(power_spectrum(envelope, sampling_rate=RATE))
    assert found == pytest.approx(1000.0 / period, abs=0.05)


def test_the_greater_of_two_waves_is_dominant_and_the_index_its_share() -> None:
    wave = 2.0 * np.sin(2 * np.pi * 5.0 * TIME) + np.sin(2 * np.pi * 9.0 * TIME)
    spectrum = power_spectrum(wave, sampling_rate=RATE)
    assert dominant_frequency(spectrum) == pytest.approx(5.0, abs=1e-9)
    assert regularity_index(spectrum) == pytest.approx(4.0 / 5.0, abs=0.03)


def test_indices_of_one_wave_are_near_one_and_of_noise_near_the_share_of_the_band(rng) -> None:
    pure = power_spectrum(np.sin(2 * np.pi * 6.0 * TIME), sampling_rate=RATE)
    assert regularity_index(pure) > 0.95
    assert organisation_index(pure) > 0.99
    noise = power_spectrum(rng.normal(size=60_000), sampling_rate=RATE)
    assert regularity_index(noise) == pytest.approx(0.75 / 12.0, abs=0.04)
    assert organisation_index(noise) == pytest.approx(4.0 / 47.0, abs=0.04)


def test_harmonics_count_as_organised_but_not_as_regular() -> None:
    wave = sum(np.sin(2 * np.pi * 4.0 * k * TIME) / math.sqrt(k) for k in (1, 2, 3, 4))
    spectrum = power_spectrum(wave, sampling_rate=RATE)
    assert organisation_index(spectrum) > 0.97
    assert regularity_index(spectrum) == pytest.approx(1 / (1 + 1 / 2 + 1 / 3), abs=0.03)


def test_the_power_of_a_wave_is_half_its_amplitude_squared() -> None:
    spectrum = power_spectrum(3.0 * np.sin(2 * np.pi * 7.0 * TIME), sampling_rate=RATE)
    assert spectrum.within(0.0, 500.0) == pytest.approx(4.5, rel=0.01)


@pytest.mark.parametrize("period", [180.0, 237.5, 400.0])
def test_the_cycle_length_is_the_period_to_a_tenth_of_a_sample(period, rng) -> None:
    noisy = train(period, width_ms=8.0) + rng.normal(0.0, 0.02, len(TIME))
    assert cycle_length(noisy, sampling_rate=RATE) == pytest.approx(period, abs=0.5)


def test_a_signal_that_does_not_repeat_has_no_cycle() -> None:
    with pytest.raises(InputError, match="repeat"):
        cycle_length(np.linspace(0.0, 1.0, 500) ** 3, sampling_rate=RATE)


@pytest.mark.parametrize(("period", "expected"), [(60.0, 60.0), (100.0, 100.0), (30.0, 60.0)])
def test_the_interval_of_deflections_is_the_period_but_for_the_refractory_time(
    period, expected
) -> None:
    found = complex_fractionated_interval(spikes(period), sampling_rate=RATE)
    assert found == pytest.approx(expected, abs=0.5)


def test_deflections_below_the_sensitivity_do_not_count() -> None:
    quiet = 0.04 * spikes(100.0)
    assert len(deflections(quiet, sampling_rate=RATE)) == 0
    assert math.isnan(complex_fractionated_interval(quiet, sampling_rate=RATE))
    assert len(deflections(quiet, sampling_rate=RATE, sensitivity=0.02)) == 80


def test_sample_entropy_of_white_noise_is_that_of_two_draws(rng) -> None:
    noise = rng.normal(size=4000)
    expected = -math.log(math.erf(0.2 / 2.0))
    for order in (1, 2):
        found = sample_entropy(noise, sampling_rate=RATE, order=order)
        assert found == pytest.approx(expected, abs=0.06)


def test_sample_entropy_counts_pairs_as_the_definition_does(rng) -> None:
    signal = rng.normal(size=60)
    reach = 0.2 * signal.std()
    count = {2: 0, 3: 0}
    for length in count:
        for i in range(58):
            for j in range(58):
                apart = np.abs(signal[i : i + length] - signal[j : j + length]).max()
                count[length] += i != j and apart <= reach
    expected = -math.log(count[3] / count[2]) if count[3] else math.inf
    assert sample_entropy(signal, sampling_rate=RATE) == pytest.approx(expected)


@pytest.mark.parametrize(
    "feature",
    [
        unipolar_activation,
        bipolar_activation,
        peak_to_peak_voltage,
        cycle_length,
        activity_envelope,
        power_spectrum,
        complex_fractionated_interval,
        sample_entropy,
    ],
)
def test_features_refuse_signals_with_gaps_and_rates_of_zero(feature) -> None:
    gap = train(100.0)
    gap[10] = np.nan
    with pytest.raises(InputError, match="missing"):
        feature(gap, sampling_rate=RATE)
    with pytest.raises(InputError):
        feature(train(100.0), sampling_rate=0.0)
    with pytest.raises(InputError, match="give"):
        feature([1.0], sampling_rate=RATE)
