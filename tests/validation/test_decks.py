"""Verification decks of other codes, on disks: each against its published number or closed form.

Spheres became disks (moment of inertia m R^2 / 2, so that 2/7 and 5/7 of a sphere that begins to roll become 1/3 and
2/3). A deck is a scene where keys allow it; what begins with a velocity runs in :class:`Dynamics`.
Numbers are in units of radius, mean mass and g unless said. Sources, by repository and path:

* MFIX DEM01 to DEM05: truongd8593/mfix, tests/dem
* YADE checkViscElPM, checkWeight: bchareyre/yade-mpi, scripts/checks-and-tests/checks
* MercuryDPM CGStaticBalance, SquarePacking: kuwt/MercuryDPM_fork, Drivers/SelfTests/CG
* Spheral twoParticleCollision-2d: LLNL/spheral, tests/functional/DEM/LinearSpringDEM/TwoParticleCollision
* Chrono rolling, stacking: projectchrono/chrono, src/tests/unit_tests/smc_contact/sequential (J. Ai et al., Powder
  Technology 206, 269 (2011), test 1; B. N. Asmar et al., Computers and Chemical Engineering 26, 1241 (2002), test 4)
* Kratos, Basic DEM Benchmarking, benchmark 1 (Y. C. Chung and J. Y. Ooi, Granular Matter 13, 643 (2011), test 1)
* ti-DEMPM, disk on an incline: Yihao-Shi/ti-DEMPM, Validation/DEM
"""

import math
import warnings

import numpy as np
import pytest
import xarray as xr
from small_scenes import free_disks

import granular_response as gr
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers.dynamics import Dynamics
from granular_response.state import State

STEP = 1e-4


def damping_ratio(restitution: float, *, pair: bool = False) -> float:
    """That of a contact which ends with its overlap; two equal disks have the reduced mass 1/2."""
    ratio = -math.log(restitution) / math.hypot(math.pi, math.log(restitution))
    return ratio / math.sqrt(2.0) if pair else ratio


def on_the_floor(friction: float, steps: int, load: dict, factors=(1.0,)) -> tuple[State, ...]:
    """A disk on a floor of stiffness 6000, moved ``steps`` time steps by gravity and then as many under each load."""
    described = {
        "packing": {"kind": "arrays", "x": [50.0], "z": [1.0 - 1.0 / 6000.0], "radius": [1.0], "width": 100.0},
        "wall": {"normal_stiffness": 6000.0, "friction": friction},
        "loads": [{"disk": 0, **load}],
        "protocol": {
            "method": "dynamics", "time_step": STEP, "maximum_steps": steps, "stop_kinetic_energy": 1e-30,
            "static_finish": False, "ramp_time": 0.0, "load_factors": list(factors),
        },
    }  # fmt: skip
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "not at rest")  # the clock is stopped
        result = gr.solve(described)
    return (result.rest, *result.loaded)


def moving(position, velocity, spin=None, *, gravity=0.0, step=STEP, integrator="beeman", **changes) -> Dynamics:
    """Disks of radius 1 with given velocities."""
    problem, state = free_disks(position, velocity=velocity, spin=spin, **changes)
    dynamics = Dynamics(problem, state, integrator, step)
    dynamics.set_ramps(gravity=(gravity, gravity, 0.0))
    return dynamics


# 1: MFIX DEM01, a ball of radius 0.1 m and density 2600 kg/m^3 falls from 0.5 m.
HEIGHT = 5.0


def fall(times, step: float = STEP, **wall) -> tuple[np.ndarray, np.ndarray, xr.Dataset]:
    """Height and velocity at some times of a disk that falls from there, and its whole motion."""
    described = {"wall": wall, "loads": [], "protocol": {"time_step": step}}
    ball = gr.Scene.from_arrays([50.0], [HEIGHT], 1.0, width=100.0, scene=described)
    found = gr.motion(ball, times, progress=False)
    z, v = (found[name].sel(axis="z").values[:, 0] for name in ("position", "velocity"))
    return z, v, found


