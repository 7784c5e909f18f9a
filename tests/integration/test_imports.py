"""What an import loads, every form of an import statement, and the signatures of the public namespace."""

import inspect
import os
import subprocess
import sys
from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from types import FunctionType, MethodType

import pytest

import granular_response as gr

HEAVY = {"numpy", "scipy", "numba", "xarray", "matplotlib", "pydantic", "yaml", "netCDF4"}


def fresh(script: str, **environment: str) -> str:
    """What a script prints in a new process."""
    run = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env={**os.environ, **environment}
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def test_importing_loads_nothing_heavy():
    """In processor time, least of three: the aim is 0.15 s."""
    script = (
        "import sys, time; start = time.process_time(); import granular_response as gr; dir(gr);"
        f"spent = time.process_time() - start; print(spent, *sorted({HEAVY} & set(sys.modules)))"
    )
    runs = [fresh(script).split() for _ in range(3)]
    assert [run[1:] for run in runs] == [[]] * 3
    assert min(float(run[0]) for run in runs) < 0.15


@pytest.mark.parametrize("module", ["granular_response.cli.main", "granular_response_paper.cli"])
def test_a_command_line_loads_nothing_heavy(module):
    assert fresh(f"import sys, {module}; print(sorted({HEAVY - {'pydantic'}} & set(sys.modules)))") == "[]"


#: Statements, and what they bind ``found`` to.
FORMS = {
    "import granular_response.solvers.dynamics as found": "module granular_response.solvers.dynamics",
    "from granular_response.solvers import dynamics as found": "module granular_response.solvers.dynamics",
    "from granular_response.linalg import band as found": "module granular_response.linalg.band",
    "import granular_response.api.result as found": "module granular_response.api.result",
    "from granular_response import solve as found": "function granular_response.api.result.solve",
    "import granular_response as gr; found = gr.solve": "function granular_response.api.result.solve",
    "from granular_response import *; found = solve": "function granular_response.api.result.solve",
}


def test_every_form_of_import_finds_what_it_names():
    """The package as nothing had loaded it before, and with the function ``solve`` already there."""
    script = f"""
import sys
for before in ("pass", "import granular_response; granular_response.solve"):
    for form in {list(FORMS)}:
        for name in [name for name in sys.modules if name.startswith("granular_response")]:
            del sys.modules[name]
        names = {{}}
        exec(f"{{before}}\\n{{form}}", names)
        found = names["found"]
        kind = type(found).__name__
        print(kind, found.__name__ if kind == "module" else f"{{found.__module__}}.{{found.__qualname__}}")
"""
    assert fresh(script).splitlines() == list(FORMS.values()) * 2


