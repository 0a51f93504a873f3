"""Views: the directions a cardiac surface is looked at from, and the camera that does it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from auricle.arrays import Floats, Points
from auricle.errors import InputError


@dataclass(frozen=True)
class View:
    """A direction to look from, as unit vectors of the surface's axes.

    Attributes
    ----------
    name
        Short name, as on a mapping system (``AP``, ``LAO 45``).
    right, up
        What points to the right and upwards in the picture.
    seen_from
        The direction in words.
    """

    name: str
    right: tuple[float, float, float]
    up: tuple[float, float, float]
    seen_from: str

    @property
    def toward(self) -> Floats:
        """Unit vector from the surface to the viewer, shape (3,).

        Examples
        --------
        Looking from the front, the viewer stands at negative y: LPS axes point backwards.

        >>> STANDARD_VIEWS["AP"].toward.tolist()
        [0.0, -1.0, 0.0]
        """
        toward: Floats = np.cross(self.right, self.up) + 0.0
        return toward


_LEFT, _BACK, _HEAD = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def _oblique(name: str, degrees: float, seen_from: str) -> View:
    angle = np.deg2rad(degrees)
    return View(name, (float(np.cos(angle)), float(np.sin(angle)), 0.0), _HEAD, seen_from)


STANDARD_VIEWS: Mapping[str, View] = MappingProxyType(
    {
        view.name: view
        for view in (
            View("AP", _LEFT, _HEAD, "the front"),
            View("PA", (-1.0, 0.0, 0.0), _HEAD, "the back"),
            _oblique("LAO 45", 45.0, "the front, 45° to the patient's left"),
            _oblique("RAO 30", -30.0, "the front, 30° to the patient's right"),
            View("LL", _BACK, _HEAD, "the patient's left"),
            View("RL", (0.0, -1.0, 0.0), _HEAD, "the patient's right"),
            View("SUP", _LEFT, _BACK, "above"),
            View("INF", _LEFT, (0.0, -1.0, 0.0), "below"),
        )
    }
)
"""Views by name, for LPS axes: x to the patient's left, y to the back, z to the head.

A file that does not say how its axes lie in the patient is drawn with the same axes; the
directions then are those of the file and the words in `View.seen_from` do not hold.
"""


@dataclass(frozen=True)
class Camera:
    """An orthographic camera.

    Attributes
    ----------
    view
        Where it looks from.
    centre
        Point shown in the middle of the picture, mm.
    mm_per_pixel
        Width of a pixel on the surface, mm.
    width, height
        Size of the picture, pixels.
    """

    view: View
    centre: tuple[float, float, float]
    mm_per_pixel: float
    width: int
    height: int

    def __post_init__(self) -> None:
        if not self.mm_per_pixel > 0 or min(self.width, self.height) < 1:
            raise InputError("a picture has at least one pixel, and a pixel a positive width")

    def project(self, points: Points) -> Points:
        """Place `points` in the picture.

        Parameters
        ----------
        points
            Shape (n, 3), mm.

        Returns
        -------
        Points
            Columns: pixels from the left edge, pixels from the top edge, mm towards the viewer.
        """
        offset = points - np.asarray(self.centre)
        placed: Points = np.column_stack(
            [
                self.width / 2 + offset @ np.asarray(self.view.right) / self.mm_per_pixel,
                self.height / 2 - offset @ np.asarray(self.view.up) / self.mm_per_pixel,
                offset @ self.view.toward,
            ]
        )
        return placed


def cameras(
    points: Points, views: Sequence[View], *, width: int, height: int, margin: float = 0.03
) -> tuple[Camera, ...]:
    """Cameras at one scale that each show all `points`, centred.

    Parameters
    ----------
    points
        What must be seen, shape (n, 3), mm.
    views
        One a camera.
    width, height
        Size of every picture, pixels.
    margin
        Share of the picture left free on each side, at least.

    Examples
    --------
    >>> ball = np.array([[-5.0, -5.0, -5.0], [5.0, 5.0, 5.0]])
    >>> (camera,) = cameras(ball, [STANDARD_VIEWS["AP"]], width=100, height=50, margin=0.0)
    >>> camera.mm_per_pixel
    0.2
    """
    middles, scales = [], []
    for view in views:
        axes = np.array([view.right, view.up, view.toward])
        placed = points @ axes.T
        low, high = placed.min(axis=0), placed.max(axis=0)
        middles.append((low + high) / 2 @ axes)
        scales += list((high - low)[:2] / ((1 - 2 * margin) * np.array([width, height])))
    scale = float(max(scales))
    return tuple(
        Camera(view, (float(x), float(y), float(z)), scale, width, height)
        for view, (x, y, z) in zip(views, middles, strict=True)
    )
