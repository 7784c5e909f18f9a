"""Equilibria of a few disks against closed forms of plane statics, derived here from the equations of balance.

Units: mean radius, mean mass, g; weights are 1. Not repeated here: rolling and sliding of a disk on a floor and on an
incline (MFIX DEM04, Chrono, ti-DEMPM: ``test_decks.py``), two disks pressed together (MFIX DEM03), collisions
(``test_motion_closed_forms.py``), Hertz contacts by three methods (``test_hertz.py``). Tolerances were declared before
the values were looked at.
"""

import math

import numpy as np
import pytest

import granular_response as gr

STIFF = 1e6


def solved(x, z, width, *, contact, wall, load=(), factors=(1.0,), radius=1.0, stiffness=STIFF) -> gr.Result:
    described = {
        "contact": {"normal_stiffness": stiffness, **contact}, "wall": wall, "loads": list(load),
        "protocol": {"time_step": "auto"},
    }  # fmt: skip
    scene = gr.Scene.from_arrays(x, z, radius, width=width, scene=described)
    return gr.solve(scene, load_factors=list(factors) if load else None, progress=False)


def wall_forces(state: gr.State, disk: int, wall: int) -> np.ndarray:
    """(2,) force of a wall on a disk, and 0 without a contact."""
    chosen = (state.walls.first == disk) & (state.walls.second == wall)
    return state.wall_force()[chosen].sum(axis=0)


def pyramid(friction: float, floor: float) -> gr.Result:
    """Three disks on a rough floor, a tenth of a radius from the walls; the lower ones do not press each other."""
    a = math.asin(1.001 / 2.0)
    x, z = [1.1, 3.102, 2.101], [1.0, 1.0, 1.0 + 2.0 * math.cos(a)]
    return solved(x, z, 4.202, contact={"friction": friction}, wall={"friction": floor}, stiffness=1e4)


@pytest.mark.parametrize(("part", "stands"), [(1.03, True), (0.97, False)])
@pytest.mark.parametrize("which", ["between disks", "on the floor"])
def test_thresholds_of_a_pyramid_without_walls(which, part, stands):
    """Friction that three disks need: tan(a / 2) between them and tan(a / 2) / 3 on the floor, a = 30 degrees.

    A lower disk turns under no torque, so that the friction T is the same at floor and contact; its balance along x,
    N sin(a) = T (1 + cos(a)), gives T / N = tan(a / 2). The upper one gives N cos(a) + T sin(a) = N = 1/2, and the
    floor bears 3/2. Below a threshold the lower disks go apart to the walls.
    """
    between, floor = math.tan(math.radians(15.0)), math.tan(math.radians(15.0)) / 3.0
    frictions = (part * between, 1.0) if which == "between disks" else (1.0, part * floor)
    state = pyramid(*frictions).rest
    apart = float(state.position[1, 0] - state.position[0, 0])
    assert (apart < 2.01) is stands
    if stands:
        at_floor = wall_forces(state, 0, 0)
        assert at_floor[1] == pytest.approx(1.5, rel=1e-6)


@pytest.mark.parametrize("degrees", [10.0, 20.0, 35.0, 50.0, 60.0])
def test_the_push_that_lifts_a_disk_over_a_curb(degrees):
    """A disk on the floor against a smaller one, up to 2e4 times as light: it lifts off at P = tan(b), b between curb
    and vertical, since P acts through its centre: moments about the point of the curb, P cos(b) = sin(b).

    The curb is held: in a corner the disk would meet the wall before it below 45 degrees.
    """
    b = math.radians(degrees)
    # centres at heights r and R: (R - r) / (R + r) = cos(b)
    small = (1.0 - math.cos(b)) / (1.0 + math.cos(b))
    weight = 2.0 / (1.0 + small**2)  # the mean is 1
    limit = weight * math.tan(b)
    load = [{"disk": 1, "force": [-limit, 0.0]}, {"disk": 0, "displacement": [0.0, 0.0]}]
    below = solved([20.0, 20.0 + (1.0 + small) * math.sin(b)], [small, 1.0], 60.0, radius=[small, 1.0],
                   contact={"friction": 0.0}, wall={}, load=load, factors=[0.999]).loaded[0]  # fmt: skip
    # what the floor bears falls in proportion to the push: the limit within 5e-5 of itself
    assert wall_forces(below, 1, 0)[1] == pytest.approx(weight * (1.0 - 0.999), rel=0.05)


