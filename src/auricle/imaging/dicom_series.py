"""Slices sorted into series: one stack of one moment each, whatever the files call themselves."""

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats
from auricle.imaging.dicom_pixels import pixel_digest
from auricle.imaging.dicom_slice import SliceHeader

SAME_PLACE_MM = 0.01
"""Slices nearer to each other than this lie at one place."""
_PARALLEL = 1e-2
_PHASE_WORDS = {
    "percent": "{:g} % of the cycle",
    "trigger_ms": "{:g} ms after the R wave",
    "temporal": "temporal position {}",
    "acquisition": "acquisition {}",
}


@dataclass(frozen=True)
class Series:
    """Slices that belong together.

    Attributes
    ----------
    slices
        In the order of their places.
    phase
        What sets it apart from its neighbours in words; empty if nothing does.
    copies
        How many files were left out as copies of others.
    scanned
        How many slices the scanner's own series has, other phases included.
    """

    slices: tuple[SliceHeader, ...]
    phase: str
    copies: int
    scanned: int


def sort_into_series(slices: Iterable[SliceHeader]) -> list[Series]:
    """Group slices by scanner's series, format, orientation and phase, whatever their file names.

    Within one identifier, slices part where they are shown at several moments: by the phase of
    the cycle where the files give it, or else, where places repeat, by trigger time, temporal
    position, acquisition or the order of instances, whichever takes the copies of a place apart.

    Returns
    -------
    list of Series
        By number of series, then phase; independent of file names.
    """
    groups: dict[Hashable, list[SliceHeader]] = {}
    for header in slices:
        groups.setdefault((header.number, header.series, header.kind, header.shape), []).append(
            header
        )
    found = [
        series
        for key in sorted(groups, key=repr)
        for stack in _parallel(groups[key])
        for series in _phases(stack)
    ]
    return sorted(found, key=_rank)


def normal_of(header: SliceHeader) -> Floats:
    """Unit vector across the slice: column direction × row direction."""
    across = np.cross(header.orientation[:3], header.orientation[3:])
    normal: Floats = across / max(float(np.linalg.norm(across)), 1e-12)
    return normal


def _rank(series: Series) -> tuple[int, float, float, int, int, float]:
    first = series.slices[0]
    phase = first.phase
    return (
        first.number,
        -1.0 if phase.percent is None else phase.percent,
        -1.0 if phase.trigger_ms is None else phase.trigger_ms,
        phase.acquisition or 0,
        min((header.order or 0) for header in series.slices),
        first.position[2],
    )


def _parallel(slices: list[SliceHeader]) -> list[list[SliceHeader]]:
    """Stacks of slices that look the same way with the same pixels."""
    stacks: list[list[SliceHeader]] = []
    for header in sorted(slices, key=_content):
        for stack in stacks:
            turned = np.abs(np.subtract(stack[0].orientation, header.orientation)).max()
            if turned < _PARALLEL and np.allclose(stack[0].spacing, header.spacing, rtol=1e-3):
                stack.append(header)
                break
        else:
            stacks.append([header])
    return stacks


def _content(header: SliceHeader) -> tuple[object, ...]:
    """A key to sort by that no renaming of files changes."""
    return (header.orientation, header.position, header.order or 0, header.instance)


def _phases(stack: list[SliceHeader]) -> list[Series]:
    kept, copies = _without_copies(_by_place(stack))
    percents = {header.phase.percent for header in kept}
    groups = None
    if len(percents) > 1:
        groups = _split(kept, lambda header: header.phase.percent, repeats_allowed=True)
    if groups is None and _repeats(kept):
        groups = _apart(kept)
    parts = [kept] if groups is None else groups
    return [
        Series(tuple(_by_place(part)), _phase_text(parts, i), copies, len(kept))
        for i, part in enumerate(parts)
    ]


