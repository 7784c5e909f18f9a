"""Observables of results against what they mean."""

import re

import numpy as np
import pytest
import xarray as xr
from refusals import refuses

import granular_response as gr
from granular_response.state import wall_normals

SLAB = gr.Slab(layers=5, disks_per_row=11)
TOP = [gr.Load(disk="top-centre", force=(0.0, -4.0))]


@pytest.fixture(scope="module")
def result() -> gr.Result:
    return gr.solve(gr.Scene(packing=SLAB, loads=TOP), load_factors=np.linspace(0.05, 1.0, 20), progress=False)


@pytest.fixture(scope="module")
def smooth() -> gr.Result:
    scene = gr.Scene(packing=SLAB, loads=TOP, contact=gr.Contact(friction=0.0))
    return gr.solve(scene.updated({"loads.0.force": [0.0, -1e-3]}), progress=False)


@pytest.mark.filterwarnings("ignore:not at rest within protocol.maximum_steps")
def test_rattlers_and_their_contacts_are_left_out():
    """Two disks with a third on them, and one that lies beside them on the floor."""
    rough = {"contact": {"friction": 0.5}, "wall": {"friction": 0.5}, "protocol": {"maximum_steps": 100_000}}
    apart = gr.Scene.from_arrays([1.0, 3.0, 2.0, 7.0], [1.0, 1.0, 2.74, 1.0], 1.0, width=12.0, scene=rough)
    loose = gr.solve(apart.updated({"loads": []}), progress=False)
    found = gr.coordination_number(loose)
    assert int(found["rattlers"][0]) == 1 and float(found["without_rattlers"][0]) == 2.0  # the floor and the upper one


def test_the_fabric_of_a_lattice_is_isotropic_in_the_bulk_and_has_trace_one(result):
    fabric = gr.fabric_tensor(result)
    np.testing.assert_allclose(fabric.values, np.swapaxes(fabric.values, 1, 2), atol=1e-15)
    np.testing.assert_allclose(np.trace(fabric.values, axis1=1, axis2=2), 1.0)
    n = result.rest.pair_normal()[result.rest.pairs.touching]
    assert float(fabric[0].sel(axis="x", other_axis="z")) == pytest.approx(np.mean(n[:, 0] * n[:, 1]))


def test_mobilization_is_one_where_contacts_slide(result):
    found = gr.mobilization(result)
    sliding = result.contacts["contact_status"].values == 2
    assert sliding.any()
    np.testing.assert_allclose(found["mobilization"].values[sliding], 1.0, atol=1e-9)
    open_ = result.contacts["contact_status"].values == 0
    assert np.isnan(found["mobilization"].values[open_]).all()
    assert np.isnan(found["wall_mobilization"]).all()  # smooth walls
    assert float(found["mobilization"].max()) <= 1.0 + 1e-9


def test_the_distribution_of_forces_has_its_mean_and_norm(result):
    density = gr.force_distribution(result, bins=4000, to=20.0)
    width = 20.0 / 4000
    assert float(density.sum()) * width == pytest.approx(1.0)
    assert float((density * density["force"]).sum()) * width == pytest.approx(1.0, abs=2e-3)
    closed = result.loaded[-1].pairs
    assert density.attrs["mean_force"] == pytest.approx(closed.normal_force[closed.touching].mean())
    for mistake in ({"bins": 0}, {"to": np.nan}):
        refuses(ValueError, "must be a", gr.force_distribution, result, **mistake)


def test_the_stiffness_matrix_answers_a_small_load(smooth):
    """K dq is the load, disk by disk, where it is so small that nothing else changes."""
    matrix = gr.stiffness_matrix(smooth, state=0)
    moved = (smooth.loaded[0].position - smooth.rest.position).ravel()
    force = (matrix @ moved).reshape(-1, 2)
    disk = int(smooth.to_dataset()["loaded_disk"][0])
    expected = np.zeros_like(force)
    expected[disk, 1] = -1e-3
    np.testing.assert_allclose(force, expected, atol=2e-7)
    # smooth floor contacts push along the normal alone
    walls = smooth.rest.walls
    assert np.allclose(wall_normals(walls.second)[walls.touching][:, 0] == 0.0, walls.second[walls.touching] == 0)


