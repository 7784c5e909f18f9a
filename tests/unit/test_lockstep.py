"""Scenes in lock-step against the same scenes one by one: every number is the same, whatever shares their lanes."""

import re
from dataclasses import replace

import numba as nb
import numpy as np
import pytest
from small_scenes import scene

from granular_response.core import lockstep as kernel
from granular_response.core.integrators import INTEGRATORS
from granular_response.core.lanes import WIDTH, aligned_zeros
from granular_response.solve import Dynamics, DynamicsError, Problem, Relaxation, Stop, relax_many
from granular_response.solve.lockstep import Lanes, Network

#: Changes that leave the network as it is: friction, stiffness, damping, load, radii.
VARIANTS = [
    {
        "contact__friction": 0.1 + 0.15 * k,
        "contact__normal_stiffness": 3000.0 - 130.0 * k,
        "contact__damping_ratio": 0.3 + 0.02 * k,
        "packing__polydispersity": 0.002 * (k % 3),
    }
    for k in range(WIDTH + 3)
]
STOP = Stop(1e-4, maximum_steps=1500)


def dynamics(integrator="beeman", *, layers=3, disks_per_row=28, force=(0.3, -2.0), **changes) -> Dynamics:
    """A slab that falls into its contacts while a disk of its top row is pushed and turned."""
    smooth = changes.get("contact__friction") == 0.0 and not changes.get("wall__friction")
    loads = [{"disk": {"row": "top", "offset": 0}, "force": list(force), "torque": 0.0 if smooth else 0.2}]
    problem = Problem.from_scene(scene(layers, disks_per_row, loads=loads, **changes))
    bare = problem.bare_state()
    return Dynamics(problem.with_loads(bare.position), bare, integrator, 2e-4)


def relaxations(integrator="beeman", variants=VARIANTS, stop=STOP, **changes) -> list[Relaxation]:
    return [
        Relaxation(
            dynamics(integrator, force=(0.1 * k, -1.0 - k), **{**variant, **changes}),
            replace(stop, maximum_steps=stop.maximum_steps + 200 * (k % 4)),
            gravity=(0.2, 1.0, 0.05),
            load=(0.0, 1.0, 0.1 + 0.02 * k),
        )
        for k, variant in enumerate(variants)
    ]


def assert_same(one, other):
    assert np.array_equal(one.position, other.position) and np.array_equal(one.velocity, other.velocity)
    assert np.array_equal(one.angle, other.angle) and np.array_equal(one.angular_velocity, other.angular_velocity)
    assert np.array_equal(one.pairs.spring, other.pairs.spring)
    assert np.array_equal(one.walls.spring, other.walls.spring)
    assert one.information == other.information


PHYSICS = {
    "friction": {},
    "frictional walls": {"wall__friction": 0.3},
    "frictional walls alone": {"contact__friction": 0.0, "wall__friction": 0.3},
    "frictionless": {"contact__friction": 0.0},
    "literal": {"protocol__friction_law": "literal"},
    "pushing dashpot": {"protocol__tensile_dashpot": False, "wall__friction": 0.3},
    "single pairs": {"layers": 4, "disks_per_row": 5},
}


@pytest.mark.parametrize("physics", PHYSICS)
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_every_scene_goes_its_own_way(integrator, physics):
    together = relax_many(relaxations(integrator, **PHYSICS[physics]))
    alone = [relaxation.run() for relaxation in relaxations(integrator, **PHYSICS[physics])]
    for one, other in zip(together, alone, strict=True):
        assert_same(one, other)
    assert np.abs(alone[0].velocity).max() > 1e-4  # still on its way, so that errors would show
    steps = {state.information["steps"] for state in alone}
    assert len(steps) >= 4  # scenes left their lanes at different times


def test_springs_are_at_work_in_these_scenes():
    states = relax_many(relaxations(wall__friction=0.3))
    assert {status for state in states for status in state.pairs.status} == {0, 1, 2}
    assert all(np.abs(state.walls.spring).max() > 1e-6 for state in states)


