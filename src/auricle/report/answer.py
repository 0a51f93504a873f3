"""The answer: how many points the maps of a surface take, in a sentence and map by map."""

from collections.abc import Sequence
from dataclasses import dataclass

from auricle.report.tables import PLANNED, UNPLANNED, Quantity, bound_of, spread_of
from auricle.report.wording import counted, listed, number, percent, signal_words
from auricle.sampling.criteria import Criterion, Need
from auricle.study.result import CaseResult, Signal

TARGET_SHARE = 0.99
"""Share of the power that the sentence is read at: an error of 10 %."""
COARSE_SHARE = 0.90
"""Share of the power told beside it: an error of 32 %, the upper one of the paper's two."""

_MOST_NAMED = 3
_CLOSE_MM = 1.0
_ANYWHERE = "if they are taken wherever the catheter happens to be"


@dataclass(frozen=True)
class Advice:
    """What one map takes.

    Attributes
    ----------
    words, label
        The map in words, and the width of a simulated focus (else the words again).
    target, coarse
        What its measured error takes to reach that of `TARGET_SHARE` and of `COARSE_SHARE`.
    bound
        What all the harmonics solved for ask for; a reading that is not reached takes more.
    share_in_band
        Share of the power that those harmonics hold.
    spread, unit
        The map's standard deviation; the unit is empty where the file does not state one.
    """

    words: str
    label: str
    target: Criterion
    coarse: Criterion
    bound: Need
    share_in_band: float
    spread: float
    unit: str

    @property
    def target_error(self) -> str:
        """Error at the target in the map's own unit; empty if that is not known."""
        if not self.unit:
            return ""
        return f"{number(self.target.nrmse * self.spread, digits=2)} {self.unit}"

    @property
    def most_planned(self) -> float:
        """Points to plan for the target, evenly spread; infinite if it is not reached."""
        return self.target.need.n_planned if self.target.need else float("inf")

    def count(self, quantity: Quantity, *, coarse: bool = False, note: str = "") -> str:
        """A number of points in words: "78", "more than 511", "78 (σ = 8 mm)"."""
        criterion = self.coarse if coarse else self.target
        if criterion.need is None:
            shown, unsure = f"more than {quantity.of(self.bound)}", ""
        else:
            shown = quantity.of(criterion.need)
            unsure = "" if criterion.need.trusted else "finer than this mesh resolves"
        notes = ", ".join(filter(None, (note, unsure)))
        return f"{shown} ({notes})" if notes else shown


def advice(signal: Signal, result: CaseResult) -> Advice:
    """What one map of a case takes."""
    by_share = {each.share: each for each in signal.for_error}
    words, width = signal_words(signal), signal.details.get("width_mm")
    return Advice(
        words=words,
        label=words if width is None else f"σ = {width:g} mm",
        target=by_share[TARGET_SHARE],
        coarse=by_share[COARSE_SHARE],
        bound=bound_of(result),
        share_in_band=float(signal.spectrum.cumulative()[-1]),
        spread=spread_of(signal, result),
        unit="" if signal.kind == "simulated" else signal.field.unit,
    )


def measured_advice(result: CaseResult) -> tuple[Advice, ...]:
    """What each map that came with the surface takes, in their order."""
    return tuple(advice(signal, result) for signal in result.fields)


def focal_advice(result: CaseResult) -> tuple[Advice, ...]:
    """What simulated foci take: the least and the most demanding width, or the only one.

    Only the maps with the fewest foci are compared, so that the width alone differs.
    """
    fewest = min((signal.details["n_foci"] for signal in result.simulated), default=1)
    return _extremes(
        [
            advice(signal, result)
            for signal in result.simulated
            if signal.details["n_foci"] == fewest
        ]
    )


