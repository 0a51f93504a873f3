"""Simplification against its peers: time, distance and counts, in one interleaved run.

    python benchmarks/simplification.py [SURFACE …] [--rounds 5] [--vertices 10000]

Without a surface, a generated atrium of about 127,000 vertices is used. Peers that are not
installed are left out; none of them is a dependency (pymeshlab is GPL). Each runs in this process
with arrays in and arrays out; the order changes from round to round. Times are CPU seconds, as
the machine may be shared. Writes docs/performance_simplification.md.
"""

import argparse
import importlib.util
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import igl
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkQuadricDecimation

from auricle.arrays import Faces, Points
from auricle.atomic import write_text
from auricle.simulation.atrium import AtriumShape, atrium
from auricle.surface.cleaning import clean
from auricle.surface.distance import geometric_distance, point_to_surface
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.simplification import simplification_sequence, simplify
from auricle.surface.soundness import triangle_quality
from auricle.surface.topology import euler_number, hole_count, unique_edges

REPORT = Path(__file__).resolve().parents[1] / "docs" / "performance_simplification.md"
Arrays = tuple[Points, Faces]
Peer = Callable[[Mesh, int], Arrays]
SWEEPS = ("fast-simplification", "pyfqmr")
"""Peers without a queue, which take any edge below a rising threshold: shown, not compared."""


def with_auricle(mesh: Mesh, n_vertices: int) -> Arrays:
    """Run ours."""
    simpler = simplify(mesh, n_vertices)
    return simpler.vertices, simpler.faces


def with_vtk(mesh: Mesh, n_vertices: int) -> Arrays:
    """Run VTK's quadric decimation."""
    points, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(mesh.vertices, deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(mesh.faces.ravel(), deep=True))
    data.SetPoints(points)
    data.SetPolys(cells)
    decimation = vtkQuadricDecimation()
    decimation.SetInputData(data)
    decimation.SetTargetReduction(1 - n_faces(mesh, n_vertices) / mesh.n_faces)
    decimation.Update()
    found = decimation.GetOutput()
    faces = vtk_to_numpy(found.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(found.GetPoints().GetData()), faces


def with_igl(mesh: Mesh, n_vertices: int) -> Arrays:
    """Run libigl's QSlim."""
    vertices, faces, *_ = igl.qslim(
        np.asfortranarray(mesh.vertices),
        np.asfortranarray(mesh.faces, dtype=np.int32),
        n_faces(mesh, n_vertices),
    )
    return vertices, faces


def with_pymeshlab(mesh: Mesh, n_vertices: int) -> Arrays:
    """Run MeshLab's quadric edge collapse."""
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces.astype(np.int32)))
    meshes.meshing_decimation_quadric_edge_collapse(
        targetfacenum=n_faces(mesh, n_vertices), preserveboundary=True
    )
    found = meshes.current_mesh()
    return found.vertex_matrix(), found.face_matrix()


def with_fast_simplification(mesh: Mesh, n_vertices: int) -> Arrays:
    """Run fast-simplification, which takes single precision."""
    import fast_simplification

    return fast_simplification.simplify(
        mesh.vertices.astype(np.float32),
        mesh.faces.astype(np.int32),
        target_count=n_faces(mesh, n_vertices),
    )


def with_pyfqmr(mesh: Mesh, n_vertices: int) -> Arrays:
    """Run pyfqmr."""
    import pyfqmr

    simplifier = pyfqmr.Simplify()
    simplifier.setMesh(mesh.vertices.copy(), mesh.faces.astype(np.int32))
    simplifier.simplify_mesh(
        target_count=n_faces(mesh, n_vertices), preserve_border=True, verbose=False
    )
    vertices, faces, _ = simplifier.getMesh()
    return vertices, faces


PEERS: dict[str, tuple[str, Peer]] = {
    "auricle": ("auricle", with_auricle),
    "vtkQuadricDecimation": ("vtkmodules", with_vtk),
    "libigl qslim": ("igl", with_igl),
    "pymeshlab": ("pymeshlab", with_pymeshlab),
    "fast-simplification": ("fast_simplification", with_fast_simplification),
    "pyfqmr": ("pyfqmr", with_pyfqmr),
}


def n_faces(mesh: Mesh, n_vertices: int) -> int:
    """Face target for peers, which take no other: never fewer vertices than asked for."""
    return 2 * (n_vertices - euler_number(mesh.faces))


def measured(mesh: Mesh, n_vertices: int, n_rounds: int) -> tuple[dict, dict]:
    """Seconds by peer and round, and the mesh each peer made."""
    peers = {
        name: peer for name, (module, peer) in PEERS.items() if importlib.util.find_spec(module)
    }
    seconds: dict[str, list[float]] = {name: [] for name in [*peers, "sequence", "level"]}
    made: dict[str, Mesh] = {}
    with_auricle(mesh, n_vertices)  # compiles, or loads what was compiled
    for turn in range(n_rounds):
        names = list(peers)
        for name in names[turn % len(names) :] + names[: turn % len(names)]:
            started = time.process_time()
            vertices, faces = peers[name](mesh, n_vertices)
            seconds[name].append(time.process_time() - started)
            made[name] = sound_part(vertices, faces)
        started = time.process_time()
        sequence = simplification_sequence(mesh)
        seconds["sequence"].append(time.process_time() - started)
        started = time.process_time()
        sequence.mesh_at(n_vertices)
        seconds["level"].append(time.process_time() - started)
    return seconds, made


