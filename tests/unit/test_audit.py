"""The check of a state from its positions alone finds whatever is tampered with."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from audit import ContactRule, audit
from small_scenes import pushed, scene
from stress.random_scenes import anachronism, check, contradiction, rounding_of

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import Solution, solve_scene
from granular_response.state import OPEN, SLIDING, STICKING, Contacts


@pytest.fixture(scope="module")
def rolling() -> Solution:
    """With contacts at either limit; disks of two sizes, so that an arm is not a radius."""
    resists = {"friction": 0.3, "rolling_friction": 0.02, "rolling_stiffness_ratio": 0.5}
    changes = {f"{kind}__{name}": value for kind in ("contact", "wall") for name, value in resists.items()}
    sizes = {"packing__polydispersity": 0.2, "packing__lattice_constant": "touching-largest", "packing__seed": 3}
    return solve_scene(scene(protocol__time_step="auto", loads=pushed(1.0, -4.0, 0.3), **changes, **sizes))


def moved(state, disk: int, x: float, z: float):
    position = state.position.copy()
    position[disk] += (x, z)
    return replace(state, position=position)


def tampered(state, side: str, where: str, **changes):
    """One contact of a side with other entries: the strongest that bears by ``where``, or the first of that status."""
    contacts = getattr(state, side)
    status = contacts.rolling_status if where.startswith("rolling") else contacts.status
    chosen = {"open": OPEN, "slides": SLIDING, "rolling slides": SLIDING}.get(where, STICKING)
    size = np.abs(contacts.rolling_force) if where == "rolling" else contacts.normal_force
    which = int(np.argmax((status == chosen) * (size if where in ("bears", "rolling") else 1.0)))
    arrays = {name: getattr(contacts, name).copy() for name in changes}
    for name, change in changes.items():
        arrays[name][which] = change(arrays[name][which])
    return replace(state, **{side: replace(contacts, **arrays)})


def without(state, side: str):
    """Without the strongest contact of a side that has a spring."""
    contacts = getattr(state, side)
    which = int(np.argmax(contacts.normal_force * (contacts.touching & (contacts.spring != 0))))
    left = {name: np.delete(values, which) for name, values in vars(contacts).items()}
    return replace(state, **{side: Contacts(**left)})


def certified(state, **changes):
    return replace(state, reached=replace(state.reached, certificate=replace(state.certificate, **changes)))


def by(amount: float):
    return lambda value: value + amount


def off(found) -> bool:
    return found.force_mismatch == pytest.approx(1e-3, rel=1e-6)


MORE, LITTLE, BEYOND = by(1e-3), by(1e-5), lambda value: 1.001 * value
#: What is done to a state under load, what the audit measures then, and what is said of it.
TAMPERED = {
    "a moved disk": (partial(moved, disk=5, x=1e-6, z=0.0),
                     lambda f: min(f.force_residual, f.force_mismatch) > 1e-4, "force_residual is"),
    "a lost disk": (partial(moved, disk=0, x=0.0, z=-9.0), lambda f: f.escaped == 1, ""),
    "a certificate": (partial(certified, rolling_excess=1e-3), lambda f: True, "rolling_excess is"),
    "friction": (partial(tampered, side="pairs", where="slides", spring=BEYOND), lambda f: f.coulomb_excess > 1e-6, ""),
    "rolling": (partial(tampered, side="pairs", where="rolling slides", rolling_spring=BEYOND),
                lambda f: f.rolling_excess > 1e-6, ""),
    "a stale spring": (partial(tampered, side="pairs", where="open", spring=LITTLE),
                       lambda f: f.stale_springs == 1, "1 stale springs"),
    "a stale rolling spring": (partial(tampered, side="pairs", where="open", rolling_spring=LITTLE),
                               lambda f: f.stale_springs == 1, "1 stale springs"),
}  # fmt: skip
for side in ("pairs", "walls"):
    TAMPERED[f"{side} that are not listed"] = (partial(without, side=side), lambda f: f.unlisted == 1, "")
    for name in ("normal_force", "tangential_force", "rolling_force"):
        recorded = partial(tampered, side=side, where="rolling" if name == "rolling_force" else "bears", **{name: MORE})
        TAMPERED[f"{name} of {side}"] = (recorded, off, "a recorded contact force is off by 0.001")
    sprung = partial(tampered, side=side, where="rolling", rolling_spring=by(1e-6))
    TAMPERED[f"a couple of {side}"] = (sprung, lambda f: f.torque_residual > 0.0, "torque_residual is")
    slack = partial(tampered, side=side, where="rolling", rolling_spring=lambda value: 0.0)
    TAMPERED[f"no couple of {side}"] = (slack, lambda f: f.torque_residual > 1e-4, "torque_residual is")


@pytest.mark.parametrize(("change", "found", "said"), TAMPERED.values(), ids=TAMPERED)
def test_what_is_tampered_with_is_found(rolling, change, found, said):
    state = change(rolling.loaded[0])
    assert found(check(rolling, state))
    assert said in complaint(rolling, state) != ""


def complaint(solution: Solution, state) -> str:
    return contradiction(state, check(solution, state), rounding_of(solution))


def test_disks_in_flight_are_found(rolling):
    """A pair that hangs in the air in contact is in flight too; at rest, nothing is."""
    rest = rolling.rest
    assert check(rolling, rest).in_flight == 0
    high = 0.99 * rest.position + np.array([0.005 * rolling.problem.packing.width, 5.0])  # off the side walls too
    found = check(rolling, replace(rest, position=high))
    assert found.in_flight > 1
    settled = replace(rest, position=high, reached=replace(rest.reached, settled=True))
    assert anachronism(rolling, settled, found, 0.0).endswith("in flight, said to be at rest")


def test_a_fall_that_took_no_time_is_found(rolling):
    rest = rolling.rest
    assert rest.reached.steps
    assert anachronism(rolling, rest, check(rolling, rest), 0.0) == ""
    short = replace(rest, reached=replace(rest.reached, steps=1, more_relaxations=None))
    early = replace(rolling, rest=short)
    assert "said to have fallen by" in anachronism(early, short, check(rolling, rest), 0.0)


def test_another_load_factor_than_was_asked_for_is_found(rolling):
    state = rolling.loaded[0]
    found = check(rolling, state)
    assert anachronism(rolling, state, found, 1.0) == ""
    assert "said to be at rest" in anachronism(rolling, state, found, 2.0)
    moving = replace(state, reached=replace(state.reached, settled=False))
    assert anachronism(rolling, moving, found, 2.0) == ""


def test_a_disk_that_bears_next_to_nothing_is_judged_by_what_it_bears():
    """In mid-air, out of balance by its whole weight, which was less than any bound in units of the mean one."""
    smooth = {"contact": {"friction": 0.0, "normal_stiffness": 37.5}, "wall": {"friction": 0.0}, "loads": []}
    dust = {"x": [2.0, 6.0, 4.0], "z": [0.98, 0.98, 5.0], "radius": 1.0, "mass": [1.0, 1.0, 1e-6]}
    problem = Problem.from_scene(Scene.from_arrays(**dust, width=8.0, scene=smooth))
    rule = ContactRule(37.5, 0.0, 0.0), ContactRule(75.0, 0.0, 0.0)
    position = problem.packing.position.copy()
    position[:2, 1] = 1.0 - problem.weight[:2] / 75.0
    state = problem.relisted(replace(problem.bare_state(), position=position))
    found = audit(state, problem.packing.radius, problem.weight, 8.0, *rule, np.zeros((3, 3)))
    assert found.force_residual < 2e-6 and found.in_flight == 1
    assert found.relative_residual == pytest.approx(1.0)
    whole = audit(state, problem.packing.radius, problem.weight, 8.0, *rule, np.zeros((3, 3)), rounding=1e-5)
    assert whole.relative_residual == 0.0  # a weight that no digit of a position shows
