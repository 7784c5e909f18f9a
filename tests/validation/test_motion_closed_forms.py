"""Motion from any start against closed forms: verification decks of other codes as scenes."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import granular_response as gr
from granular_response.solvers import taps
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.state import State


def test_a_time_within_a_step_lies_between_its_ends():
    slab = gr.Scene.from_dict({"packing": {"kind": "slab", "layers": 3, "disks_per_row": 7}, "loads": []})
    moved = slab.updated({"motion.vx": 0.3, "motion.spin": 0.2, "wall.friction": 0.2})
    between = gr.motion(moved, [0.33320, 0.33330, 0.33340], progress=False)["position"].values
    np.testing.assert_allclose(between[1], 0.5 * (between[0] + between[2]), atol=1e-6)


def test_not_a_bit_of_a_gas_depends_on_the_times_that_are_looked_at():
    """Candidates are listed again some 100 times, before the same steps; a last bit would grow to radii."""
    rng = np.random.default_rng(0)
    x, z = (places.ravel() for places in np.meshgrid(np.arange(2.0, 24.0, 4.0), np.arange(2.0, 24.0, 4.0)))
    vx, vz = rng.normal(0.0, 4.0, (2, len(x))).tolist()
    law = {"damping_ratio": 0.05, "friction": 0.3}
    gas = gr.Scene.from_arrays(x, z, 1.0, width=26.0, vx=vx, vz=vz, scene={"loads": [], "contact": law, "wall": law})
    once = gr.motion(gas, [10.0], progress=False)
    often = gr.motion(gas, np.linspace(0.0, 10.0, 38), progress=False)
    for name in ("position", "velocity", "angle", "energy"):
        np.testing.assert_array_equal(often[name][-1], once[name][-1])


def bounce(k: float, zeta: float, masses: tuple[float, ...], gap: float) -> float:
    """Speed of parting, over that of approach, of two disks or of one and the floor, less that in closed form."""
    law = {"friction": 0.0, "damping_ratio": zeta, "normal_stiffness": k}
    free = {"loads": [], "contact": law, "wall": law, "motion": {"weightless": True}}
    n, reduced = len(masses), 1.0 / sum(1.0 / m for m in masses)
    x, z = ([500.0, 502.0 + gap], [50.0, 50.0]) if n == 2 else ([500.0], [1.0 + gap])
    scene = gr.Scene.from_arrays(x, z, 1.0, mass=list(masses), width=1000.0, scene=free)
    way = {"motion.vx": [1.0, 0.0]} if n == 2 else {"motion.vz": -1.0}
    damping = 2.0 * zeta * math.sqrt(k) / (2.0 * math.sqrt(k * reduced * sum(masses) / n))
    time = gap + 6.0 * math.pi * math.sqrt(reduced * sum(masses) / n / k)
    velocity = gr.motion(scene.updated(way), [time], progress=False)["velocity"].values[0]
    parting = velocity[1, 0] - velocity[0, 0] if n == 2 else velocity[0, 1]
    return parting - math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))


@pytest.mark.parametrize("k", [1e3, 3e3, 1e6, 1e8])
@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.5])
@pytest.mark.parametrize("masses", [(1.0,), (1.0, 1.0), (1.6, 0.4)])
def test_restitution_is_right_with_the_default_time_step(k, zeta, masses):
    """Wherever in a step the bodies meet, within 1e-3 of the speed; the elastic ones within 2e-4."""
    step = math.pi / math.sqrt(2.0 * k) / 600.0
    errors = [bounce(k, zeta, masses, (10.0 + part) * step) for part in (0.1, 0.45, 0.8)]
    assert np.abs(errors).max() < (1e-3 if zeta else 2e-4)


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_a_ball_bounces_as_high_as_it_was(law):
    """Undamped, and however stiff; with five steps a collision the energy of the second case grew by a quarter."""
    for k in (3e3, 1e6):
        undamped = {"friction": 0.0, "damping_ratio": 0.0, "normal_stiffness": k, "law": law}
        scene = {"loads": [], "contact": undamped, "wall": {"damping_ratio": 0.0}}
        ball = gr.Scene.from_arrays([5.0], [3.0], 1.0, width=10.0, scene=scene)
        energy = gr.motion(ball, np.linspace(0.0, 20.0, 81), progress=False)["energy"].values
        np.testing.assert_allclose(energy, 3.0, rtol=1e-3)


@pytest.mark.parametrize("gap", [0.0, 0.01])
@pytest.mark.parametrize(
    ("masses", "velocity"),
    [
        ([1.0, 1.0, 1.0], [1.0, 0.0, 0.0]),
        ([1.0] * 5, [1.0, 1.0, 0.0, 0.0, 0.0]),
        ([1.0, 2.0, 0.5, 1.0, 0.5], [1.0, 0.0, 0.0, 0.0, 0.0]),
    ],
)
def test_a_soft_cradle_is_a_chain_of_springs(masses, velocity, gap):
    """At k = 3000 several contacts are closed at once and none takes all: m a = k (overlap before - overlap behind) of
    the chain, integrated by scipy. 2e-4 of the speed, as of other collisions without dashpots."""
    n, k, mass = len(masses), 3000.0, np.array(masses) / np.mean(masses)
    law = {"friction": 0.0, "damping_ratio": 0.0, "normal_stiffness": k}
    free = {"loads": [], "contact": law, "motion": {"weightless": True, "vx": velocity}}
    x = 500.0 + (2.0 + gap) * np.arange(n)
    row = gr.Scene.from_arrays(x, [50.0] * n, 1.0, mass=masses, width=1000.0, scene=free)
    found = gr.motion(row, [0.0, 1.0], progress=False)
    after = found["velocity"].values[1, :, 0]
    np.testing.assert_allclose(found["momentum"], [[mass @ velocity, 0.0]] * 2, atol=1e-13)
    np.testing.assert_allclose(found["angular_momentum"], -50.0 * (mass @ velocity), atol=1e-10)
    assert float(found["kinetic_energy"][1]) == pytest.approx(0.5 * mass @ after**2, rel=1e-12)

    def chain(_, y):
        push = k * np.maximum(2.0 - np.diff(y[:n]), 0.0)
        return np.r_[y[n:], (np.r_[0.0, push] - np.r_[push, 0.0]) / mass]

    solved = solve_ivp(chain, (0.0, 1.0), np.r_[x, velocity], method="DOP853", rtol=1e-11, atol=1e-12, max_step=2e-3)
    np.testing.assert_allclose(after, solved.y[n:, -1], atol=2e-4)


def a_tap_of_one_disk(monkeypatch, amplitude: float, k: float, zeta: float, **keys) -> tuple[State, State, np.ndarray]:
    """The disk when three quarters of a tap are over, at rest, and (looks, 4) from then on: t, z, its velocity and
    acceleration."""
    thrown, seen = [], []

    def landing(dynamics, stop, **ramps):
        def look(dynamics, energy):
            seen.append([dynamics.time, dynamics.position[0, 1], dynamics.v[1], dynamics.history[0][1]])

        thrown.append(dynamics.state())
        return whole(dynamics, stop, progress=look, **ramps)

    law = {"friction": 0.3, "normal_stiffness": k, "damping_ratio": zeta}
    taps_of = {"taps": {"number": 1, "amplitude": amplitude, "duration": 3.0}}
    scene = {"loads": [], "contact": law, "preparation": taps_of, "protocol": keys}
    whole = taps.relax
    monkeypatch.setattr(taps, "relax", landing)
    found = rest_state(Problem.from_scene(gr.Scene.from_arrays([5.0], [1.0], 1.0, width=10.0, scene=scene)))
    return thrown[0], found, np.array(seen)


@pytest.mark.parametrize("k", [3e3, 1e6])
@pytest.mark.parametrize("amplitude", [1.5, 3.0])
def test_a_tap_throws_a_disk_off(monkeypatch, amplitude, k):
    """Gravity in the box falls from 1 + A to 1 - A within T / 2 and changes its sign t = (A - 1) T / (4 A) before the
    end: then the disk has the speed 2 A t^2 / T and the height 2 A t^3 / (3 T). On its spring it follows the wave by
    sqrt(1 / (2 k)) late or early: so much in t."""
    state, found, _ = a_tap_of_one_disk(monkeypatch, amplitude, k, 0.5)
    t, late = (amplitude - 1.0) * 3.0 / (4.0 * amplitude), 1.0 / math.sqrt(2.0 * k)
    speed, height = 2.0 * amplitude * t**2 / 3.0, 2.0 * amplitude * t**3 / 9.0
    assert state.velocity[0, 1] == pytest.approx(speed, rel=2.0 * late / t)
    assert state.position[0, 1] - 1.0 == pytest.approx(height, rel=3.0 * late / t)
    assert found.position[0, 1] == pytest.approx(1.0 - 0.5 / k, abs=1e-9)


@pytest.mark.parametrize("zeta", [0.1, 0.5])
@pytest.mark.parametrize("amplitude", [2.0, 3.0])
def test_a_disk_lands_from_a_tap_with_its_restitution(monkeypatch, amplitude, zeta):
    """It flies on while gravity g(t) grows from 1 - A to 1 in T / 4 and stays there: z'' = -g(t), integrated twice,
    gives the speed with which it comes down. Its overlap d with the floor follows d'' = 1 - 2 zeta w d' - w^2 d up to
    d = 0, w^2 = 2 k; without weight it would leave with exp(-pi zeta / sqrt(1 - zeta^2)) of that speed. Within 1e-3."""
    k, quarter = 1e6, 0.75
    state, _, seen = a_tap_of_one_disk(monkeypatch, amplitude, k, zeta)
    least, (z, v) = 1.0 - amplitude, (state.position[0, 1] - 1.0, state.velocity[0, 1])
    v_end = v - 0.5 * (least + 1.0) * quarter
    z_end = z + v * quarter - (0.5 * least + (1.0 - least) / 6.0) * quarter**2
    assert z_end > 0.0  # it comes down later
    down = math.sqrt(v_end**2 + 2.0 * z_end)
    own = math.sqrt(2.0 * k)

    def parts(_, d):
        return d[0]

    parts.terminal, parts.direction = True, -1
    leaves = solve_ivp(
        lambda _, d: [d[1], 1.0 - 2.0 * zeta * own * d[1] - own**2 * d[0]],
        (0.0, 2.0 * math.pi / own), [0.0, down], events=parts, rtol=1e-10, atol=1e-14,
    )  # fmt: skip
    lands, up = quarter + v_end + down, -leaves.y[1, -1]
    time, height, speed, _ = seen[(seen[:, 0] > lands) & (seen[:, 0] < lands + up) & (seen[:, 1] > 1.0)].T
    assert len(time) > 20
    np.testing.assert_allclose(np.sqrt(speed**2 + 2.0 * (height - 1.0)), up, atol=1e-3 * down)


def test_a_tap_ends_once_its_disks_have_landed(monkeypatch):
    """Where accelerations stay below 0.1 g, and not much later: what is left is a swing in which contacts stay closed.

    The swing of a disk of damping ratio 0.02 on the floor falls by 6 % in each half."""
    *_, seen = a_tap_of_one_disk(monkeypatch, 2.0, 3e3, 0.02)
    acceleration = np.abs(seen[:, 3])
    assert acceleration[-10:].max() < 0.1
    assert acceleration[-60:-10].max() > 0.1


@pytest.mark.parametrize("speed", [1.0, 5.0, 20.0])
def test_energy_never_rises_where_a_sliding_contact_is_damped(speed):
    """A ball onto a rough floor, default damping. What the dashpot pulls beyond Coulomb's limit is not stored."""
    rubs = {"loads": [], "motion": {"weightless": True}, "contact": {"friction": 0.5}, "wall": {"friction": 0.5}}
    ball = gr.Scene.from_arrays([20.0], [1.001], 1.0, width=1000.0, vx=speed, vz=-0.1, scene=rubs)
    moved = gr.motion(ball, np.linspace(0.0095, 0.06, 102), progress=False)
    energy = moved["energy"].values
    assert moved["contacts"].values.max() == 1 and energy[-1] < energy[0]
    assert np.diff(energy).max() < 1e-6 * energy[0]


