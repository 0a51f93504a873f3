"""Everything auricle raises on purpose, in one tree.

::

    AuricleError            one line for the user: cause: what to do
    ├── InputError          the file or the value handed in is at fault   (exit code 3)
    │   ├── FormatError     the bytes are not what the format promises
    │   ├── SurfaceError    the surface cannot carry the computation
    │   └── ImageError      the volume or the mask cannot carry the computation
    ├── BandError           more modes are needed than are at hand        (exit code 3)
    ├── OutputError         the result cannot be written                  (exit code 1)
    └── SolverError         the computation could not certify its result  (exit code 1)
"""


class AuricleError(Exception):
    """A fault that is told to the user in one line: what is wrong, then what to do."""

    exit_code = 1


class InputError(AuricleError):
    """The input is at fault."""

    exit_code = 3


class FormatError(InputError):
    """A file does not hold what its format promises."""


class SurfaceError(InputError):
    """A surface is not fit for the computation asked for."""


class ImageError(InputError):
    """A volume or a mask is not fit for the computation asked for."""


class BandError(InputError):
    """The answer lies beyond the harmonics at hand."""


class OutputError(AuricleError):
    """A result cannot be written where it should go."""


class SolverError(AuricleError):
    """A computation ended without the certificate it owes."""


class CohortError(AuricleError):
    """Some cases of a study have no result; the others have theirs."""

    exit_code = 4
