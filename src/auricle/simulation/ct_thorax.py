"""The chest round the heart of a phantom: lungs, bones, airways, gullet and upper abdomen."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Points
from auricle.simulation.ct_atrium import PhantomAtrium
from auricle.simulation.ct_block import Block, Box, Grid
from auricle.simulation.ct_heart import descending_aorta, vessel
from auricle.simulation.ct_layers import AIR_HU, Layer, Tissue
from auricle.simulation.ct_shapes import Ellipsoids, Sweep, ellipsoid, joined, sweep, tree

_ENDLESS = 1e4
"""Semi-axis of an ellipsoid that stands for a cylinder, mm."""
_MIDDLE_Y = -12.0
_FAT_HU, _MUSCLE_HU, _LUNG_HU, _LIVER_HU = -100.0, 55.0, -860.0, 85.0
_CORTEX_HU, _MARROW_HU, _CARTILAGE_HU = 620.0, 170.0, 90.0
_VERTEBRA_PITCH, _DISC_HEIGHT = 27.0, 6.0


def thorax_layers(
    atrium: PhantomAtrium, pulmonary_hu: float, rng: np.random.Generator
) -> list[Layer]:
    """The chest from the skin inwards, in the order of painting; the heart goes on top."""
    tree_of_lung = _lung_vessels(rng)
    return [
        Layer(_cylinder(0.0, _MIDDLE_Y, 168.0, 114.0), _FAT_HU, Tissue.FAT),
        Layer(_cylinder(0.0, _MIDDLE_Y, 156.0, 106.0), _MUSCLE_HU, Tissue.MUSCLE),
        Layer(_cylinder(0.0, _MIDDLE_Y, 136.0, 93.0), _LUNG_HU, Tissue.LUNG),
        Layer(tree_of_lung, pulmonary_hu, Tissue.LUNG_VESSEL),
        *_abdomen(rng),
        Layer(_mediastinum(atrium), _FAT_HU, Tissue.FAT),
        *_bones(rng),
        *_airways(atrium),
        *_oesophagus(atrium),
    ]


@dataclass(frozen=True, eq=False)
class Stack:
    """Equal pieces of a cylinder along z with gaps between them: vertebrae, without the discs.

    Attributes
    ----------
    cylinder
        What is sliced.
    start, pitch, gap
        Height of the middle of a gap, distance to the next, and its height, mm.
    """

    cylinder: Ellipsoids
    start: float
    pitch: float
    gap: float

    @property
    def box(self) -> Box:
        """Where it lies."""
        return self.cylinder.box

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm."""
        height = block.coordinates[2] - self.start
        from_gap = np.abs((height + self.pitch / 2) % self.pitch - self.pitch / 2)
        return np.maximum(self.cylinder.distance(block), self.gap / 2 - from_gap).astype(np.float32)


def _cylinder(x: float, y: float, wide: float, deep: float) -> Ellipsoids:
    return ellipsoid(np.array([x, y, 0.0]), np.array([wide, deep, _ENDLESS]))


def _mediastinum(atrium: PhantomAtrium) -> Ellipsoids:
    behind = descending_aorta(atrium)
    return joined(
        [
            _cylinder(0.0, 66.0, 24.0, 24.0),
            _cylinder(10.0, 38.0, 22.0, 24.0),
            _cylinder(behind[0], behind[1], 13.0, 13.0),
            ellipsoid(np.array([-3.0, -20.0, 92.0]), np.array([38.0, 56.0, 55.0])),
            ellipsoid(np.array([0.0, -84.0, 20.0]), np.array([12.0, 26.0, 150.0])),
        ],
        blend=10.0,
    )


def _abdomen(rng: np.random.Generator) -> list[Layer]:
    height = rng.uniform(-6.0, 6.0)
    liver = joined(
        [
            ellipsoid(np.array([-62.0, -14.0, -126.0 + height]), np.array([100.0, 86.0, 78.0])),
            ellipsoid(np.array([14.0, -46.0, -130.0 + height]), np.array([62.0, 54.0, 50.0])),
        ],
        blend=16.0,
    )
    spleen = ellipsoid(np.array([76.0, 8.0, -136.0 + height]), np.array([76.0, 76.0, 68.0]))
    gas = ellipsoid(np.array([76.0, -30.0, -96.0 + height]), np.array([24.0, 18.0, 12.0]))
    return [
        Layer(spleen, 70.0, Tissue.STOMACH),
        Layer(gas, -980.0, Tissue.STOMACH),
        Layer(liver, _LIVER_HU, Tissue.LIVER),
    ]


