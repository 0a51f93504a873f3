"""The heart and its vessels round the left atrium of a phantom, as layers of a scene."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from auricle.arrays import Floats, Points
from auricle.simulation.atrium import AORTA_RADIUS
from auricle.simulation.ct_atrium import PhantomAtrium, pulmonary_tree, tube_sweep
from auricle.simulation.ct_layers import Layer, Tissue
from auricle.simulation.ct_shapes import (
    Apart,
    Cut,
    Ellipsoids,
    Sweep,
    Union,
    ellipsoid,
    frame,
    joined,
    sweep,
    tree,
)
from auricle.simulation.ct_valve import Funnel

_STEP = 3.0
"""mm between the nodes of a vessel."""
_FAT_HU, _METAL_HU = -85.0, 3000.0
_MIXING = 0.002
"""Share by which the right heart's contrast grows per mm towards the vein it came in by."""


@dataclass(frozen=True)
class Blood:
    """What fills the heart, and how thin its walls are.

    Attributes
    ----------
    left, right
        HU of the left and of the right heart.
    muscle
        HU of the myocardium.
    gradient
        Change of the left heart's HU towards the head, HU/mm.
    wall
        Thickness of the atrial wall, mm.
    aorta_gap
        Between the blood of the atrium and that of the aortic root, mm.
    """

    left: float
    right: float
    muscle: float
    gradient: float
    wall: float
    aorta_gap: float


@dataclass(frozen=True, eq=False)
class Heart:
    """The parts of a heart that hang together in space.

    Attributes
    ----------
    atrium
        The left atrium, at the origin of the axes.
    ventricle_axis
        Unit vector from the mitral annulus to the apex.
    ventricle
        Cavity of the left ventricle.
    right_ventricle, right_atrium
        Cavities of the right heart.
    """

    atrium: PhantomAtrium
    ventricle_axis: Points
    ventricle: Ellipsoids
    right_ventricle: Ellipsoids
    right_atrium: Ellipsoids

    @property
    def sac(self) -> Ellipsoids:
        """What the pericardium holds, but for the great vessels."""
        semi_axes = np.asarray(self.atrium.shape.semi_axes)
        return joined(
            [
                grown(self.ventricle, 14.0),
                grown(self.right_ventricle, 8.0),
                grown(self.right_atrium, 6.0),
                ellipsoid(np.zeros(3), semi_axes + 5.0),
                ellipsoid(np.array([4.0, -38.0, 30.0]), np.array([36.0, 34.0, 44.0])),
                ellipsoid(np.array([14.0, -40.0, -78.0]), np.array([52.0, 44.0, 26.0])),
            ],
            blend=14.0,
        )

    @property
    def lead_path(self) -> Points:
        """From the superior vena cava through the right heart to its apex, mm."""
        right_atrium, right_ventricle = (
            self.right_atrium.centres[0],
            self.right_ventricle.centres[0],
        )
        turns = [
            *_cava_nodes(right_atrium)[:2],
            np.add(right_atrium, (4.0, 0.0, -12.0)),
            right_ventricle,
            right_ventricle + 34.0 * self.ventricle_axis,
        ]
        return smooth_path(np.array(turns), np.ones(len(turns)))[:, :3]


def heart_of(atrium: PhantomAtrium, rng: np.random.Generator) -> Heart:
    """A heart that fits an atrium, its sizes varied by some per cent."""
    size = rng.uniform(0.94, 1.08)
    axis = atrium.annulus_normal + rng.uniform(-0.05, 0.05, 3) + np.array([0.22, -0.1, 0.12])
    axis /= np.linalg.norm(axis)
    radius = 1.62 * atrium.annulus_radius * rng.uniform(0.95, 1.05)
    half = 46.0 * size
    centre = atrium.annulus_centre + 0.80 * half * axis
    left, front, _ = atrium.shape.semi_axes
    beside = np.array([-left - 15.0, -0.85 * front, -7.0]) + rng.uniform(-2.0, 2.0, 3)
    return Heart(
        atrium,
        axis,
        ellipsoid(centre, np.array([radius, radius, half]), axis),
        ellipsoid(
            centre + np.array([-25.0, -20.0, -3.0]), np.array([25.0, 27.0, 43.0]) * size, axis
        ),
        ellipsoid(beside, np.array([19.0, 23.0, 28.0]) * size),
    )


