"""Settings from a TOML file: one table for each command, unknown names refused."""

import inspect
import tomllib
from pathlib import Path
from typing import Any

from auricle.cli.commands import COMMANDS
from auricle.errors import InputError


def read_settings(path: Path) -> dict[str, dict[str, Any]]:
    """The options a settings file gives, by command.

    ::

        [analyze]
        vertices = 10000
        focus_width = [4.0, 8.0]

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML, or names an unknown command or option.
    """
    try:
        settings = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as fault:
        raise InputError(f"{path}: {fault.strerror}: give a TOML file") from fault
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as fault:
        raise InputError(f"{path}: not TOML ({fault}): correct it") from fault
    for name, options in settings.items():
        known = _options(name)
        if not known or not isinstance(options, dict):
            raise InputError(
                f"{path}: no command named {name!r}: use a table named {', '.join(COMMANDS)}"
            )
        unknown = sorted(set(options) - known)
        if unknown:
            raise InputError(
                f"{path}: {name} has no option {unknown[0]!r}: it has {', '.join(sorted(known))}"
            )
    return settings


def _options(command: str) -> set[str]:
    if command not in COMMANDS:
        return set()
    return set(inspect.signature(COMMANDS[command]).parameters)