def test_modes_are_those_of_the_matrix(smooth, result):
    for one, sliding in ((smooth, "refuse"), (result, "stick")):
        found = gr.modes(one, 5, state=0, sliding=sliding)
        matrix = gr.stiffness_matrix(one, state=0, sliding=sliding).toarray()
        problem = one._solved.problem
        mass = 1.0 / problem.inverse_mass.reshape(problem.freedoms, -1).T.ravel()
        scale = 1.0 / np.sqrt(mass)
        values = np.linalg.eigvalsh(scale[:, None] * 0.5 * (matrix + matrix.T) * scale)
        np.testing.assert_allclose(found["frequency"] ** 2, values[:5], rtol=1e-6, atol=1e-9)
        x = found["displacement"].values.reshape(5, -1)
        np.testing.assert_allclose(x * mass @ x.T, np.eye(5), atol=1e-8)
    refuses(ValueError, r"^count = 107: must be a whole number from 1 to 106$", gr.modes, smooth, 107)


def test_two_disks_between_walls_have_all_four_modes():
    """The upper one leans on the right wall: in closed form, with the turn of the inclined contact under its force."""
    scene = {"contact": {"friction": 0.0}, "loads": []}
    pair = gr.solve(gr.Scene.from_arrays([1.0, 2.2], [1.0, 2.6], 1.0, width=3.2, scene=scene), progress=False)
    k, wall, (nx, nz) = 3000.0, 6000.0, pair.rest.pair_normal()[0]
    turn = pair.rest.pairs.normal_force[0] / (2.0 - pair.rest.pairs.overlap[0])
    contact = k * np.outer([nx, nz], [nx, nz]) - turn * np.outer([-nz, nx], [-nz, nx])
    matrix = np.block([[contact, -contact], [-contact, contact]]) + np.diag([wall, wall, wall, 0.0])
    np.testing.assert_allclose(gr.modes(pair, 4)["frequency"], np.sqrt(np.linalg.eigvalsh(matrix)), rtol=1e-9)
    alone = gr.solve(gr.Scene.from_arrays([3.0], [1.0], 1.0, width=6.0, scene=scene), progress=False)
    refuses(ValueError, r"^count = 6: no disk has two contacts$", gr.modes, alone)


def test_moduli_of_a_lattice_are_those_of_the_theory():
    """Lame's constants of the triangular lattice are both sqrt(3) / 4 k."""
    slab = gr.Slab(layers=12, disks_per_row=8, sides="periodic", lattice_constant=1.9995)
    scene = gr.Scene(packing=slab, contact=gr.Contact(friction=0.0, normal_stiffness=1e5), loads=[])
    found = gr.elastic_moduli(gr.solve(scene, progress=False), prestress=False)
    lame = np.sqrt(3.0) / 4.0 * 1e5
    np.testing.assert_allclose(found.values[:2, :2], lame * np.array([[3.0, 1.0], [1.0, 3.0]]), rtol=2e-3)
    for packing, said in (
        (gr.Slab(layers=3, disks_per_row=5), "packing.sides = walls: must be periodic"),
        (gr.Slab(layers=2, disks_per_row=5, sides="periodic"), "packing.layers = 2: must be 3 or greater"),
        (gr.Pile(layers=3), "packing.kind = pile: must be slab"),
    ):
        with pytest.raises(ValueError, match=f"^{re.escape(said)}"):
            gr.elastic_moduli(gr.solve(gr.Scene(packing=packing, loads=[]), progress=False))


def test_the_work_of_a_load_is_stored_or_slides_away(result, smooth):
    found = gr.work(result)
    total = found.sum("load")
    assert float(total["work"]) > 0.0 and (found["slid"] > -1e-12).all()
    np.testing.assert_allclose(total["dissipated"], total["slid"], atol=2e-3 * float(total["work"]))
    assert float(total["slid"]) > 10 * abs(float(total["dissipated"] - total["slid"]))
    lossless = gr.work(smooth)
    assert abs(float(lossless["dissipated"][0])) < 1e-9 and float(lossless["slid"][0]) == 0.0
    with pytest.raises(ValueError, match="no loads in this scene"):
        gr.work(gr.solve(gr.Scene(packing=gr.Slab(layers=2, disks_per_row=4), loads=[]), progress=False))


