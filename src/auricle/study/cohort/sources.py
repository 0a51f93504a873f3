"""Which cases a study's entries stand for, and what each is called."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePath

from auricle.errors import InputError
from auricle.imaging.reading import READABLE as VOLUMES
from auricle.surface.reading import READABLE as SURFACES

_GENERATED = re.compile(r"[a-z]{2,}:(?:[a-z_]+=|$)")
_RANGE = re.compile(r"\bseed=(\d+)\.\.(\d+)")
_SECOND_HALVES = (".elem", ".dat")
"""Files that belong to the .pts beside them."""


def is_generated(source: str) -> bool:
    """Whether a case is made up (``phantom:seed=3,preset=medium``), not read.

    Examples
    --------
    >>> is_generated("phantom:seed=3,preset=medium"), is_generated("scans/phantom.nrrd")
    (True, False)
    """
    return _GENERATED.match(source) is not None


def expanded(entries: Iterable[str]) -> tuple[str, ...]:
    """The cases that entries stand for, each once, in order.

    An entry is a file; a pattern with ``*``; a folder, of which every surface and image is a case,
    or else the folder itself where it holds other files (a DICOM series), or else its folders in
    turn; or a generated case, with a range of seeds if need be.

    Raises
    ------
    InputError
        If an entry stands for nothing.

    Examples
    --------
    >>> expanded(["phantom:seed=1..3,preset=small"])[1:]
    ('phantom:seed=2,preset=small', 'phantom:seed=3,preset=small')
    """
    return tuple(dict.fromkeys(case for entry in entries for case in _cases(entry)))


def _cases(entry: str) -> list[str]:
    if is_generated(entry):
        return _seeds(entry)
    found = [str(case) for place in _matching(Path(entry)) for case in _on_disk(place)]
    if not found:
        raise InputError(f"{entry}: stands for no surface and no image: correct the path")
    return found


def _matching(pattern: Path) -> list[Path]:
    if pattern.exists() or not set("*?[") & set(str(pattern)):
        return [pattern]
    return sorted(Path(pattern.anchor).glob(str(pattern.relative_to(pattern.anchor))))


def _seeds(entry: str) -> list[str]:
    span = _RANGE.search(entry)
    if span is None:
        return [entry]
    first, last = map(int, span.groups())
    if last < first:
        raise InputError(f"{entry}: a range that is empty: write the smaller seed first")
    return [_RANGE.sub(f"seed={seed}", entry, count=1) for seed in range(first, last + 1)]


def _on_disk(place: Path) -> Iterator[Path]:
    if not place.exists():
        raise InputError(f"{place}: does not exist: correct the path")
    if not place.is_dir():
        yield place
        return
    inside = sorted(each for each in place.iterdir() if not each.name.startswith("."))
    files = [each for each in inside if each.is_file()]
    readable = [each for each in files if _is_case(each)]
    if readable:
        yield from readable
    elif files:
        yield place
    else:
        for folder in inside:
            yield from _on_disk(folder)


def _is_case(file: Path) -> bool:
    suffixes = {suffix for suffix in (*SURFACES, *VOLUMES) if suffix != ".dcm"}
    return file.name.lower().endswith(tuple(suffixes - set(_SECOND_HALVES)))


def case_names(sources: Sequence[str]) -> tuple[str, ...]:
    """A name for each case: the file's without suffix, after as many folders as tell all apart.

    Examples
    --------
    >>> case_names(["in/p1/atrium.vtp", "in/p2/atrium.vtp", "in/p2/left.nii.gz"])
    ('p1/atrium', 'p2/atrium', 'left')
    """
    parts = [_parts(source) for source in sources]
    names = [each[-1] for each in parts]
    for depth in range(2, max(map(len, parts), default=0) + 1):
        often = Counter(names)
        names = [
            "/".join(each[-depth:]) if often[name] > 1 else name
            for each, name in zip(parts, names, strict=True)
        ]
    return tuple(names)


def _parts(source: str) -> tuple[str, ...]:
    if is_generated(source):
        return (source,)
    path = PurePath(source)
    name = path.name
    for suffix in (".gz", path.with_name(name.removesuffix(".gz")).suffix):
        name = name.removesuffix(suffix) or name
    return (*(part for part in path.parts[:-1] if part not in (path.anchor, "..")), name)
