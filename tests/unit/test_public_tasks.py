"""What people came for, from question to answer with ``import granular_response as gr`` and xarray alone."""

import ast
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import granular_response as gr

SLAB = gr.Scene().updated({"packing.layers": 5, "packing.disks_per_row": 21, "wall.friction": 0.0})


def test_this_file_needs_the_public_namespace_alone():
    tree = ast.parse(Path(__file__).read_text())
    names = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert names == {"ast", "granular_response", "numpy", "pathlib", "pytest", "xarray"}
    used = {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "gr"
    }
    assert used <= {*gr.__all__, "__all__"}


@pytest.fixture(scope="module")
def unloaded() -> gr.Result:
    """Loaded and unloaded again, with friction that slides."""
    scene = SLAB.updated({"contact.friction": 0.2, "loads": [{"disk": "top-centre", "force": [0.0, -8.0]}]})
    return gr.solve(scene, load_factors=[0.5, 1.0, 0.5, 0.0])


def test_unloading_leads_along_another_branch(unloaded):
    up, down = unloaded.floor_response.sel(load=0.5).values
    assert np.abs(up - down).max() > 1e-3
    assert up.sum() == pytest.approx(1.0, abs=1e-8) and down.sum() == pytest.approx(1.0, abs=1e-8)
    assert all(certificate.stable and certificate.force_residual < 1e-10 for certificate in unloaded.certificates)


def test_a_load_is_selected_by_its_factor(unloaded):
    response = unloaded.floor_response
    np.testing.assert_array_equal(response.sel(load=1.0), response.isel(load=1))
    assert response.sel(load=0.5).sizes["load"] == 2  # on the way up and down
    with pytest.raises(KeyError):
        response.sel(load=2.0)


def test_a_sweep_over_realizations_has_a_mean_with_an_error():
    scene = SLAB.updated(
        {
            "packing.layers": 4,
            "packing.disks_per_row": 9,
            "packing.polydispersity": 0.05,
            "packing.lattice_constant": "touching-largest",
            "contact.friction": 0.0,
            "loads": [{"disk": "top-centre", "force": [0.0, -0.5]}],
        }
    )
    axes = {"contact.friction": [0.0, 0.2], "packing.realization": range(3)}
    found = gr.sweep(scene, axes, lambda result: {"largest": result.floor_response.max()}, workers=1, progress=False)
    mean = found["largest"].mean("realization")
    error = found["largest"].std("realization", ddof=1) / np.sqrt(3)
    assert mean.dims == error.dims == ("friction",) and bool((error > 0.0).all()) and bool((error < mean).all())


def test_a_crossover_is_bracketed_by_bisection():
    """The force beyond which the response is largest beside the middle."""

    def two_peaks(result: gr.Result) -> bool:
        response = result.floor_response
        last = response.isel(load=-1) if "load" in response.dims else response
        middle = last.size // 2
        return bool(last.values[:middle].max() > last.values[middle])

    scene = SLAB.updated({"contact.friction": 0.0, "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}]})
    found = gr.find_event(scene, two_peaks, 0.05, 8.0, tolerance=0.05)
    assert 0.0 < found.low < found.high and found.high - found.low <= 0.05


def test_the_stress_of_a_load_is_a_map(unloaded):
    stress = unloaded.stress(state=2)
    assert {"x", "z", "force", "branch"} == set(stress.dims)
    vertical = stress.sel(force="z", branch="z")
    x, z = np.meshgrid(vertical["x"], vertical["z"])
    top = z > vertical["z"].values.mean()
    largest = np.unravel_index(np.abs(np.where(top, vertical.transpose("z", "x").values, 0.0)).argmax(), x.shape)
    assert abs(x[largest]) < 3.0  # it is largest below the load
    axes = gr.plot.stress(unloaded, state=2)
    assert axes.figure


def test_a_packing_of_another_program_is_solved(tmp_path):
    """Disks of equal size on a floor in a row, in the format of LAMMPS."""
    atoms = "\n".join(f"{k + 1} 1 2.0 1.0 {1.0 + 2.0 * k} 1.0 0.0" for k in range(4))
    head = "a row of disks\n\n4 atoms\n1 atom types\n\n0.0 8.0 xlo xhi\n0.0 4.0 ylo yhi\n-1.0 1.0 zlo zhi\n"
    (tmp_path / "row.data").write_text(f"{head}\nAtoms # sphere\n\n{atoms}\n")
    packing = {"kind": "file", "path": str(tmp_path / "row.data"), "width": 8.0, "origin": [0.0, 0.0]}
    result = gr.solve({"packing": packing, "contact": {"friction": 0.0}, "loads": [{"disk": 1, "force": [0.0, -1.0]}]})
    assert result.floor_response.values.tolist() == pytest.approx([0.0, 1.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("stiffness", [300.0, 1e6])
def test_a_step_that_is_left_out_is_stable(stiffness):
    changes = {"packing.layers": 3, "packing.disks_per_row": 5, "contact.normal_stiffness": stiffness}
    scene = gr.Scene().updated({**changes, "protocol.method": "dynamics", "loads": []})
    result = gr.solve(scene)
    assert result.certificate.stable and result.certificate.force_residual < 1e-8


def test_a_stored_result_is_read_without_this_package(unloaded, tmp_path):
    unloaded.save(tmp_path / "result.nc")
    with xr.open_dataset(tmp_path / "result.nc") as plain:
        np.testing.assert_array_equal(plain["floor_response"].sel(load=1.0), unloaded.floor_response.isel(load=1))
    back = gr.open_result(tmp_path / "result.nc")
    xr.testing.assert_equal(back.floor_response, unloaded.floor_response)


def test_a_result_goes_on_from_where_it_was(unloaded):
    further = unloaded.continued([1.0])
    assert further.load_factors == (0.5, 1.0, 0.5, 0.0, 1.0) and further.certificate.stable


def test_every_picture_of_a_result_is_one_call(unloaded):
    for draw in (gr.plot.response, gr.plot.forces, gr.plot.contacts, gr.plot.stress, gr.plot.packing):
        assert draw(unloaded).figure
    assert len(gr.plot.page(unloaded).axes) >= 4