def dem01(time: float, stiffness: float, ratio: float) -> tuple[float, float]:
    """Height and velocity in closed form: free fall, damped contact, free flight."""
    fall = math.sqrt(2.0 * (HEIGHT - 1.0))
    if time <= fall:
        return HEIGHT - 0.5 * time**2, -time
    # in contact, with y = z - 1 + 1 / k: y'' + 2 ratio w y' + w^2 y = 0
    w = math.sqrt(stiffness)
    damped = w * math.sqrt(1.0 - ratio**2)
    y0, v0 = 1.0 / stiffness, -fall
    a, b = y0, (v0 + ratio * w * y0) / damped

    def contact(t: float) -> tuple[float, float]:
        decay, sine, cosine = math.exp(-ratio * w * t), math.sin(damped * t), math.cos(damped * t)
        y = decay * (a * cosine + b * sine)
        return y + 1.0 - y0, decay * (b * damped * cosine - a * damped * sine) - ratio * w * y

    low, high = 0.5 * math.pi / damped, 1.5 * math.pi / damped  # it ends with its overlap
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if contact(middle)[0] < 1.0 else (low, middle)
    if time - fall <= low:
        return contact(time - fall)
    left, speed = time - fall - low, contact(low)[1]
    return 1.0 + speed * left - 0.5 * left**2, speed - left


@pytest.mark.parametrize(("newtons", "restitution", "error"), [(5e4, 0.9, 3e-5), (5e4, 0.7, 1e-4), (2.5e4, 1.0, 1e-6)])
def test_mfix_dem01_fall_contact_and_rebound(newtons, restitution, error):
    mass = 4.0 / 3.0 * math.pi * 0.1**3 * 2600.0
    stiffness, ratio = newtons * 0.1 / (mass * 9.81), damping_ratio(restitution)
    times = STEP * np.array([0, 10_000, 28_000, 29_000, 30_000, 31_000, 32_000, 36_000, 45_000])
    *found, whole = fall(times, normal_stiffness=stiffness, damping_ratio=ratio)
    expected = np.transpose([dem01(time, stiffness, ratio) for time in times])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=error)
    assert whole["contacts"].values.tolist() == [0, 0, 0, 1, 1, 1, 1, 0, 0]
    assert restitution < 1.0 or np.ptp(whole["energy"].values) < 1e-4 * float(whole["energy"][0])


# 2: MFIX DEM02, heights of bounces of a hard ball: 1 + (h - 1) e^(2 n).
@pytest.mark.parametrize(
    ("restitution", "bounce", "height", "error"),
    [(0.6, 1, 2.44, 8e-4), (0.8, 3, 2.048576, 2e-3), (1.0, 3, 5.0, 1e-6)],
)
def test_mfix_dem02_heights_of_bounces(restitution, bounce, height, error):
    once = math.sqrt(2.0 * (HEIGHT - 1.0))
    time = once * (1.0 + 2.0 * sum(restitution**n for n in range(1, bounce)) + restitution**bounce)
    z, v, _ = fall([time], 1e-5, normal_stiffness=2e5, damping_ratio=damping_ratio(restitution))
    assert z + 0.5 * v**2 == pytest.approx(height, rel=error)  # near the top, from where the height is found


