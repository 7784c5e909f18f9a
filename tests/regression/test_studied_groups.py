"""What studies of the paper find at reduced size beyond the numbers and pictures that ``test_groups.py`` compares."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import reduced
from PIL import Image

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.sweeps.rest import rest_of
from granular_response_paper.ensembles import AT_REST, COLLAPSED, FAILED, NOT_REACHED, realizations
from granular_response_paper.groups.frictionless_crossover.simulate import (
    OrderedSlab,
    Parameters,
    new_neighbours,
    settle,
)
from granular_response_paper.groups.polydisperse_averages import draw
from granular_response_paper.groups.polydisperse_averages import simulate as averages
from granular_response_paper.groups.superposition.simulate import load_pair
from granular_response_paper.groups.symmetry_breaking import simulate as breaking
from granular_response_paper.pipeline import drawing

BASE = Parameters(**reduced.parameters("frictionless_crossover")).base


@pytest.fixture
def of(tmp_path_factory):
    """The datasets of a group."""
    return partial(reduced.datasets, factory=tmp_path_factory)


def test_the_animation_stands_beside_its_picture(tmp_path, tmp_path_factory):
    paths = drawing.draw("overview", reduced.stored("overview", tmp_path_factory), tmp_path)
    assert tmp_path / "growing_force.gif" in paths and (tmp_path / "growing_force.png").exists()
    with Image.open(tmp_path / "growing_force.gif") as image:
        assert image.n_frames == 3


def test_the_frictionless_pile_has_two_minima(of) -> None:
    """Floor forces of a minimum known from an independent code: 8.34 in the middle, 9.15 and 9.08 beside it."""
    floor = of("pile_dip")["piles"]["floor_force"].values
    middle = floor.shape[1] // 2
    found = [floor[0, middle], floor[0, :middle].max(), floor[0, middle + 1 :].max()]
    np.testing.assert_allclose(found, [8.34, 9.15, 9.08], atol=0.005)
    for one, other, near in ((0, 1, 1e-8), (2, 2, 1e-9)):  # the minima are mirror images, with friction it is its own
        np.testing.assert_allclose(floor[one], floor[other][::-1], atol=near)


def test_paths_agree_with_the_protocol_of_the_paper(of) -> None:
    """Dynamics from rest to the force, in place of a path: a different history, nearly the same responses."""
    changes = {"protocol.method": "dynamics", "protocol.ramp_time": 20.0, "loads": []}
    scene = Scene().updated({**reduced.parameters("superposition")["scene"], **changes})
    pair = load_pair(scene, rest_of(scene), 4, (0.2,))
    assert pair.by_motion.all()
    responses = of("superposition")["responses"]["floor_response"]
    slow = responses.isel(realization=0, distance=1).sel(force=0.2).values
    np.testing.assert_allclose(pair.floor_response[0], slow, atol=0.01 * slow.max())


def test_collapse_and_failure_are_reported() -> None:
    parameters = averages.Parameters(**reduced.parameters("polydisperse_averages"))
    case = averages.Case(0.25, 0.2, "touching-largest", (5.0, 60.0, 80.0), 1)
    # so shallow that every load collapses the packing, but the one that moves nothing
    scene = realizations.ensemble_scene(parameters, case, 0)
    found = realizations.realize(scene, (0.01, 5.0, 10.0), 1e-3)
    assert found.outcome.tolist() == [AT_REST, COLLAPSED, NOT_REACHED]
    assert np.isfinite(found.floor_response[0]).all()
    assert np.isnan(found.floor_response[1:]).all()

    failed = realizations.realize(scene.updated({"protocol.maximum_steps": 100}), (1.0, 2.0), 1e-3)
    assert failed.outcome.tolist() == [FAILED, NOT_REACHED]
    assert failed.message.startswith("gravity: ")


def test_the_caption_counts_the_frictions_at_which_disorder_shortens_the_linear_range(of) -> None:
    datasets = of("polydisperse_averages")
    data = datasets["linear_range"]
    lattice = data["polydispersity"] == 0.0
    for until, times in ((1.0, data["friction"].to_index().nunique()), (9.0, 0)):
        other = data.assign(linear_until=lattice * 5.0 + ~lattice * until)
        parameters = averages.Parameters(**reduced.parameters("polydisperse_averages"))
        caption = draw.captions({**datasets, "linear_range": other}, parameters)["fig20_disordered_linear_range"]
        assert f"shorter than that of the lattice at {times} of" in str(caption)


@pytest.mark.parametrize("guess", [(50.0, 60.0), (20.0, 25.0)])
def test_where_a_further_time_step_disagrees_all_forces_are_searched(of, guess):
    parameters = breaking.Parameters(**reduced.parameters("symmetry_breaking"))
    protocol = parameters.protocols[0]
    rest = breaking.rest_of(protocol.scene(parameters.scene, 5e-4))
    found = breaking.bracket(parameters, rest, protocol, 5e-4, guess)
    assert set(guess) & set(found.forces)  # tried
    table = of("symmetry_breaking")["brackets"]
    assert (found.event.low, found.event.high) == (float(table["low"][0]), float(table["high"][0]))


def test_the_sign_follows_a_displacement_and_its_mirror_image(of):
    copies = of("symmetry_breaking")["copies"]
    names = copies["name"].values.tolist()
    one, other = (names.index(f"displaced at random, seed 1{end}") for end in ("", ", mirror image"))
    assert float(copies["asymmetry"][one]) > 0.1
    assert int(copies["asymmetry_sign"][one]) == -int(copies["asymmetry_sign"][other]) != 0
    response = copies["floor_response"].values
    np.testing.assert_allclose(response[one], response[other][::-1], atol=1e-3)


def test_new_neighbours_are_touching_pairs_that_were_apart() -> None:
    problem = Problem.from_scene(OrderedSlab(3, 7, 3000.0).scene(BASE))
    packing = problem.packing
    pushed = packing.position.copy()
    pushed[:, 0] *= 0.999
    state = problem.relisted(replace(problem.bare_state(), position=pushed))
    assert new_neighbours(packing.position, state) == 0
    # the first disk of the bottom row goes on top of the third
    pushed[0] = pushed[2] + (0.0, 1.9)
    moved = problem.relisted(replace(problem.bare_state(), position=pushed))
    touching = moved.pairs.touching & ((moved.pairs.first == 0) | (moved.pairs.second == 0))
    others = np.where(moved.pairs.first == 0, moved.pairs.second, moved.pairs.first)[touching]
    apart = np.linalg.norm(packing.position[others] - packing.position[0], axis=1) > 3.0
    assert apart.any()
    assert new_neighbours(packing.position, moved) == int(apart.sum())


def test_soft_disks_are_settled_by_dynamics() -> None:
    """Where the lattice does not hold, the rest state comes from the fall; elsewhere from the minimum."""
    soft, stiff = OrderedSlab(8, 24, 20.0), OrderedSlab(8, 24, 3000.0)
    packing = Problem.from_scene(soft.scene(BASE)).packing
    fallen, held = settle(soft.scene(BASE)), settle(stiff.scene(BASE))
    assert fallen.certificate.stable
    assert fallen.certificate.force_residual < 1e-9
    assert new_neighbours(packing.position, fallen) > 0
    assert held.reached.method == "minimise"
    assert new_neighbours(packing.position, held) == 0
