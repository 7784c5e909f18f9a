"""What every contact law must fulfil, and the 3/2 law by hand (Sec. III.B)."""

import importlib
import math
import os
import pickle
import sys
from dataclasses import replace

import numba as nb
import numpy as np
import pytest
from commands import process, refused
from demonstration import Cohesion, Cohesive, Cubic
from places import ROOT
from pydantic import Field
from refusals import refuses
from small_scenes import scene

import granular_response as gr
from granular_response.cli import scene_reference
from granular_response.contact import LAWS
from granular_response.contact.law import elastic_force, energy, stiffness
from granular_response.contact.linear import Linear
from granular_response.scene import Scene, SceneError
from granular_response.scene.base import Description, NonNegative
from granular_response.scene.material import KNOWN_LAWS
from granular_response.solvers.laws import law_class
from granular_response.solvers.problem import Problem
from granular_response.sweeps.keys import key

PATHS = os.pathsep.join([str(ROOT / "src"), str(ROOT / "tests")])
#: Those of the package, and one that lives outside.
NAMES = [*LAWS, "cohesive"]


@pytest.fixture(autouse=True)
def _cohesive():
    gr.register_law("cohesive", Cohesive, Cohesion)
    yield
    del KNOWN_LAWS["cohesive"]


def law(name, reduced_radius=0.5, friction=0.2):
    own = KNOWN_LAWS[name].parameters().model_dump()
    return law_class(name).of(3000.0, 54.0, 2400.0, 49.0, friction, -math.inf, reduced_radius, **own)


@nb.njit(error_model="numpy")
def asked(law, overlap, shape):
    return elastic_force(law, overlap, shape), stiffness(law, overlap, shape), energy(law, overlap, shape)


def shape_of(law, first=1.0, second=1.0):
    shapes = law.shapes(np.array([first]), None if second is None else np.array([second]))
    return None if shapes is None else float(shapes[0])


def test_a_scene_can_name_every_law():
    assert list(KNOWN_LAWS) == ["linear", "hertz", "cohesive"]
    for name in NAMES:
        problem = Problem.from_scene(Scene().updated({"contact.law": name}))
        assert type(problem.pair_law) is type(problem.wall_law) is law_class(name)
    with pytest.raises(SceneError, match=f"contact.law = .*must be {' or '.join(KNOWN_LAWS)}"):
        Scene().updated({"contact.law": "hertzian"})


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("overlap", [1e-5, 1e-3, 0.1])
def test_stiffness_is_the_derivative_of_the_force_and_force_that_of_the_energy(name, overlap):
    one = law(name)
    shape, h = shape_of(one, 0.8, 1.1), 1e-6 * overlap
    up, down = asked(one, overlap + h, shape), asked(one, overlap - h, shape)
    force, stiff, _ = asked(one, overlap, shape)
    assert (up[0] - down[0]) / (2.0 * h) == pytest.approx(stiff, rel=1e-6)
    assert (up[2] - down[2]) / (2.0 * h) == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("reduced_radius", "second"), [(0.5, 1.0), (1.0, None)], ids=["disks", "wall"])
def test_the_stiffness_is_that_at_one_disk_weight(name, reduced_radius, second):
    one = law(name, reduced_radius)
    shape = shape_of(one, 1.0, second)
    low, high = 0.0, 1.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if asked(one, middle, shape)[0] < 1.0 else (low, middle)
    assert asked(one, low, shape)[1] == pytest.approx(3000.0, rel=1e-9)
    assert one.stiffest(1.0) == pytest.approx(3000.0)


def test_parameters_of_a_law_are_validated_stored_and_listed():
    scene = Scene().updated({"contact.law": "cohesive"})
    assert scene.contact.parameters == Cohesion(strength=0.1) == scene.resolved_wall.parameters
    strong = scene.updated({"contact.parameters.strength": 0.5})
    assert Scene.from_text(strong.to_yaml()) == strong != scene and "strength: 0.5" in strong.to_yaml()
    assert Problem.from_scene(strong).pair_law.strength == Problem.from_scene(strong).wall_law.strength == 0.5
    for name, value, said in (
        ("strength", -1.0, "must be a number, 0 or"),
        ("strenth", 1.0, "unknown key, did you mean stre"),
    ):
        mistake = {"contact.parameters": {name: value}}
        refuses(SceneError, rf"contact\.parameters\.{name} = {value}: {said}", scene.updated, mistake)
    with pytest.raises(SceneError, match=r"contact\.parameters\.strength = 0\.5: unknown key \(allowed: none\)"):
        Scene().updated({"contact.parameters": {"strength": 0.5}})
    weak = gr.LaboratoryUnits().reduced_scene({"contact": {"law": "cohesive", "parameters": {"strength": 6.57e-4}}})
    force = gr.LaboratoryUnits().to_reduced("force", 6.57e-4)
    assert weak["contact"]["parameters"]["strength"] == pytest.approx(force)
    every = (one for section in scene_reference.sections() for one in section.listed())
    (listed,) = (one for one in every if one.path == "contact.parameters.strength")
    assert (listed.default, listed.unit) == ("0.1", "mg") and listed.meaning.startswith("Pull")


