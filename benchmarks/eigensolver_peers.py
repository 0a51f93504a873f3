"""One eigensolver on one problem, in a process of its own: time, memory and accuracy as JSON.

Run by `eigensolver.py`, under whatever interpreter has the solver; needs numpy and scipy only.
Imports, compilation and a small warm-up problem are not in the time, assembly of the solver's own
matrices from the mesh is.
"""

import importlib
import json
import resource
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy import sparse
from scipy.linalg import eigh
from scipy.sparse.linalg import LinearOperator, eigsh

SHIFT = -0.01
N_WARM = 200
"""Modes of the warm-up problem: many enough for all code of a slicing solver to be loaded."""


def auricle(problem, k, threads):
    """Solve by this package: assembly, solution, final orthonormalisation and certificate."""
    harmonics = importlib.import_module("auricle.spectral.harmonics")
    mesh = importlib.import_module("auricle.surface.mesh").Mesh(problem.vertices, problem.faces)
    basis = harmonics.manifold_harmonics(mesh, k, threads=threads)
    return basis.eigenvalues[:k], basis.modes[:, :k]


def eigsh_superlu(problem, k, _threads):
    """ARPACK, shift-inverted by SuperLU: scipy as it comes."""
    return eigsh(problem.stiffness, k, problem.mass, sigma=SHIFT)


def eigsh_superlu_symmetric(problem, k, _threads):
    """ARPACK, shift-inverted by SuperLU in its symmetric mode, ordered by minimum degree."""
    from scipy.sparse.linalg import splu

    shifted = sparse.csc_matrix(problem.stiffness - SHIFT * problem.mass)
    options = {"SymmetricMode": True}
    factors = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    inverse = LinearOperator(shifted.shape, factors.solve, dtype=np.float64)
    return eigsh(problem.stiffness, k, problem.mass, sigma=SHIFT, OPinv=inverse)


def eigsh_cholespy(problem, k, _threads):
    """ARPACK, shift-inverted by CHOLMOD through cholespy."""
    cholespy = importlib.import_module("cholespy")
    shifted = sparse.coo_matrix(problem.stiffness - SHIFT * problem.mass)
    n = shifted.shape[0]
    rows, columns = shifted.row.astype(np.int32), shifted.col.astype(np.int32)
    kind = cholespy.MatrixType.COO
    solver = cholespy.CholeskySolverD(n, rows, columns, shifted.data, kind)

    def solve(right):
        solution = np.empty(n)
        solver.solve(np.ascontiguousarray(right.ravel()), solution)
        return solution

    inverse = LinearOperator(shifted.shape, solve, dtype=np.float64)
    return eigsh(problem.stiffness, k, problem.mass, sigma=SHIFT, OPinv=inverse)


def lapy_splu(problem, k, _threads):
    """LaPy with SuperLU and lumped areas."""
    return _lapy(problem, k, cholmod=False)


def lapy_cholespy(problem, k, _threads):
    """LaPy with cholespy and lumped areas."""
    return _lapy(problem, k, cholmod=True)


def _lapy(problem, k, *, cholmod):
    lapy = importlib.import_module("lapy")
    surface = lapy.TriaMesh(problem.vertices, problem.faces)
    solver = lapy.Solver(surface, lump=True, use_cholmod=cholmod)
    problem.stiffness, problem.mass = solver.stiffness, solver.mass
    return solver.eigs(k=k)


def pyfm(problem, k, _threads):
    """PyFM (pyfmaps) as it comes."""
    trimesh = importlib.import_module("pyFM.mesh.trimesh").TriMesh(problem.vertices, problem.faces)
    trimesh.process(k=k)
    problem.stiffness, problem.mass = trimesh.W, trimesh.A
    return trimesh.eigenvalues, trimesh.eigenvectors


def robust_eigsh(problem, k, _threads):
    """robust-laplacian's intrinsic Delaunay operator, another one, and ARPACK."""
    robust = importlib.import_module("robust_laplacian")
    stiffness, mass = robust.mesh_laplacian(problem.vertices, problem.faces)
    problem.stiffness, problem.mass = stiffness, mass
    return eigsh(stiffness, k, mass, sigma=SHIFT)


