"""A packing strained as a whole against closed forms, and against the solvers that displace its ends."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refuses
from small_scenes import scene as small

from granular_response.errors import EquilibriumError
from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene
from granular_response.solvers.strain import FOLLOWING, strained
from granular_response.state import STICKING
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs

LAYERS, ROW = 8, 6
ALIKE = pytest.approx


def described(changes, loads=()) -> Scene:
    base = small(LAYERS, ROW, packing__sides="periodic", protocol__time_step="auto", loads=list(loads))
    rubs = {"contact": {"friction": 10.0, "stiffness_ratio": 0.4}, "wall.friction": 10.0}
    return base.updated(rubs).updated(changes)


@pytest.fixture(scope="module")
def disordered():
    return solve_scene(described({"packing.polydispersity": 0.1, "packing.lattice_constant": "touching-largest"}))


def unstressed(ratio, horizontal):
    """A lattice in which every contact bears a force of next to nothing; horizontal ones are open on demand."""
    spacing = 2.0 - 1e-12
    changes = {"contact.stiffness_ratio": ratio, "preparation.gravity": "frictionless", "packing.layers": 3 * LAYERS}
    scene = described({"packing.lattice_constant": 1.999, **changes})
    solution = solve_scene(scene)
    problem, rest = solution.problem, solution.rest
    packing = scene.updated({"packing.lattice_constant": spacing}).packing.build()
    pairs = rest.pairs
    level = packing.row[pairs.first] == packing.row[pairs.second]
    apart = packing.box.separation(packing.position[pairs.first], packing.position[pairs.second])
    near = (np.linalg.norm(apart, axis=1) < 2.1) & (horizontal | ~level)
    closed = {"overlap": np.where(near, 1e-12, -1.0), "status": np.where(near, STICKING, 0).astype(np.int8)}
    bears = dict.fromkeys(("normal_force", "tangential_force", "spring"), np.zeros(len(level)))
    state = replace(rest, position=packing.position, box=packing.box, pairs=replace(pairs, **closed, **bears))
    if not horizontal:  # what touches is found from positions: a hair wider and lower
        position = packing.position * [1.0 + 1e-9, 1.0 - 1e-9]
        packing = replace(packing, width=packing.width * (1.0 + 1e-9))
        state = replace(state, position=position, box=packing.box)
    return replace(problem, packing=packing), state


@pytest.mark.parametrize("horizontal", [True, False])
@pytest.mark.parametrize("ratio", [0.3, 1.0])
def test_an_unstressed_lattice_has_the_moduli_of_the_closed_form(ratio, horizontal):
    problem, state = unstressed(ratio, horizontal)
    springs = Springs(float(horizontal), 1.0, horizontal * ratio, ratio)
    for following in FOLLOWING:
        # disks of the ends have fewer neighbours to turn against, which is felt some rows into the packing
        found = strained(problem, state, following, margin=0.4).moduli / problem.stiffness
        expected = lattice.moduli(springs, "free" if following == "free" else "suppressed").matrix()
        assert found == ALIKE(expected, abs=1e-8)
    if horizontal:  # isotropic
        assert found[0, 0] - found[0, 1] == ALIKE(found[2, 2], abs=1e-8)


def cut_force(rest, loaded, height):
    """(2,) change of the force through a horizontal cut, per length: what the part above feels."""
    z = rest.position[:, 1]
    total = np.zeros(2)
    change = loaded.pair_force() - rest.pair_force()
    for i, j, force in zip(rest.pairs.first, rest.pairs.second, change, strict=True):
        if (z[i] < height) != (z[j] < height):
            total += force if z[i] >= height else -force
    return -total / rest.box.width


@pytest.mark.parametrize(("strain", "shift"), [(1, [0.0, 1.0]), (2, [2.0, 0.0])])
def test_ends_that_a_solver_displaces_feel_the_same_stress(disordered, strain, shift):
    size = 1e-7
    row, rest = disordered.problem.packing.row, disordered.rest
    ends = np.flatnonzero((row == 0) | (row == LAYERS - 1))
    loads = [
        {"disk": int(k), "displacement": [size * part * float(rest.position[k, 1]) for part in shift]} for k in ends
    ]
    moved = solve_scene(disordered.problem.scene.updated({"loads": loads}))
    between = 0.5 * (rest.position[row == 3, 1].mean() + rest.position[row == 4, 1].mean())
    stress = cut_force(moved.rest, moved.loaded[0], between) / size
    found = strained(disordered.problem, rest).stress[strain, strain]
    # simple shear turns the packing too, and with it the forces that contacts bear
    assert stress[1 if strain == 1 else 0] == ALIKE(found, rel=1e-5 if strain == 1 else 1e-2)


def test_what_follows_the_strain_is_stiffer_than_what_relaxes(disordered):
    affine, suppressed, free = (strained(disordered.problem, disordered.rest, how).moduli for how in FOLLOWING)
    for matrix in (affine, suppressed, free):
        symmetric = 0.5 * (matrix + matrix.T)
        assert np.linalg.eigvalsh(symmetric).min() > 0.0
    for stiff, soft in ((affine, suppressed), (suppressed, free)):
        assert (np.diag(stiff) > np.diag(soft)).all()


def test_what_cannot_be_strained_is_refused(disordered):
    problem, rest = disordered.problem, disordered.rest
    with pytest.raises(ValueError, match="following = 'rigid': must be one of affine, suppressed, free"):
        strained(problem, rest, "rigid")
    refuses(ValueError, r"margin = 0\.5: must be from 0 to below 0.5", strained, problem, rest, margin=0.5)
    refuses(ValueError, "leaves none of 8 rows", strained, problem, rest, margin=0.49)
    with pytest.raises(ValueError, match=r"^packing\.sides = walls: must be periodic for"):
        walls = solve_scene(described({"packing.sides": "walls", "preparation.gravity": "frictionless"}))
        strained(walls.problem, walls.rest)
    with pytest.raises(EquilibriumError, match="not certified as stable"):
        strained(problem, replace(rest, reached=replace(rest.reached, certificate=None)))
