"""The verdict on a segmentation: whether to trust it, and every reason not to, by name."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from auricle.errors import InputError


class Verdict(Enum):
    """What may be done with a segmentation."""

    OK = "ok"
    CHECK = "check"
    REFUSED = "refused"


REMEDIES = {
    "leak": "look at the overlay there; give a region of interest that leaves it out",
    "mitral": "look at the ventricular end; give a region of interest that ends at the valve",
    "no_contrast": "segment a scan with contrast in the left heart",
    "not_hu": "give CT numbers in HU: check the rescale slope and intercept",
    "low_contrast": "give the lower threshold, or a seed in the brightest part of the atrium",
    "no_chamber": "give a seed inside the left atrium",
    "seed_outside": "give the seed in mm, LPS axes, inside the volume and the region of interest",
    "seed_not_in_blood": "move the seed into the contrasted blood of the left atrium",
    "truncated": "take a scan that holds the whole atrium, or accept a cut surface",
    "volume_outside": "look at the overlay: an atrium measures 30 to 300 ml",
    "weak_neck": "look at the overlay where the chambers meet",
    "no_appendage": "look whether the appendage is missing, filled by thrombus or cut as a vein",
    "runner_up_seed": "look whether the right chamber was taken, or give a seed",
    "orientation": "give a seed; left, front and up of this file are not known",
}
"""What to do, by reason."""


@dataclass(frozen=True)
class Reason:
    """One thing a user should know before trusting a segmentation.

    Attributes
    ----------
    code
        A key of `REMEDIES`.
    cause
        What was found, with its numbers and unit.
    stops
        Whether it makes the verdict ``check``; else it is only told.
    position
        Where, mm, LPS, if it has a place.
    """

    code: str
    cause: str
    stops: bool = True
    position: tuple[float, float, float] | None = None

    @property
    def remedy(self) -> str:
        """What to do."""
        return REMEDIES[self.code]

    def __str__(self) -> str:
        return f"{self.code}: {self.cause}: {self.remedy}"


class SegmentationError(InputError):
    """A volume from which no atrium could be segmented.

    Attributes
    ----------
    code
        A key of `REMEDIES`.
    remedy
        What to do.
    """

    def __init__(self, code: str, cause: str) -> None:
        self.code = code
        self.remedy = REMEDIES[code]
        super().__init__(f"{cause}: {self.remedy}")


def verdict_of(reasons: Sequence[Reason]) -> Verdict:
    """``check`` if a reason stops, else ``ok``; refusals are raised as `SegmentationError`.

    Examples
    --------
    >>> verdict_of([Reason("no_appendage", "no appendage was found", stops=False)]).value
    'ok'
    """
    return Verdict.CHECK if any(reason.stops for reason in reasons) else Verdict.OK
