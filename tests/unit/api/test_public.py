"""The public namespace, with ``import granular_response as gr`` alone, and one base for all errors."""

import importlib
import pkgutil

import numpy as np
import pytest
from refusals import refuses

import granular_response as gr
import granular_response_paper as paper
from granular_response.sweeps.tasks import WorkerError

SMALL = {"packing": {"kind": "slab", "layers": 5, "disks_per_row": 21}, "loads": [{"disk": 93, "force": [0, -4]}]}


@pytest.fixture(scope="module")
def result() -> gr.Result:
    return gr.solve(SMALL, load_factors=[0.5, 1.0])


def test_contacts_as_a_table(result, tmp_path):
    table = result.contacts_table()
    state, data = result.loaded[-1], result.to_dataset()
    assert len(table) == state.pairs.touching.sum() + state.walls.touching.sum()
    assert list(table.columns) == ["first", "second", "wall", "x", "z", "status", "normal_force", "tangential_force"]
    assert table.attrs["units"]["normal_force"] == "mean_weight"
    between = table[table.wall == ""]
    for disk in ("first", "second"):  # the point of contact lies within both disks, half the overlap from their rims
        centre, radius = state.position[between[disk]], data["radius"].values[between[disk]]
        away = np.hypot(between.x - centre[:, 0], between.z - centre[:, 1])
        np.testing.assert_allclose(away, radius - 0.5 * state.pairs.overlap[state.pairs.touching], atol=1e-12)
    floor = table[table.wall == "floor"]
    assert (floor.second == -1).all() and (floor.z == 0.0).all()
    assert floor.normal_force.sum() == pytest.approx(float(data["floor_force"].isel(load=1).sum()))
    assert set(table.status) <= {"sticking", "sliding"}
    assert (table.status == "sliding").sum() == state.pairs.sliding.sum() + state.walls.sliding.sum()
    assert len(result.contacts_table(0)) != len(table)
    table.to_csv(tmp_path / "contacts.csv")
    assert (tmp_path / "contacts.csv").read_text().startswith("contact,first,second,wall,x,z,status,")
    refuses(IndexError, "state = 3: must be from -3 to 2", result.contacts_table, state=3)


def test_the_response_at_a_place(result):
    near = result.response_at(0.4)
    assert near.dims == ("load",) and float(near["x"]) == pytest.approx(0.0, abs=1e-3)
    np.testing.assert_array_equal(near.values, result.floor_response.set_xindex("x").sel(x=0.4, method="nearest"))
    smooth = [float(result.response_at(x, smooth=3.0).sel(load=1.0)) for x in np.arange(-60.0, 60.0)]
    assert sum(smooth) == pytest.approx(1.0, abs=1e-6)
    for mistake in ({"x": np.nan}, {"smooth": 0.0}):
        refuses(ValueError, "must be", result.response_at, **mistake)


#: Two disks on the floor between smooth walls 4 R apart, and one on both: it presses on each with half its force.
THREE = gr.Scene.from_arrays(
    x=[1.0, 3.0, 2.0],
    z=[1.0, 1.0, 1.0 + np.sqrt(3.0)],
    radius=1.0,
    width=4.0,
    scene={"loads": [{"disk": 2, "force": [0.0, -2.0]}]},
)