# 3: MFIX DEM03, two disks of densities 2:1 pressed into a box; a displaced disk is the lid.
@pytest.mark.parametrize("box", [3.6, 3.9, 3.98])
def test_mfix_dem03_two_disks_pressed_together(box):
    lower, upper = (math.pi / 6.0 * 1e-9 * density for density in (2e4, 1e4))
    unit = (lower + 2.0 * upper) / 3.0  # the lid has the upper one's mass
    stiffness = 1e3 * 5e-4 / (unit * 9.81)
    m1, m2 = lower / unit, upper / unit
    at_rest = 5.0 - (m1 + 2.0 * m2 + 2.0 * m2 + m2) / stiffness
    result = gr.solve(
        {
            "packing": {"kind": "arrays", "x": [1.0] * 3, "z": [1.0, 3.0, 5.0], "radius": [1.0] * 3,
                        "mass": [m1, m2, m2], "width": 2.0},
            "contact": {"normal_stiffness": stiffness, "friction": 0.0},
            "wall": {"normal_stiffness": stiffness},
            "loads": [{"disk": 2, "displacement": [0.0, box + 1.0 - at_rest]}],
        }
    )  # fmt: skip
    middle = (4.0 - box - (m1 - m2) / stiffness) / 3.0
    (state,) = result.loaded
    y1, y2 = state.position[:2, 1]
    force = state.walls.normal_force[(state.walls.first == 0) & (state.walls.second == 0)].item()
    closed = 1.0 - middle - m1 / stiffness, 3.0 - 2.0 * middle - m1 / stiffness, stiffness * middle + m1
    assert (y1, y2, force) == pytest.approx(closed, rel=1e-12)
    if box == 3.6:
        assert (y1, y2, force) == pytest.approx((0.86649545, 2.73319636, 974.674728), abs=1e-6, rel=1e-9)


# 4: MFIX DEM04, a disk that slides begins to roll; also one that turns, or turns back.
@pytest.mark.parametrize(("speed", "spin"), [(1.0, 0.0), (0.0, -3.0), (-1.0, 5.0), (1.0, -2.0)])
@pytest.mark.parametrize(("friction", "error"), [(0.2, 1e-5), (0.8, 1e-4)])
def test_mfix_dem04_slip_to_roll(friction, error, speed, spin):
    step, slip = 2.5e-5, speed + spin
    error *= max(1.0, abs(slip))
    dynamics = moving(
        [[50.0, 1.0 - 1.0 / 6000.0]], [(speed, 0.0)], [spin], gravity=1.0, step=step, contact__damping_ratio=0.0,
        wall__friction=friction, wall__normal_stiffness=6000.0,
    )  # fmt: skip
    dynamics.advance(round(0.99 * abs(slip) / (3.0 * friction) / step))
    assert dynamics.v[0] == pytest.approx(speed - math.copysign(friction * dynamics.time, slip), abs=error)
    while slip * (dynamics.v[0] + dynamics.v[2]) > 0.0:  # the lowest point of the disk slides
        dynamics.advance(1)
    assert friction * dynamics.time == pytest.approx(abs(slip) / 3.0, abs=error)
    assert dynamics.v[0] == pytest.approx((2.0 * speed - spin) / 3.0, abs=error)


@pytest.mark.parametrize(("torque", "slides"), [(1.0, True), (0.5, False)])
def test_mfix_dem04_by_a_torque_that_is_taken_away(torque, slides):
    """Under a torque T the disk slides: v = -mu t, spin = 2 (T - mu) t. Without, until it rolls at (2 v - spin) / 3."""
    friction, steps = 0.3, 20_000
    _, driven, released = on_the_floor(friction, steps, {"force": [0.0, 0.0], "torque": torque}, factors=(1.0, 0.0))
    time = steps * STEP
    v, spin = driven.velocity[0, 0], driven.angular_velocity[0]
    assert (v, spin) == pytest.approx(
        (-friction * time, 2.0 * (torque - friction) * time), rel=3e-3
    )  # it slips at once
    assert slides == (v + spin > 3.0 * friction * time)
    if slides:
        assert released.velocity[0, 0] == pytest.approx(v - friction * time, rel=1e-10)
    else:
        assert released.velocity[0, 0] == pytest.approx((2.0 * v - spin) / 3.0, rel=2e-3)