def test_energy_that_dashpots_wind_into_springs_is_said():
    """A disk of a tenth of the mean mass, which dashpots overdamp: sliding cuts their pull, and the springs make up for
    it. As in LAMMPS; kinetic energy never rises."""
    rubs = {"loads": [], "motion": {"weightless": True}, "contact": {"friction": 0.5}, "wall": {"friction": 0.5}}
    rubs["motion"] |= {"vx": [0.3, 0.0], "vz": [-1.0, 0.0], "spin": [-5.0, 0.0]}
    light = gr.Scene.from_arrays([500.0, 600.0], [1.001, 50.0], 1.0, mass=[0.1, 1.9], width=1000.0, scene=rubs)
    times = np.linspace(0.0009, 0.03, 300)
    with pytest.warns(UserWarning, match=r"^the energy rises by up to .* mg R without a load: dashpots wind up"):
        moved = gr.motion(light, times, progress=False)
    kinetic = (moved["kinetic_energy"] + moved["rotational_energy"]).values
    assert np.diff(kinetic).max() < 1e-3 * kinetic[0] and np.ptp(moved["energy"].values) > kinetic[0]


def test_disks_that_overlap_at_the_start_part_with_the_energy_of_their_contact():
    """By a 3/2 law, which is stiffer there than at any weight: each takes half of the energy, without dashpots."""
    law = {"friction": 0.0, "normal_stiffness": 1e6, "law": "hertz", "damping_ratio": 0.0}
    pressed = {"loads": [], "contact": law, "motion": {"weightless": True}}
    two = gr.Scene.from_arrays([500.0, 501.6], [50.0, 50.0], 1.0, width=1000.0, scene=pressed)
    moved = gr.motion(two, [0.0, 0.002], progress=False)
    assert float(moved["velocity"][1, 1, 0]) == pytest.approx(math.sqrt(float(moved["energy"][0])), rel=1e-3)


def test_bodies_do_not_pass_through_each_other():
    fast = {"loads": [], "motion": {"weightless": True}}
    two = gr.Scene.from_arrays([500.0, 504.0], [50.0, 50.0], 1.0, width=1000.0, vx=[200.0, -200.0], scene=fast)
    with pytest.raises(gr.SolveError, match=r"^disks 0 and 1 overlap by .* at time 0\.01.*: take smaller velocities"):
        gr.motion(two, [1.0], progress=False)
    ball = gr.Scene.from_arrays([500.0], [5.0], 1.0, width=1000.0, vz=-300.0, scene=fast)
    with pytest.raises(gr.SolveError, match=r"^disk 0 and the floor overlap by "):
        gr.motion(ball, [1.0], progress=False)


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
