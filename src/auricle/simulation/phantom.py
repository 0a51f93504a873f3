"""Generated contrast CT of a chest, with the true endocardium of its left atrium."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.spatial.transform import Rotation

from auricle.arrays import Points
from auricle.imaging.mask import Mask
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent
from auricle.simulation.ct_atrium import patient_atrium
from auricle.simulation.ct_block import Block
from auricle.simulation.ct_heart import Blood, Heart, filling_defect, heart_layers, heart_of, lead
from auricle.simulation.ct_layers import Labels, Layer, Tissue
from auricle.simulation.ct_scanner import Scanner
from auricle.simulation.ct_thorax import thorax_layers
from auricle.simulation.phantom_options import PRESETS, PhantomOptions
from auricle.simulation.phantom_truth import Truth, truth_surface

__all__ = ["Phantom", "PhantomOptions", "Truth", "phantom", "truth_surface"]

_MUSCLE_HU, _PLAIN_HU = 105.0, 45.0
"""Myocardium with contrast medium in it; myocardium and blood without."""
_MIDDLE = np.array([10.0, -16.0, -14.0])
"""Middle of the image from the middle of the atrium, mm."""


@dataclass(frozen=True, eq=False)
class Phantom:
    """A generated CT and what is in it.

    Attributes
    ----------
    volume
        The image, HU.
    labels
        Tissue of each voxel, shape and axes of the volume, uint8; named by `tissues`.
    truth
        The endocardium without voxels.
    options
        What was asked for.
    """

    volume: Volume
    labels: Labels
    truth: Truth
    options: PhantomOptions

    @property
    def tissues(self) -> Mapping[int, str]:
        """Names of the labels."""
        return MappingProxyType({int(t): t.name.lower().replace("_", " ") for t in Tissue})

    @property
    def mask(self) -> Mask:
        """The voxels of the left atrium: those whose middle the true endocardium encloses."""
        return Mask(self.labels == Tissue.LEFT_ATRIUM, self.volume.affine)


def phantom(options: PhantomOptions, *, progress: Progress = silent) -> Phantom:
    """Generate the contrast CT of a chest with a known left atrium.

    Parameters
    ----------
    options
        Size, anatomy, contrast and hardships.
    progress
        Told of slices painted.

    Returns
    -------
    Phantom
        The same to the last bit for the same options.
    """
    rng = np.random.default_rng([options.seed, 1])
    atrium = patient_atrium(
        np.random.default_rng([options.seed, 0]), veins=options.veins, scale=options.scale
    )
    heart = heart_of(atrium, rng)
    layers = _scene(heart, options, rng)
    block, offset = _lattice(options, rng)
    scanner = Scanner(
        blur=options.blur,
        noise=options.noise,
        motion=options.motion,
        streak=options.streak,
        metal=heart.lead_path,
    )
    voxels, labels = scanner.scan(
        layers,
        block,
        np.random.default_rng([options.seed, 2]),
        lambda done: progress("painting", done, block.shape[0]),
    )
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = block.steps, block.origin + offset
    for array in (voxels, labels):
        array.flags.writeable = False
    return Phantom(
        Volume(voxels.transpose(2, 1, 0), affine),
        labels.transpose(2, 1, 0),
        Truth(atrium, offset),
        options,
    )


def _scene(heart: Heart, options: PhantomOptions, rng: np.random.Generator) -> list[Layer]:
    left = options.contrast if options.enhanced else _PLAIN_HU
    right = options.right_contrast if options.enhanced else _PLAIN_HU
    blood = Blood(
        left=left,
        right=right,
        muscle=_MUSCLE_HU if options.enhanced else _PLAIN_HU,
        gradient=options.gradient / 100.0,
        wall=options.wall,
        aorta_gap=options.aorta_gap,
    )
    layers = thorax_layers(heart.atrium, (left + right) / 2, rng)
    layers += heart_layers(heart, blood, rng, mitral_open=options.mitral_open)
    if options.filling_defect:
        layers.append(filling_defect(heart.atrium, options.filling_defect))
    if options.lead:
        layers.append(lead(heart))
    return layers


def _lattice(options: PhantomOptions, rng: np.random.Generator) -> tuple[Block, Points]:
    """The voxels about the middle of the atrium, and where that lies in the room."""
    counts, spacing = PRESETS[options.preset]
    turn = Rotation.from_rotvec(np.radians(options.oblique) * np.array([0.8, 0.36, 0.48]))
    steps = turn.as_matrix() * np.asarray(spacing)
    middle = _MIDDLE + rng.uniform(-4.0, 4.0, 3) + (options.off_centre, 0.0, 0.0)
    offset = np.array([0.0, -170.0, -640.0]) + rng.uniform(-15.0, 15.0, 3)
    origin = middle - steps @ ((np.asarray(counts) - 1.0) / 2.0)
    return Block(origin, steps, (counts[2], counts[1], counts[0])), offset
