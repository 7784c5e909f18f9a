"""Moduli of small packings and of small slabs under load, and the elastic slabs with them beside theory."""

import numpy as np
import pytest
import reduced

from granular_response.scene import Scene
from granular_response.studies import LoadPath, Measures
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import response_of_layers
from granular_response_extensions.moduli.parameters import Parameters
from granular_response_extensions.moduli.simulate import response
from granular_response_extensions.moduli.simulate.loaded import loads, respond
from granular_response_extensions.moduli.simulate.solid import Solid, fitted, triangles
from granular_response_paper.parameters import UNIT_LOAD


def test_the_prediction_is_the_elastic_slab_between_walls():
    solid = lattice.moduli(Springs.uniform(1.0, 0.5), "free")
    layers, period = 10, 60.0
    height = np.sqrt(3.0) * layers
    given = np.array([solid.a, solid.b, solid.c, solid.d])
    found = response.prediction(given, height, period, "rough", np.array([2.0, 3.0]))
    x = np.arange(-0.5 * period + 1.0, 0.5 * period, 2.0)
    shares = response_of_layers(x, layers=layers, moduli=solid, floor="rough", width=period)
    around = np.concatenate([x - period, x, x + period])
    smooth = response.smoothed_response(response.PLACES * height, around, np.tile(shares, 3), 3.0) * height
    assert found[1] == pytest.approx(smooth, abs=0.02)  # shares stand for the pressure on two radii
    assert np.isnan(response.prediction(-given, height, period, "rough", np.array([3.0]))).all()


def test_the_nearest_isotropic_solid_is_isotropic_and_leaves_one_that_is():
    solid = Moduli.isotropic(0.3)
    given = np.array([solid.a, solid.b, solid.c, solid.d])
    assert response.nearest_isotropic(given) == pytest.approx(given)
    a, b, c, d = response.nearest_isotropic(np.array([1.0, 2.0, 0.3, 0.8]))
    assert a == b and d == pytest.approx(a - c)


def loaded(friction: float, force: float) -> tuple[LoadPath, Solid, np.ndarray]:
    """A slab of 11 layers, its solid, and what a further force adds to the floor forces."""
    scene: Scene = UNIT_LOAD.updated({"packing.layers": 11, "packing.disks_per_row": 41, "contact.friction": friction})
    path = LoadPath.of(scene)
    state = path.at(force)
    solid = Solid(path.problem, state, triangles(path.problem.packing.position))
    load = path.problem.load_vector
    return path, solid, solid.floor_forces(solid.system.answers(solid.trial)(load))


def measured(path: LoadPath, solid: Solid, width: float) -> np.ndarray:
    family = loads(path.problem, path.known[max(path.known)], 8, 4)["body"]
    return fitted(*solid.averaged(solid.fields(map(solid.system.answers(solid.trial), family)), width))


@pytest.mark.parametrize(("friction", "within"), [(0.0, 0.02), (1.0, 0.05)])
def test_a_lattice_has_its_moduli(friction, within):
    path, solid, _ = loaded(friction, 1e-3)
    contact = path.scene.contact
    ratio = contact.stiffness_ratio if friction else 0.0
    springs = Springs.uniform(contact.normal_stiffness, ratio * contact.normal_stiffness)
    expected = lattice.moduli(springs, "free").matrix()
    middle = np.abs(solid.centre - [path.problem.packing.width / 2, 9.0]).max(axis=1) < 5.0
    found = measured(path, solid, 2.0)[middle]
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), atol=within * expected.max())


def test_a_uniform_solid_responds_as_the_elastic_slab():
    path, solid, _ = loaded(0.0, 1e-3)
    contact = path.scene.contact
    uniform = lattice.moduli(Springs.uniform(contact.normal_stiffness, 0.0))
    disk = int(path.problem.load_disk[0])
    moved = solid.answer(np.broadcast_to(uniform.matrix(), (len(solid.area), 3, 3)), disk)
    measures = Measures(path)
    found = solid.floor_forces(moved)[measures.disks]
    height = path.rest.position[disk, 1]  # triangles end at the centres of the top row
    expected = response_of_layers(
        measures.x, layers=11, moduli=uniform, width=path.problem.packing.width, height=height
    )
    assert found.sum() == pytest.approx(1.0, abs=1e-9)
    assert np.abs(found - expected)[measures.interior].max() < 0.02 * expected.max()


def test_triangles_that_are_not_averaged_are_the_network_without_friction():
    """Each contact is as long as its triangles say: only the turn of the contacts under their forces is left out."""
    path, solid, expected = loaded(0.0, 4.0)
    assert Measures(path).opened(path.at(4.0)) > 50
    disk = int(path.problem.load_disk[0])
    found = solid.floor_forces(solid.answer(measured(path, solid, 0.01), disk))
    assert np.abs(found - expected).max() < 0.03 * expected.max()


def test_the_smallest_slab_has_moduli_too():
    loaded = Parameters(**reduced.parameters("moduli")).loaded
    small = UNIT_LOAD.updated({"packing.layers": 2, "packing.disks_per_row": 5})
    (step,) = respond(small, loaded, (0.1,)).steps
    assert np.isfinite(step.criterion).all() and step.tangent_error < 1e-4
