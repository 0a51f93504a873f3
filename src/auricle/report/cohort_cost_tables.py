"""What a cohort cost, stage by stage, and what many more cases would."""

from collections.abc import Sequence

from auricle.report.tables import Table
from auricle.report.wording import number, percent
from auricle.study.cohort.costs import Timed, cluster_need, stage_costs

MANY_CASES = 10_000
CORES = (100, 500, 1_000)
_LEAST_SECONDS = 0.01
"""Of a stage over all cases, below which it had nothing to do."""


def cost_tables(documents: Sequence[Timed]) -> tuple[Table, ...]:
    """Wall time of one worker by stage, and the need of ten thousand cases; none without times."""
    timed = [document for document in documents if document.timings]
    if not timed:
        return ()
    costs = stage_costs(timed)
    stages = tuple(
        (
            each.stage,
            number(each.median_s),
            number(each.total_s),
            percent(each.share),
            _exponent(each.exponent, each.exponent_error),
            _exponent(each.modes_exponent, each.modes_exponent_error),
        )
        for each in costs
        if each.total_s >= _LEAST_SECONDS
    )
    total = sum(each.total_s for each in costs)
    everything = ("all", number(total / len(timed)), number(total), percent(1.0), "", "")
    needs = []
    for n_cores in CORES:
        need = cluster_need(timed, n_cases=MANY_CASES, n_cores=n_cores)
        needs.append((f"{n_cores:,}", number(need.core_hours), number(need.wall_hours)))
    return (
        Table(
            "Cost of a case by stage (wall seconds of one worker on one core)",
            (
                "Stage",
                "Median (all: mean), s",
                "All cases, s",
                "Share",
                "b of seconds ∝ verticesᵇ",
                "c of seconds ∝ harmonicsᶜ",
            ),
            (*stages, everything),
        ),
        Table(
            f"What {MANY_CASES:,} cases like these need",
            ("Cores", "Core-hours", "Hours from start to end"),
            tuple(needs),
        ),
    )


def _exponent(value: float | None, error: float | None) -> str:
    if value is None or error is None:
        return "–"
    return f"{number(value, digits=2)} ± {number(error, digits=2)}"
