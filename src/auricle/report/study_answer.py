"""The answer of a study's analysis: what its points say of each map, in a sentence or two."""

from auricle.report.wording import counted, field_words, listed, number, percent, printable
from auricle.study.map_study import FieldAnalysis, MapAnalysis


def map_answers(one: MapAnalysis) -> tuple[str, ...]:
    """A sentence or two for each quantity of a map, or why there is none."""
    name = printable(one.name)
    if one.fields:
        return tuple(
            f"{name}, {field_words(field.name)}: {field_answer(field)}" for field in one.fields
        )
    if not one.n_points:
        return (f"{name}: no mapping points, so nothing can be said of how it was sampled.",)
    if one.prepared is None and one.extent is not None:
        spacing = number(one.extent.spacing_mm, digits=2)
        return (
            f"{name}: {counted(one.n_points, 'point')}, {spacing} mm apart in the median, but no "
            "surface that can be analysed: no map, no gaps and no errors can be told.",
        )
    return (f"{name}: {counted(one.n_points, 'point')} and no map: see its notes.",)


def field_answer(field: FieldAnalysis) -> str:
    """What the points say of one quantity."""
    result = field.rebuilt
    n_places = len(result.placed)
    if field.knows_nothing:
        return (
            f"the values at {counted(n_places, 'place')} say nothing of the map: no error, area or "
            "velocity is told."
        )
    mapped = (
        f"{percent(field.mapped_share)} of the surface was mapped "
        f"({number(result.coverage.radius_mm, digits=2)} mm to the farthest place)"
    )
    target = percent(result.config.target_nrmse)
    error = percent(field.mapped_nrmse)
    enough = field.n_sufficient
    if enough is None:
        judged = f"there the expected error is {error}, above the target of {target}"
        redundant = 0 if field.redundancy is None else field.redundancy.n_redundant
        spare = f"; {redundant:,} of {n_places:,} points add next to nothing" if redundant else ""
        return f"{mapped}; {judged}{spare}.{_derived(field)}"
    return (
        f"{mapped}; there the expected error is {error} (target {target}), and {enough:,} of its "
        f"{n_places:,} points would have been enough.{_derived(field)}"
    )


def _derived(field: FieldAnalysis) -> str:
    """Low-voltage area and velocity, where they are known."""
    parts = []
    low = field.low_voltage
    if low is not None:
        ends = (number(value / 100, digits=2) for value in (low.low_mm2, low.high_mm2))
        some = (
            f"below {low.threshold_mv:g} mV lie {number(low.expected_mm2 / 100, digits=2)} cm² "
            f"({' to '.join(ends)})"
        )
        parts.append(some if low.high_mm2 > 0 else f"none of it lies below {low.threshold_mv:g} mV")
    speed = field.velocity
    if speed is not None:
        ends = (number(value, digits=2) for value in (speed.low, speed.high))
        parts.append(
            f"conduction runs at {number(speed.expected, digits=2)} m/s in the median "
            f"({' to '.join(ends)})"
        )
    if not parts:
        return ""
    words = listed(parts)
    return f" {words[:1].upper()}{words[1:]}."