# 5: MFIX DEM05, oblique impacts; POST_ALPHA.dat has the angles of rebound where all of the contact slides.
PUBLISHED = {35: 27.3031, 40: 33.2292, 45: 39.2091, 50: 45.2158, 55: 51.2073, 60: 57.1372, 65: 62.9718}
IMPACT = {"friction": 0.092, "stiffness_ratio": 2.0 / 7.0, "normal_stiffness": 6000.0, "damping_ratio": 0.0}


def angle_of_rebound(degrees: float, step: float = 2e-5) -> float:
    angle = math.radians(degrees)
    dynamics = moving(
        [[500.0, 1.001]], [(math.sin(angle), -math.cos(angle))], step=step,
        **{f"wall__{key}": value for key, value in IMPACT.items()},
    )  # fmt: skip
    dynamics.advance(round(0.1 / step))
    assert not dynamics.touching().any() and dynamics.v[1] > 0.0
    return math.degrees(math.atan2(dynamics.v[0], dynamics.v[1]))


@pytest.mark.parametrize(("degrees", "published"), PUBLISHED.items())
def test_mfix_dem05_angle_of_rebound_with_gross_sliding(degrees, published):
    closed = math.degrees(math.atan(math.tan(math.radians(degrees)) - 2.0 * IMPACT["friction"]))
    found = angle_of_rebound(degrees)
    assert found == pytest.approx(closed, rel=2e-5)
    assert found == pytest.approx(published, rel=1.6e-4)  # the largest distance is MFIX's from the closed form


def independent_angle(degrees: float, steps: int = 40_000) -> float:
    """The impact by a loop of its own: leapfrog, and a tangential spring cut to the limit of friction."""
    k, friction = IMPACT["normal_stiffness"], IMPACT["friction"]
    step = math.pi / math.sqrt(k) / steps
    vx, vz, spin = math.sin(math.radians(degrees)), -math.cos(math.radians(degrees)), 0.0
    overlap = spring = 0.0
    while True:
        overlap -= 0.5 * step * vz
        spring += 0.5 * step * (vx + spin)
        if overlap <= 0.0 and vz > 0.0:
            return math.degrees(math.atan2(vx, vz))
        limit = friction * overlap / IMPACT["stiffness_ratio"]
        spring = min(max(spring, -limit), limit)
        tangential = -IMPACT["stiffness_ratio"] * k * spring
        vx, vz, spin = vx + step * tangential, vz + step * k * overlap, spin + 2.0 * step * tangential
        overlap -= 0.5 * step * vz
        spring += 0.5 * step * (vx + spin)


@pytest.mark.parametrize("degrees", [2.5, 10.0, 20.0])
def test_mfix_dem05_angle_of_rebound_with_partial_slip(degrees):
    assert angle_of_rebound(degrees, 2e-6) == pytest.approx(independent_angle(degrees), rel=2e-4)


# 6: YADE checkViscElPM, two spheres of 0.1 m collide at 2 m/s each, contact time 0.2 s, restitution 0.3.
def test_yade_viscoelastic_collision():
    contact_time, restitution, speed, time = 0.2, 0.3, 20.0, 0.05  # in radii and seconds
    stiffness = 0.5 * (math.pi**2 + math.log(restitution) ** 2) / contact_time**2
    dynamics = moving(
        [[500.0, 50.0], [502.0, 50.0]], [(speed, 0.0), (-speed, 0.0)], step=1e-5, contact__friction=0.0,
        contact__normal_stiffness=stiffness, contact__damping_ratio=damping_ratio(restitution, pair=True),
    )  # fmt: skip
    dynamics.advance(round(time / 1e-5))
    analytical = speed * contact_time / math.pi * restitution ** (time / contact_time) * math.sin(0.25 * math.pi)
    assert 0.1 * analytical == pytest.approx(0.0666308624, abs=1e-10)  # in metres
    assert dynamics.position[0, 0] - 500.0 == pytest.approx(analytical, rel=1e-4)  # the tolerance of the source


