"""Endpoints: what the page may ask of the server, free of any web framework."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from auricle.errors import InputError
from auricle.progress import Progress
from auricle.viewer.workspace import Workspace

LARGEST_DOCUMENT = 4 * 1024**2
"""Bytes of a request that is not the upload of a file."""


@dataclass(frozen=True)
class Call:
    """One request.

    Attributes
    ----------
    workspace
        What the page has open.
    path
        Variable parts of the address.
    query
        Parameters after its question mark.
    body
        What was sent, whole; empty for uploads.
    upload
        The uploaded file, under its own name in a folder of its own; None if it is no upload.
    """

    workspace: Workspace
    path: Mapping[str, str] = field(default_factory=dict)
    query: Mapping[str, str] = field(default_factory=dict)
    body: bytes = b""
    upload: Path | None = None

    def document(self) -> dict[str, Any]:
        """What was sent, as a JSON object.

        Raises
        ------
        InputError
            If it is none.
        """
        try:
            found = json.loads(self.body or b"{}")
        except ValueError as fault:
            raise InputError(f"the request is not JSON ({fault}): reload the page") from fault
        if not isinstance(found, dict):
            raise InputError("the request is not a JSON object: reload the page")
        return found

    def uploaded(self) -> Path:
        """The uploaded file.

        Raises
        ------
        InputError
            If there is none.
        """
        if self.upload is None:
            raise InputError("no file came with the request: choose one")
        return self.upload


@dataclass(frozen=True)
class Work:
    """Work of seconds: the page sees its progress and may cancel it by closing the stream.

    Attributes
    ----------
    run
        Does the work and gives back the document to end with. It runs in a thread without the
        workspace's lock, which it takes for the moment of putting its result there.
    """

    run: Callable[[Progress], Mapping[str, Any]]


Answer = Mapping[str, Any] | bytes | Work


@dataclass(frozen=True)
class Endpoint:
    """One address of the server and what answers there.

    Attributes
    ----------
    method
        GET, or POST for all that changes something or brings a document.
    address
        As in ``/api/plan/{step}``.
    answer
        From the request to a JSON object, bytes, or long work.
    takes_file
        Whether the request's body is a file to be stored.
    locked
        Whether it answers under the workspace's lock; what takes long does without, and locks for
        the moments in which it reads and writes.
    """

    method: str
    address: str
    answer: Callable[[Call], Answer]
    takes_file: bool = False
    locked: bool = True
