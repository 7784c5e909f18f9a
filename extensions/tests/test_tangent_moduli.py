"""Incremental moduli of loaded slabs of 5 layers, and the elastic solid against what is known of lattices."""

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.theory.lattice import Springs, moduli
from granular_response.theory.slab import response_of_layers
from granular_response_extensions.tangent_moduli import simulate
from granular_response_extensions.tangent_moduli.simulate.solid import Solid, fitted, triangles
from granular_response_paper.parameters import UNIT_LOAD
from granular_response_paper.slab_response import LoadPath, Measures


def loaded(friction: float, force: float) -> tuple[LoadPath, Solid, np.ndarray]:
    """A slab of 11 layers, its solid, and what a further force adds to the floor forces."""
    scene: Scene = UNIT_LOAD.updated({"packing.layers": 11, "packing.disks_per_row": 41, "contact.friction": friction})
    path = LoadPath.of(scene)
    state = path.at(force)
    solid = Solid(path.problem, state, triangles(path.problem.packing.position))
    load = path.problem.load_vector
    return path, solid, solid.floor_forces(solid.system.answers(solid.trial)(load))


def measured(path: LoadPath, solid: Solid, width: float) -> np.ndarray:
    family = simulate.loads(path.problem, path.known[max(path.known)], (8, 4))["body"]
    strain, stress, _ = solid.averaged(solid.fields(map(solid.system.answers(solid.trial), family)), width)
    return fitted(strain, stress)[0]


@pytest.mark.parametrize(("friction", "within"), [(0.0, 0.02), (1.0, 0.05)])
def test_a_lattice_has_its_moduli(friction, within):
    path, solid, _ = loaded(friction, 1e-3)
    contact = path.scene.contact
    ratio = contact.stiffness_ratio if friction else 0.0
    expected = moduli(Springs.uniform(contact.normal_stiffness, ratio * contact.normal_stiffness), "free").matrix()
    middle = np.abs(solid.centre - [path.problem.packing.width / 2, 9.0]).max(axis=1) < 5.0
    found = measured(path, solid, 2.0)[middle]
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), atol=within * expected.max())


def test_a_uniform_solid_responds_as_the_elastic_slab():
    path, solid, _ = loaded(0.0, 1e-3)
    contact = path.scene.contact
    uniform = moduli(Springs.uniform(contact.normal_stiffness, 0.0))
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


def test_the_tangent_is_that_of_the_path_and_floors_bear_all(datasets):
    slabs = datasets["slabs"]
    assert float(slabs["tangent_error"].max()) < 1e-4
    known = np.isfinite(slabs["force"])
    np.testing.assert_allclose(slabs["measured"].sum("floor_disk").values[known], 1.0, atol=1e-9)
    np.testing.assert_allclose(slabs["predicted"].sum("floor_disk").values[known], 1.0, atol=1e-9)