def test_a_stored_result_has_the_same_observables(result, tmp_path):
    result.save(tmp_path / "result.nc")
    back = gr.open_result(tmp_path / "result.nc")
    xr.testing.assert_identical(gr.work(back), gr.work(result))
    xr.testing.assert_identical(gr.mobilization(back), gr.mobilization(result))
    for name in ("coordination_number", "fabric_tensor", "force_distribution"):
        xr.testing.assert_identical(getattr(gr, name)(back), getattr(gr, name)(result))
    one, two = (gr.stiffness_matrix(each, sliding="stick") for each in (back, result))
    assert (one != two).nnz == 0


@pytest.mark.parametrize(
    ("x", "z", "radius"),
    [([1.0, 3.0, 2.0], [1.0, 1.0, 2.74], [1.0, 1.0, 1.0]), ([1.0, 3.5, 2.711], [1.0, 0.7, 2.536], [1.0, 0.7, 1.3])],
    ids=["equal", "unequal"],
)
def test_the_stress_of_a_disk_is_the_virial_of_its_contacts(x, z, radius):
    """Three disks on each other between walls, by the table of contacts; compression along z is positive."""
    scene = gr.Scene.from_arrays(x, z, radius, width=x[1] + radius[1], scene={"loads": []})
    found = gr.solve(scene.updated({"contact": {"friction": 0.5}, "wall": {"friction": 0.5}}), progress=False)
    state, radius = found.rest, found.to_dataset()["radius"].values
    expected = np.zeros((3, 2, 2))
    normal, walls = state.pair_normal(), wall_normals(state.walls.second)
    table = found.contacts_table(0)
    k, w = np.flatnonzero(state.pairs.touching), np.flatnonzero(state.walls.touching)
    for (_, row), (n, i, j) in zip(
        table.iterrows(),
        [(normal[c], state.pairs.first[c], state.pairs.second[c]) for c in k]
        + [(walls[c], state.walls.first[c], None) for c in w],
        strict=True,
    ):
        force = row.normal_force * n + row.tangential_force * np.array([-n[1], n[0]])
        at = np.array([row.x, row.z])
        expected[i] -= np.outer(force, at - state.position[i])
        if j is not None:
            expected[j] += np.outer(force, at - state.position[j])
    expected /= (np.pi * radius**2)[:, None, None]
    stress = gr.disk_stress(found, state=0)
    np.testing.assert_allclose(stress.values, expected, atol=1e-12)
    assert (stress.sel(force="z", branch="z") > 0.0).all() and stress.attrs["units"] == "mean_weight / mean_radius"


def test_the_stresses_of_disks_sum_to_the_stress_of_the_packing(result):
    """Areas times stresses are the sum of f d over all contacts, and what a load adds is the difference of forces."""
    state = result.loaded[-1]
    area = np.pi * result.to_dataset()["radius"].values ** 2
    total = (gr.disk_stress(result, added=False).values * area[:, None, None]).sum(axis=0)
    at_wall = state.position[state.walls.first]
    branch = [state.pair_separation(), at_wall - state.box.on_wall(at_wall, state.walls.second)]
    force = [state.pair_force(), state.wall_force()]
    expected = sum(f.T @ d for f, d in zip(force, branch, strict=True))
    np.testing.assert_allclose(total, expected, atol=1e-10)
    added = gr.disk_stress(result)
    assert abs(float(added.sum())) > 1.0  # and the geometry of the load hardly changes what gravity did
    apart = gr.disk_stress(result, added=False) - gr.disk_stress(result, state=0)
    np.testing.assert_allclose(added.values, apart.values, atol=0.02)
    refuses(ValueError, "added: a load adds nothing", lambda: gr.disk_stress(result, state=0, added=True))
