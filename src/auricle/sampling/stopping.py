"""Stopping: whether the samples so far are enough, and if not, why."""

from dataclasses import dataclass

from auricle.sampling.bandwidth import Bracket

LARGEST_CLOSING = 1.5
"""Ratio of the two ends of the bandwidth's bracket up to which it counts as closed."""
LARGEST_LOO_VARIANCE = 1.5
"""Mean square of the standardised leave-one-out residuals beyond which the map is too sure."""
LARGEST_UNDERSAMPLED_SHARE = 0.1
"""Share of the accessible area that may be coarser than the map's bandwidth asks for."""


@dataclass(frozen=True)
class Evidence:
    """What the decision rests on.

    Attributes
    ----------
    n_samples
        How many there are.
    knows_nothing
        Whether they say too little for any of the numbers below to be believed.
    target_nrmse, predicted_nrmse
        Error to reach, and the one predicted.
    bracket
        Bandwidth at the share of the power that the target stands for; None if there is none.
    undersampled_share
        Share of the accessible area that does not support the bracket's upper end.
    loo_variance
        Mean square of the standardised leave-one-out residuals; NaN if it is unknown.
    """

    n_samples: int
    knows_nothing: bool
    target_nrmse: float
    predicted_nrmse: float
    bracket: Bracket | None
    undersampled_share: float
    loo_variance: float


@dataclass(frozen=True)
class Verdict:
    """Enough, or not yet and why.

    Attributes
    ----------
    enough
        Whether sampling can stop.
    reasons
        What still speaks against it, one phrase each; empty if nothing does.
    """

    enough: bool
    reasons: tuple[str, ...]


def verdict(evidence: Evidence) -> Verdict:
    """Judge whether the samples are enough for the target.

    Four things must hold: the predicted error is within the target; the bracket of the map's
    bandwidth has closed, so that more samples would not show a finer map; hardly any part of the
    surface is coarser than that bandwidth; and the samples, each predicted from the others, are
    no farther off than the prediction says.

    Examples
    --------
    >>> known = Bracket(0.99, 40, 50)
    >>> verdict(Evidence(200, False, 0.1, 0.08, known, 0.02, 1.0)).enough
    True
    >>> verdict(Evidence(200, False, 0.1, 0.12, known, 0.02, 1.0)).reasons
    ('the predicted error is 12 %, above the target of 10 %',)
    """
    if evidence.knows_nothing:
        return Verdict(
            False, (f"{evidence.n_samples} samples say too little of the map to judge it by",)
        )
    reasons = []
    if not evidence.predicted_nrmse <= evidence.target_nrmse:
        reasons.append(
            f"the predicted error is {_percent(evidence.predicted_nrmse)}, above the target of "
            f"{_percent(evidence.target_nrmse)}"
        )
    found = evidence.bracket
    if found is None:
        reasons.append("the bandwidth lies beyond the harmonics solved")
    elif found.closing > LARGEST_CLOSING:
        reasons.append(
            f"the map's bandwidth is not yet known: between {found.lower} and {found.upper} "
            "harmonics"
        )
    if evidence.undersampled_share > LARGEST_UNDERSAMPLED_SHARE:
        reasons.append(
            f"{_percent(evidence.undersampled_share)} of the surface is sampled too sparsely for "
            "that bandwidth"
        )
    if evidence.loo_variance > LARGEST_LOO_VARIANCE:
        reasons.append(
            "samples differ from what their neighbours predict by "
            f"{evidence.loo_variance**0.5:.1f} times the stated uncertainty"
        )
    return Verdict(not reasons, tuple(reasons))


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"