@pytest.mark.parametrize("floor", [0.12, 0.18, 0.24])
def test_the_load_under_which_a_pyramid_slides_apart(floor):
    """With P on the upper disk N = (1 + P) / 2 at contact and floor, less the weight: the floor bears 1 + N and must
    hold T = N tan(a / 2) (balances of the pyramid above), so that no equilibrium exists beyond N (t - mu) = mu.

    Up to overlaps of P / k: 1e-4 of the load.
    """
    t = math.tan(0.5 * math.asin(1.001 / 2.0))
    limit = 2.0 * floor / (t - floor) - 1.0
    z = 1.0 + 2.0 * math.cos(math.asin(1.001 / 2.0))
    load = [{"disk": 2, "force": [0.0, -limit]}]
    found = solved([1.1, 3.102, 2.101], [1.0, 1.0, z], 4.202, contact={"friction": 1.0}, wall={"friction": floor},
                   load=load, factors=[0.5, 1.01])  # fmt: skip
    (lost,) = found.events.lost
    assert lost.load_factor == pytest.approx(1.0, abs=1e-4)
    apart = [float(state.position[1, 0] - state.position[0, 0]) for state in found.loaded]
    assert apart[0] < 2.01 and apart[1] > 2.1


@pytest.mark.parametrize(("friction", "degrees"), [(0.1, 40.0), (0.2, 20.0), (0.3, 30.0)])
def test_janssen_of_a_zigzag_between_rough_walls(friction, degrees):
    """Disks in turn at the left and the right wall, pressed down until all slide there: with contacts N above and N'
    below at the angle a to the vertical a wall bears W = (N + N') sin(a), and N' cos(a) + mu W = N cos(a) + 1.

    So N' (cos(a) + mu sin(a)) = N (cos(a) - mu sin(a)) + 1, Janssen's saturation 1 / (2 mu sin(a)) disk by disk. The
    contacts between disks are smooth (1e-6), and rolling moments, which enter no balance of forces, stop the disks
    from rolling down like gears. Up to overlaps: 1e-4.
    """
    count, push, a = 8, 20.0, math.radians(degrees)
    width = 2.0 + 2.0 * math.sin(a)
    rolling = {"rolling_friction": 10.0, "rolling_stiffness_ratio": 10.0}
    x = [1.0 if k % 2 == 0 else width - 1.0 for k in range(count)]
    load = [{"disk": count - 1, "force": [0.0, -push]}]
    state = solved(x, [1.0 + 2.0 * math.cos(a) * k for k in range(count)], width, load=load,
                   contact={"friction": 1e-6, **rolling}, wall={"friction": friction, **rolling}).loaded[0]  # fmt: skip
    for disk in range(1, count):  # the lowest one is held by the floor too
        across, upward = wall_forces(state, disk, 1 if disk % 2 == 0 else 2)
        assert upward == pytest.approx(friction * abs(across), rel=1e-9)
    bears, above = [], 0.0
    for k in range(count - 1):
        above = above * (math.cos(a) - friction * math.sin(a)) + 1.0 + (push if k == 0 else 0.0)
        above /= math.cos(a) + friction * math.sin(a)
        bears.append(above)
    heights = state.position[state.pairs.first, 1] + state.position[state.pairs.second, 1]
    assert state.pairs.normal_force[np.argsort(-heights)] == pytest.approx(bears, rel=1e-4)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("count", [6, 10, 15])
