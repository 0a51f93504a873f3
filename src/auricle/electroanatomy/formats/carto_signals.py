"""CARTO 3's ``ECG_Export``: one column a channel, whole numbers times a gain, at 1 kHz."""

import re
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats
from auricle.electroanatomy.formats.number_tables import number, number_table
from auricle.surface.formats.header import damaged

SAMPLING_RATE = 1000.0
"""Hz; CARTO 3 records at this rate and its files do not state it."""
_GAIN = re.compile(rb"gain\)?\s*=\s*(\S+)", re.IGNORECASE)
_ROLE = re.compile(rb"(Unipolar|Bipolar|Reference)[^=]*=\s*(.*?)(?=\s+(?:Bipolar|Reference)\b|$)")
_CHANNEL = re.compile(rb"(\S[^()\t]*)\((\d+)\)")
_HEADER_LINES = 8
_MOST_CHANNELS = 1024


@dataclass(frozen=True, eq=False)
class CartoSignals:
    """Signals of one point: samples (s, c) in mV, written channel names, roles by name."""

    samples: Floats
    channels: tuple[str, ...]
    roles: dict[str, str]


def parse_carto_signals(content: bytes, *, all_channels: bool = False) -> CartoSignals:
    """Signals of an ``ECG_Export`` file.

    Parameters
    ----------
    content
        The whole file.
    all_channels
        Keep every channel, not only the mapping and reference ones the file names.

    Raises
    ------
    FormatError
        If it has no gain or channels, or its rows are not whole.
    """
    head, rows = _split(content)
    gains = [found for line in head if (found := _GAIN.search(line))]
    if not gains:
        raise damaged("states no gain of its electrograms")
    gain = number(gains[0][1], where="the gain of its electrograms")
    if not np.isfinite(gain) or gain == 0.0:
        raise damaged("states a gain of its electrograms that is no size")
    channels = _channels(head[-1])
    roles = _roles(head[:-1])
    wanted = [
        place for place, name in enumerate(channels) if all_channels or name in roles.values()
    ]
    table = number_table(rows, where="its electrograms")
    if table.shape[1] != len(channels) or not len(table):
        raise damaged(f"names {len(channels)} channels and holds {table.shape[1]} columns")
    return CartoSignals(table[:, wanted] * gain, tuple(channels[place] for place in wanted), roles)


def _split(content: bytes) -> tuple[list[bytes], list[bytes]]:
    """Lines up to the names of the channels, and those of numbers."""
    lines = [line.strip() for line in content.splitlines()]
    for place, line in enumerate(lines[:_HEADER_LINES]):
        if b"=" not in line and _CHANNEL.search(line) is not None:
            return lines[: place + 1], [row for row in lines[place + 1 :] if row]
    raise damaged("names no channels of its electrograms")


def _channels(line: bytes) -> list[str]:
    names = [found[1].decode("latin-1").strip() for found in _CHANNEL.finditer(line)]
    if len(names) > _MOST_CHANNELS:
        raise damaged(f"names more than {_MOST_CHANNELS} channels")
    return names


def _roles(head: list[bytes]) -> dict[str, str]:
    """Channel of each role: ``unipolar``, ``bipolar``, ``reference``."""
    found = (match for line in head for match in _ROLE.finditer(line))
    return {match[1].decode().lower(): match[2].decode("latin-1").strip() for match in found}
