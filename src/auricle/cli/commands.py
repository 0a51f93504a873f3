"""Every command by its name."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from auricle.cli.map_commands import import_export
from auricle.cli.sampling_commands import plan, propose, reconstruct
from auricle.cli.study_commands import study
from auricle.cli.surface_commands import analyze, atrium, harmonics, simplify
from auricle.cli.view_commands import view
from auricle.cli.volume_commands import phantom, segment

COMMANDS: Mapping[str, Callable[..., None]] = MappingProxyType(
    {
        "analyze": analyze,
        "segment": segment,
        "import": import_export,
        "view": view,
        "plan": plan,
        "reconstruct": reconstruct,
        "next": propose,
        "study": study,
        "harmonics": harmonics,
        "simplify": simplify,
        "atrium": atrium,
        "phantom": phantom,
    }
)
"""In the order of the help."""
