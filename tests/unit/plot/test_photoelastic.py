"""The stress in a disk against closed forms, and the photoelastic pictures made of it."""

import numpy as np
import pytest

import granular_response as gr
from granular_response.observe.disk_stress import disk_stress, principal_difference
from granular_response.plot import style
from granular_response.plot.pictures import PictureError

SCENE = {
    "packing": {"kind": "slab", "layers": 5, "disks_per_row": 9},
    "loads": [{"disk": {"row": "top", "offset": 1}, "force": [0.5, -4.0]}],
}


@pytest.fixture(scope="module")
def result() -> gr.Result:
    return gr.solve(SCENE)


def drawn(result, **options) -> np.ndarray:
    axes = gr.plot.photoelastic(result, ax=style.figure()[1][0, 0], **options)
    return np.asarray(axes.images[0].get_array())


def unit(angle) -> np.ndarray:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@pytest.mark.parametrize("radius", [1.0, 0.6])
def test_a_disk_between_two_forces(radius: float) -> None:
    """Timoshenko and Goodier, art. 41: at the centre 2 P / π D in tension across, 6 P / π D in compression along."""
    outward, push = np.array([[0.0, 1.0], [0.0, -1.0]]), 2.5
    (centre,) = disk_stress(np.zeros((1, 2)), outward, -push * outward, radius)
    unit_stress = push / (np.pi * 2.0 * radius)
    np.testing.assert_allclose(centre, [[-2.0 * unit_stress, 0.0], [0.0, 6.0 * unit_stress]], atol=1e-14)
    # along the diameter across both forces, with its distance from the centre
    x = radius * np.linspace(-1.0, 1.0, 9)
    stress = disk_stress(np.stack([x, 0.0 * x], axis=1), outward, -push * outward, radius)
    along = 4.0 / (1.0 + (x / radius) ** 2) ** 2
    np.testing.assert_allclose(stress[:, 1, 1] / unit_stress, 2.0 * along - 2.0, atol=1e-12)


def random_forces(seed: int) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(seed)
    return unit(generator.uniform(0.0, 2.0 * np.pi, 5)), generator.normal(size=(5, 2))


@pytest.mark.parametrize("seed", range(3))
def test_the_rim_is_free_of_stress_but_at_the_contacts(seed: int) -> None:
    """With forces and torques that do not balance too: what balances them is spread over the disk."""
    outward, force = random_forces(seed)
    radius, normal = 0.8, unit(np.linspace(0.0, 2.0 * np.pi, 50) + 0.01)
    stress = disk_stress(radius * normal, outward, force, radius)
    traction = np.einsum("pij,pj->pi", stress, normal)
    np.testing.assert_allclose(traction, 0.0, atol=1e-11 * np.abs(stress).max())


@pytest.mark.parametrize("seed", range(3))
def test_the_stress_balances_what_is_spread_over_the_disk(seed: int) -> None:
    outward, force = random_forces(seed)
    radius, step = 0.8, 1e-5
    point = np.random.default_rng(seed).uniform(-0.3, 0.3, (7, 2))
    slope = [
        (disk_stress(point + h, outward, force, radius) - disk_stress(point - h, outward, force, radius)) / (2.0 * step)
        for h in step * np.eye(2)
    ]
    divergence = slope[0][:, :, 0] + slope[1][:, :, 1]
    torque = radius * np.sum(outward[:, 0] * force[:, 1] - outward[:, 1] * force[:, 0])
    turned = np.stack([-point[:, 1], point[:, 0]], axis=1)
    spread = -force.sum(axis=0) / (np.pi * radius**2) - 2.0 * torque * turned / (np.pi * radius**4)
    np.testing.assert_allclose(divergence, spread, atol=1e-7)


@pytest.mark.parametrize("added", [True, False])
def test_mirrored_states_give_mirrored_pictures(result, added: bool) -> None:
    options = {"added": added, "pixels": 300, "fringe": 20.0}  # wide fringes: no pixel decides by a last digit
    load = {"disk": {"row": "top", "offset": -1}, "force": [-0.5, -4.0]}
    picture, other = drawn(result, **options), drawn(gr.solve({**SCENE, "loads": [load]}), **options)
    assert picture.max() > 0.5
    assert np.abs(picture - other[:, ::-1]).max() < 1e-6 < np.abs(picture - other).max()


def test_the_light_is_that_of_the_stress(result) -> None:
    """A pixel at the centre of a disk, of four points around it."""
    fringe, disk, pixels = 4.0, 21, 900
    picture = drawn(result, fringe=fringe, pixels=pixels)
    loaded, rest = result.loaded[0], result.rest
    force = loaded.pair_force() - rest.pair_force()
    normal, pairs = loaded.pair_normal(), loaded.pairs
    outward = np.concatenate([-normal[pairs.first == disk], normal[pairs.second == disk]])
    forces = np.concatenate([force[pairs.first == disk], -force[pairs.second == disk]])
    assert not np.any(loaded.walls.first[loaded.walls.touching] == disk)
    size = loaded.box.width / pixels
    column, row = (loaded.position[disk] / size).astype(int)
    points = np.array([[column + a, row + b] for a in (0.25, 0.75) for b in (0.25, 0.75)]) * size
    stress = disk_stress(points - loaded.position[disk], outward, forces, 1.0)
    expected = np.mean(np.sin(np.pi * principal_difference(stress) / fringe) ** 2)
    assert expected > 0.001 and picture[row, column] == pytest.approx(expected, rel=1e-9)


def test_periodic_sides_show_a_disk_at_both() -> None:
    scene = {"packing": {"kind": "slab", "layers": 3, "disks_per_row": 6, "sides": "periodic"}}
    picture = drawn(gr.solve({**scene, "loads": [{"disk": 0, "force": [0.0, -3.0]}]}), pixels=240)
    assert picture[:20, :10].max() > 0.0 and picture[:20, -10:].max() > 0.0


@pytest.mark.parametrize("name", ["fringe", "half_width", "pixels"])
def test_numbers_that_are_not_positive_are_refused(result, name: str) -> None:
    with pytest.raises(PictureError, match=f"{name} = 0: must be a finite number greater than 0"):
        gr.plot.photoelastic(result, **{name: 0})