def heart_layers(
    heart: Heart, blood: Blood, rng: np.random.Generator, *, mitral_open: bool = True
) -> list[Layer]:
    """The heart from the fat round it to the valve leaflets, in the order of painting."""
    atrium = heart.atrium
    veins = pulmonary_tree(atrium.veins, rng)
    aorta = _aorta(atrium, AORTA_RADIUS - blood.aorta_gap)
    return [
        Layer(heart.sac, _FAT_HU, Tissue.FAT),
        *_right_heart(heart, blood),
        Layer(heart.ventricle, blood.muscle, Tissue.MYOCARDIUM, growth=9.5),
        Layer(aorta, 70.0, Tissue.MYOCARDIUM, growth=1.6),
        Layer(veins, 70.0, Tissue.ATRIAL_WALL, growth=min(1.0, blood.wall)),
        Layer(atrium, 0.9 * blood.muscle, Tissue.ATRIAL_WALL, growth=blood.wall),
        Layer(
            Apart(aorta, atrium, blood.aorta_gap),
            blood.left - 10.0,
            Tissue.AORTA,
            gradient=blood.gradient,
        ),
        *_left_heart_blood(heart, veins, blood),
        *_groove_vessels(atrium, blood),
        *_valve(heart, blood, mitral_open=mitral_open),
    ]


def filling_defect(atrium: PhantomAtrium, share: float) -> Layer:
    """Unopacified blood in the outer `share` of the appendage."""
    appendage = atrium.shape.appendage
    lobes = tree([tube_sweep(tube) for tube in (appendage, *atrium.shape.lobes)])
    before, at = appendage.centre_line(np.array([0.99, 1.0]) - share)
    upstream = (before - at) / np.linalg.norm(before - at)
    return Layer(Cut(lobes, at, upstream), 70.0, None)


def lead(heart: Heart) -> Layer:
    """A pacing lead."""
    path = heart.lead_path
    return Layer(sweep(path, np.full(len(path), 1.1)), _METAL_HU, Tissue.LEAD)


def smooth_path(nodes: Points, radii: Floats) -> Floats:
    """Nodes and radii (m, 4) every few mm along a smooth curve through a few."""
    ends = np.column_stack([nodes, radii])
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    places = np.linspace(0.0, lengths[-1], max(int(lengths[-1] / _STEP), 2) + 1)
    path: Floats = PchipInterpolator(lengths, ends)(places)
    return path


def vessel(*nodes: tuple[float, float, float, float]) -> Sweep:
    """A tube through nodes of x, y, z and radius, mm."""
    ends = np.array(nodes)
    path = smooth_path(ends[:, :3], ends[:, 3])
    return sweep(path[:, :3], path[:, 3])


def grown(shape: Ellipsoids, by: float) -> Ellipsoids:
    """Ellipsoids with semi-axes longer by so many mm."""
    lengths = np.linalg.norm(shape.shapes, axis=2, keepdims=True)
    return Ellipsoids(shape.centres, shape.shapes / (1.0 + by * lengths), shape.blend)


def aortic_root(atrium: PhantomAtrium) -> Points:
    """Middle of the aortic root, which dents the atrium, mm."""
    semi_axes = np.asarray(atrium.shape.semi_axes)
    root: Points = semi_axes * (-0.15, -0.9, 0.35) - (0.0, AORTA_RADIUS, 0.0)
    return root