def _by_place(slices: Sequence[SliceHeader]) -> list[SliceHeader]:
    normal = normal_of(slices[0])
    return sorted(
        slices, key=lambda header: (float(np.dot(header.position, normal)), header.order or 0)
    )


def _places(slices: Sequence[SliceHeader]) -> list[int]:
    """Number of the place of each slice, counted along the normal."""
    normal = normal_of(slices[0])
    heights = np.array([np.dot(header.position, normal) for header in slices])
    order = np.argsort(heights, kind="stable")
    ranks = np.concatenate([[0], np.cumsum(np.diff(heights[order]) >= SAME_PLACE_MM)])
    places = np.empty(len(slices), int)
    places[order] = ranks
    return [int(place) for place in places]


def _repeats(slices: Sequence[SliceHeader]) -> bool:
    return len(set(_places(slices))) < len(slices)


def _without_copies(slices: list[SliceHeader]) -> tuple[list[SliceHeader], int]:
    """Leave out slices that show the same pixels at the same place and moment as another."""
    kept: list[SliceHeader] = []
    groups: dict[Hashable, list[SliceHeader]] = {}
    for place, header in zip(_places(slices), slices, strict=True):
        groups.setdefault((place, header.phase), []).append(header)
    for together in groups.values():
        if len(together) == 1:
            kept += together
            continue
        different: dict[Hashable, SliceHeader] = {}
        for header in sorted(together, key=_content):
            different.setdefault(pixel_digest(header), header)
        kept += different.values()
    return kept, len(slices) - len(kept)


def _apart(slices: list[SliceHeader]) -> list[list[SliceHeader]] | None:
    """Split slices whose places repeat by the first thing that takes them all apart."""
    keys: tuple[Callable[[SliceHeader], Hashable], ...] = (
        lambda header: header.phase.temporal,
        lambda header: header.phase.trigger_ms,
        lambda header: header.phase.acquisition,
    )
    for key in keys:
        groups = _split(slices, key, repeats_allowed=False)
        if groups is not None:
            return groups
    return _runs(slices)


def _split(
    slices: list[SliceHeader], key: Callable[[SliceHeader], Hashable], *, repeats_allowed: bool
) -> list[list[SliceHeader]] | None:
    groups: dict[Hashable, list[SliceHeader]] = {}
    for header in slices:
        groups.setdefault(key(header), []).append(header)
    if len(groups) < 2 or any(len(group) < 2 for group in groups.values()):
        return None
    if not repeats_allowed and any(_repeats(group) for group in groups.values()):
        return None
    # None, where a file does not say, comes last
    return [groups[name] for name in sorted(groups, key=lambda name: (name is None, name))]


def _runs(slices: list[SliceHeader]) -> list[list[SliceHeader]] | None:
    """Split by the order of instances: a new run begins where a place comes again."""
    numbers = [header.order for header in slices]
    if None in numbers or len(set(numbers)) < len(numbers):
        return None
    runs: list[list[SliceHeader]] = [[]]
    seen: set[int] = set()
    place_of = dict(zip((id(header) for header in slices), _places(slices), strict=True))
    for header in sorted(slices, key=lambda header: header.order or 0):
        if place_of[id(header)] in seen:
            runs.append([])
            seen = set()
        seen.add(place_of[id(header)])
        runs[-1].append(header)
    even = len({len(run) for run in runs}) == 1
    return runs if len(runs) > 1 and len(runs[0]) > 1 and even else None


def _phase_text(parts: Sequence[Sequence[SliceHeader]], index: int) -> str:
    """What sets one part of a stack apart from the others, in words."""
    for name, words in _PHASE_WORDS.items():
        values = [{getattr(header.phase, name) for header in part} for part in parts]
        told = all(len(value) == 1 and None not in value for value in values)
        if (
            told
            and len(set().union(*values)) == len(parts)
            and (len(parts) > 1 or name == "percent")
        ):
            return words.format(*values[index])
    return f"run {index + 1} of {len(parts)} by instance number" if len(parts) > 1 else ""
