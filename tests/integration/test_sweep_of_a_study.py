"""A study gives the same file with worker processes."""

import contextlib
import io
import shutil
import sys
from pathlib import Path

import pytest
import reduced

from granular_response_paper import cli

GROUP = "superposition"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder with the parameter file, from which commands start."""
    shutil.copy(reduced.path(GROUP), tmp_path / "params.yaml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The file that one process writes."""
    return reduced.stored(GROUP, tmp_path_factory).read_bytes()


def test_its_command_writes_the_same_bytes_with_workers(folder, expected, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["", "simulate", GROUP, "-o", "here.nc", "--workers", "2"])
    with contextlib.redirect_stdout(io.StringIO()), pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    assert Path("here.nc").read_bytes() == expected
