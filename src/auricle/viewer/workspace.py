"""The workspace: what one page has open, each part found by its type."""

import threading
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Protocol, TypeVar, runtime_checkable

from auricle.errors import InputError

Part = TypeVar("Part")


@runtime_checkable
class Shown(Protocol):
    """A part that has views of its own in the page."""

    @property
    def views(self) -> tuple[str, ...]:
        """Names of the views that show it: ``explore``, ``plan``, ``segment``, ``cohort``."""

    def described(self) -> Mapping[str, Any]:
        """What the page is told of it first, under names of its own, ready for JSON."""


class Workspace:
    """What one page has open: a surface, a volume, a plan under way … at most one of each type.

    Parameters
    ----------
    folder
        Where uploaded files may lie until the page is closed.
    name
        What was opened, as shown in the title.

    Attributes
    ----------
    lock
        Held while a request reads or changes parts.
    busy
        Held by the one long piece of work that may run beside the requests.

    Examples
    --------
    >>> workspace = Workspace(Path("uploads"), "atrium.vtp")
    >>> workspace.put(3.5)
    >>> workspace.require(float, "no number is open")
    3.5
    """

    def __init__(self, folder: Path, name: str = "") -> None:
        self.folder = folder
        self.name = name
        self.lock = threading.RLock()
        self.busy = threading.Lock()
        self._parts: dict[type, Any] = {}

    def put(self, part: object) -> None:
        """Open a part, in place of any other of its type."""
        self._parts[type(part)] = part

    def remove(self, kind: type) -> None:
        """Close the part of this type, if there is one."""
        self._parts.pop(kind, None)

    def find(self, kind: type[Part]) -> Part | None:
        """The open part of this type; None if there is none."""
        found: Part | None = self._parts.get(kind)
        return found

    def require(self, kind: type[Part], lack: str) -> Part:
        """The open part of this type.

        Raises
        ------
        InputError
            If there is none; `lack` says what is missing.
        """
        found = self.find(kind)
        if found is None:
            raise InputError(f"{lack}: open a file first")
        return found

    def open(self, name: str, parts: Iterable[object]) -> None:
        """Close all that was open, and open these under a name."""
        self.name = name
        self._parts.clear()
        for part in parts:
            self.put(part)

    def described(self) -> dict[str, Any]:
        """What is open, for the page: its name, the views that show it, and each part's own words.

        The views come in the order in which their parts were opened.
        """
        shown = [part for part in self._parts.values() if isinstance(part, Shown)]
        views = dict.fromkeys(view for part in shown for view in part.views)
        document: dict[str, Any] = {"name": self.name, "views": list(views)}
        for part in shown:
            document |= part.described()
        return document
