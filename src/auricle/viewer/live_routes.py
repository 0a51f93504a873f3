"""What the page asks of a live map: samples come and go, the map follows, and is judged."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.errors import InputError
from auricle.progress import Progress
from auricle.sampling.samples import Samples
from auricle.sampling.samples_file import read_samples
from auricle.viewer.container import packed
from auricle.viewer.endpoints import Call, Endpoint, Work
from auricle.viewer.live_map import Aim, LiveMap, Snapshot
from auricle.viewer.open_case import OpenCase
from auricle.viewer.workspace import Workspace

MOST_REVIEWED = 14
"""Numbers of samples at which a review judges a study."""
_FEWEST = 5


def state(call: Call) -> bytes:
    """The live map as it is: header, map and deviation on the surface, samples, next point."""
    return _state(_live(call.workspace))


def begin(call: Call) -> bytes:
    """Begin a new live map: ``{name, unit, target_nrmse, noise, cycle_length_ms}``."""
    case = _case(call.workspace)
    call.workspace.put(LiveMap(case.prepared, _aim(call.document())))
    return _state(_live(call.workspace))


def add(call: Call) -> bytes:
    """Take a sample: ``{position: [x, y, z], value}``, mm and the map's unit."""
    told = call.document()
    position, value = told.get("position"), told.get("value")
    if not isinstance(position, list) or not all(map(_is_number, [*position, value])):
        raise InputError("a sample is a position, three numbers in mm, and a value: give both")
    live = _live(call.workspace)
    live.add(np.array(position, dtype=float), float(str(value)))
    return _state(live)


def take_all(call: Call) -> bytes:
    """Take these samples in place of all others: ``{positions: [[x, y, z], …], values: […]}``."""
    told = call.document()
    live = _live(call.workspace)
    try:
        positions = np.array(told.get("positions"), dtype=float).reshape(-1, 3)
        values = np.array(told.get("values"), dtype=float).reshape(-1)
    except (TypeError, ValueError) as fault:
        raise InputError("samples are positions, three numbers each, and values") from fault
    fresh = LiveMap(live.prepared, live.aim)
    fresh.load(Samples(positions, values, name=live.aim.name, unit=live.aim.unit))
    fresh.redo(len(values))
    fresh.refit()
    call.workspace.put(fresh)
    return _state(fresh)


def go_to(call: Call) -> bytes:
    """Let the map rest on the first so many samples: ``{n_taken}``; undo, redo and playback."""
    count = call.document().get("n_taken")
    if not isinstance(count, int):
        raise InputError("how many samples: give a whole number")
    live = _live(call.workspace)
    live.go_to(count)
    return _state(live)


def load_table(call: Call) -> Mapping[str, Any]:
    """Samples from an uploaded table in place of all others, none taken yet.

    The query names its columns: ``x``, ``y``, ``z``, ``value`` and perhaps ``noise``.
    """
    path, asked = call.uploaded(), call.query
    columns = {axis: asked[axis] for axis in "xyz" if axis in asked}
    live = _live(call.workspace)
    try:
        read = read_samples(
            path, columns=columns, value=asked.get("value", "LAT"), noise=asked.get("noise") or None
        )
        fresh = LiveMap(live.prepared, _renamed(live.aim, read.name, read.unit))
        fresh.load(read)
    except InputError as fault:
        raise InputError(str(fault).replace(str(path), path.name)) from fault
    call.workspace.put(fresh)
    return dict(fresh.described())


def play(call: Call) -> bytes:
    """A recording of the open case, none of its samples taken yet: ``{recording, …}``."""
    told = call.document()
    case, number = _case(call.workspace), told.get("recording")
    if not isinstance(number, int) or not 0 <= number < len(case.recordings):
        raise InputError(f"which recording: give 0 to {len(case.recordings) - 1}")
    recording = case.recordings[number]
    wraps = recording.cycle_length if told.get("wraps", True) else None
    aim = _aim({**told, "cycle_length_ms": wraps})
    fresh = LiveMap(case.prepared, _renamed(aim, recording.samples.name, recording.samples.unit))
    fresh.load(recording.samples)
    call.workspace.put(fresh)
    return _state(fresh)


def judge(call: Call) -> bytes:
    """Whether the samples so far are enough, why not, and how fine a map they support where.

    Fits hyper-parameters anew if it is time to: ``refitted`` then says that the map has changed.
    """
    workspace = call.workspace
    with workspace.lock:
        live = _live(workspace)
        refitted = live.refit()
        snapshot = live.snapshot
    header, arrays = _judged(snapshot)
    return packed({**header, "refitted": refitted}, arrays)


