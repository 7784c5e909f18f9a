"""Results as others read them, and sealed files that are no results."""

import re

import numpy as np
import pytest
import xarray as xr
from commands import refused, succeeded
from refusals import refuses
from small_scenes import pushed, scene
from spoilt import spoil

import granular_response as gr
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.checked import checked, read_result
from granular_response.store.result import ResultError, load_coordinates, to_dataset


@pytest.fixture(scope="module")
def solution():
    return solve_scene(scene(contact__friction=0.3, loads=pushed(0.5, -3.0)), load_factors=(0.5, 1.0, 2.0))


@pytest.fixture(scope="module")
def path(solution, tmp_path_factory):
    path = tmp_path_factory.mktemp("checked") / "result.nc"
    store.write(path, to_dataset(solution))
    return path


@pytest.mark.parametrize("factors", [[], [1.0]], ids=["no load", "one load"])
def test_load_is_a_dimension_for_any_number_of_loads(solution, factors):
    scene = solution.scene if factors else solution.scene.updated({"loads": []})
    data = to_dataset(solve_scene(scene, load_factors=factors or None))
    for name in ("floor_force", "floor_force_change", "floor_response"):
        assert data[name].dims == ("load", "floor_disk") and data.sizes["load"] == len(factors)
    assert data["load_factor"].values.tolist() == factors
    assert checked(data).identical(data)


@pytest.mark.parametrize(
    ("factors", "branches"),
    [
        ([1, 2, 1, 0, 1, 2, 3], "loading loading unloading unloading reloading reloading loading"),
        ([1, 1, 0.5, 0.5], "loading loading unloading unloading"),
        ([1, -1, -0.5, 1, 2], "loading loading unloading reloading loading"),
        ([0, 1], "loading loading"),
    ],
)
def test_each_load_has_its_branch(factors, branches):
    assert load_coordinates(factors)["branch"].values.tolist() == branches.split()


def test_codes_say_what_they_mean(path):
    with xr.open_dataset(path) as plain:
        for name, meanings in (
            ("contact_status", "open sticking sliding"),
            ("wall_status", "open sticking sliding"),
            ("wall_index", "floor left_wall right_wall"),
        ):
            attributes = plain[name].attrs
            assert attributes["flag_meanings"] == meanings and attributes["flag_values"].tolist() == [0, 1, 2]
            assert attributes["flag_values"].dtype == plain[name].dtype


def test_force_vectors_carry_weight_and_load(path):
    with xr.open_dataset(path) as data:
        for k, factor in enumerate(data["state_load_factor"].values):
            total = np.zeros((data.sizes["disk"], 2))
            np.add.at(total, data["contact_disk"].values, data["contact_force"].values[k])
            np.add.at(total, data["contact_partner"].values, -data["contact_force"].values[k])
            np.add.at(total, data["wall_disk"].values, data["wall_force"].values[k])
            total[:, 1] -= data["mass"].values
            total[data["loaded_disk"].values] += factor * data["applied_load"].values[:, :2]
            np.testing.assert_allclose(total, 0.0, atol=1e-9)


def test_what_another_program_writes_is_shown_as_not_sealed_and_exported(solution, path, tmp_path):
    to_dataset(solution).to_netcdf(tmp_path / "by_xarray.nc")
    altered = xr.load_dataset(path)
    altered["floor_response"] = 2.0 * altered["floor_response"]
    altered.to_netcdf(tmp_path / "altered.nc")
    shown = {file: succeeded("show", file, folder=tmp_path) for file in (path, "by_xarray.nc", "altered.nc")}
    said = "not sealed: rewritten by another program, so its numbers are not guaranteed\n"
    assert [text.count(said) for text in shown.values()] == [0, 1, 1] and "not sealed" not in shown[path]
    assert "max. unbalanced force" in shown["by_xarray.nc"]
    succeeded("export", "by_xarray.nc", "-o", "a.xyz", folder=tmp_path)
    refused("plot", "altered.nc", "-o", "a.png", folder=tmp_path)
    xr.Dataset({"a": ("n", [1.0])}).to_netcdf(tmp_path / "foreign.nc")
    refused("show", "foreign.nc", folder=tmp_path)


DAMAGE = {
    "a missing variable": (lambda d: d.drop_vars("wall_index"), "variable wall_index is missing"),
    "a partner that is not there": (lambda d: spoil(d, "contact_partner", 99), "contact_partner: holds 99, must"),
    "other dimensions": (lambda d: d.assign(angle=d["angle"].T), "variable angle: has dimensions disk, state"),
    "words": (lambda d: d.assign(mass=d["mass"].astype(str)), "variable mass: has values of type"),
    "no states": (lambda d: d.isel(state=slice(0)), "must have a state"),
    "a load too many": (lambda d: d.isel(state=slice(3)), "dimension load: must have 2 entries"),
    "no scene": (lambda d: d.drop_attrs(deep=False), "attribute scene is missing"),
    "deep JSON": (lambda d: d.assign_attrs(method="[" * 100_000 + "]" * 100_000), "attribute method: must be"),
    "half a certificate": (lambda d: d.drop_vars("certificate_loose_disks"), "variable certificate_loose_disks is"),
    "far away": (lambda d: spoil(d, "position", 1e300), "variable position: must be at most 1e+09 mean radii away"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_sealed_file_that_is_no_result(solution, tmp_path, damage):
    change, said = DAMAGE[damage]
    store.write(tmp_path / "bad.nc", change(to_dataset(solution)))
    with pytest.raises(ResultError, match=r"^[^\n]*bad\.nc: is not a whole result: [^\n]*$") as caught:
        read_result(tmp_path / "bad.nc")
    assert said in str(caught.value)
    refuses(ResultError, None, gr.open_result, tmp_path / "bad.nc")


@pytest.mark.parametrize("layout", [2, 4])
def test_a_result_of_another_layout_is_refused_in_one_line(solution, path, tmp_path, monkeypatch, layout):
    with monkeypatch.context() as other:
        other.setattr(store, "FORMAT", f"granular_response {layout}")
        store.write(tmp_path / "other.nc", to_dataset(solution))
    said = f"other.nc: was written by another version: format = 'granular_response {layout}', must be {store.FORMAT!r}"
    refuses(store.StoreError, re.escape(said), gr.open_result, tmp_path / "other.nc")
    assert said in refused("show", "other.nc", folder=tmp_path)
