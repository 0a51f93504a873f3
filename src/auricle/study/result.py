"""What the analysis of one surface yields: plain data, complete, without behaviour."""

from collections.abc import Mapping
from dataclasses import dataclass

from auricle.arrays import PerMode, Points
from auricle.sampling.criteria import Criterion
from auricle.spectral.harmonics import Certificate
from auricle.spectral.power import Spectrum
from auricle.study.config import AnalysisConfig
from auricle.surface.cleaning import Repair
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import Soundness


@dataclass(frozen=True)
class Source:
    """The file a case came from: its name without the folder, size in bytes and SHA-256."""

    name: str
    n_bytes: int
    sha256: str


@dataclass(frozen=True)
class GeometryError:
    """How far the surface rebuilt from `n_modes` harmonics lies from the original, mm."""

    n_modes: int
    rms_mm: float
    gd_mean_mm: float
    gd_percentile_95_mm: float
    hausdorff_mm: float


@dataclass(frozen=True, eq=False)
class Signal:
    """One map on the surface and everything read off its spectrum.

    Attributes
    ----------
    name, title
        Key for files (``local_activation_time``) and words for people.
    kind
        ``geometry``, ``field`` (came with the surface) or ``simulated``.
    field
        The map on the analysed surface; NaN where unsampled.
    spectrum, criteria
        Its spectrum on the capped shell and the readings of it.
    for_error
        What it takes to bring the measured error down to 39, 32, 22 and 10 %.
    nrmse
        Measured error of the first 1 … k harmonics on the real surface, shape (k,), relative to
        the map's area-weighted standard deviation there.
    unsampled_share
        Share of the area that held no value and was filled smoothly before the transform.
    details
        What else is known of it (a focus's width, the closed form's prediction), by name with
        its unit.
    """

    name: str
    title: str
    kind: str
    field: FieldMap
    spectrum: Spectrum
    criteria: tuple[Criterion, ...]
    for_error: tuple[Criterion, ...]
    nrmse: PerMode
    unsampled_share: float
    details: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class CaseResult:
    """Everything the main job finds out about one surface.

    Attributes
    ----------
    source
        The file.
    config
        The parameters of this run.
    original
        Soundness of the surface after cleaning, before simplification.
    repairs, remarks
        What cleaning changed, and what the reader and the analysis want known.
    surface
        The analysed surface: cleaned and simplified, holes open.
    analyzed
        Its soundness.
    simplification_gd_mm
        Mean geometric distance from the cleaned to the analysed surface, mm.
    shell_area_mm2, cap_areas_mm2
        Area of the closed shell the harmonics live on, and of each cap that closed a hole.
    n_shell_vertices
        Its number of vertices, caps included.
    laplacian
        Which operator was used: ``cotangent`` or ``intrinsic Delaunay``.
    certificate
        Of the harmonics.
    geometry, fields, simulated
        The maps analysed.
    geometry_errors
        Error of the rebuilt surface against the number of harmonics.
    reconstructions
        Positions of the surface's vertices rebuilt from 50, 250, 500 … harmonics, mm.
    versions
        Of auricle, Python and the libraries that enter the numbers.
    seconds
        Wall time by stage.
    space
        Frame of the positions, as the file states it.
    """

    source: Source
    config: AnalysisConfig
    original: Soundness
    repairs: tuple[Repair, ...]
    remarks: tuple[str, ...]
    surface: Mesh
    analyzed: Soundness
    simplification_gd_mm: float
    shell_area_mm2: float
    cap_areas_mm2: tuple[float, ...]
    n_shell_vertices: int
    laplacian: str
    certificate: Certificate
    geometry: Signal
    fields: tuple[Signal, ...]
    simulated: tuple[Signal, ...]
    geometry_errors: tuple[GeometryError, ...]
    reconstructions: Mapping[int, Points]
    versions: Mapping[str, str]
    seconds: Mapping[str, float]
    space: str = "unknown"
