"""Packings from arrays: the same as from a file, stored with the scene, and the error for what cannot be."""

import numpy as np
import pytest
import xarray as xr
from refusals import refuses
from stress.random_scenes import write_table

import granular_response as gr
from granular_response.scene import FilePacking
from granular_response.scene.packing import exact_mean

PYRAMID = {"x": [1.0, 3.0, 5.0, 2.0, 4.0], "z": [1.0, 1.0, 1.0, 2.75, 2.75], "radius": 1.0}
QUIET = {"loads": [], "contact": {"friction": 0.0}}


def test_it_is_the_packing_of_a_file_with_these_numbers(tmp_path):
    table = np.random.default_rng(3).uniform([0.5, 0.5, 0.1], [9.0, 5.0, 0.4], (40, 3))
    write_table(tmp_path / "disks.csv", table)
    from_file = FilePacking(path=str(tmp_path / "disks.csv"), width=10.0).build()
    packing = gr.Scene.from_arrays(*table.T, width=10.0).packing.build()
    for name in ("position", "radius", "mass", "row"):
        assert np.array_equal(getattr(packing, name), getattr(from_file, name))
    assert packing.box == from_file.box


def test_columns_of_any_kind_and_lone_numbers():
    whole = gr.Scene.from_arrays(PYRAMID["x"], PYRAMID["z"], [1.0] * 5, mass=[2.0] * 5)
    x, z = xr.DataArray(PYRAMID["x"]).to_series(), np.array(PYRAMID["z"], np.float32)
    assert gr.Scene.from_arrays(x, z, 1, mass=2.0) == whole
    assert whole.packing.build().width == 6.0
    assert gr.Scene.from_arrays([11], [6], 1, origin=(10, 5)).packing.build().position.tolist() == [[1.0, 1.0]]


def test_a_stored_result_has_the_packing_and_goes_on(tmp_path):
    third = {"x": np.array(PYRAMID["x"]) / 3, "z": np.array(PYRAMID["z"]) / 3, "radius": 1 / 3}
    scene = gr.Scene.from_arrays(**third, scene={**QUIET, "loads": [{"disk": 4, "force": [0.0, -0.1]}]})
    assert gr.Scene.from_text(scene.to_yaml()) == scene
    result = gr.solve(scene)
    result.save(tmp_path / "own.nc")
    opened = gr.open_result(tmp_path / "own.nc")
    assert opened.scene == scene
    further = opened.continued([2.0]).loaded[-1]
    assert np.array_equal(further.position, result.continued([2.0]).loaded[-1].position)
    assert gr.plot.packing(opened).figure


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": [1, 3, 5, 2, -4]}, "packing.x[4] = -4.0: must be between the side walls 0 and 6"),
        ({"x": [1, 3, 5, 2, 1], "z": [1] * 5}, "packing.x[4] = 1.0: disk is in the same place as that of disk 0"),
        ({"z": [1, 1, np.nan, 2, 2]}, "packing.z[2] = nan: must be a finite number"),
        ({"z": [1, 1]}, "packing.z = [1.0, 1.0]: must have as many numbers as x, has 2, not 5"),
        ({"radius": [1, 1, 1, 1, 0]}, "packing.radius[4] = 0.0: must be greater than 0"),
        ({"x": "12345"}, "packing.x = '12345': must be a list of finite numbers, one for each disk"),
        ({"origin": (10.0, 0.0)}, "packing.x[0] = 1.0: must be between the side walls 10 and 6"),
        ({"sides": "periodic"}, "packing.width = null: must be given with periodic sides"),
        ({"scene": {"loads": [{"disk": 5, "force": [0, -1]}]}}, "loads[0].disk = 5: must be from 0 to 4"),
    ],
)
def test_mistakes_name_the_key_the_value_and_what_is_allowed(changes, message):
    assert refuses(gr.SceneError, None, gr.Scene.from_arrays, **{**PYRAMID, **changes}).startswith(message)


@pytest.mark.parametrize("light", [0, 2, 5])
def test_the_lightest_disk_that_is_allowed_is_stable_in_a_frictionless_stack(light):
    stack = {"x": [1.0] * 6, "z": [1.0 + 2.0 * k for k in range(6)], "radius": 1.0, "width": 2.0, "scene": QUIET}
    mass = [1e-6 if k == light else 1.0 for k in range(6)]
    assert gr.solve(gr.Scene.from_arrays(**stack, mass=mass), progress=False).certificate.stable
    mass[light] = 1e-8
    said = "must be at least 1e-06, a millionth of the largest"
    refuses(gr.SceneError, said, gr.Scene.from_arrays, **stack, mass=mass)


def test_a_mean_is_rounded_once_and_does_not_overflow():
    many = [0.1] * 10
    assert exact_mean(np.array(many)) == 0.1 != sum(many) / 10
    assert exact_mean(np.array([1e308, 1.5e308])) == pytest.approx(1.25e308, rel=1e-15)
