"""Where a case of the study comes from."""

from pathlib import Path

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.paper.source import original_surface, phantom_options
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface


def test_the_text_of_a_generated_ct_holds_its_options():
    options = phantom_options("phantom:seed=3,preset=medium,veins=fifth,lead=true,noise=30")
    assert (options.seed, options.preset, options.veins) == (3, "medium", "fifth")
    assert options.lead is True
    assert options.noise == 30.0


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("phantom:sed=3", "no option 'sed'"),
        ("phantom:seed=three", "seed=three"),
        ("phantom:lead=perhaps", "lead=perhaps"),
        ("phantom:preset=huge", "no preset"),
        ("phantom:case=strange", "no hard case"),
    ],
)
def test_a_generated_ct_that_is_misspelt_is_refused(text, match):
    with pytest.raises(InputError, match=match):
        phantom_options(text)


def test_a_surface_file_keeps_its_name_without_its_folder(tmp_path):
    path = tmp_path / "somebody" / "atrium.vtp"
    write_surface(path, icosphere(radius=30.0, subdivisions=2))
    found = original_surface(path)
    assert (found.name, found.kind) == ("atrium.vtp", "surface")
    assert found.source.n_bytes == path.stat().st_size
    assert "somebody" not in repr(found.source)


def test_a_generated_surface_is_the_patient_of_its_seed():
    one, same, other = (
        original_surface(Path(f"atrium:seed={seed},spacing=3")) for seed in (1, 1, 2)
    )
    assert one.source == same.source
    assert np.array_equal(one.cleaned.mesh.vertices, same.cleaned.mesh.vertices)
    assert one.source.sha256 != other.source.sha256


@pytest.mark.parametrize("text", ["atrium:seed=-1", "atrium:spacing=0.01"])
def test_a_generated_surface_out_of_range_is_refused(text):
    with pytest.raises(InputError):
        original_surface(Path(text))


def test_a_generated_ct_comes_with_its_segmentation_and_its_truth():
    found = original_surface(Path("phantom:seed=1,preset=tiny"), accept_check=True)
    assert found.kind == "phantom"
    assert found.truth is not None
    assert found.scan is not None
    assert found.scan["phantom"]["seed"] == 1
    assert found.scan["volume_ml"] == pytest.approx(found.cleaned.soundness.volume_mm3 / 1000)


def test_a_doubtful_segmentation_enters_only_if_accepted():
    doubtful = Path("phantom:seed=1,preset=tiny,case=truncated")
    with pytest.raises(InputError, match=r"verdict check.*accept_check"):
        original_surface(doubtful)
    assert original_surface(doubtful, accept_check=True).scan["verdict"] == "check"