def test_forces_of_a_smooth_packing_follow_from_its_geometry(count, seed):
    """Without friction 2 n balances of forces have one solution for at most 2 n forces: solved from the directions of
    the contacts alone, without their law. Forces of some mg within 1e-9."""
    packing = gr.Poured(disks=count, width=7.0, polydispersity=0.3, seed=seed)
    contact = gr.Contact(friction=0.0, normal_stiffness=STIFF)
    push = gr.Load(disk="top-centre", force=(1.5, -3.0))
    scene = gr.Scene(packing=packing, contact=contact, loads=[push], protocol={"time_step": "auto"})
    found = gr.solve(scene, progress=False)
    weight = packing.build().radius ** 2
    for state, force in ((found.rest, (0.0, 0.0)), (found.loaded[0], push.force)):
        outer = np.zeros((count, 2))
        outer[:, 1] = -weight / weight.mean()
        outer[found.loaded_disks[0]] += force
        columns, borne = [], []
        for contacts in (state.pairs, state.walls):
            for k in np.flatnonzero(contacts.touching):
                column, one, other = np.zeros((count, 2)), contacts.first[k], contacts.second[k]
                if contacts is state.pairs:
                    apart = state.position[one] - state.position[other]
                    column[one], column[other] = apart / np.hypot(*apart), -apart / np.hypot(*apart)
                else:
                    column[one] = ((0.0, 1.0), (1.0, 0.0), (-1.0, 0.0))[other]
                columns.append(column.ravel())
                borne.append(contacts.normal_force[k])
        matrix = np.array(columns).T
        solution, _, rank, _ = np.linalg.lstsq(matrix, -outer.ravel(), rcond=1e-9)
        assert rank == len(borne) >= 2 * count - 1
        np.testing.assert_allclose(borne, solution, rtol=0.0, atol=1e-9)


def floor_wave(layers: int, disks_per_row: int) -> tuple[float, float]:
    """Part of a wave of load on the top row that reaches the floor of a smooth periodic slab, and the closed form."""
    slab = gr.Slab(layers=layers, disks_per_row=disks_per_row, sides="periodic", lattice_constant=1.99)
    scene = gr.Scene(packing=slab, contact=gr.Contact(friction=0.0), loads=[])
    x, z = gr.solve(scene, progress=False).rest.position.T
    top, floor = np.argsort(z)[-disks_per_row:], np.argsort(z)[:disks_per_row]
    wave = np.cos(2.0 * math.pi * x / (1.99 * disks_per_row))
    push = [gr.Load(disk=int(k), force=(0.0, -1e-3 * wave[k])) for k in top]
    found = gr.solve(scene.updated({"loads": push}), progress=False)
    change = [wall_forces(found.loaded[0], k, 0)[1] - wall_forces(found.rest, k, 0)[1] for k in floor]
    depth = 2.0 * math.pi / (1.99 * disks_per_row) * z[top].mean()
    closed = 2.0 * (math.sinh(depth) + depth * math.cosh(depth)) / (math.sinh(2.0 * depth) + 2.0 * depth)
    return float(2e3 * (change @ wave[floor]) / disks_per_row), closed


@pytest.mark.parametrize("disks", [2, 3])
def test_a_slab_of_disks_is_an_elastic_layer(disks):
    """Pressure p cos(q x) on a layer of depth H on a smooth floor: 2 (sinh(qH) + qH cosh(qH)) / (sinh(2qH) + 2qH) of it
    there, whatever the isotropic moduli. Airy's function cos(q x) (A cosh(q z) + B q z sinh(q z)), no shear at z = H.

    A lattice without friction is isotropic. 4 % with 12 layers, and half of that with twice as many.
    """
    coarse, fine = (floor_wave(layers, disks * layers) for layers in (12, 24))
    assert coarse[0] == pytest.approx(coarse[1], rel=0.04)
    assert fine[0] == pytest.approx(fine[1], rel=0.02)
