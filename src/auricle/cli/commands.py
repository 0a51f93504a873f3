"""Every command by its name."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from auricle.cli.sampling_commands import plan, propose, reconstruct
from auricle.cli.surface_commands import analyze, atrium, harmonics, simplify

COMMANDS: Mapping[str, Callable[..., None]] = MappingProxyType(
    {
        "analyze": analyze,
        "plan": plan,
        "reconstruct": reconstruct,
        "next": propose,
        "harmonics": harmonics,
        "simplify": simplify,
        "atrium": atrium,
    }
)
"""In the order of the help."""
