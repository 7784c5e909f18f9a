"""The loss of symmetry on a slab of 7 layers of 25 disks."""

import numpy as np
import pytest
import reduced

from granular_response_paper.groups.symmetry_breaking import simulate as study

PARAMETERS = reduced.parameters("symmetry_breaking")


def test_symmetry_is_lost_between_symmetric_and_asymmetric_runs(datasets):
    table, runs = datasets["brackets"], datasets["runs"]
    low, high = float(table["low"][0]), float(table["high"][0])
    assert 20.0 <= low < high <= 60.0
    assert high - low <= 20.0
    first = runs.isel(run=(runs["ramp_time"].values == 20.0) & (runs["time_step"].values == 5e-4))
    by_force = dict(zip(first["force"].values, first["asymmetry"].values, strict=True))
    assert by_force[low] <= 0.1 < by_force[high]
    assert by_force[20.0] < 1e-6


@pytest.mark.parametrize("guess", [(50.0, 60.0), (20.0, 25.0)])
def test_where_a_further_time_step_disagrees_all_forces_are_searched(datasets, guess):
    parameters = study.Parameters(**PARAMETERS)
    protocol = parameters.protocols[0]
    rest = study.rest_of(protocol.scene(parameters.scene, 5e-4))
    found = study.bracket(parameters, rest, protocol, 5e-4, guess)
    assert set(guess) & set(found.forces)  # tried
    table = datasets["brackets"]
    assert (found.event.low, found.event.high) == (float(table["low"][0]), float(table["high"][0]))


def test_the_sign_follows_a_displacement_and_its_mirror_image(datasets):
    copies = datasets["copies"]
    names = copies["name"].values.tolist()
    one, other = (names.index(f"displaced at random, seed 1{end}") for end in ("", ", mirror image"))
    assert float(copies["asymmetry"][one]) > 0.1
    assert int(copies["asymmetry_sign"][one]) == -int(copies["asymmetry_sign"][other]) != 0
    response = copies["floor_response"].values
    np.testing.assert_allclose(response[one], response[other][::-1], atol=1e-3)