# 7: YADE checkWeight, the forces on floor and walls bear the weight.
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_yade_weight_of_a_pile(seed):
    result = gr.solve(
        {
            "packing": {"kind": "poured", "disks": 51, "width": 14.0, "seed": seed},
            "contact": {"friction": 0.3}, "wall": {"friction": 0.3}, "loads": [],
            "protocol": {"time_step": "auto", "stop_kinetic_energy": 1e-9},
        }
    )  # fmt: skip
    assert result.rest.wall_force()[:, 1].sum() == pytest.approx(51.0, rel=1e-9)


# 8: MercuryDPM CGStaticBalance, the mean stress of two disks on a third, in units of their diameter.
def test_mercury_static_balance():
    meant = 0.5 * (math.pi**2 + math.log(0.1) ** 2) / 0.01**2  # contact time 0.01, restitution 0.1
    result = gr.solve(
        {
            "packing": {"kind": "arrays", "x": [1.0] * 2, "z": [1.0, 3.0], "radius": [1.0] * 2, "width": 2.0},
            # half of the lowest contact is a floor, so of twice the stiffness, as is usual
            "contact": {"friction": 0.0, "normal_stiffness": 0.5 * meant}, "loads": [],
        }
    )  # fmt: skip
    rest = result.rest
    floor = rest.walls.second == 0
    lengths = [np.diff(rest.position[:, 1]), rest.position[rest.walls.first[floor], 1]]
    forces = [rest.pairs.normal_force, rest.walls.normal_force[floor]]
    stress = sum(float(force @ length) for force, length in zip(forces, lengths, strict=True)) / 2.0 / 2.5
    assert stress == pytest.approx(0.8 - 1.2 / meant, rel=1e-13)
    assert stress == pytest.approx(0.799984, abs=5e-7)


# 9: MercuryDPM SquarePacking, five columns of five.
def test_mercury_square_packing():
    x, z = (grid.ravel() for grid in np.meshgrid(np.arange(1.0, 10.0, 2.0), np.arange(1.0, 10.0, 2.0)))
    result = gr.solve(
        {
            "packing": {"kind": "arrays", "x": x.tolist(), "z": z.tolist(), "radius": [1.0] * 25, "width": 10.0},
            "contact": {"friction": 0.0}, "loads": [],
        }
    )  # fmt: skip
    rest = result.rest
    floor = rest.walls.second == 0
    assert rest.walls.normal_force[floor] == pytest.approx(np.full(5, 5.0), rel=1e-12)
    above = np.abs(rest.position[rest.pairs.first, 0] - rest.position[rest.pairs.second, 0]) < 0.5
    overlaps = np.sort(3000.0 * rest.pairs.overlap[above])
    assert overlaps == pytest.approx(np.repeat([1.0, 2.0, 3.0, 4.0], 5), rel=1e-9)


# 10: Spheral twoParticleCollision-2d.
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("restitution", [0.55, 0.6, 1.0])
def test_spheral_two_particle_collision(restitution, integrator):
    dynamics = moving(
        [[500.0, 50.0], [502.01, 50.0]], [(0.5, 0.0), (-0.5, 0.0)], step=2e-5, integrator=integrator,
        contact__friction=0.0, contact__damping_ratio=damping_ratio(restitution, pair=True),
    )  # fmt: skip
    dynamics.advance(5000)
    assert not dynamics.touching().any()
    before, after = dynamics.v[0], dynamics.v[1]
    assert before + after == pytest.approx(0.0, abs=1e-15)  # linear momentum, to the tolerance of the source
    assert after - before == pytest.approx(restitution, abs=1e-3)  # there 2e-2


