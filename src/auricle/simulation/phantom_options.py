"""What a phantom shall be: its size, its anatomy, its contrast and what makes it hard."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from auricle.errors import InputError

PRESETS: Mapping[str, tuple[tuple[int, int, int], tuple[float, float, float]]] = MappingProxyType(
    {
        "tiny": ((64, 64, 50), (3.2, 3.2, 3.0)),
        "small": ((128, 128, 100), (1.6, 1.6, 1.5)),
        "medium": ((256, 256, 150), (0.8, 0.8, 1.0)),
        "clinical": ((512, 512, 250), (0.4, 0.4, 0.6)),
    }
)
"""Voxels along x, y and z, and their spacing, mm: always about 205 x 205 x 150 mm."""

VEINS = ("four", "common_left", "fifth")

_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "scale": (0.7, 1.4),
        "contrast": (150.0, 900.0),
        "right_contrast": (20.0, 900.0),
        "wall": (0.3, 5.0),
        "aorta_gap": (0.0, 5.0),
        "gradient": (-500.0, 500.0),
        "filling_defect": (0.0, 0.95),
        "motion": (0.0, 10.0),
        "streak": (0.0, 500.0),
        "noise": (0.0, 200.0),
        "blur": (0.0, 3.0),
        "oblique": (-60.0, 60.0),
        "off_centre": (-100.0, 100.0),
    }
)


@dataclass(frozen=True)
class PhantomOptions:
    """Everything a phantom depends on; the same options give the same bytes.

    Attributes
    ----------
    preset
        Number and size of the voxels, one of `PRESETS`.
    seed
        The patient: each seed another anatomy, the same for every preset and contrast.
    veins
        "four", "common_left" (one trunk on the left) or "fifth" (a right middle vein).
    scale
        Of the left atrium, its annulus included.
    mitral_open
        Whether the leaflets stand open into the ventricle.
    enhanced
        Whether there is contrast medium at all.
    contrast, right_contrast
        HU of the blood in the left atrium and in the right heart.
    gradient
        Change of the contrast of the left heart towards the head, HU over 100 mm.
    wall, aorta_gap
        Thickness of the atrial wall, and distance from the blood of the aortic root, mm.
    filling_defect
        Share of the appendage that the contrast medium does not reach.
    motion
        Steps between bands of slices taken in different heartbeats, mm; the truth stays.
    lead, streak
        Whether a pacing lead lies in the right heart, and the height of its streaks, HU.
    noise, blur
        Standard deviation of the noise, HU, and of the point spread, mm.
    oblique
        Turn of the lattice about an oblique axis, degrees.
    off_centre
        How far the image lies too much to the patient's left, mm: from 70 on it cuts the atrium.

    Raises
    ------
    InputError
        If an option is unknown or out of its range.
    """

    preset: str = "small"
    seed: int = 0
    veins: str = "four"
    scale: float = 1.0
    mitral_open: bool = True
    enhanced: bool = True
    contrast: float = 400.0
    right_contrast: float = 170.0
    gradient: float = 0.0
    wall: float = 2.0
    aorta_gap: float = 2.0
    filling_defect: float = 0.0
    motion: float = 0.0
    lead: bool = False
    streak: float = 0.0
    noise: float = 22.0
    blur: float = 0.5
    oblique: float = 0.0
    off_centre: float = 0.0

    def __post_init__(self) -> None:
        if self.preset not in PRESETS:
            raise InputError(f"no preset “{self.preset}”: give {', '.join(PRESETS)}")
        if self.veins not in VEINS:
            raise InputError(f"no veins “{self.veins}”: give {', '.join(VEINS)}")
        if self.seed < 0:
            raise InputError(f"a seed of {self.seed}: give 0 or more")
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"{name} of {value}: give {low:g} to {high:g}")


HOSTILE: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "nominal": {},
        "mitral_closed": {"mitral_open": False},
        "equal_contrast": {"right_contrast": 400.0},
        "noisy": {"noise": 60.0},
        "large": {"scale": 1.25},
        "small": {"scale": 0.8},
        "oblique": {"oblique": 20.0},
        "low_contrast": {"contrast": 220.0},
        "common_trunk": {"veins": "common_left"},
        "fifth_vein": {"veins": "fifth"},
        "thin_aorta_gap": {"aorta_gap": 0.3},
        "thin_wall": {"wall": 0.8},
        "gradient": {"gradient": 120.0},
        "lead": {"lead": True, "streak": 60.0},
        "filling_defect": {"filling_defect": 0.8},
        "motion": {"motion": 4.0},
        "no_contrast": {"enhanced": False},
        "truncated": {"off_centre": 85.0},
    }
)
"""Cases that are hard for a segmentation, by what is changed."""


def hostile(name: str, options: PhantomOptions) -> PhantomOptions:
    """The options with one hard case of `HOSTILE` put in.

    Raises
    ------
    InputError
        If there is no such case.

    Examples
    --------
    >>> hostile("low_contrast", PhantomOptions(preset="tiny")).contrast
    220.0
    """
    if name not in HOSTILE:
        raise InputError(f"no hard case “{name}”: give {', '.join(HOSTILE)}")
    return replace(options, **HOSTILE[name])
