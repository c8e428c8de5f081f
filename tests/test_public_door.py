"""The public door: what is exported exists, is documented as the house asks, and nothing else is public."""

import inspect
import subprocess
import sys

import pytest

import kinetostat

FUNCTIONS = [name for name in kinetostat.__all__ if inspect.isfunction(getattr(kinetostat, name))]


def test_every_exported_name_exists():
    assert [name for name in kinetostat.__all__ if not hasattr(kinetostat, name)] == []
    assert kinetostat.__all__ == sorted(kinetostat.__all__)
    assert set(dir(kinetostat)) == {*kinetostat.__all__, "__version__"}


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'jacobain'"):
        _ = kinetostat.jacobain


@pytest.mark.parametrize("name", kinetostat.__all__)
def test_every_exported_name_has_a_docstring(name):
    assert len(inspect.getdoc(getattr(kinetostat, name)) or "") > 20


@pytest.mark.parametrize("name", FUNCTIONS)
def test_public_functions_say_what_they_raise(name):
    function = getattr(kinetostat, name)
    doc = inspect.getdoc(function)
    if name not in ("random_configurations", "find_settings"):  # they raise nothing
        assert "Raises:" in doc
    for parameter in inspect.signature(function).parameters:
        assert parameter in doc, f"{name} does not mention {parameter}"


@pytest.mark.parametrize("name", ["jacobian", "adjoint", "fk", "manipulability"])
def test_mathematical_functions_say_equation_shapes_and_source(name):
    doc = inspect.getdoc(getattr(kinetostat, name))
    assert "(..., " in doc
    assert " = " in doc


def test_importing_the_package_imports_neither_pinocchio_nor_typer_nor_yourdfpy():
    program = (
        "import sys, kinetostat; kinetostat.load; kinetostat.jacobian; kinetostat.summary;"
        "print([m for m in ('pinocchio', 'typer', 'rich', 'yourdfpy', 'trimesh', 'pydantic') if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"


def test_a_query_imports_no_more_than_it_needs():
    program = (
        "import sys; from kinetostat_cli.main import run;"
        "code = run(['jacobian', 'textbook:planar_2r']);"
        "unneeded = ('rich', 'yourdfpy', 'trimesh', 'pydantic', 'scipy', 'xacro', 'numba');"
        "print(code, [m for m in unneeded if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "0 []"
