"""Solutions as datasets and back."""

from dataclasses import fields, replace

import numpy as np
import pytest
from small_scenes import scene

from granular_response.solve import solve_scene
from granular_response.state import Contacts, Crossing
from granular_response.store import files as store
from granular_response.store.result import scene_of, solution_from, state_from, to_dataset


@pytest.fixture(scope="module", params=[0.0, 0.3], ids=["frictionless", "frictional"])
def solution(request):
    load = {"disk": "top-centre", "force": [0.5, -3.0], "torque": 0.2 if request.param else 0.0}
    return solve_scene(scene(contact__friction=request.param, loads=[load]), load_factors=(0.5, 1.0))


def equal(a, b) -> bool:
    """Whether two states are the same to the last bit, types included."""
    for field in fields(a):
        x, y = getattr(a, field.name), getattr(b, field.name)
        if field.name == "reached":
            continue
        if isinstance(x, Contacts):
            if not equal(x, y):
                return False
        elif not (np.array_equal(x, y) and np.asarray(x).dtype == np.asarray(y).dtype):
            return False
    return True


def test_states_come_back_to_the_last_bit(solution, tmp_path):
    data = to_dataset(solution)
    store.write(tmp_path / "result.nc", {"result": data})
    back = store.read(tmp_path / "result.nc")["result"]
    assert scene_of(back) == solution.scene
    for dataset in (data, back):
        for index, state in enumerate([solution.rest, *solution.loaded]):
            assert equal(state_from(dataset, index), state)


def test_every_variable_says_what_it_is(solution):
    data = to_dataset(solution)
    assert len(data.variables) > 20
    for name, variable in data.variables.items():
        assert variable.attrs.get("long_name"), name
        assert variable.attrs.get("units"), name


def test_floor_response_of_each_load(solution):
    data = to_dataset(solution)
    assert data.floor_response.dims == ("load", "floor_disk")
    total = np.hypot(0.5, 3.0)
    assert data.total_force.values == pytest.approx([0.5 * total, total])
    assert data.floor_response.sum("floor_disk").values == pytest.approx([3.0 / total] * 2, abs=1e-9)
    change = data.floor_force - data.floor_force_rest
    assert np.allclose(change / data.total_force, data.floor_response, rtol=0, atol=1e-12)
    assert data.certificate_force_residual.values.max() < 1e-9
    assert data.attrs["stable"] == "yes" and data.attrs["settled"] == "yes"


def test_a_dataset_without_states_is_refused(solution):
    with pytest.raises(ValueError, match="holds no states"):
        state_from(to_dataset(solution).drop_vars("contact_spring"))


def test_stretches_that_dynamics_crossed_are_stored(solution, tmp_path):
    assert not any(name.startswith("crossing") for name in to_dataset(solution).variables)
    crossings = (Crossing(0.2, 0.25, "unstable", 0.5), Crossing(0.7, 0.8, "no equilibrium", 1.5))
    # the record of a path grows: later states repeat what earlier ones tell
    loaded = tuple(
        replace(state, reached=replace(state.reached, crossings=crossings[: k + 1]))
        for k, state in enumerate(solution.loaded)
    )
    crossed = replace(solution, loaded=loaded)
    store.write(tmp_path / "result.nc", to_dataset(crossed))
    dataset = store.read(tmp_path / "result.nc")[""]
    assert dataset["crossing_start"].values.tolist() == [0.2, 0.7]
    assert dataset["crossing_reason"].values.tolist() == ["unstable", "no equilibrium"]
    again = solution_from(dataset)
    assert again.loaded[0].reached.crossings == crossings
    assert to_dataset(again).identical(to_dataset(crossed))
