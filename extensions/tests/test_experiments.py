"""Packings of the experiments at small size, from parameters through a file."""

import numpy as np
import pytest
import reduced

from granular_response.observe.stress import contact_forces, line_forces
from granular_response.state import FLOOR
from granular_response.studies import LoadPath
from granular_response_extensions.experiments import simulate
from granular_response_extensions.experiments.parameters import Parameters


def test_lines_bear_the_load(datasets):
    packings = datasets["packings"]
    assert float(packings["imbalance"].max()) < 1e-7 and (packings["moved"] < 2.0).all()


def test_a_line_with_side_walls_bears_load_and_weight():
    """All forces of a loaded state, by hand: the line, the side walls above it, the weights and the load."""
    asked = Parameters(**reduced.parameters("experiments"))
    path = LoadPath.of(asked.scene_of(asked.cases[2], 0))
    state, radius = path.at(3.0), path.problem.packing.radius
    weight = radius**2 / np.mean(radius**2)
    for height in (2.0, 5.0):
        above = state.position[:, 1] > height
        walls = (state.walls.second != FLOOR) & above[state.walls.first]
        load = 3.0 * above[int(path.problem.load_disk[0])]
        borne = line_forces(contact_forces(state), height)[1].sum() + state.wall_force()[walls, 1].sum()
        assert borne == pytest.approx(weight[above].sum() + load, abs=1e-6)


def test_statistics_of_known_profiles():
    """Rays at 60 degrees, and a stress whose width is as the depth."""
    asked = Parameters(**reduced.parameters("experiments") | {"reach": 60, "depths": 20, "ring": [6.0, 12.0]})
    x, depth = np.arange(-60.0, 60.5, 0.5), np.arange(1.0, 21.0)[:, None]
    rays = sum(np.exp(-((x + sign * depth / np.sqrt(3.0)) ** 2)) for sign in (-1.0, 1.0))
    stress = 2.0 / np.pi / depth / (1.0 + (x / depth) ** 2) ** 2
    found = simulate.statistics(asked, x, 25.0, rays, stress)
    assert abs(found["chain"] - 60.0) <= 1.0 and found["contrast"] > 3.0 and found["dip"] == 0.0
    assert found["power"][:, 0] == pytest.approx([1.0, 1.0], abs=0.02)
    assert found["slope"] == pytest.approx([np.sqrt(np.sqrt(2.0) - 1.0), 0.4417], abs=0.01)
