"""What every contact law must fulfil, and the 3/2 law by hand (Sec. III.B)."""

import math

import numba as nb
import numpy as np
import pytest

from granular_response.contact import LAWS
from granular_response.contact.law import elastic_force, energy, stiffness
from granular_response.scene import Scene, SceneError
from granular_response.scene.material import Contact
from granular_response.solvers.problem import Problem


def law(name, reduced_radius=0.5, friction=0.2):
    return LAWS[name].of(3000.0, 54.0, 2400.0, 49.0, friction, -math.inf, reduced_radius)


@nb.njit(error_model="numpy")
def asked(law, overlap, shape):
    return elastic_force(law, overlap, shape), stiffness(law, overlap, shape), energy(law, overlap, shape)


def shape_of(law, first=1.0, second=1.0):
    shapes = law.shapes(np.array([first]), None if second is None else np.array([second]))
    return None if shapes is None else float(shapes[0])


def test_a_scene_can_name_every_law():
    assert set(Contact.model_fields["law"].annotation.__args__) == set(LAWS)
    for name in LAWS:
        problem = Problem.from_scene(Scene().updated({"contact.law": name}))
        assert type(problem.pair_law) is type(problem.wall_law) is LAWS[name]
    with pytest.raises(SceneError, match=r"contact\.law = .*must be linear or hertz"):
        Scene().updated({"contact.law": "hertzian"})


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("overlap", [1e-5, 1e-3, 0.1])
def test_stiffness_is_the_derivative_of_the_force_and_force_that_of_the_energy(name, overlap):
    one = law(name)
    shape, h = shape_of(one, 0.8, 1.1), 1e-6 * overlap
    up, down = asked(one, overlap + h, shape), asked(one, overlap - h, shape)
    force, stiff, _ = asked(one, overlap, shape)
    assert (up[0] - down[0]) / (2.0 * h) == pytest.approx(stiff, rel=1e-6)
    assert (up[2] - down[2]) / (2.0 * h) == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize("name", LAWS)
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


def test_hertz_by_hand():
    """f = K sqrt(R) xi^(3/2): eight times the force at four times the overlap, twice at four times the radius."""
    one = law("hertz")
    equal, wall = shape_of(one), shape_of(one, 2.0, None)
    assert equal == 1.0 and wall == pytest.approx(2.0)
    force = asked(one, 4e-4, equal)[0]
    assert force == pytest.approx((3000.0 / 1.5) ** 1.5 * 8e-6)
    assert asked(one, 16e-4, equal)[0] == pytest.approx(8.0 * force)
    assert asked(one, 4e-4, wall)[0] == pytest.approx(2.0 * force)


@pytest.mark.parametrize("name", LAWS)
def test_the_stiffest_contact_of_a_force(name):
    one = law(name)
    xi = 0.01
    force, stiff, _ = asked(one, xi, shape_of(one))
    assert one.stiffest(force) == pytest.approx(stiff)


@pytest.mark.parametrize("name", LAWS)
def test_without_friction_nothing_acts_along_the_tangent(name):
    smooth = law(name).without_friction()
    assert (smooth.friction, smooth.tangential_stiffness, smooth.tangential_damping) == (0.0, 0.0, 0.0)
    assert asked(smooth, 0.01, shape_of(smooth)) == asked(law(name), 0.01, shape_of(smooth))
