"""Scenes and results that are copied, sent to other processes, and solved by several threads or in an event loop."""

import asyncio
import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import granular_response as gr

SCENE = {
    "packing": {"kind": "slab", "layers": 3, "disks_per_row": 5},
    "contact": {"friction": 0.3},
    "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
}


def numbers(result: gr.Result) -> list[np.ndarray]:
    """Positions and normal forces of all states, and the response."""
    states = (result.rest, *result.loaded)
    return [*(s.position for s in states), *(s.pairs.normal_force for s in states), result.floor_response.values]


@pytest.fixture(scope="module")
def solved() -> gr.Result:
    return gr.solve(SCENE)


def test_threads_that_solve_at_once_have_the_bits_of_one(solved):
    frictions = [0.3, 0.1, 0.3, 0.0]
    scenes = [{**SCENE, "contact": {"friction": friction}} for friction in frictions]
    alone = {friction: gr.solve(scene) for friction, scene in zip(frictions[1:], scenes[1:], strict=True)}
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(gr.solve, scenes))
    for friction, result in zip(frictions, together, strict=True):
        for one, other in zip(numbers(result), numbers(alone[friction]), strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_copies_of_scenes_and_results_are_the_same(solved, tmp_path, again):
    assert again(solved.scene) == solved.scene
    solved.save(tmp_path / "a.nc")
    for result in (solved, gr.open_result(tmp_path / "a.nc")):
        for one, other in zip(numbers(again(result)), numbers(result), strict=True):
            np.testing.assert_array_equal(one, other)


def test_a_sweep_runs_within_a_running_event_loop(solved):
    """As in a notebook."""

    async def swept():
        return gr.sweep(SCENE, {"contact.friction": [0.3]}, workers=2, progress=False)

    found = asyncio.run(swept())["floor_response"].sel(friction=0.3)
    np.testing.assert_array_equal(np.ravel(found.values), np.ravel(solved.floor_response.values))