def test_a_disk_hangs_on_the_floor_by_cohesion():
    """It bears its weight less the load, down to the pull of the contact; statics is not asked, and says why."""
    base = {"packing": {"kind": "arrays", "x": [1.0], "z": [1.0], "radius": [1.0], "width": 2.5}}
    base |= {"contact": {"law": "cohesive", "parameters": {"strength": 0.3}}, "loads": [{"disk": 0, "force": [0, 1.2]}]}
    with pytest.warns(UserWarning, match="not certified: .*a contact that pulls lets go at once"):
        result = gr.solve(base)
    state = result.loaded[-1]
    floor = state.walls.second == 0
    assert state.walls.normal_force[floor] == pytest.approx(-0.2, abs=1e-4)
    assert state.walls.overlap[floor] == pytest.approx(0.1 / 6000.0, abs=1e-7)
    assert "lets go at once" in result.to_dataset().attrs["method_reason"]
    with pytest.raises(gr.GranularError):  # beyond the pull the load carries it off
        gr.solve(gr.Scene.from_dict(base).updated({"loads.0.force": [0.0, 1.4]}))
    for method in ("path", "minimise"):
        said = rf"protocol\.method = {method}: must be dynamics or auto, a contact that pulls"
        with pytest.raises(SceneError, match=said):
            gr.solve(gr.Scene.from_dict(base).updated({"contact.friction": 0.0, "protocol.method": method}))


MINE = """
import granular_response as gr
from demonstration import Cubic

class Mine(Cubic):
    pass

gr.register_law("mine", Mine)
"""


def test_a_law_without_parameters_is_known_in_other_processes_and_tells_results_apart(tmp_path, monkeypatch):
    """Scenes bring its module, and its file is a part of the key under which results are kept."""
    file = tmp_path / "law_of_mine.py"
    file.write_text(MINE)
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("law_of_mine")

    scene = Scene().updated({"contact.law": "mine"})
    sent, before = pickle.dumps(scene), key(scene)
    del KNOWN_LAWS["mine"]
    del sys.modules["law_of_mine"]
    try:
        received = pickle.loads(sent)
        assert received == scene and type(Problem.from_scene(received).pair_law).__qualname__ == "Mine"
        file.write_text(MINE + "# another force\n")
        assert key(received) != before
    finally:
        del KNOWN_LAWS["mine"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("linear", Cubic), "is the name of another law, Linear"),
        (("two words", Cubic), "must be letters, digits and underscores"),
        (("mine", Cohesion), "has no normal_stiffness, .* must be a named tuple"),
        (("mine", Cubic, dict), "must be a subclass of"),
        (("mine", Cubic(*range(len(Cubic._fields)))), "has no class; must be a named tuple"),
        (("mine", Cohesive), "of.* missing 1 required keyword-only argument: 'strength'"),
    ],
)
def test_a_law_that_lacks_something_is_refused(arguments, said):
    refuses(gr.GranularError, said, gr.register_law, *arguments)
    assert "mine" not in KNOWN_LAWS


class Growth(Description):
    growth: NonNegative = Field(default=0.0, description="Of the force with the overlap.")


class Growing(Cohesive):
    """A force that grows, of which the energy knows nothing: right by its default alone."""

    @classmethod
    def of(cls, *constants, growth):
        return cls(*constants[:-1], growth)

    def elastic_force(self, overlap, shape):
        return self.normal_stiffness * overlap * (1.0 + self.strength * overlap)

    def stiffness(self, overlap, shape):
        return self.normal_stiffness * (1.0 + 2.0 * self.strength * overlap)

    def energy(self, overlap, shape):
        return 0.5 * self.normal_stiffness * overlap * overlap


