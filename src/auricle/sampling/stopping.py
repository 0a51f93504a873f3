"""Stopping: whether the samples so far are enough, and if not, why."""

from dataclasses import dataclass

from auricle.sampling.bandwidth import Bracket

LARGEST_CLOSING = 1.5
"""Ratio of the two ends of the bandwidth's bracket up to which it counts as closed."""
LARGEST_LOO_VARIANCE = 1.5
"""Mean square of the standardised leave-one-out residuals beyond which the map is too sure."""
LARGEST_UNDERSAMPLED_SHARE = 0.1
"""Share of the accessible area that may be coarser than the map's bandwidth asks for."""
LARGEST_LEFT_OUT_SHARE = 0.5
"""Share of the samples that may lie off the surface before the two are taken not to belong."""
_MOST_DIGITS = 5
"""Of an error that is hardly above its target."""


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
    left_out_share
        Share of the samples handed in that could not be used.
    """

    n_samples: int
    knows_nothing: bool
    target_nrmse: float
    predicted_nrmse: float
    bracket: Bracket | None
    undersampled_share: float
    loo_variance: float
    left_out_share: float = 0.0


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

    Five things must hold: the predicted error is within the target; the bracket of the map's
    bandwidth has closed, so that more samples would not show a finer map; hardly any part of the
    surface is coarser than that bandwidth; the samples, each predicted from the others, are no
    farther off than the prediction says; and most of those handed in lie on the surface.

    Examples
    --------
    >>> known = Bracket(0.99, 40, 50)
    >>> verdict(Evidence(200, False, 0.1, 0.08, known, 0.02, 1.0)).enough
    True
    >>> verdict(Evidence(200, False, 0.1, 0.12, known, 0.02, 1.0)).reasons
    ('the predicted error is 12 %, above the target of 10 %',)
    """
    strangers = _strangers(evidence)
    if evidence.knows_nothing:
        few = "1 sample says" if evidence.n_samples == 1 else f"{evidence.n_samples} samples say"
        return Verdict(False, (f"{few} too little of the map to judge it by", *strangers))
    reasons = [*strangers, *_error(evidence), *_bandwidth(evidence)]
    if evidence.loo_variance > LARGEST_LOO_VARIANCE:
        reasons.append(
            "samples differ from what their neighbours predict by "
            f"{evidence.loo_variance**0.5:.1f} times the stated uncertainty"
        )
    return Verdict(not reasons, tuple(reasons))


def _strangers(evidence: Evidence) -> tuple[str, ...]:
    if evidence.left_out_share <= LARGEST_LEFT_OUT_SHARE:
        return ()
    left = _percent(evidence.left_out_share)
    return (
        f"{left} of the samples were left out: check that they are in mm and in the surface's "
        "frame",
    )


def _error(evidence: Evidence) -> tuple[str, ...]:
    if evidence.predicted_nrmse <= evidence.target_nrmse:
        return ()
    target = _percent(evidence.target_nrmse)
    digits = 2
    while _percent(evidence.predicted_nrmse, digits) == target and digits < _MOST_DIGITS:
        digits += 1
    error = _percent(evidence.predicted_nrmse, digits)
    return (f"the predicted error is {error}, above the target of {target}",)


def _bandwidth(evidence: Evidence) -> tuple[str, ...]:
    found = evidence.bracket
    if found is None:
        return ("the map's bandwidth lies beyond the harmonics solved: solve for more",)
    reasons = []
    if found.closing > LARGEST_CLOSING:
        reasons.append(
            f"the map's bandwidth is not yet known: between {found.lower} and {found.upper} "
            "harmonics"
        )
    if evidence.undersampled_share > LARGEST_UNDERSAMPLED_SHARE:
        reasons.append(
            f"{_percent(evidence.undersampled_share)} of the surface is sampled too sparsely for "
            "that bandwidth"
        )
    return tuple(reasons)


def _percent(share: float, digits: int = 2) -> str:
    """Significant digits, in full.

    >>> _percent(0.083), _percent(0.12), _percent(1.14), _percent(1.0)
    ('8.3 %', '12 %', '110 %', '100 %')
    """
    return f"{float(f'{100 * share:.{digits}g}'):g} %"
