"""What a cohort cost, stage by stage, and what many more cases would."""

from collections.abc import Sequence

from auricle.report.tables import Table
from auricle.report.wording import number, percent
from auricle.study.cohort.costs import Timed, cluster_need, stage_costs

MANY_CASES = 10_000
CORES = (100, 500, 1_000)


def cost_tables(documents: Sequence[Timed]) -> tuple[Table, ...]:
    """Wall time of one worker by stage, and the need of ten thousand cases; none without times."""
    timed = [document for document in documents if document.timings]
    if not timed:
        return ()
    stages = tuple(
        (
            each.stage,
            number(each.median_s),
            number(each.total_s),
            percent(each.share),
            "–"
            if each.exponent is None or each.exponent_error is None
            else f"{number(each.exponent, digits=2)} ± {number(each.exponent_error, digits=2)}",
        )
        for each in stage_costs(timed)
    )
    needs = []
    for n_cores in CORES:
        need = cluster_need(timed, n_cases=MANY_CASES, n_cores=n_cores)
        needs.append((f"{n_cores:,}", number(need.core_hours), number(need.wall_hours)))
    return (
        Table(
            "Cost of a case by stage (wall seconds of one worker on one core)",
            ("Stage", "Median, s", "All cases, s", "Share", "Exponent b of seconds ∝ verticesᵇ"),
            stages,
        ),
        Table(
            f"What {MANY_CASES:,} cases like these need",
            ("Cores", "Core-hours", "Hours"),
            tuple(needs),
        ),
    )
