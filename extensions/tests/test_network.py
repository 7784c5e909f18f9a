"""Contact networks of small slabs, from parameters through a file; counts made two ways."""

import numpy as np
import pytest
import reduced

from granular_response.observe import network
from granular_response.studies import LoadPath
from granular_response_extensions.network import simulate
from granular_response_extensions.network.parameters import Parameters
from granular_response_paper.ensembles.realizations import ensemble_scene


def test_distributions_are_normalised(datasets):
    data = datasets["statistics"]
    assert np.nanmax(np.abs(data["force_mean"] - 1.0)) < 1e-12
    assert np.nanmax(data["force_density"].sum("force")) * np.diff(simulate.FORCES)[0] <= 1.0 + 1e-12
    rough = data["mobilization_density"].sel(friction=0.2, state="rest").sum("mobilization")
    assert rough.values * np.diff(simulate.MOBILIZATION)[0] == pytest.approx(1.0)
    assert np.isnan(data["mobilization_density"].sel(friction=0.0)).all()
    assert data["angle_density"].sel(state="rest").sum("angle").values * np.pi / simulate.ANGLES == pytest.approx(1.0)


def test_every_cut_bears_what_rests_on_it(datasets):
    assert np.nanmax(datasets["statistics"]["cut_imbalance"]) < 1e-8


@pytest.fixture(scope="module")
def paths():
    """One packing of each case."""
    asked = Parameters(**reduced.parameters("network"))
    return [LoadPath.of(ensemble_scene(asked, case, 0)) for case in asked.cases.values()]


def test_rattlers_are_the_disks_with_fewer_than_two_forces(paths):
    """Forces in place of statuses and of removing again and again."""
    for path in paths:
        rest = path.rest
        force = np.concatenate([rest.pairs.normal_force, rest.pairs.normal_force, rest.walls.normal_force])
        ends = np.concatenate([rest.pairs.first, rest.pairs.second, rest.walls.first])
        bearing = np.bincount(ends[force > 0.0], minlength=len(rest.position)) >= 2
        assert np.array_equal(bearing, ~network.rattlers(rest))


def test_coordination_is_that_of_a_count_by_hand(datasets, paths):
    """Disk by disk in sets, in place of arrays."""
    stored = datasets["statistics"]["coordination_number"].isel(realization=0).sel(state="rest").values.ravel()
    for path, expected in zip(paths, stored, strict=True):
        rest = path.rest
        near = {disk: [] for disk in range(len(rest.position))}
        for i, j in zip(rest.pairs.first[rest.pairs.touching], rest.pairs.second[rest.pairs.touching], strict=True):
            near[int(i)].append(int(j))
            near[int(j)].append(int(i))
        for k in np.flatnonzero(rest.walls.touching):
            near[int(rest.walls.first[k])].append("wall")
        while loose := [disk for disk, others in near.items() if len(others) < 2]:
            for disk in loose:
                for other in near.pop(disk):
                    if other in near:
                        near[other].remove(disk)
        contacts = sum(2.0 if other == "wall" else 1.0 for others in near.values() for other in others)
        assert contacts / len(near) == pytest.approx(expected, abs=1e-12)
