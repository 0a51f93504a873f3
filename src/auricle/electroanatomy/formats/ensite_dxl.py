"""EnSite Precision's ``DxL_*.csv``: a column a point, first the table, then the waveforms.

Row names after public descriptions of exports of revision 5.x: ``pt number``, ``roving x`` …
``surfPt z``, ``utilized``, ``end time``, ``ref LAT`` and ``rov LAT`` (s), ``peak2peak`` (mV).
"""

import math
import re
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Truths
from auricle.electroanatomy.electrogram import MILLISECONDS, Electrogram
from auricle.electroanatomy.formats.number_tables import number, number_table
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.naming import channel_names
from auricle.electroanatomy.points import MappingPoints
from auricle.errors import FormatError
from auricle.surface.formats.header import count_of, damaged

_REVISION = re.compile(rb"File Revision\s*:\s*,?\s*(\d+)\.")
_COUNT = re.compile(rb"Total number of data points \(columns\):\s*,\s*(\S+)")
_FILE = re.compile(rb"This is file (\d+) of (\d+)")
_BEGIN = b"begin data"
_WAVES = (b"rov trace", b"ref trace")
_REVISIONS = (5,)
_MISSING_WORDS = (b"", b"invalid", b"nan")


@dataclass(frozen=True, eq=False)
class DxlFile:
    """One file of points: which of how many it is, their table, and electrograms by row."""

    place: int
    total: int
    points: MappingPoints
    electrograms: dict[int, Electrogram]


def parse_dxl(content: bytes, omissions: Omissions, *, signals: bool = True) -> DxlFile:
    """Points and electrograms of one file.

    Points that stand at no position are left out and counted in `omissions`.

    Raises
    ------
    FormatError
        If the revision is not 5, a row has another length than announced, waveforms are shorter
        than their duration, or a number is none.
    """
    lines = [line.strip() for line in content.splitlines()]
    begin = next((k for k, line in enumerate(lines) if line.lower().startswith(_BEGIN)), None)
    revision = _REVISION.search(content[:4096])
    if begin is None or revision is None or int(revision[1]) not in _REVISIONS:
        raise FormatError("holds points of a revision that is not 5: export from Precision again")
    head = b"\n".join(lines[:begin])
    announced = _COUNT.search(head)
    count = count_of(announced[1] if announced else b"", "points")
    rows, waves = _split(lines[begin + 1 :])
    table = {name: _columns(words, count) for name, words in rows.items()}
    position = _triples(table, "roving", count)
    placed = np.asarray(np.isfinite(position).all(axis=1))
    omissions.add("points without a position left out", int((~placed).sum()))
    found = _FILE.search(head)
    return DxlFile(
        int(found[1]) if found else 1,
        int(found[2]) if found else 1,
        _points(table, position, count).chosen(placed) if count else MappingPoints(position),
        _electrograms(table, waves, placed) if signals and count else {},
    )


def _split(lines: list[bytes]) -> tuple[dict[str, list[bytes]], list[bytes]]:
    """Rows of the table by name, and the lines from its end on."""
    rows: dict[str, list[bytes]] = {}
    for place, line in enumerate(lines):
        name, *words = line.split(b",")
        if name.lower().startswith(b"seg data len"):
            return rows, lines[place:]
        rows.setdefault(name.strip().rstrip(b":").decode("latin-1").lower(), words)
    return rows, []


def _columns(words: list[bytes], count: int) -> list[bytes]:
    """Words of a row, one a point; a comma at the line's end adds none."""
    trimmed = words[:-1] if len(words) == count + 1 and not words[-1].strip() else words
    return [word.strip() for word in trimmed]


def _row(table: dict[str, list[bytes]], name: str, count: int) -> Floats:
    """Numbers of a row, NaN where there is none."""
    words = table.get(name)
    if words is None:
        return np.full(count, np.nan)
    if len(words) != count:
        raise damaged(f"announces {count:,} points and holds {len(words):,} of {name!r}")
    return np.array(
        [
            math.nan if word.lower() in _MISSING_WORDS else number(word, where="its points")
            for word in words
        ]
    )