def sound_part(vertices: Points, faces: Faces) -> Mesh:
    """Without the faces that name a vertex twice, which some peers leave."""
    faces = np.asarray(faces, dtype=np.int64)
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    used, numbered = np.unique(faces[whole], return_inverse=True)
    return Mesh(np.asarray(vertices, dtype=np.float64)[used], numbered.reshape(-1, 3))


def distance_back(mesh: Mesh, simpler: Mesh) -> float:
    """Mean distance to `mesh` over the faces of `simpler`, from 16 points of each, mm.

    Its vertices alone would not do: where the volume is kept they stand out and the faces cut in.
    """
    i, j = (index.ravel() for index in np.indices((4, 4)))
    upright = np.column_stack([i, j])[i + j < 4] + 1 / 3
    hanging = np.column_stack([i, j])[i + j < 3] + 2 / 3
    two = np.concatenate([upright, hanging]) / 4
    weights = np.column_stack([two, 1 - two.sum(axis=1)])
    points = np.einsum("pc,fci->fpi", weights, simpler.vertices[simpler.faces]).reshape(-1, 3)
    areas = np.repeat(simpler.face_areas, len(weights))
    return float(np.average(point_to_surface(points, mesh), weights=areas))


def table(name: str, mesh: Mesh, n_vertices: int, n_rounds: int) -> str:
    """Markdown for one surface."""
    seconds, made = measured(mesh, n_vertices, n_rounds)
    best = {name: statistics.median(times) for name, times in seconds.items()}
    lines = [
        f"## {name}: {mesh.n_vertices:,} to {n_vertices:,} vertices, "
        f"{hole_count(mesh.faces)} holes",
        "",
        "| tool | CPU s, median (least to most) | vertices | mean GD, µm | back, on faces "
        "| largest | worst quality | manifold edges |",
        "|---|---|---|---|---|---|---|---|",
    ]
    mean = {}
    for tool, found in made.items():
        there = geometric_distance(mesh, found)
        back = distance_back(mesh, found)
        mean[tool] = there.mean
        is_manifold = "yes" if unique_edges(found.faces)[1].max() <= 2 else "no"
        spread = f"{min(seconds[tool]):.2f} to {max(seconds[tool]):.2f}"
        lines.append(
            f"| {tool} | {best[tool]:.2f} ({spread}) | {found.n_vertices:,} "
            f"| {1000 * there.mean:.2f} | {1000 * back:.2f} | {1000 * there.hausdorff:.0f} "
            f"| {triangle_quality(found).min():.3f} | {is_manifold} |"
        )
    queued = [tool for tool in made if tool not in (*SWEEPS, "auricle")]
    fastest, nearest = min(queued, key=best.__getitem__), min(queued, key=mean.__getitem__)
    ratios = [other / own for other, own in zip(seconds[fastest], seconds["auricle"], strict=True)]
    lines += [
        "",
        f"Against the fastest with a queue ({fastest}): "
        f"{best[fastest] / best['auricle']:.2f} times as fast by the medians "
        f"({min(ratios):.2f} to {max(ratios):.2f} by round).",
        f"Against the nearest of them ({nearest}): mean GD "
        f"{mean['auricle'] / mean[nearest]:.3f} times its.",
        f"The whole sequence to the coarsest level takes {best['sequence']:.2f} s, "
        f"{best['sequence'] / best['auricle']:.2f} times one decimation; "
        f"one level of it {1000 * best['level']:.0f} ms.",
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surfaces", nargs="*", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--vertices", type=int, default=10_000)
    options = parser.parse_args()
    meshes = {
        path.stem: clean(read_surface(path), check_scale=False).mesh for path in options.surfaces
    }
    shape = AtriumShape.random(np.random.default_rng(3))
    meshes = {"generated atrium": atrium(shape, spacing=0.38), **meshes}
    text = (
        "# Simplification: measured\n\n"
        f"{options.rounds} interleaved rounds in one process, CPU seconds, arrays in to arrays "
        "out; by `python benchmarks/simplification.py`. Peers take a number of faces and are given "
        "one that leaves them no fewer vertices. GD is from the full surface's vertices; "
        "back is from points all over the simplified faces.\n\n"
    )
    for name, mesh in meshes.items():
        text += table(name, mesh, options.vertices, options.rounds) + "\n"
        sys.stdout.write(text)
        write_text(REPORT, text.rstrip() + "\n")


if __name__ == "__main__":
    main()