def test_a_profile_of_sensors_is_that_of_three_disks():
    """By hand: 1.5 weights on each floor disk, and 1 more under 2 mg. The paper's disks are 7.5 mm wide."""
    three, units, weight = gr.solve(THREE), gr.LaboratoryUnits(), 3.286096e-3
    rest = three.floor_profile(units, 7.5, state=0)
    assert rest.values == pytest.approx([1.5 * weight, 1.5 * weight], rel=1e-6)
    assert rest["x"].values == pytest.approx([3.75, 11.25]) and (rest.units, rest["x"].units) == ("N", "mm")
    added = three.floor_profile(units, 7.5)
    assert added.values == pytest.approx([weight, weight], rel=1e-6)
    whole = three.floor_profile(units, 7.5, added=False)
    assert whole.values == pytest.approx([2.5 * weight, 2.5 * weight], rel=1e-6)
    wide = three.floor_profile(units, 10.0)  # the second one reaches beyond the right wall at 15 mm
    assert wide["x"].values == pytest.approx([5.0, 15.0]) and wide.values == pytest.approx(added.values)
    part = three.floor_profile(units, [0.0, 5.0, 9.0])  # the second disk is outside
    assert part["x"].values == pytest.approx([2.5, 7.0]) and part.values == pytest.approx([weight, 0.0], rel=1e-6)
    near = gr.LaboratoryUnits(radius=1.004 * units.radius)  # of a table whose mean radius is off by less than 1 %
    assert len(three.floor_profile(near, 7.5)) == 2 and len(three.floor_profile(near, 5.0)) == 3
    refuses(ValueError, r"^sensors = 0\.0075: must be in mm", three.floor_profile, units, 0.0075)
    for mistake in (0.0, -1.0, np.nan, "wide", [3.0], [3.0, 2.0], [[1.0, 2.0]]):
        refuses(ValueError, "^sensors = .*: must be a width in mm", three.floor_profile, units, mistake)
    refuses(ValueError, "added: a load adds nothing", three.floor_profile, units, 7.5, state=0, added=True)


@pytest.mark.parametrize("sides", ["walls", "periodic"])
def test_the_forces_on_sensors_sum_to_the_weight_of_all_disks(sides):
    """Between smooth walls and periodic sides the floor bears all, in sensors of any width."""
    units = gr.LaboratoryUnits(radius=2e-3, thickness=5e-3, density=2500.0)
    slab = gr.solve(gr.Scene.from_dict(SMALL).updated({"packing.sides": sides, "packing.polydispersity": 0.05}))
    weight = len(slab.rest.position) * np.pi * 2e-3**2 * 5e-3 * 2500.0 * 9.8  # N, of disks of the mean mass
    applied = 4.0 * units.unit("force")
    for width in (2.0, 7.0, 1000.0):
        rest, added = slab.floor_profile(units, width, state=0), slab.floor_profile(units, width)
        assert float(rest.sum()) == pytest.approx(weight, rel=1e-9)
        assert float(added.sum()) == pytest.approx(applied, rel=1e-9)


def test_displacements_are_from_the_initial_equilibrium(result):
    moved, (disk,) = result.displacement, result.loaded_disks
    assert moved.dims == ("load", "disk", "axis") and moved["force"].values.tolist() == [2.0, 4.0]
    expected = result.loaded[1].position - result.rest.position
    np.testing.assert_array_equal(moved.isel(load=1), expected)
    down = moved.sel(axis="z").isel(disk=disk)
    assert down[1] < down[0] < 0.0 and abs(expected).max() == -float(down[1])
    assert gr.solve(gr.Scene(packing=gr.Slab(layers=2, disks_per_row=4), loads=[])).displacement.shape == (0, 7, 2)


def test_after_unloading_the_change_is_defined():
    unloaded = gr.solve(SMALL, load_factors=[1.0, 0.0])
    assert np.isnan(unloaded.floor_response.sel(load=0.0)).all()
    assert np.abs(unloaded.floor_force_change.sel(load=0.0)).max() > 1e-3
    labels = [text.get_text() for text in gr.plot.response(unloaded).get_legend().get_texts()]
    assert labels == ["4 (loading)"]


def test_a_method_of_the_call(result):
    by_dynamics = gr.solve(SMALL, method="dynamics", load_factors=[0.5])
    assert by_dynamics.scene.protocol.method == "dynamics"
    np.testing.assert_allclose(by_dynamics.rest.position, result.rest.position, atol=1e-9)
    refuses(gr.SceneError, r"method = 'dynamic': must be .*did you mean dynamics", gr.solve, SMALL, method="dynamic")


