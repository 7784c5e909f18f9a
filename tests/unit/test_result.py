"""Solutions as datasets and back."""

from dataclasses import fields

import numpy as np
import pytest
from small_scenes import scene

import granular_response
from granular_response.scene import Scene
from granular_response.solve import solve_scene
from granular_response.state import Contacts
from granular_response.store import files as store
from granular_response.store.result import ResultError, scene_of, state_from, to_dataset


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


CHANGING = {
    "packing.layers": 4,
    "packing.disks_per_row": 7,
    "packing.polydispersity": 0.3,
    "packing.lattice_constant": "touching-largest",
    "packing.realization": 4,
    "contact.normal_stiffness": 1000.0,
    "contact.friction": 0.1,
    "protocol.time_step": "auto",
    "loads.0.force": [10, -25],
}


@pytest.mark.parametrize("changes", [{}, {"contact.friction": 0.0}])
def test_a_stored_result_goes_on_with_the_bits_of_a_run_that_was_not_cut(changes, tmp_path):
    """Dynamics on the way lists other candidates: each stored state keeps its own list."""
    scene = Scene().updated({**CHANGING, **changes})
    whole = granular_response.solve(scene, load_factors=[1, 2, 0.2])
    granular_response.solve(scene, load_factors=[1, 2]).save(tmp_path / "cut.nc")
    cut = granular_response.open_result(tmp_path / "cut.nc")
    assert {"contact_own_place", "wall_own_place"} <= set(cut.to_dataset().variables)
    goes_on = cut.continued([0.2])
    for name in ("position", "angle"):
        np.testing.assert_array_equal(getattr(goes_on.loaded[-1], name), getattr(whole.loaded[-1], name))
    for name in ("first", "second", "spring", "normal_force"):
        np.testing.assert_array_equal(getattr(goes_on.loaded[0].pairs, name), getattr(whole.loaded[0].pairs, name))
        np.testing.assert_array_equal(getattr(goes_on.rest.walls, name), getattr(whole.rest.walls, name))


def test_a_box_that_has_changed_since_is_noticed(tmp_path):
    disks = [(x, 1.0) for x in (1.0, 3.0, 5.0, 7.0)] + [(x, 1.0 + 3**0.5) for x in (2.0, 4.0, 6.0)]

    def write(width):
        title = f"granular-response: {len(disks)} disks, width {width}, sides walls"  # by which the box is known
        lines = [title, "", f"{len(disks)} atoms", "1 atom types", "", f"0.0 {width} xlo xhi", "0.0 10 ylo yhi"]
        lines += ["-1 1 zlo zhi", "", "Atoms # sphere", ""]
        lines += [f"{k} 1 2.0 1.0 {x} {z} 0.0" for k, (x, z) in enumerate(disks, 1)]
        (tmp_path / "disks.data").write_text("\n".join(lines) + "\n")

    write(12.0)
    packing = {"kind": "file", "path": "disks.data"}
    load = {"disk": 5, "force": [0.0, -1.0]}
    rough = {"contact": {"friction": 1.0}, "wall": {"friction": 1.0}}
    scene = Scene.from_dict({"packing": packing, "loads": [load], **rough}, folder=tmp_path)
    granular_response.solve(scene).save(tmp_path / "result.nc")
    write(8.5)
    with pytest.raises(ResultError, match="table of disks has changed"):
        granular_response.open_result(tmp_path / "result.nc", folder=tmp_path).continued([2.0])