def _triples(table: dict[str, list[bytes]], name: str, count: int) -> Floats:
    return np.column_stack([_row(table, f"{name} {axis}", count) for axis in "xyz"])


def _points(table: dict[str, list[bytes]], position: Floats, count: int) -> MappingPoints:
    lag = _row(table, "rov lat", count) - _row(table, "ref lat", count)
    numbers = _row(table, "pt number", count)
    used = _row(table, "utilized", count)
    known = np.isfinite(numbers).all()
    return MappingPoints(
        np.where(np.isfinite(position), position, 0.0),  # rows without one are dropped after
        _triples(table, "surfpt", count),
        local_activation_time=lag * MILLISECONDS,
        bipolar_voltage=_row(table, "peak2peak", count),
        identifiers=numbers.astype(np.int64) if known else np.arange(1, count + 1),
        included=np.where(np.isnan(used), 1.0, used) != 0.0,
    )


def _electrograms(
    table: dict[str, list[bytes]], waves: list[bytes], placed: Truths
) -> dict[int, Electrogram]:
    """Electrograms by row of the points that are placed."""
    count = len(placed)
    blocks = {wave: _block(waves, wave, count) for wave in _WAVES}
    heard = {wave: found for wave, found in blocks.items() if found is not None}
    if not heard:
        return {}
    if len({len(samples) for _, samples in heard.values()}) > 1:
        raise damaged("holds waveforms of different lengths")
    rate, seconds = _stated(waves, b"sample rate"), _stated(waves, b"exported seconds")
    for _, samples in heard.values():
        if abs(len(samples) - rate * seconds) > 1:
            raise damaged(f"announces {seconds:g} s at {rate:g} Hz and holds {len(samples):,} rows")
    reference, mapped = (
        (seconds - _row(table, "end time", count) + _row(table, name, count)) * rate
        for name in ("ref lat", "rov lat")
    )
    found = {}
    for row, place in enumerate(np.flatnonzero(placed)):
        own = {wave: pair for wave, pair in heard.items() if np.isfinite(pair[1][:, place]).any()}
        if not own:
            continue
        channels = channel_names([names[place] for names, _ in own.values()])
        named = dict(zip(own, channels, strict=True))
        found[row] = Electrogram(
            np.column_stack([samples[:, place] for _, samples in own.values()]),
            rate,
            channels,
            bipolar=named.get(_WAVES[0], ""),
            reference=named.get(_WAVES[1], ""),
            reference_annotation=float(reference[place]),
            map_annotation=float(mapped[place]),
        )
    return found


def _block(lines: list[bytes], wave: bytes, count: int) -> tuple[list[str], Floats] | None:
    """Names and samples (s, points) of one kind of waveform, None if there is none."""
    starts = [place for place, line in enumerate(lines) if line.lower().startswith(wave)]
    if not starts:
        return None
    names = [word.decode("latin-1") for word in _columns(lines[starts[0]].split(b",")[1:], count)]
    rows = []
    for line in lines[starts[0] + 1 :]:
        if not line.startswith(b","):
            break
        rows.append(b",".join(_columns(line.split(b",")[1:], count)))
    samples = number_table(rows, where="its waveforms", delimiter=",")
    if len(names) != count or samples.shape[1:] != (count,):
        raise damaged(f"holds waveforms of another number of points than {count:,}")
    return names, samples


def _stated(lines: list[bytes], name: bytes) -> float:
    for line in lines:
        head, _, rest = line.partition(b",")
        if head.strip().rstrip(b":").lower() == name:
            value = number(rest.strip(b", "), where="its header")
            if math.isfinite(value) and value > 0:
                return value
    raise damaged(f"states no {name.decode()} of its waveforms")
