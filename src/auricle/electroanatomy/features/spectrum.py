"""Frequency features of an electrogram: dominant frequency, regularity and organisation index."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import butter, detrend, sosfiltfilt, welch

from auricle.arrays import Floats
from auricle.electroanatomy.features.signal import checked_signal
from auricle.errors import InputError

BAND = (3.0, 15.0)
"""Hz; where the dominant frequency of atrial activity is looked for."""
_ATRIAL_BAND, _ENVELOPE = (40.0, 250.0), 20.0
_FILTER_ORDER = 3
_REGULARITY_BAND, _HARMONIC_BAND = 0.75, 1.0
_HARMONICS = 4
_RESOLUTION = 0.05


@dataclass(frozen=True, eq=False)
class PowerSpectrum:
    """One-sided power spectral density: frequencies (f,) in Hz, power (f,) in mV²/Hz."""

    frequencies: Floats
    power: Floats

    def within(self, low: float, high: float) -> float:
        """Power between two frequencies, both included, mV²."""
        inside = (self.frequencies >= low) & (self.frequencies <= high)
        return float(self.power[inside].sum() * (self.frequencies[1] - self.frequencies[0]))


def activity_envelope(samples: ArrayLike, *, sampling_rate: float) -> Floats:
    """Signal whose spectrum shows how often a bipole is activated, shape (s,).

    Band pass 40 to 250 Hz, magnitude, low pass 20 Hz, by Butterworth filters of third order run
    forwards and backwards (Botteron and Smith, IEEE Trans. Biomed. Eng. 42:548, 1995); the upper
    edge is 0.45 of the rate where that is lower.

    Raises
    ------
    InputError
        If the signal is too short for the filters, or the rate is below 100 Hz.
    """
    signal = checked_signal(samples, sampling_rate=sampling_rate, shortest=64)
    low, high = _ATRIAL_BAND[0], min(_ATRIAL_BAND[1], 0.45 * sampling_rate)
    if high <= low:
        raise InputError(f"sampling rate {sampling_rate:g} Hz: give 100 Hz or more")
    band = butter(_FILTER_ORDER, (low, high), "bandpass", fs=sampling_rate, output="sos")
    envelope = butter(_FILTER_ORDER, _ENVELOPE, "lowpass", fs=sampling_rate, output="sos")
    smooth: Floats = sosfiltfilt(envelope, np.abs(sosfiltfilt(band, signal)))
    return smooth


def power_spectrum(
    samples: ArrayLike, *, sampling_rate: float, segment: float = 4.0
) -> PowerSpectrum:
    """Welch's spectrum: Hann windows of `segment` seconds, half overlapping, 0.05 Hz apart.

    The trend is taken off first; what a signal of T seconds tells apart stays about 2/T Hz,
    whatever the spacing.

    Raises
    ------
    InputError
        If samples are missing or there are hardly any.
    """
    signal = checked_signal(samples, sampling_rate=sampling_rate, shortest=64)
    length = min(round(segment * sampling_rate), len(signal))
    padded = max(round(sampling_rate / _RESOLUTION), length)
    frequencies, power = welch(
        detrend(signal), sampling_rate, window="hann", nperseg=length, nfft=padded
    )
    return PowerSpectrum(frequencies, power)


def dominant_frequency(spectrum: PowerSpectrum, *, band: tuple[float, float] = BAND) -> float:
    """Frequency of the greatest power within a band, Hz.

    After Sanders et al., Circulation 112:789, 2005.

    Raises
    ------
    InputError
        If the band holds no power.

    Examples
    --------
    >>> time = np.arange(4000) / 1000.0
    >>> wave = np.sin(2 * np.pi * 6.0 * time)
    >>> round(dominant_frequency(power_spectrum(wave, sampling_rate=1000.0)), 6)
    6.0
    """
    inside = (spectrum.frequencies >= band[0]) & (spectrum.frequencies <= band[1])
    if not (spectrum.power[inside] > 0).any():
        raise InputError(f"no power between {band[0]:g} and {band[1]:g} Hz: choose another band")
    return float(spectrum.frequencies[inside][spectrum.power[inside].argmax()])


def regularity_index(spectrum: PowerSpectrum, *, band: tuple[float, float] = BAND) -> float:
    """Share of the band's power within 0.75 Hz about the dominant frequency, 0 … 1.

    Near 1 for one rhythm; Sanders et al. (Circulation 112:789, 2005) ask for 0.2 or more before
    they trust a dominant frequency.

    Raises
    ------
    InputError
        If the band holds no power.
    """
    peak = dominant_frequency(spectrum, band=band)
    half = _REGULARITY_BAND / 2.0
    inside = spectrum.within(max(peak - half, band[0]), min(peak + half, band[1]))
    return inside / spectrum.within(*band)


def organisation_index(
    spectrum: PowerSpectrum, *, band: tuple[float, float] = BAND, highest: float = 50.0
) -> float:
    """Share of the power up to `highest` at the dominant frequency and three harmonics, 0 … 1.

    One Hz about each counts, between the band's lower edge and `highest` (Everett et al., IEEE
    Trans. Biomed. Eng. 48:969, 2001).

    Raises
    ------
    InputError
        If the band holds no power.
    """
    peak = dominant_frequency(spectrum, band=band)
    half = _HARMONIC_BAND / 2.0
    places = (peak * k for k in range(1, _HARMONICS + 1))
    peaks = sum(spectrum.within(place - half, min(place + half, highest)) for place in places)
    return peaks / spectrum.within(min(band[0], peak - half), highest)
