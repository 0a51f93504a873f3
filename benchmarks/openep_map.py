"""The clinical map of OpenEP's data set 2, sampled as auricle recommends: the achieved error.

    python benchmarks/openep_map.py [OUT_DIR] [--vertices 5000] [--modes 800]

The map as exported is taken as the truth. Printed are the number of points that `auricle plan`
recommends for an error of 10 % (and of other targets), the error predicted, and the error achieved
when the map is sampled at the planned places and, as often, wherever a catheter happened to be.
With OUT_DIR the unplanned samples are also written as an OpenEP file there, for `auricle analyze`.
The data are found through AURICLE_DATA.
"""

import argparse
import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from auricle.arrays import Floats
from auricle.electroanatomy.formats.openep_writing import write_openep
from auricle.electroanatomy.points import MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.study.plan_result import PlanConfig
from auricle.study.planning import plan_surface
from auricle.study.preparation import PreparedSurface
from auricle.surface.reading import read_surface

MAP = "maps/openep-dataset2/openep_ds2_lat_bip.vtk"
TARGETS = (0.3, 0.2, 0.1)


def achieved(prepared: PreparedSurface, truth: Floats, places: Floats) -> tuple[float, float, int]:
    """Error measured and predicted with the map known at some vertices, and how many they are."""
    known = places[np.isfinite(truth[places])]
    process = GaussianProcess(prepared.chamber, Sites.at_vertices(known))
    found = process.fit(truth[known])
    areas = np.where(np.isfinite(truth), prepared.chamber.accessible_areas[: len(truth)], 0.0)
    shares, values = areas / areas.sum(), np.nan_to_num(truth)
    off = found.mean[: len(truth)] - values
    spread = shares @ (values - shares @ values) ** 2
    measured = float(np.sqrt(shares @ off**2 / spread))
    return measured, found.predicted_nrmse_with_detail(), len(known)


def export(path: Path, surface: Path, count: int, seed: int) -> None:
    """The map as an OpenEP file, its points at random vertices, 1 mm off the surface and 2 ms."""
    rng = np.random.default_rng(seed)
    soup = read_surface(surface)
    times = soup.point_fields["LAT"]
    voltage = soup.point_fields["BIP_0_2mV_8bit"]
    rows = rng.choice(np.flatnonzero(np.isfinite(times)), count, replace=False)
    points = MappingPoints(
        soup.vertices[rows] + rng.normal(0.0, 1 / np.sqrt(3), (count, 3)),
        soup.vertices[rows],
        local_activation_time=times[rows] + rng.normal(0.0, 2.0, count),
        bipolar_voltage=voltage[rows],
    )
    named = {"local_activation_time": times, "bipolar_voltage": voltage}
    surface_soup = type(soup)(soup.vertices, soup.faces, point_fields=named)
    write_openep(path, ElectroanatomicMap("map 1", surface_soup, points))


def say(line: str) -> None:
    """Print a line at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def main() -> None:
    """Print a row a target."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("out", nargs="?", type=Path)
    options.add_argument("--vertices", type=int, default=5000)
    options.add_argument("--modes", type=int, default=800)
    chosen = options.parse_args()
    surface = Path(os.environ["AURICLE_DATA"]) / MAP
    say("target,harmonics,points,predicted,planned_n,planned_error,unplanned_n,unplanned_error")
    for target in TARGETS:
        config = PlanConfig(
            field="LAT", target_nrmse=target, n_vertices=chosen.vertices, n_modes=chosen.modes
        )
        result = plan_surface(surface, config)
        advised = result.recommendation
        if result.plan is None or advised.n_samples is None:
            say(f"{target},,,{advised.predicted_nrmse:.3f}: {advised.unreachable}")
            continue
        prepared = result.prepared
        truth = prepared.field("LAT").values
        planned = result.plan.planned
        anywhere = random_sampling(
            prepared.chamber, advised.n_samples, rng=np.random.default_rng(1)
        )
        error, _, count = achieved(prepared, truth, planned[planned < len(truth)])
        other, _, others = achieved(prepared, truth, anywhere[anywhere < len(truth)])
        say(
            f"{target},{advised.n_modes},{advised.n_samples},{advised.predicted_nrmse:.3f},"
            f"{count},{error:.3f},{others},{other:.3f}"
        )
    if chosen.out is not None:
        for count in (150, 600):
            export(chosen.out / f"openep_{count}.mat", surface, count, seed=1)


if __name__ == "__main__":
    main()
