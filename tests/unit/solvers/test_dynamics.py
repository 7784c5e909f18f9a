"""Dynamics: histories survive a new list, looking changes nothing, bad runs end with a message."""

import re
from dataclasses import replace

import numpy as np
import pytest
from printed import shown
from refusals import refuses
from small_scenes import at_rest, free_disks, scene

import granular_response as gr
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers.dynamics import Dynamics, DynamicsError, Stop, relax
from granular_response.solvers.problem import Problem


def falling(integrator="beeman", *, steps=3000, **changes) -> Dynamics:
    """A frictional slab on its way into its contacts: springs are stretched, some contacts slide."""
    problem = Problem.from_scene(scene(wall__friction=0.3, **changes))
    dynamics = Dynamics(problem, problem.bare_state(), integrator, 2e-4)
    dynamics.advance(steps)
    return dynamics


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_listing_again_keeps_the_motion(integrator):
    """Lists made anew every few steps, by search, give the trajectory of one list (histories carried along)."""
    plain, often = falling(integrator), falling(integrator)
    assert all(np.abs(kind.spring).max() > 1e-6 for kind in (often.model.pairs, often.model.walls))
    for _ in range(20):
        often.candidates = replace(often.candidates, limit=0.0)
        often.advance(8)
    plain.advance(160)
    assert (often.rebuilds, plain.rebuilds) == (20, 0)
    assert often.position == pytest.approx(plain.position, abs=1e-12)
    assert often.angle == pytest.approx(plain.angle, abs=1e-12)
    assert often.state().pairs.spring == pytest.approx(plain.state().pairs.spring, abs=1e-12)
    assert often.state().walls.spring == pytest.approx(plain.state().walls.spring, abs=1e-12)


def test_a_disk_thrown_far_is_followed():
    """It flies over a neighbour's neighbours and lands elsewhere; nothing passes through anything."""
    places = [[5.0 + 2.0 * k, 1.0] for k in range(8)]
    problem, state = free_disks([*places, [6.0, 4.0]], velocity=[*([(0.0, 0.0)] * 8), (4.0, 3.0)], width=24.0)
    dynamics = Dynamics(problem, state, "beeman", 4e-4)
    dynamics.advance(40_000)
    assert dynamics.rebuilds > 3
    x = dynamics.position
    distance = np.linalg.norm(x[:, None] - x[None], axis=2)[np.triu_indices(9, 1)]
    assert distance.min() > 1.9
    assert x[:, 1].min() > 0.9
    assert x[8, 0] > 10.0


def test_blow_up_is_an_error():
    problem, state = free_disks([[10.0, 1.0], [11.0, 1.9]], velocity=[(0, 0), (0, 0)], contact__damping_ratio=1.0)
    dynamics = Dynamics(problem, state, "beeman", 0.1)
    refuses(DynamicsError, r"time_step 0\.1; take a smaller", relax, dynamics, Stop(1e-13, maximum_steps=20_000))


def test_a_disk_too_fast_for_any_list_is_an_error():
    problem, state = free_disks([[500.0, 500.0]], velocity=[(1e4, 0.0)])
    refuses(DynamicsError, "blew up", Dynamics(problem, state).advance, 100)


def test_envelope_is_stricter_than_the_instant():
    problem = Problem.from_scene(scene(contact__friction=0.0))
    steps = {}
    for rule in ("instantaneous", "envelope"):
        state = relax(Dynamics(problem, problem.bare_state()), Stop(1e-10, rule))
        assert state.reached.settled
        steps[rule] = state.reached.relaxation_steps
    assert steps["envelope"] >= steps["instantaneous"] + 20.0 / 5e-4 * 0.9


