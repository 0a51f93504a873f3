"""One small case, made once: a closed surface with two fields and four simulated maps."""

from collections.abc import Iterator

import numpy as np
import pytest

from auricle.arrays import PerVertex
from auricle.spectral.harmonics import Harmonics, manifold_harmonics
from auricle.study.config import AnalysisConfig
from auricle.study.result import CaseResult, GeometryError, Signal, Source
from auricle.study.signals import analyzed_signal
from auricle.surface.distance import geometric_distance, vertexwise_rms
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.soundness import soundness

CONFIG = AnalysisConfig(n_modes=80, focus_widths_mm=(8.0, 16.0), focus_counts=(1, 2))


def bumpy_sphere() -> Mesh:
    sphere = icosphere(radius=30.0, subdivisions=3)
    x, y, z = sphere.vertices.T / 30
    return Mesh(sphere.vertices * (1 + 0.15 * x * y + 0.1 * z**3)[:, None], sphere.faces)


class Analysis:
    """The surface and its harmonics, and what a signal on it is."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.basis: Harmonics = manifold_harmonics(mesh, CONFIG.n_modes)

    def signal(self, field: FieldMap, kind: str, title: str, **details: float) -> Signal:
        known = field.sampled.reshape(-1, *[1] * (field.values.ndim - 1))
        return analyzed_signal(
            self.basis,
            field=field,
            on_shell=np.where(known, field.values, 0.0),
            kind=kind,
            title=title,
            details=details,
        )

    def foci(self) -> Iterator[Signal]:
        centres = self.mesh.vertices[[0, 300]]
        distances = np.linalg.norm(self.mesh.vertices[None] - centres[:, None], axis=2)
        for count in CONFIG.focus_counts:
            for width in CONFIG.focus_widths_mm:
                values: PerVertex = np.exp(-(distances[:count] ** 2) / (2 * width**2)).sum(axis=0)
                name = f"foci_{count}_width_{width:g}_mm"
                foci = "1 focus" if count == 1 else f"{count} foci"
                yield self.signal(
                    FieldMap(self.mesh, values, name),
                    "simulated",
                    f"{foci}, σ = {width:g} mm",
                    n_foci=count,
                    width_mm=width,
                    expected_modes_90=30.0,
                )

    def rebuilt(self, count: int) -> np.ndarray:
        coefficients = self.basis.transform(self.mesh.vertices)
        return self.basis.inverse(coefficients[:count])

    def geometry_error(self, count: int) -> GeometryError:
        positions = self.rebuilt(count)
        found = geometric_distance(Mesh(positions, self.mesh.faces), self.mesh)
        return GeometryError(
            n_modes=count,
            rms_mm=vertexwise_rms(positions, self.mesh.vertices, self.basis.areas),
            gd_mean_mm=found.mean,
            gd_percentile_95_mm=found.percentile_95,
            hausdorff_mm=found.hausdorff,
        )


@pytest.fixture(scope="session")
def case() -> CaseResult:
    """Activation time in ms, sampled everywhere, and a voltage with NaN and a jump."""
    made = Analysis(bumpy_sphere())
    mesh = made.mesh
    x, y, z = mesh.vertices.T / 30
    time = FieldMap(mesh, 80 + 30 * x * y + 5 * z, "local_activation_time", "ms")
    jump = np.where(z > 0.8, np.nan, np.sign(x + 0.2 * np.sin(9 * y)) + 1.5)
    voltage = FieldMap(mesh, jump, "bipolar_voltage")
    return CaseResult(
        source=Source("chamber.vtp", 40_825, "2089174b48befa7b" * 4),
        config=CONFIG,
        original=soundness(mesh),
        repairs=(),
        remarks=("the surface has 642 vertices and was not simplified",),
        surface=mesh,
        analyzed=soundness(mesh),
        simplification_gd_mm=0.0,
        shell_area_mm2=made.basis.area,
        cap_areas_mm2=(),
        n_shell_vertices=mesh.n_vertices,
        laplacian=made.basis.laplacian,
        certificate=made.basis.certificate,
        geometry=made.signal(
            FieldMap(mesh, mesh.vertices, "geometry", "mm"), "geometry", "Geometry (x, y, z)"
        ),
        fields=tuple(made.signal(each, "field", each.name) for each in (time, voltage)),
        simulated=tuple(made.foci()),
        geometry_errors=tuple(made.geometry_error(count) for count in (5, 10, 20, 50, 80)),
        reconstructions={50: made.rebuilt(50)},
        versions={"auricle": "0.1.0", "numpy": "2.0.0"},
        seconds={"harmonics": 0.5},
    )
