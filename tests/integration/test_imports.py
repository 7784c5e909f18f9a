"""What an import loads, and the signatures of the public namespace."""

import inspect
from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from types import FunctionType, MethodType

import pytest
from commands import python
from places import DATA

import granular_response as gr

HEAVY = {"numpy", "scipy", "numba", "xarray", "matplotlib", "pydantic", "yaml", "netCDF4"}


def test_importing_loads_nothing_heavy():
    """In processor time, least of three: the aim is 0.15 s."""
    script = (
        "import sys, time; start = time.process_time(); import granular_response as gr; dir(gr);"
        f"spent = time.process_time() - start; print(spent, *sorted({HEAVY} & set(sys.modules)))"
    )
    runs = [python("-c", script).split() for _ in range(3)]
    assert [run[1:] for run in runs] == [[]] * 3
    assert min(float(run[0]) for run in runs) < 0.15


@pytest.mark.parametrize("module", ["granular_response.cli.main", "granular_response_paper.cli"])
def test_a_command_line_loads_nothing_heavy(module):
    script = f"import sys, {module}; print(sorted({HEAVY - {'pydantic'}} & set(sys.modules)))"
    assert python("-c", script) == "[]\n"


def parameters(function) -> str:
    signature = inspect.signature(function)
    plain = [one.replace(annotation=inspect.Parameter.empty) for one in signature.parameters.values()]
    text = str(signature.replace(parameters=plain, return_annotation=inspect.Signature.empty))
    for default in (one.default for one in plain):
        if inspect.isroutine(default) or inspect.isclass(default):
            text = text.replace(repr(default), default.__name__)
        elif isinstance(default, Mapping):
            text = text.replace(repr(default), "{...}")
    return text


def test_public_signatures_stay():
    """One that changes breaks what others have written: it goes into docs/changelog.md and into the file."""
    found = [f"{name}{parameters(getattr(gr, name))}" for name in gr.__all__ if inspect.isfunction(getattr(gr, name))]
    for owner in ("Events", "LaboratoryUnits", "Result", "Scene", "plot", "studies", "studies.LoadPath"):
        of = attrgetter(owner)(gr)
        for name in of.__all__ if inspect.ismodule(of) else [name for name in vars(of) if not name.startswith("_")]:
            value = getattr(of, name)
            if isinstance(value, FunctionType | MethodType) or owner == "Result":
                found.append(f"{owner}.{name}{parameters(value) if callable(value) else ''}")
    assert sorted(found) == (DATA / "public_signatures.txt").read_text().splitlines()


def test_every_public_name_is_there_and_documented():
    for name in set(gr.__all__) - {"__version__"}:
        assert getattr(gr, name).__doc__ and name in dir(gr)
    with pytest.raises(AttributeError, match="no attribute 'solv'"):
        gr.solv  # noqa: B018


def test_a_law_from_elsewhere_does_not_trouble_other_processes(tmp_path):
    """Machine code for it is not kept: a process without its module could not read the list of what is."""
    small = {"packing": {"kind": "slab", "layers": 2, "disks_per_row": 5}, "contact": {"friction": 0.0}}
    plain = (
        "from granular_response.scene import Scene; from granular_response.solvers.problem import Problem;"
        f"Problem.from_scene(Scene.from_dict({small})).bare_state()"
    )
    tests = str(Path(__file__).parents[1])
    with_it = f"import sys; sys.path.append({tests!r}); import demonstration; demonstration.problem(0.0).bare_state()"
    for script in (with_it, plain):
        python("-c", script, NUMBA_CACHE_DIR=str(tmp_path))
    assert list(tmp_path.rglob("*.nbi"))