def test_a_scene_in_laboratory_units():
    units = gr.LaboratoryUnits(radius=0.01)
    loads = [{"disk": {"x": -0.1}, "force": [0.0, -15.0 * units.unit("force")], "torque": 0.1 * units.unit("torque")}]
    protocol = {"ramp_time": 20.0 * units.time, "time_step": "auto", "load_factors": [0.5, 1.0]}
    scene = gr.Scene.from_dict(units.reduced_scene({"loads": loads, "protocol": protocol}))
    assert scene.loads[0].disk == gr.At(x=-10.0) and scene.loads[0].force[1] == pytest.approx(-15.0)
    assert scene.loads[0].torque == pytest.approx(0.1)
    assert scene.protocol.ramp_time == pytest.approx(20.0) and scene.protocol.load_factors == (0.5, 1.0)
    refuses(OSError, "no such file", gr.Scene.from_yaml, "nowhere.yaml")


def test_stress_carries_the_load(result):
    """Over a line the added vertical stress is the load above it; so is the whole stress with the weights."""
    across = np.arange(-40.0, 40.0, 0.25)
    added = result.stress(across, [4.5], width=1.0).sel(force="z", branch="z")
    assert float(added.sum() * 0.25) == pytest.approx(4.0, rel=2e-3)
    assert added.dims == ("z", "x") and float(added.x[int(added.values.argmax())]) == pytest.approx(0.0, abs=1.0)
    rest, half = (result.stress(across, [4.5], state=k, added=False).sel(force="z", branch="z") for k in (0, 1))
    assert float((half - rest).sum() * 0.25) == pytest.approx(2.0, rel=2e-2)
    refuses(ValueError, "added: a load adds nothing", result.stress, state=0, added=True)
    refuses(IndexError, "state = 3: must be from -3 to 2", result.stress, state=3)


def test_periodic_sides_are_crossed_the_shortest_way(tmp_path):
    packing = {"packing.layers": 5, "packing.disks_per_row": 11, "packing.sides": "periodic", "wall.friction": 0.3}
    scene = gr.Scene().updated({**packing, "loads.0.disk": {"row": "top", "offset": -4}})
    (tmp_path / "scene.yaml").write_text(scene.to_yaml())
    result = gr.solve(tmp_path / "scene.yaml")
    disk = int(result.to_dataset()["loaded_disk"][0])
    assert 0.0 <= result.origin < 22.0
    answers = result.influence(sliding="stick")
    assert abs(answers["disk_x"].values).max() <= 11.0
    assert answers["disk_x"].values[disk] == pytest.approx(0.0, abs=1e-9)
    stress = result.stress()
    assert stress["x"].values[[0, -1]] == pytest.approx([-11.0, 11.0])
    np.testing.assert_allclose(stress.isel(x=0), stress.isel(x=-1), atol=1e-12)
    mesh = gr.plot.stress(result).collections[0]
    places = mesh.get_coordinates()
    drawn = mesh.get_array().reshape(places.shape[:2])
    expected = result.stress(places[0, :, 0], places[:, 0, 1]).sel(force="z", branch="z")
    np.testing.assert_allclose(drawn, expected, atol=1e-12)


def test_what_is_done_to_what_a_result_gives_does_not_change_it(result):
    before = result.to_dataset()
    for given in (result.floor_response, result.contacts["contact_force"], result.to_dataset()["position"]):
        given.values[...] = 0.0
    assert result.to_dataset().identical(before)


def test_two_loads_on_one_disk_have_its_place_as_origin():
    disk, slab = gr.Row(row="top", offset=2), gr.Slab(layers=3, disks_per_row=9)
    parts = [gr.Load(disk=disk, force=(0, -1)), gr.Load(disk=disk, force=(0.2, 0))]
    two, one = (
        gr.solve(gr.Scene(packing=slab, loads=loads), progress=False)
        for loads in (parts, [gr.Load(disk=disk, force=(0.2, -1))])
    )
    np.testing.assert_array_equal(two.floor_response["x"], one.floor_response["x"])
    np.testing.assert_allclose(two.floor_force_change, one.floor_force_change, atol=1e-9)


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
    assert issubclass(gr.StoreError, OSError) and issubclass(gr.SceneError, ValueError)
    assert issubclass(gr.SweepError, RuntimeError) and issubclass(gr.ResultError, ValueError)
