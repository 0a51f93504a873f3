"""The package's front door."""

import subprocess
import sys

import pytest

import auricle


@pytest.mark.parametrize("name", auricle.__all__)
def test_every_public_name_is_there_and_says_what_it_is(name) -> None:
    found = getattr(auricle, name)
    assert name == "__version__" or found.__doc__


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'atrial'"):
        auricle.atrial  # noqa: B018


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import auricle, sys; print(sorted({'numpy', 'scipy', 'vtkmodules'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
