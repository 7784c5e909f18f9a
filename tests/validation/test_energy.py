"""Contacts take energy and never give any."""

import pytest
from small_scenes import scene
from stress.closed_forms import collision

from granular_response.contact import LAWS
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import NotSettled
from granular_response.solvers.solution import solve_scene


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("damping_ratio", [0.0, 0.5])
@pytest.mark.parametrize("pair", [False, True], ids=["floor", "pair"])
@pytest.mark.parametrize("friction", [0.05, 0.5, 2.0, 100.0])
@pytest.mark.parametrize(("step", "error"), [(5e-4, 1.5e-4), (1e-4, 1.5e-5)])
def test_no_collision_gains_energy(step, error, friction, pair, damping_ratio, law):
    """At any incidence from grazing to head-on and with any spin, but for the error of the integration."""
    rubs = {"friction": friction, "damping_ratio": damping_ratio}
    one = scene().updated({"contact": {**rubs, "law": law}, "wall": rubs, "loads": []})
    grazing = 0.5 if law == "linear" else 2.0  # the softer contact lasts longer than is waited for
    left = {
        (angle, spin): collision(one, angle, spin, step, pair=pair)
        for angle in (grazing, 5.0, 10.0, 25.0, 45.0, 65.0, 85.0, 90.0)
        for spin in (-3.0, 0.0, 1.0)
    }
    assert 0.0 < min(left.values()) < 0.95  # some slide or are damped: the test is one of friction and of dashpots
    assert max(left.values()) < (1.0 if damping_ratio and law == "linear" else 1.0 + error)
    assert not damping_ratio or max(left[90.0, spin] for spin in (-3.0, 0.0, 1.0)) < 0.9


def test_literal_friction_rule_never_settles_and_says_so():
    """The spring frozen beyond the limit keeps disks turning: flagged by ``relax``, an error from ``solve_scene``."""
    literal = scene(protocol__friction_law="literal", protocol__maximum_steps=40_000)
    problem = Problem.from_scene(literal)
    state = relax(Dynamics(problem, problem.bare_state()), Stop(1e-13, maximum_steps=40_000))
    assert state.reached.settled is False and state.reached.relaxation_steps == 40_000
    assert state.reached.kinetic_energy > 1e-9
    with pytest.raises(NotSettled, match=r"did not come to rest under gravity within protocol\.maximum_steps = 40000"):
        solve_scene(literal)
    unfinished = solve_scene(literal.updated({"protocol.static_finish": False}))
    assert unfinished.rest.reached.settled is False
    # the rule that is used by default settles in the same time, and so does a frozen spring that is free to unload
    for law in ("cut", "unloading"):
        other = Problem.from_scene(scene(protocol__friction_law=law))
        assert relax(Dynamics(other, other.bare_state()), Stop(1e-13, maximum_steps=40_000)).reached.settled
