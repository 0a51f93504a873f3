"""`docs/performance.md` and its figure, from the results that `eigensolver.py` collected."""

import json
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("svg")
mpl.rcParams["svg.hashsalt"] = "auricle"
from matplotlib import pyplot as plt  # noqa: E402

DOCS = Path(__file__).parents[1] / "docs"
NAMES = {
    "auricle": "auricle",
    "eigsh_superlu": "scipy eigsh (SuperLU)",
    "eigsh_superlu_symmetric": "scipy eigsh (SuperLU, symmetric mode)",
    "eigsh_cholespy": "scipy eigsh + cholespy",
    "lapy_splu": "LaPy (splu)",
    "lapy_cholespy": "LaPy (cholespy)",
    "pyfm": "pyFM",
    "robust_eigsh": "robust-laplacian + eigsh",
    "slepc_slicing": "SLEPc slicing + MUMPS (Debian)",
    "dense_lapack": "dense LAPACK",
    "floor": "floor: k solves, one factorisation, 2nk² flops",
}
ROUNDS = 5
HEADER = """# Speed of the eigensolver

Written by `benchmarks/eigensolver_report.py`; do not edit. How to repeat it is said in
`benchmarks/eigensolver.py`.

Medians (least to greatest) of CPU seconds of the solver's process; imports and compilation are not
in them, assembly, final orthonormalisation and certificate are. The residual is the largest
‖Ku − λMu‖ in the inverse-area norm over λ, of the solver's own operator; departure is that from
orthonormality under the areas. SLEPc was given tolerance 1e-10 and the end of the interval. Wall
times were taken on two cores shared with other work, whose load is in the last column: they say
little there, and the ratios are of CPU times. "Memory held ready": of this machine's system, which
otherwise asks its host for every page, at up to 2 seconds of CPU time a gigabyte.
"""


def warning(rows: list[dict]) -> list[str]:
    """What to say while there are too few runs to trust."""
    fewest = min(len(runs) for (_, name), runs in grouped(rows).items() if name != "floor")
    if fewest >= ROUNDS:
        return []
    return [
        f"**Provisional**: some rows hold {fewest} run{'s' * (fewest > 1)} and not {ROUNDS}, and "
        "the same work took up to half as much CPU time again when the machine was busy. A ratio "
        "between rows of different load is no evidence of a difference below 1.5.",
        "",
    ]


def table(rows: list[dict]) -> list[str]:
    """One problem at one number of threads, as lines of Markdown."""
    lines = [
        "| solver | k | runs | CPU, s | wall, s | peak, MB | residual | departure "
        "| CPU ÷ auricle's | load |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    groups = grouped(rows)
    for (k, solver), runs in sorted(groups.items(), key=lambda item: (item[0][0], cost(item[1]))):
        good = [run for run in runs if "failed" not in run]
        if not good:
            lines.append(f"| {NAMES[solver]} | {k} | {len(runs)} | {runs[0]['failed']} ||||||| |")
            continue
        own = groups.get((k, "auricle"))
        ratio = f"{cost(good) / cost(own):.2f}" if own else ""
        cells = [NAMES[solver], k, len(good), spread(good, "cpu_s"), spread(good, "wall_s")]
        cells += [number(good, "peak_mb", ".0f"), number(good, "residual", ".0e")]
        cells += [number(good, "orthogonality", ".0e"), ratio, number(good, "load", ".0f")]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return lines


def grouped(rows: list[dict]) -> dict[tuple[int, str], list[dict]]:
    """Runs by number of modes and solver."""
    groups = defaultdict(list)
    for row in rows:
        groups[row["k"], row["solver"]].append(row)
    return groups


def cost(runs: list[dict]) -> float:
    """Median CPU seconds; infinite where no run came through."""
    return float(np.median([run["cpu_s"] for run in runs if "failed" not in run] or [np.inf]))


def spread(runs: list[dict], name: str) -> str:
    """Median, with the range in brackets where there are several."""
    values = [run[name] for run in runs if name in run]
    if not values:
        return ""
    middle = f"{np.median(values):.2f}"
    return middle if len(values) < 2 else f"{middle} ({min(values):.2f} to {max(values):.2f})"


def number(runs: list[dict], name: str, form: str) -> str:
    """Median of a figure, where it was taken."""
    values = [run[name] for run in runs if name in run]
    return f"{np.median(values):{form}}" if values else ""


def exponent(rows: list[dict]) -> str:
    """Growth of auricle's time with k, by least squares between the logarithms."""
    groups = {k: cost(runs) for (k, solver), runs in grouped(rows).items() if solver == "auricle"}
    if len(groups) < 2:
        return ""
    slope = np.polyfit(np.log(list(groups)), np.log(list(groups.values())), 1)[0]
    return f"auricle's CPU time grows as k^{slope:.2f} here."


def draw(rows: list[dict], path: Path) -> None:
    """CPU time over the number of modes, a line a solver."""
    figure, axes = plt.subplots(figsize=(7, 4.5))
    for solver, name in NAMES.items():
        found = {
            k: cost(runs)
            for (k, each), runs in sorted(grouped(rows).items())
            if each == solver and np.isfinite(cost(runs))
        }
        if found:
            style = {"auricle": "o-", "floor": "k:"}.get(solver, "s--")
            axes.loglog(list(found), list(found.values()), style, label=name)
    axes.set(xlabel="harmonics", ylabel="CPU time, s")
    axes.legend(fontsize=7)
    figure.tight_layout()
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, metadata={"Date": None})


def main(folder: str) -> None:
    """Write the page and the figure."""
    lines = (Path(folder) / "results.jsonl").read_text().splitlines()
    rows = [json.loads(line) for line in lines]
    by_case = defaultdict(list)
    for row in rows:
        by_case[row["problem"], row.get("threads", 1), row.get("held", False)].append(row)
    processors = sorted({row["processor"] for row in rows})
    page = [
        HEADER,
        f"Processor: {'; '.join(processors)}.",
        "",
        *warning(rows),
        "![CPU time over number of harmonics](figures/performance_eigensolver.svg)",
        "",
    ]
    for (problem, threads, held), some in sorted(by_case.items()):
        plural, ready = "s" if threads > 1 else "", ", memory held ready" if held else ""
        page += [f"## {problem}, {threads} thread{plural}{ready}", "", *table(some), ""]
        page += [exponent(some), ""] if exponent(some) else []
    (DOCS / "performance.md").write_text("\n".join(page).rstrip() + "\n")
    first = max(by_case, key=lambda case: len(by_case[case]))
    draw(by_case[first], DOCS / "figures" / "performance_eigensolver.svg")


if __name__ == "__main__":
    main(sys.argv[1])
