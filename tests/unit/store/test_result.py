"""Solutions as datasets and back."""

from dataclasses import fields, replace

import numpy as np
import pytest
import xarray as xr
from small_scenes import pushed, scene

import granular_response
from granular_response.scene import Scene
from granular_response.solvers.solution import continue_solution, solve_scene
from granular_response.state import Contacts
from granular_response.store import files as store
from granular_response.store.result import ResultError, scene_of, solution_from, state_from, to_dataset


@pytest.fixture(scope="module", params=[0.0, 0.3], ids=["frictionless", "frictional"])
def solution(request):
    loads = pushed(0.5, -3.0, 0.2 if request.param else 0.0)
    return solve_scene(scene(contact__friction=request.param, loads=loads), load_factors=(0.5, 1.0))


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
    rng, rest = np.random.default_rng(0), solution.rest
    velocity, spin = rng.normal(size=rest.velocity.shape), rng.normal(size=rest.angle.shape)
    solution = replace(solution, rest=replace(rest, velocity=velocity, angular_velocity=spin))
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
        assert len(variable.attrs["long_name"]) < 40 and variable.attrs["description"], name
        coded = variable.dtype.kind not in "iuf" or "flag_values" in variable.attrs or name == "applied_load"
        assert ("units" in variable.attrs) != coded, name
    units = {name: data[name].attrs["units"] for name in ("x", "mass", "floor_force", "velocity", "floor_response")}
    assert list(units.values()) == ["mean_radius", "mean_mass", "mean_weight", "mean_radius / reduced_time", "1"]


def test_floor_response_of_each_load(solution):
    data = to_dataset(solution)
    assert data.floor_response.dims == ("load", "floor_disk")
    total = np.hypot(0.5, 3.0)
    assert data.total_force.values == pytest.approx([0.5 * total, total])
    assert data.floor_response.sum("floor_disk").values == pytest.approx([3.0 / total] * 2, abs=1e-9)
    change = data.floor_force - data.floor_force_rest
    np.testing.assert_array_equal(change, data.floor_force_change)
    assert np.allclose(change / data.total_force, data.floor_response, rtol=0, atol=1e-12)
    assert data.certificate_force_residual.values.max() < 1e-9
    assert data.attrs["stable"] == "yes" and data.attrs["settled"] == "yes"


@pytest.mark.parametrize(("width", "last"), [(8.5, 1), (12.0, 2)], ids=["box", "mass"])
def test_a_table_that_has_changed_since_is_noticed(tmp_path, width, last):
    rows = "".join(f"{x},{z},1,1\n" for x, z in [(1, 1), (3, 1), (5, 1), (7, 1), (2, 2.75), (4, 2.75)])

    def write(width, last=1):
        title = f"# granular-response: 7 disks, width {width}, sides walls\n"  # by which the box is known
        (tmp_path / "disks.csv").write_text(f"{title}x,z,radius,mass\n{rows}6,2.75,1,{last}\n")

    write(12.0)
    packing, load = {"kind": "file", "path": "disks.csv"}, {"disk": 5, "force": [0.0, -1.0]}
    rough = {"contact": {"friction": 1.0}, "wall": {"friction": 1.0}}
    scene = Scene.from_dict({"packing": packing, "loads": [load], **rough}, folder=tmp_path)
    granular_response.solve(scene).save(tmp_path / "result.nc")
    write(width, last)
    with pytest.raises(ResultError, match="table of disks has changed"):
        granular_response.open_result(tmp_path / "result.nc", folder=tmp_path).continued([2.0])


SLAB = scene(5, 11, contact__friction=0.3, loads=pushed(0.0, -1.0))


def assert_same_contacts(one, other) -> None:
    """For states that may list their candidates in another order."""
    for name in ("position", "angle", "velocity", "angular_velocity"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    names = ("first", "second", "overlap", "normal_force", "tangential_force", "spring", "status")
    names += ("rolling_force", "rolling_spring", "rolling_status")
    for kind in ("pairs", "walls"):
        rows = []
        for contacts in (getattr(one, kind), getattr(other, kind)):
            touching = np.stack([getattr(contacts, name)[contacts.touching].astype(float) for name in names])
            rows.append(touching[:, np.lexsort(touching[1::-1])])
        np.testing.assert_array_equal(*rows)


@pytest.mark.parametrize(
    "changes",
    [
        {"contact.friction": 0.0},
        {"contact.friction": 0.3, "protocol.method": "dynamics", "protocol.stop_kinetic_energy": 1e-9},
        # its path loses its equilibrium, which the test sees to
        {"contact.friction": 0.2, "packing.polydispersity": 0.1, "packing.seed": 3},
        {"contact.rolling_friction": 0.02, "contact.rolling_stiffness_ratio": 0.5},
        {"contact.law": "hertz", "loads.0.force": [0.5, -4.0], "loads.0.torque": 0.5},
        {"packing.sides": "periodic", "packing.lattice_constant": 1.9995, "wall.friction": 0.2},
        {"loads": [{"disk": "top-centre", "displacement": [None, -2e-3]}]},
    ],
    ids=["minimise", "dynamics", "path that is lost", "rolling", "3/2 law and torque", "periodic", "displaced"],
)
def test_a_continued_result_is_the_uninterrupted_one(tmp_path, changes):
    """Cut at each load, stored and read again: every state, event and measured number has the same bits."""
    scene = SLAB.updated({"loads.0.force": [0.0, -10.0]}).updated(changes)
    straight = solve_scene(scene, load_factors=[0.3, 0.6, 1.0, 0.4])
    if "packing.seed" in changes:
        assert any(event.lost for event in straight.loaded[1].reached.events)
    parts = solve_scene(scene, load_factors=[0.3])
    for factor in (0.6, 1.0, 0.4):
        store.write(tmp_path / "part.nc", to_dataset(parts))
        parts = continue_solution(solution_from(store.read(tmp_path / "part.nc")[""]), [factor])
    for one, other in zip((straight.rest, *straight.loaded), (parts.rest, *parts.loaded), strict=True):
        assert_same_contacts(one, other)
    # states of one file share one list of candidates, so what does not touch may be listed in another order
    lists = {"contact", "wall_contact"}
    one, other = (to_dataset(solution).drop_dims(lists) for solution in (parts, straight))
    assert any(str(name).startswith("reached_") for name in one.variables)
    xr.testing.assert_identical(one, other)