# 11: Ai et al., test 1: a disk rolls with 1 m/s, R = 0.05 m, coefficient of rolling friction 0.2, until it stops.
@pytest.mark.parametrize("ratio", [0.1, 1.0])
def test_rolling_friction_stops_a_disk(ratio):
    speed = 1.0 / math.sqrt(0.05 * 9.81)
    stiffness = 6000.0
    dynamics = moving(
        [[50.0, 1.0 - 1.0 / stiffness]], [(speed, 0.0)], [-speed], gravity=1.0, wall__normal_stiffness=stiffness,
        wall__friction=0.8, wall__rolling_friction=0.2, wall__rolling_stiffness_ratio=ratio,
    )  # fmt: skip
    while dynamics.v[0] > 0.0:
        dynamics.advance(100)
    way, time = 0.75 * speed**2 / 0.2, 1.5 * speed / 0.2
    assert (way, time) == pytest.approx((7.64526, 10.7088), rel=1e-5)
    assert dynamics.position[0, 0] - 50.0 == pytest.approx(way, rel=1e-4)
    assert dynamics.time == pytest.approx(time, abs=0.02)


# 12: Chung and Ooi, test 1: a collision by the power 3/2.
def test_hertzian_collision():
    step, mass, stiffness = 5e-6, 0.5, (2.0 * 3000.0 / 3.0) ** 1.5
    largest = (5.0 * mass / (4.0 * stiffness)) ** 0.4
    duration = 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * largest
    assert (largest, duration) == pytest.approx((0.00866431054, 0.0255014502), rel=1e-9)
    dynamics = moving(
        [[500.0, 50.0], [502.0001, 50.0]], [(0.5, 0.0), (-0.5, 0.0)], step=step, integrator="verlet",
        contact__friction=0.0, contact__law="hertz", contact__damping_ratio=0.0, contact__normal_stiffness=3000.0,
    )  # fmt: skip
    overlaps = []
    while dynamics.time < 0.0001 + 1.1 * duration:
        dynamics.advance(1)
        overlaps.append(2.0 - float(np.diff(dynamics.position[:, 0])[0]))
    assert max(overlaps) == pytest.approx(largest, rel=1e-6)
    assert np.count_nonzero(np.array(overlaps) > 0.0) * step == pytest.approx(duration, abs=2.0 * step)
    assert dynamics.v[1] - dynamics.v[0] == pytest.approx(1.0, abs=1e-8)


# 13: ti-DEMPM test 2, a disk on an incline: a horizontal force does what the incline does.
@pytest.mark.parametrize(
    ("friction", "slope", "velocity", "error"),
    [(0.3, 0.45, 1.5, 1e-10), (0.3, 0.89, 2.96667, 3e-6), (0.3, 0.91, 3.05, 5e-4), (0.1, 0.5, 2.0, 2e-4)],
)
def test_disk_on_an_incline(friction, slope, velocity, error):
    """Rolling up to tan = 3 mu, with 2/3 of the acceleration; sliding beyond, with tan - mu."""
    _, state = on_the_floor(friction, round(5.0 / STEP), {"force": [slope, 0.0]})
    closed = 5.0 * (2.0 / 3.0 * slope if slope < 3.0 * friction else slope - friction)
    assert closed == pytest.approx(velocity, rel=2e-6)
    assert state.velocity[0, 0] == pytest.approx(closed, rel=error)


# 14: Asmar et al., test 4: five dropped disks stay in a stack.
def test_dropped_disks_stay_in_a_stack():
    result = gr.solve(
        {
            "packing": {"kind": "arrays", "x": [1.0] * 5, "z": [1.1 + 2.1 * k for k in range(5)],
                        "radius": [1.0] * 5, "width": 2.0},
            "loads": [],
        }
    )  # fmt: skip
    overlaps = np.array([5.0 / 6000.0, 4.0 / 3000.0, 3.0 / 3000.0, 2.0 / 3000.0, 1.0 / 3000.0])
    assert result.rest.position[:, 1] == pytest.approx(1.0 + 2.0 * np.arange(5) - np.cumsum(overlaps), rel=1e-13)
    assert result.rest.position[:, 0].tolist() == [1.0] * 5
