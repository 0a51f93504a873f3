"""A scanner: from a scene of layers to slices of Hounsfield units."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Points
from auricle.simulation.ct_block import Block
from auricle.simulation.ct_layers import Labels, Layer, paint
from auricle.simulation.ct_noise import Slice, blurred, noise_slices, stepped, streaks

_SLAB_VOXELS = 6_000_000
_LOWEST_HU, _HIGHEST_HU = -1024.0, 3071.0
_BAND = 24.0
"""Height of the slices taken in one heartbeat, mm."""
_METAL_REACH = 3.0
"""How far above and below metal its streaks go, mm."""


@dataclass(frozen=True, eq=False)
class Scanner:
    """What comes between the body and the image.

    Attributes
    ----------
    blur
        Standard deviation of the point spread, mm.
    noise
        Standard deviation of the noise, HU.
    motion
        Step between slices of different heartbeats, mm.
    streak
        Height of the streaks round metal, HU.
    metal
        Shape (m, 3): places that cast streaks, mm.
    """

    blur: float
    noise: float
    motion: float
    streak: float
    metal: Points

    def scan(
        self,
        layers: Sequence[Layer],
        block: Block,
        rng: np.random.Generator,
        told: Callable[[int], None],
    ) -> tuple[NDArray[np.int16], Labels]:
        """Image (HU) and labels of a block, indexed [k, j, i], one slab after the other.

        Parameters
        ----------
        layers
            The scene.
        block
            Voxels.
        rng
            Source of the noise.
        told
            Called with the number of slices that are done.
        """
        voxels = np.empty(block.shape, dtype=np.int16)
        labels = np.empty(block.shape, dtype=np.uint8)
        depth, rows, columns = block.shape
        spacing = np.linalg.norm(block.steps, axis=0)[::-1]
        noise = noise_slices(rng, (rows, columns), (spacing[1], spacing[2]))
        height = max(_SLAB_VOXELS // (rows * columns), 1)
        for start in range(0, depth, height):
            stop = min(start + height, depth)
            planes, labels[start:stop] = self._slab(layers, block, (start, stop), spacing)
            for k, plane in enumerate(planes, start):
                image = self._streaked(self._moved(plane, k, spacing), k, block, spacing)
                image = image + np.float32(self.noise) * next(noise)
                voxels[k] = np.clip(np.rint(image), _LOWEST_HU, _HIGHEST_HU)
            told(stop)
        return voxels, labels

    def _slab(
        self, layers: Sequence[Layer], block: Block, slices: tuple[int, int], spacing: Floats
    ) -> tuple[Iterator[Slice], Labels]:
        start, stop = slices
        sigmas = self.blur / spacing
        halo = int(np.ceil(4.0 * sigmas[0]))
        first, last = max(start - halo, 0), min(stop + halo, block.shape[0])
        hu, labels = paint(layers, block.slab(first, last))
        hu = blurred(hu, (sigmas[0], sigmas[1], sigmas[2]))
        inner = slice(start - first, stop - first)
        return iter(hu[inner]), labels[inner]

    def _moved(self, plane: Slice, k: int, spacing: Floats) -> Slice:
        """Every other band of slices lies aside, as if the heart had beaten elsewhere."""
        if not self.motion or int(k * spacing[0] / _BAND) % 2 == 0:
            return plane
        return stepped(plane, (0.8 * self.motion / spacing[1], 0.6 * self.motion / spacing[2]))

    def _streaked(self, plane: Slice, k: int, block: Block, spacing: Floats) -> Slice:
        if not self.streak or not len(self.metal):
            return plane
        places = (self.metal - block.origin) @ block.inverse.T
        near = places[np.abs(places[:, 2] - k) < _METAL_REACH / spacing[0]]
        if not len(near):
            return plane
        column, row, _ = near.mean(axis=0)
        rays = streaks((plane.shape[0], plane.shape[1]), (spacing[1], spacing[2]), (row, column))
        return plane + np.float32(self.streak) * rays
