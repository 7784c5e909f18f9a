"""One base for all errors."""

import importlib
import pkgutil

import pytest

import granular_response as gr
import granular_response_paper as paper
from granular_response.errors import GranularError
from granular_response.sweeps.executor import WorkerError


def errors() -> list[type[Exception]]:
    """Every exception class of library and reproduction, but for warnings."""
    found: set[type[Exception]] = set()
    for module in (m for one in (gr, paper) for m in pkgutil.walk_packages(one.__path__, f"{one.__name__}.")):
        if not module.name.endswith("__main__"):
            for value in vars(importlib.import_module(module.name)).values():
                if isinstance(value, type) and issubclass(value, Exception) and value.__module__ == module.name:
                    found.add(value)
    return sorted((kind for kind in found if not issubclass(kind, Warning)), key=lambda kind: kind.__name__)


def test_all_errors_have_the_public_base():
    """But for what stands for the exception of somebody's function that cannot leave its worker process."""
    assert len(errors()) > 25
    assert [kind for kind in errors() if not issubclass(kind, gr.GranularError)] == [WorkerError]


def test_public_errors_are_what_is_raised(tmp_path):
    with pytest.raises(gr.SceneError):
        gr.solve({"packing": {"kind": "sphere"}})
    with pytest.raises(gr.StoreError, match="no such file"):
        gr.open_result(tmp_path / "nothing.nc")
    assert issubclass(gr.StoreError, OSError) and issubclass(gr.SceneError, ValueError)
    assert issubclass(gr.SweepError, RuntimeError) and issubclass(gr.ResultError, ValueError)
    assert gr.GranularError is GranularError