def descending_aorta(atrium: PhantomAtrium) -> Points:
    """Where the descending aorta passes behind the atrium, mm."""
    _, back, _ = atrium.shape.semi_axes
    return np.array([27.0, back + 22.0, 0.0])


def _aorta(atrium: PhantomAtrium, radius: float) -> Sweep:
    outflow = np.add(atrium.annulus_centre, (6.0, -20.0, -9.0))
    root, behind = aortic_root(atrium), descending_aorta(atrium)
    return vessel(
        (*np.add(outflow, (9.0, -1.0, -10.0)), 9.0),
        (*outflow, 9.5),
        (*root, radius),
        (*np.add(root, (-7.0, -2.0, 26.0)), 13.5),
        (root[0] - 6.0, -16.0, 74.0, 13.0),
        (12.0, 12.0, 84.0, 12.0),
        (behind[0] - 2.0, behind[1], 60.0, 11.0),
        (*behind, 10.5),
        (behind[0] - 4.0, behind[1] + 3.0, -60.0, 10.0),
        (behind[0] - 14.0, behind[1] + 4.0, -140.0, 10.0),
    )


def _pulmonary_arteries(heart: Heart) -> Sweep:
    top = heart.atrium.shape.semi_axes[2] + 15.0
    root = aortic_root(heart.atrium)
    trunk = vessel(
        (*np.add(heart.right_ventricle.centres[0], (6.0, -2.0, 18.0)), 14.0),
        (*np.add(root, (18.0, -20.0, -2.0)), 13.5),
        (*np.add(root, (23.0, -8.0, 22.0)), 13.0),
        (16.0, -26.0, top + 4.0, 12.5),
        (10.0, -16.0, top + 6.0, 11.0),
    )
    right = vessel(
        (14.0, -22.0, top + 4.0, 10.5),
        (-8.0, -6.0, top + 1.0, 9.5),
        (-32.0, 6.0, top, 9.0),
        (-50.0, 22.0, top - 5.0, 8.0),
        (-60.0, 36.0, 12.0, 6.5),
        (-64.0, 44.0, -20.0, 4.0),
    )
    left = vessel(
        (16.0, -22.0, top + 6.0, 10.0),
        (32.0, 0.0, top + 14.0, 9.5),
        (48.0, 26.0, top + 6.0, 8.5),
        (60.0, 42.0, 18.0, 6.5),
        (66.0, 50.0, -16.0, 4.0),
    )
    return tree([trunk, right, left])


def _cava_nodes(right_atrium: Points) -> Points:
    x, y, z = right_atrium
    return np.array([(x + 8.0, y, z + 120.0), (x + 8.0, y, z + 42.0), (x + 6.0, y, z + 12.0)])


def _right_heart(heart: Heart, blood: Blood) -> list[Layer]:
    ventricle, atrium = heart.right_ventricle, heart.right_atrium
    middle, beside = ventricle.centres[0], atrium.centres[0]
    appendage = vessel(
        (*np.add(beside, (6.0, -10.0, 12.0)), 12.0),
        (*np.add(beside, (14.0, -26.0, 22.0)), 10.0),
        (*np.add(beside, (26.0, -36.0, 26.0)), 6.0),
    )
    tricuspid = vessel(
        (*np.add(beside, (4.0, -10.0, -6.0)), 14.0), (*(0.4 * beside + 0.6 * middle), 14.0)
    )
    superior = vessel(*((x, y, z, 9.0) for x, y, z in _cava_nodes(beside)))
    inferior = vessel(
        (*np.add(beside, (6.0, 8.0, -16.0)), 12.0), (*np.add(beside, (10.0, 18.0, -120.0)), 12.5)
    )
    cavae = tree([superior, inferior])
    arteries = _pulmonary_arteries(heart)
    chamber = Union(atrium, appendage, blend=4.0)
    return [
        Layer(cavae, 60.0, Tissue.MYOCARDIUM, growth=1.0),
        Layer(ventricle, blood.muscle, Tissue.MYOCARDIUM, growth=3.5),
        Layer(chamber, blood.muscle, Tissue.MYOCARDIUM, growth=2.0),
        Layer(arteries, 60.0, Tissue.MYOCARDIUM, growth=1.2),
        Layer(cavae, blood.right, Tissue.VENA_CAVA, gradient=_MIXING * blood.right),
        Layer(ventricle, blood.right + 10.0, Tissue.RIGHT_VENTRICLE),
        Layer(chamber, blood.right, Tissue.RIGHT_ATRIUM, gradient=_MIXING * blood.right),
        Layer(tricuspid, blood.right, Tissue.RIGHT_ATRIUM),
        Layer(arteries, blood.right + 40.0, Tissue.PULMONARY_ARTERY),
    ]