#: A method of the cubic law, what takes its place, and what is said of the class.
WRONG = [
    ("elastic_force", lambda self, overlap, shape: 1.3 * self.factor * overlap * overlap * overlap,
     r"elastic_force is \S+ at overlap 1\.01e-06, where the derivative of energy is \S+$"),
    ("stiffness", lambda self, overlap, shape: 2.0 * self.factor * overlap * overlap,
     r"stiffness is .* at overlap 1\.01e-06, where the derivative of elastic_force is"),
    ("shapes", lambda self, first, second: np.ones(len(first)) if second is None else None,
     r"shapes is None for two disks or for a disk and a wall, must be for both or for neither$"),
    ("shapes", lambda self, first, second: 0.5, r"shapes is 0\.5 for 3 contacts, must be as many finite numbers$"),
    ("stiffest", lambda self, force: np.nan, r"stiffest is nan at a force of 1, must be a finite number greater"),
    ("energy", lambda self, overlap, shape: self.faktor * overlap,
     r"cannot be compiled, .*: Unknown attribute 'faktor' of type Wrong"),
    ("elastic_force", lambda self, overlap, shape: self.factor * overlap**3.0,  # for one contact alone
     r"cannot be compiled, must be arithmetic and functions of machine/lanes\.py: .*function pow"),
    ("energy", lambda self, delta, shape: delta, r"cannot be compiled, .* signature: \(self, delta, shape\)$"),
    ("of", classmethod(lambda cls, *constants: None), r"of\(\) gave None, must give the law$"),
]  # fmt: skip


@pytest.mark.parametrize(("method", "wrong", "said"), WRONG)
def test_a_law_that_contradicts_itself_is_refused(method, wrong, said):
    refuses(gr.GranularError, f"Wrong: {said}", gr.register_law, "wrong", type("Wrong", (Cubic,), {method: wrong}))
    assert "wrong" not in KNOWN_LAWS


def stiffer(factor: float, name: str) -> type:
    """A class of springs that are ``factor`` times as stiff, as a cell of a notebook defines it."""

    def elastic_force(self, overlap, shape):
        return factor * self.normal_stiffness * overlap

    def stiffness(self, overlap, shape):
        return factor * self.normal_stiffness

    def energy(self, overlap, shape):
        return 0.5 * factor * self.normal_stiffness * overlap * overlap

    return type(name, (Linear,), {one.__name__: one for one in (elastic_force, stiffness, energy)})


@pytest.mark.parametrize("name", ["Mine", "Linear"])  # the second is that of a law of the package
def test_a_class_of_the_same_name_is_another_law(name):
    two = scene(2, 7, contact__friction=0.0, loads=[])
    usual = Problem.from_scene(two)
    squeezed = replace(usual.bare_state(), position=0.999 * usual.bare_state().position)
    forces = [usual.with_static_forces(squeezed).pairs.normal_force.sum()]
    for factor in (2, 3):
        gr.register_law(f"{name}_{factor}", stiffer(factor, name))
        problem = Problem.from_scene(two.updated({"contact.law": f"{name}_{factor}"}))
        forces.append(problem.with_static_forces(squeezed).pairs.normal_force.sum())
        del KNOWN_LAWS[f"{name}_{factor}"]
    assert forces[0] > 0.0 and np.array(forces[1:]) / forces[0] == pytest.approx([2.0, 3.0])


def test_parameters_with_which_a_law_contradicts_itself_are_refused():
    gr.register_law("growing", Growing, Growth)
    try:
        scene = Scene().updated({"contact.law": "growing"})
        Problem.from_scene(scene)
        with pytest.raises(SceneError, match=r"^contact\.parameters: with these of law growing elastic_force is"):
            Problem.from_scene(scene.updated({"contact.parameters.growth": 5.0}))
    finally:
        del KNOWN_LAWS["growing"]


SCENE = """
packing: {kind: arrays, x: [1.0], z: [1.0], radius: [1.0], width: 2.5}
contact: {law: mine, friction: 0.0}
loads: [{disk: 0, force: [0.0, -1.0]}]
protocol: {method: dynamics, static_finish: false, stop_kinetic_energy: 1.0e-9}  # kernels of statics take longest
"""


def test_a_law_of_ones_own_on_the_command_line(tmp_path):
    """Its module is named by the option, and in what is said of a result whose law is not known."""
    (tmp_path / "law_of_mine.py").write_text(MINE)
    (tmp_path / "scene.yaml").write_text(SCENE)
    run = ("run", "scene.yaml", "-o", "a.nc")
    line = refused(*run, folder=tmp_path)
    assert "contact.law = 'mine': must be linear or hertz, or a law of gr.register_law" in line
    assert "more mistake" not in line
    environment = {**os.environ, "PYTHONPATH": PATHS}
    done = process(*run, "--import", "law_of_mine", folder=tmp_path, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    further = ("continue", "a.nc", "--to", "2", "-o", "b.nc")
    needed = "granular-response: a.nc: contact.law = 'mine': is a law of the module law_of_mine, which must be imported"
    assert refused(*further, folder=tmp_path).startswith(needed)
    with pytest.raises(gr.GranularError, match=r"is a law of the module law_of_mine"):
        _ = gr.open_result(tmp_path / "a.nc").scene
    missing = "granular-response: --import law_of_yours: ModuleNotFoundError: No module named 'law_of_yours'\n"
    assert refused(*further, "--import", "law_of_yours", folder=tmp_path) == missing