#: Parameters of what is public, without their types.
SIGNATURES = {
    "Events.counts": "(self)",
    "Events.of": "(self, *kinds)",
    "Events.to_dataframe": "(self)",
    "LaboratoryUnits.define": "(self, registry)",
    "LaboratoryUnits.reduced_scene": "(self, scene)",
    "LaboratoryUnits.to_laboratory": "(self, quantity, value)",
    "LaboratoryUnits.to_reduced": "(self, quantity, value)",
    "LaboratoryUnits.unit": "(self, quantity)",
    "Result.contacts_table": "(self, state=-1)",
    "Result.continued": "(self, load_factors, *, progress=True)",
    "Result.export": "(self, path, *, state=None)",
    "Result.influence": "(self, *, state=-1, sliding='refuse')",
    "Result.response_at": "(self, x=0.0, *, smooth=None)",
    "Result.save": "(self, path)",
    "Result.stress": "(self, x=None, z=None, *, state=-1, added=None, width=2.0)",
    "Result.to_dataset": "(self)",
    "Scene.from_arrays": (
        "(x, z, radius, *, mass=None, width=None, origin=(0.0, 0.0), sides='walls', overlaps='kept', vx=None,"
        " vz=None, spin=None, scene=None)"
    ),
    "Scene.from_dict": "(data, *, folder=None)",
    "Scene.from_text": "(text, *, folder=None)",
    "Scene.from_yaml": "(path)",
    "Scene.merged": "(self, changes)",
    "Scene.to_dict": "(self)",
    "Scene.to_yaml": "(self)",
    "Scene.updated": "(self, changes)",
    "coordination_number": "(result)",
    "elastic_moduli": "(result, *, state=0, following='free', margin=0.25, prestress=True)",
    "fabric_tensor": "(result)",
    "find_event": "(scene, happened, low, high, *, where=None, key='load', tolerance=None, progress=True)",
    "force_distribution": "(result, *, state=-1, bins=24, to=6.0)",
    "map_tasks": (
        "(function, items, *, workers=None, scheduler=None, progress=None, checkpoint=None, parts=(), what='tasks')"
    ),
    "mobilization": "(result)",
    "modes": "(result, count=6, *, state=-1, sliding='refuse')",
    "motion": "(scene, times, *, start=None, progress=True)",
    "open_result": "(path, *, folder=None)",
    "plot.animate": "(results, *, output=None, half_width=None, fps=6.0, dpi=120.0, width=7.0, figure=None)",
    "plot.contacts": "(result, *, ax=None, state=-1, half_width=None, **lines)",
    "plot.floor": "(result, *, ax=None, state=-1, added=None, **line)",
    "plot.forces": "(result, *, ax=None, state=-1, added=None, scale='sqrt', vmax=None, half_width=None, **lines)",
    "plot.motion": "(moved, *, output=None, fps=12.0, dpi=120.0, width=7.0, figure=None)",
    "plot.packing": "(result, *, ax=None, state=-1, values=None, label='', cmap='viridis', **patches)",
    "plot.page": "(result, what=None, *, state=-1, scale='sqrt', figure=None)",
    "plot.photoelastic": (
        "(result, *, ax=None, state=-1, added=None, fringe=None, half_width=None, pixels=1200, **image)"
    ),
    "plot.response": "(result, *, ax=None, **line)",
    "plot.stress": (
        "(result, *, ax=None, state=-1, added=None, component='zz', width=2.0, vmax=None, half_width=None,"
        " cmap='RdBu', **mesh)"
    ),
    "preparations": (
        "(scene, ways={...}, measure=floor_response, *, load_factors=None, workers=None, scheduler=None,"
        " checkpoint=None, progress=True)"
    ),
    "register_law": "(name, law, parameters=NoParameters)",
    "solve": "(scene, *, load_factors=None, method=None, progress=True)",
    "stiffness_matrix": "(result, *, state=-1, sliding='refuse')",
    "studies.LoadPath.at": "(self, force)",
    "studies.LoadPath.first": "(self, forces, happening, width=1e-06, *, tolerance=None, beside=0.0)",
    "studies.LoadPath.from_solution": "(solution)",
    "studies.LoadPath.of": "(scene, rest=None, packing=None)",
    "studies.LoadPath.solution": "(self, force)",
    "studies.LoadPath.through": "(self, forces)",
    "studies.bisect_event": "(predicate, low, high, tolerance, *, at_low=None, at_high=None)",
    "studies.by_motion": "(state)",
    "studies.first_change": "(values, happened)",
    "studies.first_opening": "(measures, anywhere=False)",
    "studies.happenings": "(measures, smallest, asymmetry)",
    "studies.linear_end": "(force, response, tolerance)",
    "studies.lost": "(states)",
    "studies.reaches_floor": "(measures)",
    "studies.two_peaks": "(measures)",
    "sweep": (
        "(scene, axes, measure=floor_response, *, load_factors=None, workers=None, scheduler=None,"
        " checkpoint=None, progress=True)"
    ),
    "threads": "(count)",
    "work": "(result)",
}
#: What a result has without being called.
PROPERTIES = """
certificate certificates contacts displacement events floor_force_change floor_response load_factors loaded
loaded_disks origin reaction rest scene
"""


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
    """One that changes breaks what others have written: it goes into CHANGELOG.md and into this list."""
    places = {name: getattr(gr, name) for name in gr.__all__ if inspect.isfunction(getattr(gr, name))}
    for owner in ("Events", "LaboratoryUnits", "Result", "Scene", "plot", "studies", "studies.LoadPath"):
        found = attrgetter(owner)(gr)
        names = found.__all__ if inspect.ismodule(found) else [n for n in vars(found) if not n.startswith("_")]
        places |= {
            f"{owner}.{name}": getattr(found, name)
            for name in names
            if isinstance(getattr(found, name), (FunctionType, MethodType))
        }
    assert {name: parameters(function) for name, function in places.items()} == SIGNATURES
    assert set(PROPERTIES.split()) == {
        name for name in vars(gr.Result) if not name.startswith("_") and f"Result.{name}" not in SIGNATURES
    }


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
        fresh(script, NUMBA_CACHE_DIR=str(tmp_path))
    assert list(tmp_path.rglob("*.nbi"))