def test_grouping_changes_nothing():
    """In another order, and each with other neighbours in the lanes."""
    plain = relax_many(relaxations())
    order = np.random.default_rng(0).permutation(len(VARIANTS))
    shuffled = relax_many([relaxations()[k] for k in order])
    for k, state in zip(order, shuffled, strict=True):
        assert_same(state, plain[k])


def test_scenes_settle_as_they_do_alone():
    """The stopping criteria of each scene hold at the same step as alone."""
    stop = Stop(1e-5, maximum_steps=200_000)
    variants = VARIANTS[: WIDTH + 1]
    together = relax_many(relaxations(variants=variants, stop=stop))
    assert all(state.information["settled"] for state in together)
    assert len({state.information["steps"] for state in together}) > WIDTH // 2
    for one, relaxation in zip(together, relaxations(variants=variants, stop=stop), strict=True):
        assert_same(one, relaxation.run())


def test_a_scene_that_needs_a_new_list_goes_on_alone():
    """One slab is thrown up by its overlaps at the start; the others never notice."""
    variants = [dict(v) for v in VARIANTS[:WIDTH]]
    variants[3]["packing__polydispersity"] = 0.25
    thrown = relaxations(variants=variants)
    states = relax_many(thrown)
    assert thrown[3].dynamics.rebuilds > 0
    for one, relaxation in zip(states, relaxations(variants=variants), strict=True):
        assert_same(one, relaxation.run())


def test_other_networks_are_kept_apart():
    mixed = [*relaxations(), *relaxations(layers=4), *relaxations(contact__friction=0.0)]
    assert not Network(mixed[0].dynamics).fits(mixed[-1].dynamics)
    alone = [*relaxations(), *relaxations(layers=4), *relaxations(contact__friction=0.0)]
    for one, relaxation in zip(relax_many(mixed), alone, strict=True):
        assert_same(one, relaxation.run())


def test_a_motion_that_blows_up_is_an_error():
    bad = relaxations()
    for relaxation in bad:
        relaxation.dynamics.time_step = 0.02
    with pytest.raises(DynamicsError, match="blew up"):
        relax_many(bad)


def test_square_roots_and_divisions_are_vector_instructions():
    """Of the loop over pairs, compiled afresh: stored machine code has no listing."""
    one = dynamics()
    lanes = Lanes(Network(one))
    lanes.put(0, one)
    net = lanes.network
    flat = [array.reshape(-1, WIDTH) for array in (lanes.motion, lanes.contact, lanes.force, lanes.laws)]

    @nb.njit(error_model="numpy")
    def pairs(motion, contact, force, laws, first, second):
        law = kernel._law(laws, 0)
        kernel._frictional_pairs(0, first.size, motion, contact, force, first, second, law, 0, law[0])

    pairs(*flat, net.pair_first, net.pair_second)
    (listing,) = pairs.inspect_llvm().values()
    vectors = rf"<{WIDTH} x double>"
    assert re.search(rf"call {vectors} @llvm\.sqrt\.v{WIDTH}f64", listing)
    assert re.search(rf"fdiv {vectors}", listing)
    assert not re.search(r"fdiv double|@llvm\.sqrt\.f64\(", listing)
    assert not re.search(r" = f\w+ (fast|reassoc|contract)", listing)


def test_arrays_begin_at_a_cache_line():
    for n in range(1, 20):
        array = aligned_zeros(n, 3, WIDTH)
        assert array.ctypes.data % 64 == 0 and array.flags.c_contiguous and not array.any()


def test_scenes_that_leave_their_lists_fast_go_their_own_way():
    """Large overlaps at the start throw disks farther in a hundred steps than any list reaches."""

    def several() -> list[Relaxation]:
        fast = {"packing__polydispersity": 0.5, "packing__lattice_constant": 2.0}
        return relaxations("verlet", stop=Stop(1e-9, maximum_steps=600), **fast)

    together = relax_many(several())
    alone = [relaxation.run() for relaxation in several()]
    for one, other in zip(together, alone, strict=True):
        assert_same(one, other)
    assert all(state.information["rebuilds"] for state in alone)