def _left_heart_blood(heart: Heart, veins: Sweep, blood: Blood) -> list[Layer]:
    atrium = heart.atrium
    centre, normal = atrium.annulus_centre, atrium.annulus_normal
    cavity = Cut(heart.ventricle, centre + 2.5 * normal, -normal)
    radius = atrium.annulus_radius
    orifice = sweep(centre + np.outer([-radius, radius], normal), np.full(2, radius))
    channel = Cut(Cut(orifice, centre - 3.0 * normal, -normal), centre + 8.0 * normal, normal)
    return [
        Layer(cavity, blood.left - 12.0, Tissue.LEFT_VENTRICLE),
        Layer(channel, blood.left, Tissue.LEFT_VENTRICLE, gradient=blood.gradient),
        Layer(veins, blood.left, Tissue.PULMONARY_VEIN, gradient=blood.gradient),
        Layer(atrium, blood.left, Tissue.LEFT_ATRIUM, gradient=blood.gradient),
    ]


def _groove_vessels(atrium: PhantomAtrium, blood: Blood) -> list[Layer]:
    """Coronary sinus and circumflex artery, in the groove behind the annulus."""
    normal = atrium.annulus_normal
    back = np.array([0.0, 1.0, 0.0]) - normal[1] * normal
    back /= np.linalg.norm(back)
    angles = np.linspace(0.0, np.pi, 12)[:, None]
    ring = np.cos(angles) * np.cross(normal, back) + np.sin(angles) * back
    sinus = atrium.annulus_centre + 5.0 * normal + (atrium.annulus_radius + 13.0) * ring
    artery = atrium.annulus_centre + 1.0 * normal + (atrium.annulus_radius + 12.0) * ring[:9]
    return [
        Layer(sweep(sinus, np.linspace(2.4, 4.2, 12)), 0.6 * blood.right, Tissue.CORONARY_VESSEL),
        Layer(sweep(artery, np.full(9, 1.5)), blood.left - 20.0, Tissue.CORONARY_VESSEL),
    ]


def _valve(heart: Heart, blood: Blood, *, mitral_open: bool) -> list[Layer]:
    atrium = heart.atrium
    centre, normal, radius = atrium.annulus_centre, atrium.annulus_normal, atrium.annulus_radius
    leaflets = Funnel(
        centre,
        normal,
        (1.0, radius),
        (16.0, 0.52 * radius) if mitral_open else (5.0, 0.0),
        thickness=1.5,
    )
    side, forward, axis = frame(heart.ventricle_axis)
    middle = heart.ventricle.centres[0]
    width = 1.0 / np.linalg.norm(heart.ventricle.shapes[0, 0])
    papillaries = []
    for sign in (-1.0, 1.0):
        aside = sign * (0.8 * side + 0.6 * forward * sign)
        foot, head = middle + 24.0 * axis + 0.72 * width * aside, middle + 0.5 * width * aside
        papillaries.append(vessel((*foot, 5.5), (*head, 4.0)))
    return [
        Layer(leaflets, 0.9 * blood.muscle, Tissue.MITRAL_VALVE),
        Layer(tree(papillaries), blood.muscle, Tissue.MYOCARDIUM),
    ]
