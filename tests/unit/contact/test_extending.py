"""The recipes of docs/extending.md, followed with laws and an integrator that the package does not have."""

import numpy as np
import pytest
from demonstration import Euler, Weakening, Weaker, problem
from refusals import refuses
from small_scenes import pushed, scene, shaken, started

import granular_response as gr
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.kernels.transitions import SLIDES
from granular_response.scene import Scene
from granular_response.scene.material import KNOWN_LAWS
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.energy import minimise
from granular_response.solvers.equilibrium import certify
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.rates import RateProblem
from granular_response.solvers.solution import rest_state, solve_scene
from granular_response.solvers.timestep import oscillator_limit
from granular_response.state import OPEN, SLIDING, STICKING


def test_a_law_of_ones_own_is_minimised():
    smooth = problem(0.0)
    rest = minimise(smooth, smooth.bare_state())
    assert certify(smooth, rest).force_residual < 1e-9
    normal, overlap = rest.pairs.normal_force, rest.pairs.overlap
    closed = overlap > 0
    assert normal[closed] == pytest.approx(1000.0**3 * overlap[closed] ** 3)


def test_a_law_of_ones_own_settles_and_follows_a_path():
    rough = problem(0.5)
    rest = rest_state(rough)
    assert rest.certificate.stable and rest.certificate.force_residual < 1e-9
    (loaded,) = follow(rough.with_loads(rest.position), rest, [0.1])
    assert loaded.certificate.force_residual < 1e-9
    added = loaded.walls.normal_force.sum() - rest.walls.normal_force.sum()
    assert added == pytest.approx(1.5, rel=0.3)  # the floor takes it up, the side walls give and take a little


WEAKER = {"contact__law": "weaker", "contact__friction": 0.3, "wall__friction": 0.4}


@pytest.fixture
def _weaker():
    gr.register_law("weaker", Weaker, Weakening)
    yield
    del KNOWN_LAWS["weaker"]


def most(contacts, friction):
    """Limits by hand, for normal forces that halve the coefficient at 1 mg."""
    return friction * contacts.normal_force / (1.0 + contacts.normal_force)


@pytest.mark.usefixtures("_weaker")
def test_a_limit_of_ones_own_is_that_of_dynamics_statics_rates_and_tangents():
    made = Problem.from_scene(scene(3, 5, **WEAKER))
    state = shaken(made, seed=2, spring=5e-3)
    system, known = started(made, state)
    here = system.trial(known, known.q)
    force = Dynamics(made, state).history[0, : system.dof] / made.inverse_mass
    assert here.contact_force + made.weight_vector == pytest.approx(force, abs=1e-9)
    slides, kinds = here.status == SLIDING, system.state(here, 0.0)
    limits = np.concatenate([most(kinds.pairs, 0.3), most(kinds.walls, 0.4)])
    assert slides.sum() > 10 and np.abs(here.tangential)[slides] == pytest.approx(limits[slides], rel=1e-12)
    assert system.limits(here) == pytest.approx(limits)
    # rates: what is left until contacts slide, and the forces of those that do, fall as differences say
    sense = np.where(here.status == OPEN, OPEN, STICKING)
    rates, h = RateProblem(system, 1.0, force=0.0), 1e-8
    v = np.random.default_rng(5).normal(size=system.dof)
    there, back = (system.trial(known, known.q + s * h * v, fixed=sense) for s in (1.0, -1.0))
    kept, seen = system.trial(known, known.q, fixed=sense), 0
    found = rates.changes(kept, v, sense)
    for c in np.flatnonzero((found.rate > 0.0) & (np.abs(found.what) == SLIDES)):
        side = np.sign(found.what[c])
        left = [system.limits(trial)[c] - side * trial.tangential[c] for trial in (back, kept, there)]
        assert found.left[c] == pytest.approx(left[1], abs=1e-12)
        assert found.rate[c] == pytest.approx((left[0] - left[2]) / (2.0 * h), rel=1e-4, abs=1e-2)
        assert rates.until(kept, int(c), int(found.what[c]), v) == pytest.approx((found.left[c], found.rate[c]))
        seen += 1
    assert seen > 5
    there, back = (system.trial(known, known.q + s * h * v, fixed=here.sense) for s in (1.0, -1.0))
    by_difference = (there.contact_force - back.contact_force) / (2.0 * h)
    assert system.force_rates(here, v) == pytest.approx(by_difference, rel=1e-4, abs=0.1)
    # and a factorisation that is brought up to date solves with the tangent of the new statuses
    stick = np.where(slides, STICKING, here.sense).astype(np.int8)
    changed = stick.copy()
    changed[np.flatnonzero(slides)[:3]] = here.sense[slides][:3]
    right, solved = np.linspace(-1.0, 1.0, system.dof), []
    for factor in (system.renewed_factor(known, changed), None):
        if factor is None:
            system.renewed_factor(known, stick)
            factor = system.updated_factor(known, changed)
        solved.append(factor.solve(right))
    assert solved[1] == pytest.approx(solved[0], rel=1e-2, abs=1e-2 * np.abs(solved[0]).max())


@pytest.mark.usefixtures("_weaker")
def test_a_scene_with_a_limit_of_ones_own_is_loaded():
    solution = solve_scene(scene(4, 9, loads=pushed(1.0, -4.0), protocol__load_factors=[0.5, 1.0], **WEAKER))
    last = solution.loaded[-1]
    assert last.certificate.stable and last.certificate.coulomb_excess < 1e-8
    for contacts, friction in ((last.pairs, 0.3), (last.walls, 0.4)):
        slides = contacts.sliding
        assert np.abs(contacts.tangential_force)[slides] == pytest.approx(most(contacts, friction)[slides], abs=1e-8)
    assert last.pairs.sliding.any() or last.walls.sliding.any()


class Wrong(Weaker):
    """Its limit has another slope."""

    def limit_slope(self, force_normal):
        return self.friction


def test_a_limit_with_another_slope_is_refused():
    said = "limit_slope is .* where the derivative of limit is"
    refuses(gr.GranularError, said, gr.register_law, "wrong", Wrong, Weakening)
    assert "wrong" not in KNOWN_LAWS


def test_an_integrator_of_ones_own(monkeypatch):
    monkeypatch.setitem(INTEGRATORS, "euler", Euler())
    made = Problem.from_scene(Scene().updated({"packing": {"layers": 3, "disks_per_row": 7}}))
    ours, paper = (Dynamics(made, made.bare_state(), name, 1e-5) for name in ("euler", "beeman"))
    for dynamics in (ours, paper):
        dynamics.set_ramps()
        dynamics.advance(2000)
    moved = np.abs(paper.position - made.packing.position).max()
    assert 0 < np.abs(ours.position - paper.position).max() < 0.01 * moved
    # an undamped spring: stable up to 2 over the frequency
    assert oscillator_limit("euler", 400.0, 0.0) == pytest.approx(0.1, rel=2e-2)
