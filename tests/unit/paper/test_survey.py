"""The survey's parameters, and that its runs go on where they were."""

import numpy as np
import pytest
import yaml

from granular_response.store import files as store
from granular_response_paper.ensembles import AT_REST
from granular_response_paper.survey import simulate as survey

SMALL = {
    "method": "auto",
    "scene": {
        "packing": {"layers": 4, "disks_per_row": 9, "lattice_constant": "touching-largest"},
        "protocol": {"integrator": "verlet", "stop_kinetic_energy": 1e-9, "maximum_steps": 200_000},
    },
    "time_step_part": 0.9,
    "longest_time_step": 1e-3,
    "collapse_depth": 2.0,
    "realizations": 3,
    "blocks": {
        "small": [
            {"polydispersities": [0.01], "frictions": [0.0, 0.2], "forces": [0.5, 5.0], "wall_friction": 0.0},
            {"polydispersities": [0.0], "frictions": [0.0], "forces": [0.5], "lattice_constants": [2.0]},
        ],
    },
}


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "params.yaml"
    path.write_text(yaml.safe_dump(SMALL))
    return path


def test_gravity_grows_over_each_ramp_that_a_block_names():
    slow = {"polydispersities": [0.01], "frictions": [0.2], "forces": [0.5], "gravity_ramps": [5.0, 20.0]}
    blocks = {"slow": [slow, slow | {"gravity_ramps": None}]}
    parameters = survey.Parameters(**SMALL | {"blocks": blocks})
    ramps = [survey.ensemble_task(parameters, case, 0).args[0].preparation for case in parameters.cases("slow")]
    assert [(one.gravity, one.ramp_time) for one in ramps[:2]] == [("slow", 5.0), ("slow", 20.0)]
    assert ramps[2].gravity == "at-once"


def test_a_run_goes_on_where_it_was_and_stores_what_was_found(file):
    begun = []
    survey.run(survey.ensemble("small", file, 2), file.parent, workers=1, progress=lambda *call: begun.append(call))
    assert begun[0][:2] == (0, 5)
    begun.clear()
    block = survey.ensemble("small", file)
    path = survey.run(block, file.parent, workers=1, progress=lambda *call: begun.append(call))
    assert begun[0][:2] == (5, 7)  # the third ones alone

    found = store.read(path)
    one = found["ensembles"].isel(case=1, realization=2)
    again = block.tasks[1, 2]()
    assert (one["outcome"].values[:2] == AT_REST).all()
    np.testing.assert_allclose(one["floor_response"].values[:2], again.floor_response, atol=2.0**-18, rtol=1e-7)
    np.testing.assert_allclose(one["x"].values, again.x, atol=2.0**-13, rtol=1e-7)
    assert one["wall_friction"] == 0.0 and one["gravity_ramp"] == ""
    packing = found["packings"].isel(case=1, realization=2)
    for name in survey.PACKINGS:
        np.testing.assert_equal(packing[name].values, np.float32(getattr(again.packing, name)))
    marks = store.read_attributes(path)
    assert marks["block"] == "small" and marks["seed"] == "0" and "collapse_depth" in marks["parameters"]
    assert survey.sources(*survey.SOURCES) in marks["sources"]
