"""Motion from any start against closed forms: verification decks of other codes as scenes."""

import math

import numpy as np
import pytest

import granular_response as gr


def test_a_collision_keeps_momentum_and_its_restitution():
    """Linear springs and dashpots: exp(-pi zeta / sqrt(1 - zeta^2)) (Spheral, TwoParticleCollision).

    The damping ratio of a scene is that of a disk at a wall, with twice the reduced mass of two disks.
    """
    zeta = 0.15 * math.sqrt(2.0)
    law = {"friction": 0.0, "damping_ratio": 0.15}
    free = {"loads": [], "contact": law, "motion": {"weightless": True}, "protocol": {"time_step": 2e-5}}
    two = gr.Scene.from_arrays([500.0, 502.01], [50.0, 50.0], 1.0, width=1000.0, vx=[0.5, -0.5], scene=free)
    found = gr.motion(two, [0.0, 0.2], progress=False)
    apart = float(np.diff(found["velocity"].sel(axis="x").isel(time=1))[0])
    assert apart == pytest.approx(math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2)), abs=5e-4)
    np.testing.assert_allclose(found["momentum"], 0.0, atol=1e-15)
    np.testing.assert_allclose(found["angular_momentum"], 0.0, atol=1e-12)
    assert float(found["kinetic_energy"][1]) == pytest.approx(0.25 * apart**2, rel=1e-12)


def test_times_that_are_looked_at_change_nothing_of_what_follows():
    slab = gr.Scene.from_dict({"packing": {"kind": "slab", "layers": 3, "disks_per_row": 7}, "loads": []})
    moved = slab.updated({"motion.vx": 0.3, "motion.spin": 0.2, "wall.friction": 0.2})
    end = gr.motion(moved, [2.0], progress=False)
    often = gr.motion(moved, [0.1, 0.33333, 0.71828, 1.0, 2.0], progress=False)
    for name in ("position", "velocity", "angle"):
        np.testing.assert_allclose(often[name][-1], end[name][-1], rtol=0.0, atol=1e-12)
    between = gr.motion(moved, [0.33320, 0.33330, 0.33340], progress=False)["position"].values
    np.testing.assert_allclose(between[1], 0.5 * (between[0] + between[2]), atol=1e-6)


def test_an_equilibrium_stays_and_a_load_moves_it():
    packing = {"kind": "slab", "layers": 3, "disks_per_row": 7}
    slab = gr.Scene.from_dict({"packing": packing, "contact": {"friction": 0.0}, "protocol": {"ramp_time": 0.0}})
    result = gr.solve(slab, progress=False)
    still = gr.motion(slab.updated({"loads": []}), [5.0], start=result.rest, progress=False)
    np.testing.assert_allclose(still["position"][0], result.rest.position, atol=1e-12)
    assert float(still["kinetic_energy"][0]) < 1e-20
    pushed = gr.motion(slab, [0.0, 200.0], start=result.rest, progress=False)
    np.testing.assert_allclose(pushed["position"][1], result.loaded[-1].position, atol=1e-6)
    assert pushed["load_factor"].values.tolist() == [1.0, 1.0]
    smooth = slab.updated({"protocol.ramp_time": 5.0})
    named = smooth.updated({"loads.0.disk": int(result.loaded_disks[0])})
    under = gr.motion(named, [1.0], start=result.loaded[-1], progress=False)  # its load is there from the beginning
    np.testing.assert_allclose(under["position"][0], result.loaded[-1].position, atol=1e-12)
    with pytest.raises(
        gr.SceneError, match=r"^loads\[0\]\.disk = 'top-centre': must be the number of a disk, since start"
    ):
        gr.motion(smooth, [1.0], start=result.loaded[-1])
    with pytest.raises(gr.SceneError, match=r"^start: a Result, must be a state, such as result.rest or result.loaded"):
        gr.motion(slab, [1.0], start=result)
    with pytest.raises(gr.SceneError, match=r"^start: a state of 20 disks, must be one of this packing of 908$"):
        gr.motion(gr.Scene(loads=[]), [1.0], start=result.rest)
    for other in ({"packing.polydispersity": 0.1}, {"packing.lattice_constant": 1.999}):
        with pytest.raises(gr.SceneError, match=r"^start: a state of other radii or in another box, must be"):
            gr.motion(slab.updated({"loads": [], **other}), [1.0], start=result.rest)
