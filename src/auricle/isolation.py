"""Third-party parsers run in child processes: they may crash, hang or eat memory there."""

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress

from auricle.errors import FormatError
from auricle.foreign import damaged, shown

_TAIL_BYTES = 4096
_LIBRARY_FAULT = 1
_OUT_OF_MEMORY = ("MemoryError", "bad_alloc", "Unable to allocate")
ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "VTK_SMP_BACKEND_IN_USE": "Sequential",
    "ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS": "1",
}
"""Environment in which a process and its libraries keep to one thread."""


def run_child(command: Sequence[str], *, seconds: float) -> None:
    """Run `command` to its end with this process's import path.

    Exit code 3 means that its last line on standard error names the fault of the file.

    Raises
    ------
    FormatError
        If it ends in any way but with exit code 0 within `seconds`.
    """
    environment = {
        **os.environ,
        **ONE_THREAD,
        "PYTHONPATH": os.pathsep.join(place for place in sys.path if place),
        "PYTHONIOENCODING": "utf-8",
    }
    with tempfile.TemporaryFile() as errors:
        try:
            code = subprocess.run(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=errors,
                timeout=seconds,
                check=False,
            ).returncode
        except subprocess.TimeoutExpired as fault:
            raise FormatError(
                f"took its reader longer than {seconds:.0f} s: export it in a simpler form"
            ) from fault
        if code:
            errors.seek(max(errors.seek(0, os.SEEK_END) - _TAIL_BYTES, 0))
            raise _fault(code, errors.read().decode("utf-8", "replace"))


def limit_memory(most: int) -> None:
    """Cap this process's address space at `most` bytes where the system can; no core files."""
    try:
        import resource
    except ImportError:  # Windows has no such limits
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    if hard == resource.RLIM_INFINITY or hard > most:
        with suppress(ValueError):  # macOS refuses this limit; the time limit remains
            resource.setrlimit(resource.RLIMIT_AS, (most, hard))


def _fault(code: int, tail: str) -> FormatError:
    last = tail.strip().splitlines()[-1] if tail.strip() else ""
    if code == FormatError.exit_code:
        return FormatError(last)
    if any(sign in tail for sign in _OUT_OF_MEMORY):
        return FormatError("needs more memory than its size allows: it is damaged or too large")
    if code == _LIBRARY_FAULT:
        return damaged(f"made its reader fail ({_one_line(last)})")
    return damaged(f"made its reader crash ({_signal_name(code)})")


def _signal_name(code: int) -> str:
    try:
        return signal.Signals(-code).name
    except ValueError:
        return f"exit code {code}"


def _one_line(text: str) -> str:
    return shown(" ".join(text.split()), longest=200)[1:-1]
