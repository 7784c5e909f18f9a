"""From a scene to its solution: which method, what comes out."""

import numpy as np
import pytest
from refusals import refuses
from small_scenes import pushed, scene

from granular_response.errors import EquilibriumError
from granular_response.scene import SceneError
from granular_response.solvers import path
from granular_response.solvers.dynamics import DynamicsError
from granular_response.solvers.path import losses, points
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import NotSettled
from granular_response.solvers.solution import rest_state, solve_scene

LOAD = pushed(0.0, -2.0)


@pytest.mark.parametrize(
    ("changes", "rest", "load"),
    [
        ({"contact__friction": 0.0}, "minimise", "minimise"),
        ({"contact__friction": 0.2}, "dynamics", "path"),
        ({"contact__friction": 0.0, "packing__polydispersity": 0.01}, "dynamics", "minimise"),
        ({"contact__friction": 0.2, "protocol__method": "dynamics"}, "dynamics", "dynamics"),
        ({"contact__friction": 0.0, "protocol__method": "path"}, "minimise", "path"),
    ],
)
def test_method_and_certificates(changes, rest, load):
    reports = []

    def progress(done, total, what):
        reports.append((done / total, what))

    solution = solve_scene(scene(loads=LOAD, **changes), load_factors=(0.5, 1.0), progress=progress)
    assert solution.rest_choice.method == rest and solution.load_choice.method == load
    assert solution.rest_choice.reason and solution.load_choice.reason
    assert [s.load_factor for s in solution.loaded] == [0.5, 1.0]
    assert solution.total_force == 2.0
    for state in (solution.rest, *solution.loaded):
        assert state.certificate.force_residual < 1e-9
        assert state.certificate.stable
    assert reports and all(0.0 <= part <= 1.0 for part, _ in reports)


RUBS, SMOOTH = {"contact__friction": 0.3}, {"contact__friction": 0.0}
UNEVEN = {"packing__polydispersity": 0.1, "packing__lattice_constant": "touching-largest"}


@pytest.mark.parametrize(
    ("changes", "key", "value", "idle"),
    [
        (RUBS, "preparation__ramp_time", 3.0, True),
        (RUBS | {"preparation__gravity": "slow"}, "preparation__ramp_time", 3.0, False),
        (SMOOTH | {"preparation__gravity": "slow"}, "preparation__ramp_time", 3.0, True),
        (SMOOTH, "preparation__gravity", "slow", True),
        (SMOOTH | UNEVEN, "preparation__gravity", "slow", False),
        (SMOOTH, "protocol__friction_law", "literal", True),
        (RUBS, "protocol__stop_kinetic_energy", 1e-9, False),
        (RUBS | UNEVEN, "protocol__stop_kinetic_energy", 1e-10, False),
        (RUBS | UNEVEN, "protocol__stop_kinetic_energy", 1e-8, False),
        (SMOOTH | {"loads": []}, "protocol__load_factors", [0.5, 1.0], True),
    ],
)
def test_a_setting_without_effect_is_named_and_has_none(changes, key, value, idle):
    found = [solve_scene(scene(**{"loads": LOAD, **changes, **more})) for more in ({}, {key: value})]
    said = [line for line in found[1].remarks if line.startswith(key.replace("__", "."))]
    assert [" has no effect (" in line for line in said] == [True] * idle
    positions = [[state.position for state in (one.rest, *one.loaded)] for one in found]
    same = all(np.array_equal(a, b) for a, b in zip(*positions, strict=True))
    assert same is idle


@pytest.mark.parametrize("method", ["path", "dynamics", "auto"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_load_that_tears_a_disk_off_is_one_clear_line_and_soon(method, friction):
    with pytest.raises(DynamicsError, match=r"^a load lifts disk 22 off the packing for good; nothing can hold it$"):
        solve_scene(scene(contact__friction=friction, loads=pushed(0.0, 3.0), protocol__method=method))


@pytest.mark.parametrize("steps", [0.99, 1.0, 1.005, 1.009, 1.05, 1.1, 3.0])
def test_a_path_whose_every_increment_fails_gives_up_after_a_few(monkeypatch, steps):
    """However near the target is: an increment a little longer than the shortest one was tried for ever."""

    class Moves(Exception):
        pass

    tried = []

    def fails(*_, **__):
        tried.append(1)
        assert len(tried) < 50
        return None

    def moves(*_):
        raise Moves

    problem = Problem.from_scene(scene(loads=pushed(0.0, -1.0)))
    rest = rest_state(problem)
    monkeypatch.setattr(points, "solve_increment", fails)
    monkeypatch.setattr(path, "landed", fails)
    monkeypatch.setattr(losses, "by_motion", moves)
    refuses(Moves, None, path.follow, problem.with_loads(rest.position), rest, [steps * path.OPTIONS.beyond])
    assert len(tried) > 1


def test_friction_that_comes_after_gravity_leaves_no_tangential_force():
    smooth = solve_scene(scene(contact__friction=0.0, loads=[])).rest
    solution = solve_scene(scene(preparation__gravity="frictionless", loads=LOAD))
    assert solution.rest_choice.method == "minimise" and "without friction" in solution.rest_choice.reason
    assert solution.rest.position == pytest.approx(smooth.position, abs=1e-11)
    assert abs(solution.rest.pairs.tangential_force).max() < 1e-10
    assert abs(solution.loaded[0].pairs.tangential_force).max() > 0.01
    for state in (solution.rest, *solution.loaded):
        assert state.certificate.stable
        assert state.certificate.force_residual < 1e-9


def test_rows_that_just_touch_stay_up_when_friction_comes():
    """Contacts without force may open in the last digit; the state that is returned is stable all the same."""
    changes = {
        "contact": {"normal_stiffness": 102.98014201713849, "damping_ratio": 1.744, "friction": 0.0},
        "protocol": {"integrator": "verlet", "time_step": "auto"},
        "packing.sides": "periodic",
        "wall.friction": 0.7,
        "preparation.gravity": "frictionless",
    }
    solution = solve_scene(scene(5, 11, loads=[]).updated(changes))
    assert solution.rest.certificate.stable


def test_disks_that_pass_through_each_other_are_refused():
    crushed = scene(contact__friction=0.0, contact__normal_stiffness=100.0, loads=LOAD)
    with pytest.raises(EquilibriumError, match=r"overlap by .* mean radii at load factor 200"):
        solve_scene(crushed, load_factors=(200.0,))


def test_steps_that_run_out_without_friction_are_what_is_said():
    smooth = {"preparation__gravity": "frictionless", "packing__polydispersity": 0.1, "loads": []}
    moving = scene(contact__friction=0.3, protocol__maximum_steps=333, protocol__static_finish=False, **smooth)
    refuses(NotSettled, r"under gravity without friction within protocol.maximum_steps = 333 ", solve_scene, moving)


@pytest.mark.parametrize("law", ["literal", "unloading"])
def test_friction_laws_of_motion_are_left_to_dynamics(law):
    literal = scene(protocol__friction_law=law, protocol__stop_kinetic_energy=1e-6, loads=LOAD)
    solution = solve_scene(literal)
    assert solution.rest_choice.method == solution.load_choice.method == "dynamics"
    assert "friction_law" in solution.load_choice.reason
    with pytest.raises(SceneError, match=r"protocol.method = path: must be dynamics or auto, protocol.friction_law"):
        solve_scene(literal.updated({"protocol.method": "path"}))