def answer_sentence(result: CaseResult) -> str:
    """How many points to take: plain text, one or two sentences.

    The maps that came with the surface first, then simulated foci from the least to the most
    demanding; where there is neither, the shape itself. The counts bring the error measured on
    the real surface down to 10 % of the map's standard deviation.
    """
    maps, foci = measured_advice(result), focal_advice(result)
    if len(maps) == 1:
        told = _one_map(maps[0])
    elif maps:
        told = _several_maps(maps)
    else:
        told = _foci_alone(foci) if foci else _shape(result)
    besides = f" {_foci_besides(foci)}." if maps and foci else ""
    sentence = f"On this surface ({number(result.analyzed.area_mm2 / 100)} cm²), {told}.{besides}"
    return sentence.replace("about more than", "more than")


def _one_map(only: Advice) -> str:
    error = f"an error of {percent(only.target.nrmse)} of its variation"
    found = only.target.need
    if found is None:
        return (
            f"{only.words} takes {only.count(PLANNED)} evenly spread points for {error}: the "
            f"{counted(only.bound.n_modes, 'harmonic')} solved hold only "
            f"{percent(only.share_in_band)} of its power"
        )
    absolute = f" (about {only.target_error})" if only.target_error else ""
    return (
        f"plan about {only.count(PLANNED)} evenly spread points, one every "
        f"{number(found.planned_spacing_mm, digits=2)} mm, to map {only.words} with {error}"
        f"{absolute}, or about {only.count(UNPLANNED)} {_ANYWHERE}; sampling theory demands at "
        f"least {found.n_least}, and an error of {percent(only.coarse.nrmse)} takes "
        f"{only.count(PLANNED, coarse=True)}"
    )


def _several_maps(maps: Sequence[Advice]) -> str:
    named, others = maps[:_MOST_NAMED], _extremes(maps[_MOST_NAMED:])
    planned = [
        f"{named[0].count(PLANNED)} evenly spread points for {named[0].words}",
        *(f"{each.count(PLANNED)} for {each.words}" for each in named[1:]),
    ]
    if others:
        ends = " to ".join(each.count(PLANNED) for each in others)
        planned.append(f"{ends} for {counted(len(maps) - len(named), 'further map')}")
    unplanned = listed([each.count(UNPLANNED) for each in named])
    rough = listed([each.count(PLANNED, coarse=True) for each in named])
    again = " for the maps named" if others else ""
    return (
        f"an error of {percent(named[0].target.nrmse)} of a map's variation takes about "
        f"{listed(planned)} ({unplanned}{again} {_ANYWHERE}); an error of "
        f"{percent(named[0].coarse.nrmse)} takes {rough}{again}"
    )


def _foci_besides(foci: Sequence[Advice]) -> str:
    error = percent(foci[0].target.nrmse)
    return f"A simulated focal source takes {_ends(foci, PLANNED)} for {error}, evenly spread"


def _foci_alone(foci: Sequence[Advice]) -> str:
    return (
        f"plan about {_ends(foci, PLANNED)} evenly spread points to map a focal source with an "
        f"error of {percent(foci[0].target.nrmse)} of its variation, or about "
        f"{_ends(foci, UNPLANNED)} {_ANYWHERE}"
    )


def _shape(result: CaseResult) -> str:
    """What rebuilds the surface to within a millimetre, or how close the harmonics come."""
    errors = result.geometry_errors
    found = next((each for each in errors if each.gd_mean_mm <= _CLOSE_MM), errors[-1])
    return (
        f"which holds no map, {counted(found.n_modes, 'harmonic')} rebuild the shape to a mean "
        f"distance of {number(found.gd_mean_mm, digits=2)} mm"
    )


def _ends(advised: Sequence[Advice], quantity: Quantity) -> str:
    return " to ".join(each.count(quantity, note=each.label) for each in advised)


def _extremes(advised: Sequence[Advice]) -> tuple[Advice, ...]:
    """The least and the most demanding; one where all ask for the same."""
    if not advised:
        return ()
    least = min(advised, key=lambda each: each.most_planned)
    most = max(advised, key=lambda each: each.most_planned)
    return (least,) if least.most_planned == most.most_planned else (least, most)
