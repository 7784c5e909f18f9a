"""Equilibria of a few disks against closed forms of plane statics, derived here from the equations of balance.

Units: mean radius, mean mass, g; weights are 1. Not repeated here: rolling and sliding of a disk on a floor and on an
incline (MFIX DEM04, Chrono, ti-DEMPM: ``test_decks.py``), two disks pressed together (MFIX DEM03), collisions
(``test_motion_closed_forms.py``), the elastic slab by finite elements (``test_theory_slab_independent.py``), Hertz
contacts by three methods (``test_hertz.py``).
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


@pytest.mark.parametrize("gap", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("force", [0.0, 3.0])
def test_a_smooth_pyramid_presses_its_walls(gap, force):
    """Two disks at smooth walls bear a third: each wall bears (1 + P) tan(a) / 2, with sin(a) half the distance over 2.

    Balance of the upper disk: 2 N cos(a) = 1 + P; of a lower one: wall N sin(a), floor 1 + N cos(a). By geometry alone
    (isostatic), up to overlaps of 1e-6.
    """
    a = math.asin((1.0 + 0.5 * gap) / 2.0)
    load = [{"disk": 2, "force": [0.0, -force]}] if force else []
    x = [1.0, 3.0 + gap, 2.0 + 0.5 * gap]
    found = solved(x, [1.0, 1.0, 1.0 + 2.0 * math.cos(a)], 4.0 + gap, contact={"friction": 0.0}, wall={}, load=load)
    state = (found.rest, *found.loaded)[-1]
    assert wall_forces(state, 0, 1)[0] == pytest.approx(0.5 * (1.0 + force) * math.tan(a), rel=2e-5)
    assert wall_forces(state, 1, 2)[0] == pytest.approx(-0.5 * (1.0 + force) * math.tan(a), rel=2e-5)
    assert wall_forces(state, 0, 0)[1] == pytest.approx(1.0 + 0.5 * (1.0 + force), rel=1e-6)


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


@pytest.mark.parametrize("degrees", [50.0, 60.0])
def test_the_push_that_lifts_a_disk_over_a_curb(degrees):
    """A disk on the floor against a smaller one fast in the corner: it lifts off at P = tan(b), b between curb and
    vertical, since P acts through its centre: moments about the point of the curb, P cos(b) = sin(b).

    The curb is a disk at the left wall, held by the wall and by its own floor contact.
    """
    b = math.radians(degrees)
    # centres at heights r and R: (R - r) / (R + r) = cos(b)
    small = (1.0 - math.cos(b)) / (1.0 + math.cos(b))
    x = small + (1.0 + small) * math.sin(b)
    scene = gr.Scene.from_arrays(
        [small, x], [small, 1.0], [small, 1.0], width=40.0,
        scene={
            "contact": {"friction": 0.0, "normal_stiffness": STIFF},
            "protocol": {"time_step": "auto", "method": "path"},
            "loads": [{"disk": 1, "force": [-1.0, 0.0]}],
        },
    )  # fmt: skip
    weight = 2.0 / (1.0 + small**2)  # the mean is 1
    limit = weight * math.tan(b)
    below = gr.solve(scene, load_factors=[0.999 * limit], progress=False).loaded[0]
    # what the floor bears falls in proportion to the push: the limit within 5e-5 of itself
    assert wall_forces(below, 1, 0)[1] == pytest.approx(weight * (1.0 - 0.999), rel=0.05)


@pytest.mark.parametrize(("law", "power"), [("linear", 1.0), ("hertz", 1.5)])
def test_overlaps_of_a_column(law, power):
    """The k-th contact from the top bears k weights: overlap k / K, or (k / K')^(2/3) with the 3/2 law.

    K' from the lowest contact between disks: ratios of overlaps need no constant of the law.
    """
    count = 5
    found = solved([1.0] * count, [1.0 + 2.0 * k for k in range(count)], 2.0, contact={"friction": 0.0, "law": law},
                   wall={}, stiffness=1e5)  # fmt: skip
    state = found.rest
    by_height = np.argsort(np.minimum(state.position[state.pairs.first, 1], state.position[state.pairs.second, 1]))
    closed = [k for k in by_height[::-1] if state.pairs.touching[k]]
    bears = np.arange(1, count)
    assert state.pairs.normal_force[closed] == pytest.approx(bears, rel=1e-9)
    overlap = state.pairs.overlap[closed]
    assert overlap / overlap[0] == pytest.approx(bears ** (1.0 / power), rel=1e-6)
    if law == "linear":
        assert overlap == pytest.approx(bears / 1e5, rel=1e-6)
