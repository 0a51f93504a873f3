"""Painting a scene onto voxels, layer over layer, with edges smoothed by partial volume."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from auricle.compiled import compiled
from auricle.simulation.ct_block import Block, Grid
from auricle.simulation.ct_shapes import Shape

Labels = NDArray[np.uint8]

AIR_HU = -1000.0


class Tissue(IntEnum):
    """What a voxel of the label map is."""

    AIR = 0
    FAT = 1
    MUSCLE = 2
    LUNG = 3
    BONE = 4
    SPINAL_CANAL = 5
    LIVER = 6
    STOMACH = 7
    AIRWAY = 8
    OESOPHAGUS = 9
    LUNG_VESSEL = 10
    MYOCARDIUM = 11
    RIGHT_ATRIUM = 12
    RIGHT_VENTRICLE = 13
    PULMONARY_ARTERY = 14
    VENA_CAVA = 15
    CORONARY_VESSEL = 16
    ATRIAL_WALL = 17
    AORTA = 18
    LEFT_VENTRICLE = 19
    PULMONARY_VEIN = 20
    LEFT_ATRIUM = 21
    MITRAL_VALVE = 22
    LEAD = 23


@dataclass(frozen=True, eq=False)
class Layer:
    """A structure of even density.

    Attributes
    ----------
    shape
        Its region.
    hu
        Its density.
    tissue
        Its label, or None to leave the labels beneath as they are.
    growth
        How far it reaches beyond its shape, mm.
    gradient
        Change of its density towards the head, HU/mm, from `hu` at height 0.
    """

    shape: Shape
    hu: float
    tissue: Tissue | None
    growth: float = 0.0
    gradient: float = 0.0


def paint(layers: Sequence[Layer], block: Block) -> tuple[Grid, Labels]:
    """Densities (HU) and labels of the voxels of a block, indexed [k, j, i].

    Each layer covers what lies beneath by the share of a voxel it fills, taken from the distance
    of the voxel's middle: exact for a flat face along the lattice, close for others.
    """
    hu = np.full(block.shape, AIR_HU, dtype=np.float32)
    labels = np.full(block.shape, Tissue.AIR, dtype=np.uint8)
    for layer in layers:
        window = block.window(layer.shape.box, margin=layer.growth + block.edge)
        if window is None:
            continue
        part = block.part(window)
        distance = layer.shape.distance(part)
        label = -1 if layer.tissue is None else int(layer.tissue)
        density = layer.gradient * np.array([part.origin[2], *part.steps[2]])
        density[0] += layer.hu
        _cover(hu[window], labels[window], distance, density, (layer.growth, part.edge), label)
    return hu, labels


@compiled
def _cover(
    hu: Grid,
    labels: Labels,
    distance: Grid,
    density: NDArray[np.float64],
    edge: tuple[float, float],
    label: int,
) -> None:
    """Lay density[0] + density[1:] @ (i, j, k) over `hu`, up to a distance, with a wide edge."""
    growth, width = edge
    depth, rows, columns = distance.shape
    for k in range(depth):
        for j in range(rows):
            start = density[0] + density[2] * j + density[3] * k
            for i in range(columns):
                share = 0.5 - (distance[k, j, i] - growth) / width
                if share <= 0.0:
                    continue
                value = start + density[1] * i
                hu[k, j, i] += min(share, 1.0) * (value - hu[k, j, i])
                if share > 0.5 and label >= 0:
                    labels[k, j, i] = label