def review(call: Call) -> Work:
    """Judge the row of samples after the first 5, … and all: and say when it was enough."""
    live = _live(call.workspace)
    whole = live.row

    def run(progress: Progress) -> Mapping[str, Any]:
        most = len(whole.samples)
        if most < _FEWEST:
            raise InputError(f"{most} samples: a study has {_FEWEST} at least")
        counts = np.unique(np.rint(np.geomspace(_FEWEST, most, MOST_REVIEWED)).astype(int))
        steps = []
        for index, count in enumerate(counts.tolist()):
            progress("judge the study", index, len(counts))
            error, found = whole.first(count).judged()
            steps.append(
                {
                    "n_samples": count,
                    "predicted_nrmse": _finite(error),
                    "enough": found.verdict.enough,
                    "reasons": list(found.verdict.reasons),
                }
            )
        progress("judge the study", len(counts), len(counts))
        return {"steps": steps, "enough_from": _enough_from(steps)}

    return Work(run)


def _enough_from(steps: list[dict[str, Any]]) -> int | None:
    """Number of samples from which on it was enough, to the end; None if it never was.

    >>> _enough_from([{"n_samples": n, "enough": n > 20} for n in (5, 30, 60)])
    30
    >>> _enough_from([{"n_samples": n, "enough": n == 30} for n in (5, 30, 60)]) is None
    True
    """
    found = None
    for step in reversed(steps):
        if not step["enough"]:
            break
        found = int(step["n_samples"])
    return found


def _judged(snapshot: Snapshot) -> tuple[dict[str, Any], dict[str, Any]]:
    n = snapshot.prepared.surface.n_vertices
    if not snapshot.samples:
        header = {"n_taken": 0, "enough": False, "reasons": ["no sample is taken yet"]}
        return header | {"predicted_nrmse": None, "bandwidth": None}, {}
    error, found = snapshot.judged()
    waves = np.where(np.isfinite(found.wavelengths[:n]), found.wavelengths[:n], np.nan)
    known = math.isfinite(error)
    header = {
        "n_taken": len(snapshot.samples),
        "enough": found.verdict.enough,
        "reasons": list(found.verdict.reasons),
        "predicted_nrmse": _finite(error),
        "undersampled_share": found.undersampled_share if known else None,
        "bandwidth": None
        if found.bracket is None or not known
        else [found.bracket.lower, found.bracket.upper],
    }
    return header, {"wavelengths": waves.astype(np.float32)} if known else {}


def _state(live: LiveMap) -> bytes:
    ahead = live.next_point()
    mean, std = live.map()
    header = {
        **live.described(),
        "next": ahead.position.tolist(),
        "next_nrmse": None if live.knows_nothing else _finite(ahead.predicted_nrmse),
    }
    arrays: dict[str, NDArray[Any]] = {
        "positions": live.positions.astype(np.float32),
        "values": np.array([each.value for each in live.samples], dtype=np.float64),
        "distances": np.array([each.distance for each in live.samples], dtype=np.float32),
    }
    if not live.knows_nothing:
        arrays |= {"mean": mean.astype(np.float32), "std": std.astype(np.float32)}
    return packed(header, arrays)


def _case(workspace: Workspace) -> OpenCase:
    return workspace.require(OpenCase, "no surface is open")


def _live(workspace: Workspace) -> LiveMap:
    """The live map of the open case; a new one if there is none, or it is of another surface."""
    case, live = _case(workspace), workspace.find(LiveMap)
    if live is None or live.prepared is not case.prepared:
        live = LiveMap(case.prepared, Aim())
        workspace.put(live)
    return live


def _aim(told: Mapping[str, Any]) -> Aim:
    name, unit = told.get("name", "value"), told.get("unit", "")
    if not isinstance(name, str) or not isinstance(unit, str):
        raise InputError("name and unit of the values are texts: give those")
    numbers = {}
    for key in ("target_nrmse", "noise", "cycle_length_ms"):
        value = told.get(key)
        if value is not None and not _is_number(value):
            raise InputError(f"{key} {value!r}: give a number")
        numbers[key] = None if value is None else float(value)
    target = numbers["target_nrmse"]
    return Aim(
        name=name[:80] or "value",
        unit=unit[:20],
        target_nrmse=0.1 if target is None else target,
        noise=numbers["noise"],
        cycle_length=numbers["cycle_length_ms"],
    )


def _renamed(aim: Aim, name: str, unit: str) -> Aim:
    return Aim(name, unit, aim.target_nrmse, aim.noise, aim.cycle_length)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


ENDPOINTS = (
    Endpoint("GET", "/api/live", state),
    Endpoint("POST", "/api/live", begin),
    Endpoint("POST", "/api/live/add", add),
    Endpoint("POST", "/api/live/samples", take_all),
    Endpoint("POST", "/api/live/go-to", go_to),
    Endpoint("POST", "/api/live/table", load_table, takes_file=True),
    Endpoint("POST", "/api/live/play", play),
    Endpoint("POST", "/api/live/judge", judge, locked=False),
    Endpoint("POST", "/api/live/review", review),
)
