"""The notebook of every figure group, made from its parameters, runs at reduced size and shows its figures."""

import os

import nbformat
import pytest
import reduced
from jupyter_client import KernelManager
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell
from places import ROOT

from granular_response_paper import notebooks
from granular_response_paper.groups import NAMES
from granular_response_paper.pipeline import GroupError, group_member, simulation

OWN = ROOT / "params.yaml"
#: Groups whose reduced datasets are looked at by tests of their own: their notebooks here draw these.
LOOKED_AT = ["stability", *(group for group in NAMES if (ROOT / f"tests/regression/test_{group}.py").exists())]
READ = """\
from granular_response.store import files


def simulate(parameters):
    return files.read({path!r})"""


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    """One for all notebooks: most of the time of a small one goes by until it has imported what it needs."""
    folder = tmp_path_factory.mktemp("kernel")
    paths = os.pathsep.join([str(ROOT / "src"), os.environ.get("PYTHONPATH", "")])
    manager = KernelManager()
    settings = {"PYTHONPATH": paths, "IPYTHONDIR": str(folder / "ipython")}
    manager.start_kernel(cwd=str(folder), env={**os.environ, **settings})
    yield manager
    manager.shutdown_kernel(now=True)


@pytest.mark.parametrize("group", NAMES)
def test_a_notebook_runs_and_shows_every_figure(group, kernel, tmp_path, tmp_path_factory):
    (path,) = notebooks.write(tmp_path / "notebooks", [group], own=OWN, reduced=reduced.PATH)
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert not any(cell.get("outputs") for cell in notebook.cells)
    assert "dpi=100" in notebook.cells[-1].source
    notebook.cells[-1].source = notebook.cells[-1].source.replace("dpi=100", "dpi=20")  # of pictures that nobody sees
    # nothing that a notebook before it has named; %reset also collects garbage, for a quarter of a second each time
    notebook.cells.insert(0, new_code_cell("%reset_selective -f ."))
    if group in LOOKED_AT:
        run = next(k for k, cell in enumerate(notebook.cells) if "simulate(parameters)" in cell.source)
        path = str(reduced.stored(group, tmp_path_factory))
        notebook.cells.insert(run, new_code_cell(READ.format(path=path)))
    NotebookClient(notebook, km=kernel, timeout=120).execute()
    shown = [output.get("data", {}) for output in notebook.cells[-1].outputs]
    pictures = [data for data in shown if "image/png" in data]
    assert pictures and len(pictures) == sum("text/markdown" in data for data in shown)


@pytest.mark.parametrize("group", NAMES)
def test_a_notebook_has_the_parameters_of_its_group(group, tmp_path):
    (path,) = notebooks.write(tmp_path, [group], own=OWN, reduced=reduced.PATH)
    names: dict = {}
    for cell in nbformat.read(path, as_version=4).cells:
        if cell.source.startswith(("own = ", "reduced = ")):
            exec(cell.source, names)
    described = group_member(group, "parameters", "Parameters")
    for name, file in (("own", OWN), ("reduced", reduced.PATH)):
        given, expected = simulation.parameters(group, file)
        assert names[name] == given and described(**names[name]) == expected


def test_notebooks_that_simulate_are_among_them():
    assert 4 <= len(LOOKED_AT) < len(NAMES) - 2


def test_a_group_that_is_none_is_said(tmp_path):
    with pytest.raises(GroupError, match="pile_dpi: no such figure group"):
        notebooks.write(tmp_path, ["pile_dpi"], own=OWN, reduced=reduced.PATH)
    assert not any(tmp_path.iterdir())
