"""Memory that is left, so that work which cannot fit is refused before it starts."""

import os
from pathlib import Path

from auricle.errors import InputError

_GROUP = Path("/sys/fs/cgroup")
_SYSTEM = Path("/proc/meminfo")


def memory_left(*, system: Path = _SYSTEM, group: Path = _GROUP) -> int | None:
    """Bytes this process may still take: of the machine or of its control group (a container).

    None where the system does not tell (Windows). Where it only tells how much it has in all
    (macOS), that.
    """
    known = [each for each in (_of_system(system), _of_group(group)) if each is not None]
    return min(known) if known else None


def require_memory(n_bytes: int, work: str) -> None:
    """Refuse work that needs more memory than is left.

    Raises
    ------
    InputError
        Saying how much is needed and how much there is.
    """
    left = memory_left()
    if left is not None and n_bytes > left:
        raise InputError(
            f"{work} need {n_bytes / 2**30:.1f} GiB of memory but {left / 2**30:.1f} are free: "
            "ask for fewer, or simplify the surface first"
        )


def _of_system(system: Path) -> int | None:
    if system.exists():
        for line in system.read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024 * int(line.split()[1])
    sizes = getattr(os, "sysconf_names", {})
    if "SC_PHYS_PAGES" not in sizes or "SC_PAGE_SIZE" not in sizes:
        return None
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _of_group(group: Path) -> int | None:
    """What a control group of version 2 or 1 leaves; None without a limit."""
    for most, used in (
        (group / "memory.max", group / "memory.current"),
        (group / "memory/memory.limit_in_bytes", group / "memory/memory.usage_in_bytes"),
    ):
        if most.exists() and used.exists():
            limit = most.read_text().strip()
            return None if limit == "max" else int(limit) - int(used.read_text())
    return None
