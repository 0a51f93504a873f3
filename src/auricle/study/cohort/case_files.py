"""The results of a study on disk: one whole file a case, named by what it depends on.

::

    cases/KEY.json       what was found: the same bytes for the same input, parameters and code
    timings/KEY.json     seconds by stage: of this run, of this machine
    failures/KEY.json    instead of both: why there is no result
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from auricle.atomic import write_text

CASE_FORMAT = "auricle case 1"
FAILURE_FORMAT = "auricle failure 1"


@dataclass(frozen=True)
class CaseFiles:
    """The files of every case of a study, in one folder that many processes may share."""

    folder: Path

    def place(self, key: str) -> Path:
        """Where the result of a case lies."""
        return self.folder / "cases" / f"{key}.json"

    def is_finished(self, key: str) -> bool:
        """Whether the case has a result."""
        return self.place(key).is_file()

    def values(self, key: str) -> dict[str, Any]:
        """What was found in a finished case."""
        values: dict[str, Any] = json.loads(self.place(key).read_text(encoding="utf-8"))["values"]
        return values

    def timings(self, key: str) -> dict[str, float]:
        """Seconds by stage; empty if they were not kept."""
        place = self._timings(key)
        if not place.is_file():
            return {}
        seconds: dict[str, float] = json.loads(place.read_text(encoding="utf-8"))
        return seconds

    def failure(self, key: str) -> str | None:
        """Why a case has no result, in one line; None if it has not failed."""
        place = self._failure(key)
        if self.is_finished(key) or not place.is_file():
            return None
        return str(json.loads(place.read_text(encoding="utf-8"))["error"])

    def keep(self, key: str, values: Mapping[str, Any], timings: Mapping[str, float]) -> None:
        """Write the timings, then, last, what was found; an earlier failure goes.

        Raises
        ------
        OutputError
            If they cannot be written.
        """
        write_text(self._timings(key), _json(dict(timings)))
        document = {"format": CASE_FORMAT, "key": key, "values": dict(values)}
        write_text(self.place(key), _json(document))
        self._failure(key).unlink(missing_ok=True)

    def keep_failure(self, key: str, *, name: str, error: str) -> None:
        """Write why a case has no result.

        Raises
        ------
        OutputError
            If it cannot be written.
        """
        document = {"format": FAILURE_FORMAT, "key": key, "case": name, "error": error}
        write_text(self._failure(key), _json(document))

    def sweep(self, key: str) -> None:
        """Remove the unfinished files of a process that was killed while it wrote this case."""
        for place in (self.place(key), self._timings(key), self._failure(key)):
            for left in place.parent.glob(f".{key}.*"):
                left.unlink(missing_ok=True)

    def _timings(self, key: str) -> Path:
        return self.folder / "timings" / f"{key}.json"

    def _failure(self, key: str) -> Path:
        return self.folder / "failures" / f"{key}.json"


def _json(document: Mapping[str, Any]) -> str:
    """Numbers at full precision, no NaN, one line: there are long arrays among them."""
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False) + "\n"
