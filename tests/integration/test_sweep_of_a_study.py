"""A study gives the same file wherever its sweeps run: by its command, and on a real Dask cluster on this machine."""

import contextlib
import io
import sys
from pathlib import Path

import pytest
import yaml

from granular_response.store import files as store
from granular_response.sweeps import tasks
from granular_response.sweeps.resources import using
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


def test_its_command_writes_the_same_bytes_with_workers(folder, expected, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["", "simulate", GROUP, "-o", "here.nc", "--workers", "2"])
    with contextlib.redirect_stdout(io.StringIO()), pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    assert Path("here.nc").read_bytes() == expected


def test_a_cluster_writes_the_same_bytes(folder, expected, cluster, monkeypatch):
    sent = []
    submitted = tasks._submitted
    monkeypatch.setattr(tasks, "_submitted", lambda *given: (sent.append(given[0]), submitted(*given)))
    with cluster.get_client() as client, using(executor=client.get_executor()) as resources:
        simulation.simulate(GROUP, Path("here.nc"))
        assert sent and set(sent) == {resources.executor}
    assert Path("here.nc").read_bytes() == expected
