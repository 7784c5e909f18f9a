"""Preparations as descriptions, and the band of a response over them."""

import numpy as np
import pytest

import granular_response as gr
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.solvers.taps import tapped
from granular_response.sweeps import rest

SLAB = gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9), loads=[gr.Load(disk="top-centre", force=(0, -4))])
TAPPED = SLAB.updated({"preparation": gr.Preparation(gravity="slow", ramp_time=20.0, taps=gr.Taps(number=2))})


def test_a_scene_is_tapped_after_it_has_come_to_rest():
    state = rest_state(Problem.from_scene(TAPPED))
    problem = Problem.from_scene(TAPPED.updated({"preparation.taps": None}))
    untapped = rest_state(problem)
    expected = tapped(problem, untapped, 2, 0.5, 3.0)
    np.testing.assert_array_equal(state.position, expected.position)
    assert np.abs(state.walls.normal_force - untapped.walls.normal_force).max() > 1e-3
    assert state.certificate.stable
    assert rest.name(Problem.from_scene(TAPPED)) != rest.name(problem)


def test_taps_are_written_only_where_there_are_some():
    assert "taps" not in SLAB.to_dict()["preparation"]
    assert gr.Scene.from_text(TAPPED.to_yaml()) == TAPPED
    assert SLAB.updated({"preparation.taps.number": 3}).preparation.taps == gr.Taps(number=3)
    units = gr.LaboratoryUnits()
    data = {"preparation": {"taps": {"amplitude": 1.5, "duration": 3.0 * units.time}}}
    assert units.reduced_scene(data)["preparation"]["taps"] == {"amplitude": 1.5, "duration": pytest.approx(3.0)}


def test_a_start_without_friction_is_tapped_with_friction_only():
    smooth = TAPPED.updated({"preparation.gravity": "frictionless", "preparation.taps.number": 1})
    problem = Problem.from_scene(smooth.updated({"preparation.taps": None}))
    expected = tapped(problem, rest_state(problem), 1, 0.5, 3.0)
    np.testing.assert_array_equal(rest_state(Problem.from_scene(smooth)).position, expected.position)


def test_the_band_is_that_of_the_responses():
    ways = {
        "at once": {},
        "slow": gr.Preparation(gravity="slow", ramp_time=20.0),
        "smooth": {"gravity": "frictionless"},
    }
    found = gr.preparations(SLAB, ways, workers=1, progress=False)
    assert found["preparation"].values.tolist() == ["at once", "slow", "smooth"]
    alone = gr.solve(SLAB.updated({"preparation.gravity": "frictionless"}), progress=False)
    np.testing.assert_array_equal(found["floor_response"].sel(preparation="smooth"), alone.floor_response)
    responses = found["floor_response"].values
    np.testing.assert_array_equal(found["floor_response_low"], responses.min(axis=0))
    np.testing.assert_array_equal(found["floor_response_high"], responses.max(axis=0))
    assert (found["floor_response_high"] - found["floor_response_low"]).max() > 1e-3
    assert found["floor_response_low"].attrs == found["floor_response"].attrs


def test_a_band_is_that_of_one_disk():
    """Other disks reach the floor, and another one is on top, where the packing rearranges as it comes to rest."""
    load = [gr.Load(disk="top-centre", force=(0, -2))]
    heap = gr.Scene(packing=gr.Poured(disks=40, width=14.0, seed=0), contact=gr.Contact(friction=0.5), loads=load)
    ways = {"at once": {}, "smooth": {"gravity": "frictionless"}}
    with pytest.warns(
        UserWarning, match=r"^loads are on other disks in other preparations \(at once: \[39\], smooth: "
    ):
        found = gr.preparations(heap, ways, workers=1, progress=False)
    for way, changes in ways.items():
        alone = gr.solve(heap.updated({"preparation": changes}), progress=False).floor_response
        here = found["floor_response"].sel(preparation=way, floor_disk=alone["floor_disk"].values)
        assert here.dims == alone.dims
        np.testing.assert_array_equal(here, alone)
        assert found["floor_response"].sel(preparation=way).count() == alone.count()
    assert (np.diff(found["x"].mean("preparation")) > 0.0).all()


@pytest.mark.parametrize(
    ("ways", "said"),
    [
        ({}, r"ways = {}: must be a mapping of names to preparations"),
        ([gr.Preparation()], r"ways = \[.*\]: must be a mapping"),
        ({"a": {"gravity": "sloow"}}, r"ways\['a'\]: preparation.gravity = 'sloow': must be .*did you mean slow"),
        ({"a": {}, "b": gr.Preparation()}, r"ways\['b'\]: is the same as 'a'; keys that are left out are those of the"),
        ({"a": 3}, r"ways\['a'\]: preparation = 3: must be a mapping with keys"),
    ],
)
def test_ways_that_are_none(ways, said):
    with pytest.raises(gr.SceneError, match=f"^{said}"):
        gr.preparations(SLAB, ways)
