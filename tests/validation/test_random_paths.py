"""Paths of small random slabs that once went on for ever, by steps of 1e-4 or less of the load."""

from __future__ import annotations

import numpy as np
import pytest
from small_scenes import at_rest, pushed, scene

from granular_response.scene import Scene
from granular_response.solvers.path import PathRecord, follow


def drawn(seed: int) -> Scene:
    """A slab of one to five layers under a force on the disk in the middle of its top row, drawn from a seed."""
    g = np.random.default_rng(seed)
    law = str(g.choice(["linear", "hertz"]))
    sides = str(g.choice(["walls", "periodic"]))
    spread = float(g.choice([0.0, 0.02, 0.1, 0.2]))
    layers, row = int(g.integers(1, 6)), int(g.integers(3 if sides == "walls" else 5, 11))
    friction, wall_friction = float(g.choice([0.05, 0.2, 0.5, 1.0])), float(g.choice([0.0, 0.2, 0.5]))
    size = float(10 ** g.uniform(-2, 1.5))
    way = g.normal(size=2) * [0.3, 1.0]
    way[1] = -abs(way[1])
    way /= np.hypot(*way)
    if sides == "periodic" and wall_friction == 0.0:
        way = np.array([0.0, -1.0])
    packing = {"layers": layers, "disks_per_row": row, "sides": sides, "polydispersity": spread, "seed": seed}
    if spread > 0.0:
        packing["lattice_constant"] = "touching-largest"
    elif sides == "periodic":
        packing["lattice_constant"] = 1.9995
    return Scene.from_dict(
        {
            "packing": {"kind": "slab", **packing},
            "contact": {"law": law, "friction": friction},
            "wall": {"friction": wall_friction},
            "protocol": {"time_step": "auto"},
            "loads": [{"disk": "top-centre", "force": (size * way).tolist()}],
        }
    )


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(0, id="an event on another branch, beyond a limit point"),
        pytest.param(85, id="a contact that opens before the event that was found"),
        pytest.param(26, id="a contact that slides at no force"),
        pytest.param(32, id="the same, with few disks"),
        pytest.param(70, id="the same, with many contacts"),
    ],
)
def test_paths_end(seed):
    problem, rest = at_rest(drawn(seed))
    record = PathRecord()

    def check(_: float) -> None:
        assert record.increments < 150
        assert sum(event.lost for event in record.events) < 10

    (state,) = follow(problem, rest, [1.0], record=record, progress=check)
    assert state.certificate.stable


def test_a_path_of_no_length_ends():
    """Neighbours in a row touch at no force: whether they are closed is a matter of rounding, and so is stability."""
    ring = {"packing__sides": "periodic", "contact__friction": 0.5}
    problem, rest = at_rest(scene(3, 10, loads=pushed(0.0, -0.05), **ring))
    same, loaded = follow(problem, rest, [0.0, 1.0])
    assert same.certificate == rest.certificate and loaded.certificate.stable
