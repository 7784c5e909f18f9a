"""What small solutions cost, in steps, iterations and factorisations.

Most numbers that solvers go by decide no result, only how much work leads to it. Another value of one shows here. A
difference that is understood is stored with ``--force-regen``.
"""

from dataclasses import replace

import numba as nb
import pytest
from refusals import refuses
from small_scenes import free_disks, pushed, scene

from granular_response.observe.network import mirror_disks
from granular_response.scene import Scene
from granular_response.solvers import dynamics, energy, equations
from granular_response.solvers.energy import _Descent, minimise
from granular_response.solvers.equilibrium import EquilibriumError, finish
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state, solve_scene
from granular_response.state import Reached, State


def spent(reached: Reached) -> dict[str, int]:
    """All that is counted of the way to a state."""
    counts = {name: value for name, value in vars(reached).items() if type(value) is int}
    return counts | ({"events": len(reached.events)} if reached.events else {})


SMOOTH = {"contact__friction": 0.0, "wall__friction": 0.0}
SOLVED = {
    "a slab under a large force": scene(6, 13, contact__friction=0.2, loads=pushed(0.0, -60.0)),
    "a slab with much friction": scene(6, 13, contact__friction=1.0, loads=pushed(0.0, -100.0)),
    "a slab that is pushed aside": scene(5, 11, contact__friction=0.5, loads=pushed(2.0, -3.0)),
    "a slab under a load that comes back": scene(
        5, 11, contact__friction=0.2, loads=pushed(0.0, -20.0), protocol__load_factors=[1.0, 0.0, 1.0]
    ),
    "a slab without friction": scene(6, 13, **SMOOTH, loads=pushed(0.0, -8.0)),
    "a slab by dynamics": scene(5, 11, contact__friction=0.2, loads=pushed(0.0, -4.0), protocol__method="dynamics"),
    "a disordered slab": scene(6, 13, packing__polydispersity=0.1, contact__friction=0.5, loads=pushed(0.0, -40.0)),
    "disks that resist rolling": scene(
        4,
        9,
        contact__friction=0.4,
        contact__rolling_friction=0.1,
        contact__rolling_stiffness_ratio=0.5,
        loads=pushed(0.0, -6.0),
    ),
    "disks by the 3/2 law": scene(4, 9, contact__law="hertz", contact__friction=0.2, loads=pushed(0.0, -4.0)),
    "a pile": Scene.from_dict({"packing": {"kind": "pile"}, "contact": {"friction": 0.2}}),
}


@pytest.mark.parametrize("name", SOLVED)
def test_a_solution_costs_what_it_did(name, data_regression):
    solution = solve_scene(SOLVED[name])
    states = [solution.rest, *solution.loaded]
    data_regression.check([spent(state.reached) for state in states])


def test_kernels_whose_types_are_looked_at_once_have_the_same_ones_each_time(monkeypatch):
    """Their machine code would read other arrays as if they were those of the first call."""
    first, called = {}, set()

    def checked(compiled, of):
        def call(*arguments):
            called.add(compiled.__name__)
            found = [nb.typeof(one) for one in arguments]
            assert found == first.setdefault((compiled.__name__, of), found), compiled.__name__
            return compiled(*arguments)

        return call

    for module in (dynamics, equations):
        monkeypatch.setattr(module, "typed", checked)
    for name in "a slab with much friction", "a slab by dynamics", "disks that resist rolling", "disks by the 3/2 law":
        solve_scene(SOLVED[name])
    assert called == {"advance", "changed_stiffness", "contacts", "count_ties", "next_changes", "until"}


def half_way() -> tuple[Problem, State]:
    """A heap half-way between its minimum and its mirror image, near a saddle."""
    problem = Problem.from_scene(Scene.from_dict({"packing": {"kind": "pile"}, "contact": {"friction": 0.0}}))
    rest = rest_state(problem)
    reflected = rest.position[mirror_disks(problem.packing.position, 0.5 * problem.packing.width)] * [-1.0, 1.0]
    middle = 0.5 * (rest.position + reflected + [problem.packing.width, 0.0])
    return problem, problem.with_static_forces(replace(rest, position=middle))


def bare(*size: int, **changes) -> tuple[Problem, State]:
    problem = Problem.from_scene(scene(*size, **SMOOTH, **changes))
    return problem, problem.bare_state()


MINIMISED = {
    "a heap near a saddle": (half_way, {}),
    "a disordered slab": (lambda: bare(6, 13, packing__polydispersity=0.1), {}),
    "a soft slab as large ones": (lambda: bare(12, 25, contact__normal_stiffness=300.0), {"large": 0}),
}


@pytest.mark.parametrize("name", MINIMISED)
def test_a_minimisation_costs_what_it_did(name, data_regression, monkeypatch):
    start, options = MINIMISED[name]
    monkeypatch.setattr(energy, "OPTIONS", replace(energy.OPTIONS, **options))
    data_regression.check(spent(minimise(*start()).reached))


def test_a_minimisation_looks_every_tenth_iteration_whether_disks_leave_their_neighbours():
    descent = _Descent(*bare(12, 25, contact__normal_stiffness=60.0), 0.0)
    with pytest.raises(EquilibriumError, match="leave their neighbours"):
        while not descent.at_minimum():
            descent.go_on()
    assert descent.iterations == 59  # they do after 50


@pytest.mark.parametrize("depth, refused", [(0.09, False), (0.11, True)])
def test_an_equilibrium_a_tenth_of_a_radius_away_is_another_one(depth, refused):
    problem, state = free_disks([[500.0, 1.0 - depth]], wall__friction=0.3)
    if refused:
        refuses(EquilibriumError, "mean radii away", finish, problem, state)
    else:
        assert finish(problem, state).position[0, 1] == pytest.approx(1.0 - 1.0 / 6000.0, abs=1e-9)
