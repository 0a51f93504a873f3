"""The eigensolver against its peers on real left atria: interleaved rounds, one process a run.

    python benchmarks/eigensolver.py prepare PROBLEMS MESH VERTICES MOST_MODES
    python benchmarks/eigensolver.py prepare PROBLEMS warm 2562 250
    python benchmarks/eigensolver.py measure PROBLEMS NAME --k 100 --rounds 5 --solvers …
    python benchmarks/eigensolver.py floor PROBLEMS NAME --k 100 500
    python benchmarks/eigensolver_report.py PROBLEMS     # writes docs/performance.md and its figure

PROBLEMS is a folder; results are appended to its results.jsonl. A solver's interpreter is this one
unless `--python SOLVER='COMMAND …'` names another (its own environment, or Debian’s for SLEPc).

A virtual machine's host may take free memory back; a process then pays seconds a gigabyte to have
it again, whatever it computes. `sysctl vm.nr_hugepages=…` holds memory ready, and with
`GLIBC_TUNABLES=glibc.malloc.hugetlb=2` in the environment every solver is given of that. Results
are marked as such; their peak is not that of the process and left out.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

PEERS = Path(__file__).with_name("eigensolver_peers.py")


def prepare(folder: Path, source: str, n_vertices: int, most_modes: int) -> None:
    """Write one problem: mesh, matrices, and the eigenvalues that place slicing's last gap.

    `source` is a mesh file, ``sphere``, or ``warm`` for the problem that warms every solver up.
    """
    from auricle.spectral.harmonics import manifold_harmonics
    from auricle.spectral.laplacian import laplacian

    mesh = surface(source, n_vertices)
    operator = laplacian(mesh)
    stiffness = operator.stiffness.tocsc()
    folder.mkdir(parents=True, exist_ok=True)
    label = Path(source).stem.split("_")[0]
    size = "" if source == "warm" else f"-{round(mesh.n_vertices / 1000)}k"
    np.savez(
        folder / f"{label}{size}.npz",
        vertices=mesh.vertices,
        faces=mesh.faces,
        areas=operator.areas,
        data=stiffness.data,
        indices=stiffness.indices,
        indptr=stiffness.indptr,
        reference=manifold_harmonics(mesh, most_modes + 1).eigenvalues,
    )


def surface(source: str, n_vertices: int):
    """A closed mesh of about that many vertices."""
    from auricle.surface import capping, cleaning, reading, shapes, simplification

    if source in ("sphere", "warm"):
        subdivisions = round(np.log(n_vertices / 10) / np.log(4))
        sphere = shapes.icosphere(radius=30.0, subdivisions=subdivisions)
        return sphere if source == "sphere" else with_needles(sphere)
    whole = cleaning.clean(reading.read_surface(Path(source))).mesh
    if n_vertices < whole.n_vertices:
        whole = simplification.simplify(whole, n_vertices)
    return capping.cap_holes(whole).mesh


def with_needles(whole):
    """The same with triangles as poor as real atria have: what these need is loaded beforehand."""
    from auricle.surface.mesh import Mesh

    vertices, (one, other, _) = np.array(whole.vertices), whole.faces[0]
    vertices[one] += 0.99 * (vertices[other] - vertices[one])
    return Mesh(vertices, whole.faces)


def measure(folder: Path, name: str, choices: argparse.Namespace) -> None:
    """Run every solver once a round, in turn, in as many rounds as were asked for."""
    pythons = dict(each.split("=", 1) for each in choices.python)
    for number in range(choices.rounds):
        for k in choices.k:
            for solver in choices.solvers:
                command = shlex.split(pythons.get(solver, sys.executable))
                result = run(command, solver, folder, (name, k, choices.threads, choices.limit))
                note(
                    folder, {"problem": name, "round": number, "load": os.getloadavg()[0], **result}
                )


def run(command: list[str], solver: str, folder: Path, case: tuple[str, int, int, float]) -> dict:
    """One solver in a process; what went wrong where it gave nothing."""
    name, k, threads, limit = case
    out = folder / "eigenvalues" / f"{name}-{k}-{solver}.npy"
    out.parent.mkdir(exist_ok=True)
    count = "1" if solver == "auricle" else str(threads)
    variables = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    environment = os.environ | dict.fromkeys(variables, count)
    arguments = [PEERS, solver, folder / f"{name}.npz", k, threads, out]
    failed = {"solver": solver, "k": k, "threads": threads}
    try:
        done = subprocess.run(
            [*command, *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=limit,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return failed | {"failed": f"nothing after {limit:.0f} s"}
    if done.returncode:
        return failed | {"failed": (done.stderr.strip() or "ended").splitlines()[-1][:200]}
    return json.loads(done.stdout.splitlines()[-1])


def floor(folder: Path, name: str, counts: list[int]) -> None:
    """What k solves, one factorisation and 2nk² flops at the rate of a matrix product take, s."""
    from threadpoolctl import threadpool_limits

    from auricle.spectral.factorization import analyze, factorize

    with np.load(folder / f"{name}.npz") as stored:
        problem = dict(stored)
    from scipy import sparse

    n = len(problem["areas"])
    parts = (problem["data"], problem["indices"], problem["indptr"])
    stiffness = sparse.csc_array(parts, shape=(n, n))
    roots = sparse.diags_array(1 / np.sqrt(problem["areas"]))
    matrix = sparse.csc_array(roots @ stiffness @ roots)
    symbolic = analyze(matrix)
    right = np.random.default_rng(0).standard_normal((n, 64))
    square = np.random.default_rng(1).standard_normal((1200, 1200))
    with threadpool_limits(1, user_api="blas"):
        middle = float(problem["reference"][len(problem["reference"]) // 2])
        factors = factorize(matrix, middle, symbolic=symbolic)
        factoring = quickest(lambda: factorize(matrix, middle, symbolic=symbolic))
        solving = quickest(lambda: factors.solve(right, refine=False)) / 64
        rate = 2 * 1200**3 / quickest(lambda: square @ square)
    for k in counts:
        seconds = factoring + k * solving + 2 * n * k**2 / rate
        figures = {"factor_s": factoring, "solve_s": solving, "flops_per_s": rate}
        note(
            folder, {"problem": name, "solver": "floor", "n": n, "k": k, "cpu_s": seconds} | figures
        )


def quickest(work, times: int = 7) -> float:
    """Least CPU time of a few runs, s."""
    taken = []
    for _ in range(times):
        begin = time.process_time()
        work()
        taken.append(time.process_time() - begin)
    return min(taken)


def processor() -> str:
    """Name, family and model, where the system tells them: ratios depend on its registers."""
    table = Path("/proc/cpuinfo")
    lines = table.read_text().splitlines() if table.exists() else []
    told = dict(line.split(":", 1) for line in lines if ":" in line)
    told = {name.strip(): figure.strip() for name, figure in told.items()}
    names = ("model name", "cpu family", "model")
    return ", ".join(f"{name} {told[name]}" for name in names if name in told)


def note(folder: Path, figures: dict) -> None:
    """Append a result."""
    if "malloc.hugetlb=2" in os.environ.get("GLIBC_TUNABLES", ""):
        figures = {name: figure for name, figure in figures.items() if name != "peak_mb"}
        figures["held"] = True
    figures = {"processor": processor()} | figures
    with (folder / "results.jsonl").open("a") as file:
        file.write(json.dumps(figures) + "\n")


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("task", choices=["prepare", "measure", "floor"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("name", help="a problem, or to prepare one a mesh file or `sphere`")
    parser.add_argument("sizes", nargs="*", type=int, help="vertices and most modes, to prepare")
    parser.add_argument("--k", nargs="+", type=int, default=[100])
    parser.add_argument("--solvers", nargs="+", default=["auricle"])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--limit", type=float, default=1200.0, help="seconds for one run")
    parser.add_argument("--python", action="append", default=[], help="SOLVER=COMMAND")
    choices = parser.parse_args()
    if choices.task == "prepare":
        prepare(choices.folder, choices.name, *choices.sizes)
    elif choices.task == "measure":
        measure(choices.folder, choices.name, choices)
    else:
        floor(choices.folder, choices.name, choices.k)


if __name__ == "__main__":
    main()
