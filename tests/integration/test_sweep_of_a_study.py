"""A study gives the same file wherever its sweeps run: by its command, with a real Dask cluster on this machine."""

import contextlib
import io
import sys
from pathlib import Path

import pytest
import yaml

from granular_response.store import files as store
from granular_response.sweeps import tasks
from granular_response_paper import cli
from granular_response_paper.pipeline import simulation

GROUP = "superposition"
SECTIONS = {
    "common": {"method": "auto"},
    GROUP: {
        "scene": {
            "packing.layers": 5,
            "packing.disks_per_row": 13,
            "packing.polydispersity": 0.1,
            "packing.lattice_constant": "touching-largest",
            "contact.friction": 0.2,
            "protocol.integrator": "verlet",
            "protocol.time_step": "auto",
            "protocol.ramp_time": 2.0,
            "protocol.stop_kinetic_energy": 1e-9,
        },
        "realizations": 2,
        "offsets": [1],
        "forces": [0.2, 1.0],
        "single_forces": [0.5, 1.0],
        "width": 3.0,
        "tolerance": 0.05,
    },
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder with the parameter file, from which commands start."""
    (tmp_path / "params.yaml").write_text(yaml.safe_dump(SECTIONS))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The file that one process writes."""
    folder = tmp_path_factory.mktemp("expected")
    (folder / "params.yaml").write_text(yaml.safe_dump(SECTIONS))
    path = simulation.simulate(GROUP, folder / "one.nc", parameter_file=folder / "params.yaml", workers=1)
    assert store.read(path)["errors"]["floor_error"].notnull().all()
    return path.read_bytes()


@pytest.fixture
def only_dask(monkeypatch):
    """No task runs here or in a process of ours."""

    def refuse(*_):
        raise AssertionError("not on the cluster")

    monkeypatch.setattr(tasks, "_here", refuse)
    monkeypatch.setattr(tasks, "over_processes", refuse)


def command(monkeypatch, *arguments: str) -> bytes:
    """The file that the command wrote."""
    monkeypatch.setattr(sys, "argv", ["granular-response-paper", "simulate", GROUP, "-o", "here.nc", *arguments])
    with contextlib.redirect_stdout(io.StringIO()), pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    return Path("here.nc").read_bytes()


@pytest.mark.parametrize("by", ["command line", "environment"])
def test_a_named_cluster_writes_the_same_bytes(folder, expected, cluster, only_dask, monkeypatch, by) -> None:
    named = ["--scheduler", cluster.scheduler_address] if by == "command line" else []
    if not named:
        monkeypatch.setenv(tasks.SCHEDULER_VARIABLE, cluster.scheduler_address)
    assert command(monkeypatch, *named) == expected