def slepc_slicing(problem, k, _threads):
    """SLEPc's Krylov-Schur with spectrum slicing and MUMPS, told where the k-th eigenvalue ends."""
    petsc = importlib.import_module("petsc4py.PETSc")
    slepc = importlib.import_module("slepc4py.SLEPc")
    options = petsc.Options()
    options["mat_mumps_icntl_13"], options["mat_mumps_icntl_24"] = 1, 1
    matrices = []
    for each in (problem.stiffness, problem.mass):
        csr = sparse.csr_matrix(each)
        rows = (csr.indptr.astype(np.int32), csr.indices.astype(np.int32), csr.data)
        matrices.append(petsc.Mat().createAIJ(size=csr.shape, csr=rows))
        matrices[-1].setOption(petsc.Mat.Option.SYMMETRIC, True)
    solver = slepc.EPS().create()
    solver.setOperators(*matrices)
    solver.setProblemType(slepc.EPS.ProblemType.GHEP)
    solver.setType("krylovschur")
    solver.setWhichEigenpairs(slepc.EPS.Which.ALL)
    ends = problem.reference[k - 1 : k + 1]
    solver.setInterval(-0.5 * problem.reference[-1] / len(problem.reference), ends.mean())
    transform = solver.getST()
    transform.setType("sinvert")
    transform.getKSP().setType("preonly")
    transform.getKSP().getPC().setType("cholesky")
    transform.getKSP().getPC().setFactorSolverType("mumps")
    solver.setTolerances(1e-10, 100)
    solver.setFromOptions()
    solver.solve()
    values, vectors = [], []
    vector = matrices[0].createVecRight()
    for i in range(solver.getConverged()):
        values.append(solver.getEigenpair(i, vector).real)
        vectors.append(vector.getArray().copy())
    return np.array(values), np.array(vectors).T


def dense_lapack(problem, k, _threads):
    """LAPACK's divide and conquer on the full matrix."""
    roots = 1 / np.sqrt(problem.areas)
    full = roots[:, None] * problem.stiffness.toarray() * roots
    values, vectors = eigh(full, driver="evd", overwrite_a=True)
    return values[:k], roots[:, None] * vectors[:, :k]


SOLVERS = {
    function.__name__: function
    for function in (
        auricle,
        eigsh_superlu,
        eigsh_superlu_symmetric,
        eigsh_cholespy,
        lapy_splu,
        lapy_cholespy,
        pyfm,
        robust_eigsh,
        slepc_slicing,
        dense_lapack,
    )
}


def loaded(path):
    """A problem as `eigensolver.py` wrote it."""
    with np.load(path) as stored:
        fields = dict(stored)
    parts = (fields.pop("data"), fields.pop("indices"), fields.pop("indptr"))
    n = len(fields["areas"])
    return SimpleNamespace(
        **fields,
        stiffness=sparse.csc_matrix(parts, shape=(n, n)),
        mass=sparse.csc_matrix(sparse.diags(fields["areas"])),
    )


def accuracy(problem, values, vectors):
    """Largest relative residual in the inverse-area norm, and departure from orthonormality."""
    areas = problem.mass.diagonal()
    worst = overlap = 0.0
    for first in range(0, len(values), 100):
        some = slice(first, first + 100)
        images = problem.stiffness @ vectors[:, some]
        images -= areas[:, None] * vectors[:, some] * values[some]
        sizes = np.sqrt((images**2 / areas[:, None]).sum(axis=0))
        worst = max(worst, float((sizes / np.maximum(values[some], values[1])).max()))
        products = vectors[:, some].T @ (areas[:, None] * vectors)
        products[np.arange(len(products)), first + np.arange(len(products))] -= 1
        overlap = max(overlap, float(np.abs(products).max()))
    return worst, overlap


def main(name, path, k, threads, out):
    """Run a solver; the eigenvalues go to `out`, the figures to standard output."""
    solve, k, threads = SOLVERS[name], int(k), int(threads)
    warm = Path(path).with_name("warm.npz")
    if warm != Path(path) and warm.exists():
        solve(loaded(warm), N_WARM, threads)
    problem = loaded(path)
    cpu, wall = time.process_time(), time.perf_counter()
    values, vectors = solve(problem, k, threads)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    order = np.argsort(values)
    residual, overlap = accuracy(problem, np.asarray(values)[order], np.asarray(vectors)[:, order])
    np.save(out, np.asarray(values)[order])
    figures = {
        "solver": name,
        "n": len(problem.areas),
        "k": k,
        "threads": threads,
        "found": len(values),
        "cpu_s": cpu,
        "wall_s": wall,
        "peak_mb": peak,
        "residual": residual,
        "orthogonality": overlap,
    }
    sys.stdout.write(json.dumps(figures) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
