"""Sweeps and events by the public namespace alone."""

import io

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

import granular_response as gr
from granular_response.api.terminal import TerminalProgress
from granular_response.observe.events import EventNotBracketed
from granular_response.scene import SceneError
from granular_response.sweeps.errors import SweepError

SCENE = gr.Scene().updated({"packing.layers": 4, "packing.disks_per_row": 9, "contact.friction": 0.0})
DISORDERED = SCENE.updated(
    {
        "packing.polydispersity": 0.05,
        "packing.lattice_constant": "touching-largest",
        "protocol.integrator": "verlet",
        "protocol.time_step": "auto",
        "protocol.stop_kinetic_energy": 1e-9,
    }
)


def response_at(changes):
    return gr.solve(SCENE.updated(changes)).floor_response.values


def test_a_sweep_is_one_dataset_on_common_axes():
    frictions, layers = [0.0, 0.3], (3, 5)
    found = gr.sweep(
        SCENE,
        {"contact.friction": frictions, "packing.layers": layers},
        lambda result: {"largest": result.floor_response.max(), "disks": len(result.rest.position)},
        workers=2,
        progress=False,
    )
    assert found["largest"].dims == found["disks"].dims == ("friction", "layers")
    assert found["friction"].values.tolist() == frictions and found["layers"].values.tolist() == [3, 5]
    assert found["friction"].attrs["key"] == "contact.friction"
    assert found["disks"].dtype.kind == "i" and "error" not in found
    for friction in frictions:
        for rows in layers:
            expected = response_at({"contact.friction": friction, "packing.layers": rows}).max()
            assert found["largest"].sel(friction=friction, layers=rows) == expected


def test_the_floor_response_is_measured_where_nothing_is_named(tmp_path):
    found = gr.sweep(DISORDERED, {"packing.realization": range(3)}, workers=1, progress=False)
    assert found["floor_response"].dims == ("realization", "floor_disk")
    assert found["x"].dims == ("realization", "floor_disk")  # disks lie elsewhere in each
    assert "x" in found.coords
    one = gr.solve(DISORDERED.updated({"packing.realization": 2})).floor_response
    np.testing.assert_array_equal(found["floor_response"].sel(realization=2), one)
    np.testing.assert_array_equal(found["x"].sel(realization=2), one["x"])
    found.to_netcdf(tmp_path / "sweep.nc")
    assert xr.open_dataset(tmp_path / "sweep.nc").equals(found)


def test_what_has_another_length_is_filled_up():
    def responses(result):
        return {"floor": result.floor_response, "plain": result.floor_response.values}

    found = gr.sweep(SCENE, {"packing.disks_per_row": [7, 9]}, responses, workers=1, progress=False)
    assert found["floor"].sizes == {"disks_per_row": 2, "floor_disk": 9}
    assert found["plain"].sizes == {"disks_per_row": 2, "plain_0": 9}
    for name in ("floor", "plain"):
        assert np.isnan(found[name].values).sum(axis=1).tolist() == [2, 0]
    assert "plain_0" not in found.coords


def test_values_of_every_kind_are_coordinates():
    loads = [[{"disk": "top-centre", "force": [0.0, -force]}] for force in (0.5, 1.0)]
    axes = {
        "loads": loads,
        "packing.lattice_constant": [2.0, "touching-largest"],
        "contact.normal_stiffness": np.array([150.0]),
        "wall.normal_stiffness": [200.0],
    }
    found = gr.sweep(SCENE, axes, lambda result: result.loaded[-1].load_factor, workers=1, progress=False)
    shape = {"loads": 2, "lattice_constant": 2, "contact_normal_stiffness": 1, "wall_normal_stiffness": 1}
    assert found["measure"].sizes == shape
    assert found["loads"].values.tolist() == [0, 1]
    assert found["lattice_constant"].values.tolist() == ["2.0", "touching-largest"]


def test_a_combination_without_equilibrium_is_missing_and_says_why():
    up = [[{"disk": "top-centre", "force": [0.0, force]}] for force in (-1.0, 30.0)]

    def measured(result):
        return {"largest": result.floor_response.max(), "settled": True, "name": "x"}

    with pytest.warns(UserWarning, match=r"1 of 2 combinations have no equilibrium, see the variable error; .*lifts"):
        found = gr.sweep(SCENE, {"loads": up}, measured, workers=1, progress=False)
    assert found["largest"].isnull().values.tolist() == [False, True]
    assert found["settled"].values[0] == 1.0 and np.isnan(found["settled"].values[1])
    assert found["name"].values.tolist() == ["x", ""]
    assert found["error"].values[0] == "" and "lifts disk" in found["error"].values[1]
    with pytest.raises(SweepError, match=r"none of 1 combinations has an equilibrium, the first: .*lifts disk"):
        gr.sweep(SCENE, {"loads": up[1:]}, workers=1, progress=False)


