"""Scenes at the edge of what can be solved: an answer, or the line that says what is wrong with the scene."""

import warnings

import numpy as np
import pytest
from refusals import refuses
from small_scenes import free_disks, pushed, scene

import granular_response as gr
from granular_response.errors import EquilibriumError
from granular_response.scene import Scene, SceneError
from granular_response.solvers import solution as solving
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.equilibrium import finish
from granular_response.solvers.settle import NotSettled
from granular_response.solvers.solution import solve_scene
from granular_response.solvers.stability import Spectrum
from granular_response.solvers.system import StaticSystem


def test_a_disk_that_slides_alone_has_no_unstable_direction():
    """Nothing changes as it moves along the floor or turns: both are left out, or its symmetric part is indefinite."""
    problem, state = free_disks([[10.0, 1.0 - 1e-3]], contact__friction=0.2, wall__friction=0.2)
    state = problem.with_static_forces(state)
    system = StaticSystem(problem, state)
    known = system.start(state)
    pushed = known.q + np.array([1e-2, 0.0, 0.0])
    trial = system.trial(known, pushed)
    assert trial.status.tolist() == [2]
    tangent = system.tangent(trial, 1e-6).toarray()
    assert np.linalg.eigvalsh(tangent + tangent.T).min() < -0.1
    assert np.linalg.eigvals(tangent).real.min() > 0.0
    assert Spectrum(system, trial).negative_modes == 0
    assert np.abs(Spectrum(system, trial).direction).max() == 1.0


def test_a_load_that_no_contact_bears_is_refused_before_anything_settles(monkeypatch):
    monkeypatch.setattr(solving, "rest_state", lambda *_, **__: pytest.fail("settled first"))
    with pytest.raises(SceneError, match=r"^loads\[0\].force: 1e\+300 mg .* must be at most 2.4e\+04"):
        solve_scene(scene(loads=[{"disk": "top-centre", "force": [0.0, -1e300]}]))
    small = scene(loads=pushed(0.0, -1.0))
    refuses(SceneError, r"^loads\[0\].force: 3e\+04 mg", solve_scene, small, load_factors=[0.1, -3e4, 0.0])


def test_a_disk_that_a_table_does_not_have_is_found_before_it_settles(tmp_path, monkeypatch):
    (tmp_path / "disks.csv").write_text("x,z,radius\n1,1,1\n3,1,1\n")
    monkeypatch.setattr(solving, "rest_state", lambda *_, **__: pytest.fail("settled first"))
    table = {"kind": "file", "path": "disks.csv", "width": 4.0}
    beyond = Scene.from_dict({"packing": table, "loads": [{"disk": 2, "force": [0.0, -1.0]}]}, folder=tmp_path)
    refuses(SceneError, "must be from 0 to 1, the packing has 2 disks", solve_scene, beyond)


@pytest.mark.parametrize(("where", "friction"), [("contact", 1e-8), ("wall", 1e-7)])
def test_a_friction_that_newton_cannot_follow_is_named(where, friction):
    problem, state = free_disks([[10.0, 3.0]], **{"contact__friction": 0.0, f"{where}__friction": friction})
    refuses(EquilibriumError, rf"{where}.friction = 1e-0[78] is so small .* at least 0.0001", finish, problem, state)


@pytest.mark.parametrize(
    ("force", "stiffness", "said"), [(1e-12, 2e3, True), (1e-10, 2e3, True), (1.0, 2e3, False), (0.01, 1e10, True)]
)
def test_a_response_that_is_rounding_says_so(force, stiffness, said):
    """Of small loads, and of larger ones on disks so stiff that the last digit of a position is a force."""
    stiff = {"preparation__gravity": "frictionless", "contact__normal_stiffness": stiffness}
    line = "of the response to the smallest load may be rounding; take larger loads"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        gr.solve(scene(loads=pushed(0.0, -force), **stiff))
    assert any(line in str(warning.message) for warning in caught) is said


def counted_steps(monkeypatch) -> list[int]:
    """The time steps that dynamics takes from here on, a number for each call."""
    taken: list[int] = []
    advance = Dynamics._advance

    def counting(self, steps):
        before = self.steps
        advance(self, steps)
        taken.append(self.steps - before)

    monkeypatch.setattr(Dynamics, "_advance", counting)
    return taken


def test_maximum_steps_is_the_most_that_a_stage_takes(monkeypatch):
    """Between two tries of statics, and from an equilibrium that was left, steps were not counted."""
    described = {
        "contact": {"friction": 1.0, "normal_stiffness": 1e6},
        "wall": {"friction": 1.0},
        "loads": [],
        "protocol": {"time_step": "auto", "maximum_steps": 20000},
    }
    tower = Scene.from_arrays([1.5, 1.5], [0.999999, 2.9999979999999997], 1.0, width=3.0, scene=described)
    taken = counted_steps(monkeypatch)
    with pytest.raises(
        NotSettled, match=r"within protocol\.maximum_steps = 20000 .*: the equilibrium found is unstable$"
    ):
        solve_scene(tower)
    assert 0 < sum(taken) <= 20000


@pytest.mark.parametrize(
    ("light", "contact", "steps"),
    [
        # on the tip of the first one: its own force tips it over, a hundred-thousandth of any other stiffness
        ((2.0, 2.974999995, 1e-6), {"normal_stiffness": 30.0, "damping_ratio": 0.002}, 400_000),
        # in mid-air: out of balance by its whole weight, which is next to nothing beside the others
        ((4.0, 5.0, 1e-6), {"normal_stiffness": 30.0, "damping_ratio": 0.0}, 200_000),
    ],
    ids=["on a tip", "in mid-air"],
)
def test_no_certificate_for_a_light_disk_that_does_not_stay(light, contact, steps):
    x, z, mass = zip((2.0, 0.975, 1.0), (6.0, 0.975, 1.0), light, strict=True)
    described = {
        "contact": {"friction": 0.0, **contact},
        "wall": {"friction": 0.0},
        "loads": [{"disk": 1, "force": [0.0, -0.5]}],
        "protocol": {"maximum_steps": steps},
    }
    dust = Scene.from_arrays(x, z, 1.0, mass=mass, width=8.0, scene=described)
    refuses(NotSettled, "did not come to rest under gravity", solve_scene, dust)


@pytest.mark.parametrize("most", [1, 50, 99, 100, 101, 250])
@pytest.mark.parametrize("integrator", ["beeman", "verlet", "leapfrog", "gear"])
def test_a_limit_of_steps_holds_to_the_step(most, integrator):
    """It was rounded up to the next hundred. For gravity, for each load, and where a load moves a disk."""
    protocol = {"method": "dynamics", "static_finish": False, "maximum_steps": most, "time_step": 1e-4,
                "load_factors": [1.0, 2.0], "integrator": integrator}  # fmt: skip
    for load in ({"disk": 0, "force": [0, -1.0]}, {"disk": 0, "displacement": [None, -1e-3]}):
        scene = {"protocol": protocol, "loads": [load]}
        with pytest.warns(UserWarning, match=rf"not at rest within protocol\.maximum_steps = {most}: gravity"):
            result = gr.solve(gr.Scene.from_arrays(x=[5], z=[5.0], radius=1.0, width=10, scene=scene), progress=False)
        assert [one.reached.relaxation_steps for one in (result.rest, *result.loaded)] == [most] * 3
        assert result.rest.reached.steps == most
        assert result.rest.reached.time == pytest.approx(most * 1e-4)