def test_motion_that_a_small_load_begins_has_fallen_to_a_part_of_its_largest_energy():
    """So little is out of balance that the energy is never above the limit: without ``fallen`` no motion is seen."""
    problem, rest = at_rest(scene(contact__friction=0.2, loads=[{"disk": "top-centre", "force": [0.0, -1.0]}]))
    ended = {}
    for part in (1.0, 1e-2, 1e-4):
        energies = []
        state = relax(
            Dynamics(problem, rest), Stop(1e-6, fallen=part), load=(0.0, 0.01, 0.1),
            progress=lambda _, energy, energies=energies: energies.append(energy),
        )  # fmt: skip
        assert state.reached.settled and max(energies) < 1e-6
        assert energies[-1] <= part * max(energies)
        ended[part] = state.reached.relaxation_steps
    assert ended[1.0] < ended[1e-2] < ended[1e-4]


def test_loose_disk_does_not_keep_a_packing_from_rest():
    """A disk that rolls on the floor for ever carries nothing and is left out of the deciding energy."""
    problem, state = free_disks(
        [[10.0, 1.0 - 1 / 6000], [50.0, 1.0 - 1 / 6000]], velocity=[(0, 0), (1e-6, 0)], contact__friction=0.2
    )
    settled = relax(Dynamics(problem, state), Stop(1e-13, maximum_steps=20_000))
    assert settled.reached.settled
    assert settled.reached.loose_disks == 2
    assert settled.reached.stopped_rattlers == 1  # the other one lies still
    assert settled.reached.kinetic_energy > 1e-13


def test_a_result_says_that_rolling_toes_were_stopped_by_hand(tmp_path):
    """A pile on a flat floor without rolling resistance: its core holds, and the two disks of its toe roll away."""
    packing = gr.Pile(layers=5).build()
    changes = {
        "contact": {"friction": 0.6, "stiffness_ratio": 0.5},
        "wall": {"friction": 0.6},
        "protocol": {"integrator": "leapfrog", "time_step": "auto", "maximum_steps": 40_000},
        "loads": [],
    }
    x, room = packing.position[:, 0] + 5.0, packing.width + 10.0
    alone = gr.Scene.from_arrays(x, packing.position[:, 1], packing.radius, width=room, scene=gr.Scene(**changes))
    result = gr.solve(alone)
    assert result.rest.reached.stopped_rattlers == result.certificate.loose_disks == 2
    assert "2 rolling rattlers stopped by hand" in repr(result)
    result.save(tmp_path / "pile.nc")
    assert gr.open_result(tmp_path / "pile.nc").rest.reached.stopped_rattlers == 2
    assert re.search(r"rattlers stopped by hand +2\n", shown(tmp_path / "pile.nc"))


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_what_rolls_are_disks_that_touch_the_floor_alone(friction):
    """Not those beside another one, in flight or at a wall. Motion along the floor counts, and spin."""
    z = 1.0 - 1 / 6000
    places = [(50.0, z), (100.0, z), (101.9, z), (150.0, 5.0), (z, 20.0)]
    problem, state = free_disks(places, velocity=[(0.3, 0.1)] * 5, contact__friction=friction, wall__friction=friction)
    dynamics = Dynamics(problem, replace(state, angular_velocity=np.full(5, 0.7)))
    touching = dynamics.touching()
    rollers, energy = dynamics.rolling(touching, dynamics.contact_count(touching))
    spin = 0.5 * 0.5 * 0.7**2 if friction else 0.0
    assert rollers == 1 and energy == pytest.approx((0.5 * 0.3**2 + spin) / 5, rel=1e-14)


def test_ramps_of_gravity_and_load():
    """On one free disk the velocity is the integral of the ramp, whose parabola the algorithms follow."""
    problem, state = free_disks([[500.0, 500.0]], loads=[{"disk": 0, "force": [2.0, 0.0], "torque": 0.5}])
    problem = problem.with_loads(state.position)
    dynamics = Dynamics(problem, state, "beeman", 1e-3)
    dynamics.set_ramps(gravity=(0.0, 1.0, 1.0), load=(1.0, 3.0, 1.0))
    dynamics.advance(2000)
    velocity = dynamics.state().velocity[0]
    assert velocity == pytest.approx([2.0 * (2.0 + 3.0), -(0.5 + 1.0)], abs=2e-3)
    assert dynamics.load[1] == dynamics.state().load_factor == 3.0