@pytest.mark.parametrize(
    ("axes", "measure", "error", "said"),
    [
        ({"contact.frition": [0.1]}, None, SceneError, r"frition.*friction"),
        ({"contact.friction": [0.1, -1]}, None, SceneError, r"contact.friction = -1"),
        ({"contact.friction": []}, None, ValueError, r"contact.friction has no values"),
        ({"contact.friction": [0.1, 0.1]}, None, ValueError, r"contact.friction has a value twice"),
        ({"contact.friction": [0.1]}, lambda result: 1 / 0, SweepError, r"task 1 of 1 .*ZeroDivisionError"),
        ({"contact.friction": [0.1]}, lambda result: result, SweepError, r"measure is a Result, must be a number"),
        ({"contact.friction": [0.1]}, lambda result: {"friction": 1}, SweepError, r"friction is the name of an axis"),
    ],
)
def test_mistakes_are_one_line(axes, measure, error, said):
    with pytest.raises(error, match=said) as caught:
        gr.sweep(SCENE, axes, *filter(None, [measure]), workers=1, progress=False)
    assert "\n" not in str(caught.value)


def test_a_sweep_continues_from_its_checkpoint(tmp_path):
    calls = []

    def count(done, total, what):
        calls.append((done, total, what))

    def largest(result):
        return result.floor_response.max()

    one = gr.sweep(SCENE, {"contact.friction": [0.0]}, largest, workers=1, checkpoint=tmp_path, progress=count)
    two = gr.sweep(SCENE, {"contact.friction": [0.0, 0.1]}, largest, workers=1, checkpoint=tmp_path, progress=count)
    assert calls == [(0, 1, "scenes"), (1, 1, "scenes"), (1, 2, "scenes"), (2, 2, "scenes")]
    assert one["floor_response"][0] == two["floor_response"][0]


def opened(result):
    return bool((result.rest.pairs.touching & ~result.loaded[-1].pairs.touching).any())


def test_an_event_along_the_load_is_bracketed():
    bracket = gr.find_event(SCENE, opened, 0.01, 1.0, tolerance=0.002, progress=False)
    assert bracket.width <= 0.002 and bracket.at_low is False
    assert not opened(gr.solve(SCENE, load_factors=[bracket.low]))
    assert opened(gr.solve(SCENE, load_factors=[bracket.high]))


def test_an_event_along_a_key_is_bracketed():
    ends = [response_at({"contact.friction": friction}).max() for friction in (0.0, 1.0)]

    def beyond_the_middle(result):
        return bool((result.floor_response.max() > np.mean(ends)) == (ends[1] > ends[0]))

    calls = []
    bracket = gr.find_event(
        SCENE, beyond_the_middle, 0.0, 1.0, key="contact.friction", tolerance=0.2,
        progress=lambda *call: calls.append(call),
    )  # fmt: skip
    assert bracket.width <= 0.2 and bracket.at_low is False
    assert not beyond_the_middle(gr.solve(SCENE.updated({"contact.friction": bracket.low})))
    assert beyond_the_middle(gr.solve(SCENE.updated({"contact.friction": bracket.high})))
    assert calls == [(done, bracket.evaluations, "event") for done in range(bracket.evaluations + 1)]


@pytest.mark.parametrize(
    ("arguments", "error", "said"),
    [
        ((0.0, 1.0), ValueError, r"low = 0.0: must be greater than 0"),
        ((1.0, 0.5), ValueError, r"low below high"),
        ((0.001, 0.002), EventNotBracketed, r"is False at both"),
    ],
)
def test_mistakes_of_an_event_are_one_line(arguments, error, said):
    with pytest.raises(error, match=said):
        gr.find_event(SCENE, opened, *arguments, progress=False)


def test_progress_in_a_notebook_is_a_line_of_text():
    stream = io.StringIO()
    with TerminalProgress(Console(file=stream, force_jupyter=True), patience=0) as progress:
        for done in range(4):
            progress(done, 3, "scenes")
    assert stream.getvalue().startswith("\rscenes: 0 of 3, 0 s ")
    assert stream.getvalue().endswith("\rscenes: 3 of 3, 0 s \n")