def _bones(rng: np.random.Generator) -> list[Layer]:
    start = rng.uniform(0.0, _VERTEBRA_PITCH)
    column = _cylinder(0.0, 66.0, 18.5, 15.0)
    vertebrae = Stack(column, start, _VERTEBRA_PITCH, _DISC_HEIGHT)
    inner = Stack(_cylinder(0.0, 66.0, 16.5, 13.0), start, _VERTEBRA_PITCH, _DISC_HEIGHT + 4.0)
    ribs, cartilage = _ribs(start)
    sternum = _cylinder(0.0, -109.0, 17.0, 6.0)
    arch = _cylinder(0.0, 90.0, 13.0, 12.0)
    return [
        Layer(arch, 420.0, Tissue.BONE),
        Layer(_cylinder(0.0, 90.0, 8.5, 7.5), 30.0, Tissue.SPINAL_CANAL),
        Layer(column, 95.0, Tissue.SPINAL_CANAL),
        Layer(vertebrae, _CORTEX_HU, Tissue.BONE),
        # Spongy bone: denser towards the plates and uneven from one vertebra to the next.
        Layer(inner, _MARROW_HU, Tissue.BONE, gradient=0.35),
        Layer(ribs, _CORTEX_HU, Tissue.BONE),
        Layer(ribs, _MARROW_HU, Tissue.BONE, growth=-1.5),
        Layer(cartilage, _CARTILAGE_HU, Tissue.MUSCLE),
        Layer(sternum, 380.0, Tissue.BONE),
        Layer(sternum, 120.0, Tissue.BONE, growth=-1.5),
    ]


def _ribs(start: float) -> tuple[Sweep, Sweep]:
    """Ribs and their cartilage: half ellipses round the lungs that sink towards the front."""
    ribs, cartilages = [], []
    for number in range(-7, 8):
        for side in (-1.0, 1.0):
            path = _rib_path(start + _VERTEBRA_PITCH * number, side)
            ribs.append(sweep(path[:30], np.full(30, 5.0)))
            cartilages.append(sweep(path[29:], np.full(len(path) - 29, 4.5)))
    return tree(ribs), tree(cartilages)


def _rib_path(height: float, side: float) -> Points:
    share = np.linspace(0.0, 1.0, 40)
    angle = np.radians(100.0 + 165.0 * share)
    return np.column_stack(
        [
            -side * 146.0 * np.cos(angle) * np.where(share < 0.02, 0.9, 1.0),
            _MIDDLE_Y + 99.5 * np.sin(angle),
            height - 75.0 * np.sin(np.pi / 2 * np.minimum(share / 0.75, 1.0)),
        ]
    )


def _airways(atrium: PhantomAtrium) -> list[Layer]:
    roof = atrium.shape.semi_axes[2]
    carina = np.array([-1.0, 20.0, roof + 34.0])
    airways = tree(
        [
            vessel((0.0, 24.0, carina[2] + 90.0, 8.5), (*carina, 8.0)),
            vessel((*carina, 7.0), (24.0, 32.0, roof + 17.0, 6.5), (46.0, 36.0, roof + 8.0, 5.5)),
            vessel((46.0, 36.0, roof + 8.0, 4.5), (66.0, 36.0, roof - 22.0, 3.0)),
            vessel((*carina, 7.5), (-24.0, 32.0, roof + 17.0, 6.5), (-44.0, 36.0, roof + 6.0, 5.0)),
            vessel((-44.0, 36.0, roof + 6.0, 4.5), (-62.0, 38.0, roof - 26.0, 3.0)),
        ]
    )
    return [
        Layer(airways, 30.0, Tissue.MUSCLE, growth=1.5),
        Layer(airways, -985.0, Tissue.AIRWAY),
    ]


def _oesophagus(atrium: PhantomAtrium) -> list[Layer]:
    back = atrium.shape.semi_axes[1]
    nodes = [
        (4.0, 40.0, 150.0),
        (4.0, 38.0, 60.0),
        (8.0, back + 9.5, 10.0),
        (10.0, back + 9.0, -20.0),
        (16.0, back + 10.0, -110.0),
    ]
    wall = vessel(*((x, y, z, 6.0) for x, y, z in nodes))
    lumen = vessel(*((x, y, z, 2.3) for x, y, z in nodes[:4]))
    return [
        Layer(wall, 40.0, Tissue.OESOPHAGUS),
        Layer(lumen, AIR_HU + 60.0, Tissue.OESOPHAGUS),
    ]


def _lung_vessels(rng: np.random.Generator) -> Sweep:
    """Vessels from each hilum into the lung, thinner as they go."""
    share = np.linspace(0.0, 1.0, 9)[:, None]
    vessels = []
    for side in (-1.0, 1.0):
        for _ in range(70):
            way = rng.normal(size=3) * (0.9, 1.0, 1.1) + (1.0 * side, 0.0, -0.1)
            way /= np.linalg.norm(way)
            start = np.array([52.0 * side, 16.0, 8.0]) + rng.normal(0.0, 9.0, 3)
            length = rng.uniform(45.0, 110.0)
            nodes = start + length * share * way + share**2 * rng.uniform(-16.0, 16.0, 3)
            vessels.append(
                sweep(nodes, rng.uniform(2.0, 4.0) * np.linspace(1.0, 0.18, 9), reach=2.0)
            )
            for at in (4, 6):
                aside = 0.5 * way + 0.6 * rng.normal(size=3)
                twig = nodes[at] + 0.4 * length * share * aside / np.linalg.norm(aside)
                vessels.append(sweep(twig, np.linspace(1.4, 0.5, 9), reach=2.0))
    return tree(vessels)
