"""Electrograms: what the electrodes recorded at one mapping point, with its annotations."""

import math
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, read_only
from auricle.errors import InputError

MILLISECONDS = 1000.0


@dataclass(frozen=True, eq=False)
class Electrogram:
    """Simultaneous signals at one mapping point.

    Parameters
    ----------
    samples
        Shape (s, c), mV, one column a channel; NaN where nothing was recorded.
    sampling_rate
        Samples a second, Hz.
    channels
        Names of the columns.
    bipolar, unipolar, reference
        Which channel is the mapping bipole, the mapping unipole and the timing reference;
        empty where the file does not say, or does not hold it.
    reference_annotation, map_annotation
        Sample index, from 0, of the reference's and of the local activation; NaN if missing.
    window_of_interest
        First and last moment in which activation counts, ms after the reference annotation.

    Raises
    ------
    InputError
        If shapes and names disagree, the rate is not positive, or a role names no channel.

    Examples
    --------
    >>> signal = Electrogram(np.zeros((5, 1)), 1000.0, ("M1-M2",), bipolar="M1-M2",
    ...                      reference_annotation=1.0, map_annotation=4.0)
    >>> signal.local_activation_time
    3.0
    """

    samples: Floats
    sampling_rate: float
    channels: tuple[str, ...]
    bipolar: str = ""
    unipolar: str = ""
    reference: str = ""
    reference_annotation: float = math.nan
    map_annotation: float = math.nan
    window_of_interest: tuple[float, float] = (math.nan, math.nan)

    def __post_init__(self) -> None:
        object.__setattr__(self, "samples", read_only(self.samples, np.float64))
        if self.samples.ndim != 2 or self.samples.shape[1] != len(self.channels):
            raise InputError(
                f"samples of shape {self.samples.shape} for {len(self.channels)} channels: "
                "give one column a channel"
            )
        if np.isinf(self.samples).any():
            raise InputError("an electrogram holds infinite values: mark them NaN")
        if not (math.isfinite(self.sampling_rate) and self.sampling_rate > 0):
            raise InputError(f"sampling rate {self.sampling_rate}: give a positive number (Hz)")
        unknown = {self.bipolar, self.unipolar, self.reference} - {"", *self.channels}
        if unknown:
            raise InputError(f"{len(unknown)} named channels are not there: name one that is")

    @property
    def local_activation_time(self) -> float:
        """Map annotation minus reference annotation, ms; NaN if either is missing."""
        samples = self.map_annotation - self.reference_annotation
        return samples / self.sampling_rate * MILLISECONDS

    def channel(self, name: str) -> Floats:
        """Signal of one channel, shape (s,), mV.

        Raises
        ------
        InputError
            If there is no such channel.
        """
        if name not in self.channels:
            raise InputError(f"there is no channel {name!r}: choose one of {self.channels}")
        signal: Floats = self.samples[:, self.channels.index(name)]
        return signal

    @property
    def window(self) -> slice:
        """Samples within the window of interest; all where the window is not known.

        Raises
        ------
        InputError
            If the window lies outside what was recorded.
        """
        edges = np.array(self.window_of_interest) / MILLISECONDS * self.sampling_rate
        edges = edges + self.reference_annotation
        if not np.isfinite(edges).all():
            return slice(0, len(self.samples))
        first, last = (round(float(edge)) for edge in edges)
        first, stop = max(first, 0), min(last + 1, len(self.samples))
        if first >= stop:
            raise InputError("the window of interest lies outside the recording: choose another")
        return slice(first, stop)
