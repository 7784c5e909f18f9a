"""What nothing determines: it stays, it is said, and the list of load factors does not decide it."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, pushed, scene

import granular_response as gr
from granular_response.observe.broke_in import broke_in
from granular_response.scene.arrays import LEAST_MASS
from granular_response.solvers import free, solution
from granular_response.solvers.equilibrium import external_force
from granular_response.solvers.system import StaticSystem

FAR = np.linspace(0.05, 1.0, 20)


def lifted(width: float, friction: float, wall: float, rolling: float = 0.0) -> gr.Scene:
    """Disk 0 on the floor at the left wall, disk 1 on it and at the right wall, lifted with x free."""
    contact = {"friction": friction}
    if rolling:
        contact |= {"rolling_friction": rolling, "rolling_stiffness_ratio": 0.2}
    described = {"contact": contact, "wall": {"friction": wall}, "loads": [{"disk": 1, "displacement": [None, 0.05]}]}
    z = 1.0 + (4.0 - (width - 2.0) ** 2) ** 0.5
    return gr.Scene.from_arrays([1.0, width - 1.0], [1.0, z], 1.0, width=width, scene=described)


@pytest.mark.parametrize(
    "scene",
    [
        lifted(3.2, 0.0, 0.0), lifted(3.2, 0.5, 0.0), lifted(3.2, 0.5, 0.5), lifted(3.2, 0.5, 0.0, 0.3),
        lifted(3.2, 1.5, 0.5), lifted(3.6, 0.5, 0.5, 0.3), lifted(3.6, 1.5, 0.5), lifted(3.9, 1.5, 0.5, 0.3),
    ],
)  # fmt: skip
def test_a_lifted_disk_stays_below_where_it_is_lifted(scene):
    """Once it is off, no force acts on it along x: by all lists of load factors it is within 1e-6 of one place."""
    found = [gr.solve(scene, load_factors=factors, progress=False) for factors in ([1.0], [0.003, 0.01, 1.0], FAR)]
    moved = [result.loaded[-1].position - result.rest.position for result in found]
    for other in moved[1:]:
        np.testing.assert_allclose(other, moved[0], atol=1e-6)
    assert abs(moved[0][1, 0]) < 1e-3 and moved[0][1, 1] == pytest.approx(0.05)
    last = found[0]
    assert last.certificate.stable and 1 in last.certificate.undetermined and len(last.events) < 20
    assert "not determined" in str(last)
    # between smooth walls two disks that stick to each other turn as gears
    gears = scene.contact.friction > 0.0 and scene.resolved_wall.friction == 0.0 and not scene.contact.rolling_friction
    assert last.rest.certificate.undetermined == ((0, 1) if gears else ())
    stored = gr.Result(dataset=last.to_dataset())
    assert stored.certificates == last.certificates
    assert stored.to_dataset()["undetermined"].values[-1, 1] == 1


def test_disks_that_roll_freely_are_named_and_those_that_do_not_are_not():
    """A disk that lies alone on a rough floor, beside three that hold each other between the walls."""
    scene = gr.Scene.from_arrays(
        [1.0, 3.0, 2.0, 8.0], [1.0, 1.0, 2.7320508, 1.0], 1.0, width=12.0,
        scene={"contact": {"friction": 0.5}, "wall": {"friction": 0.5}, "loads": [{"disk": 2, "force": [0.0, -0.1]}]},
    )  # fmt: skip
    result = gr.solve(scene, progress=False)
    assert 3 in result.certificate.undetermined
    for friction in (0.0, 0.3):  # on a smooth floor, with and without rotations
        alone = {"loads": [], "contact": {"friction": friction}, "wall": {"friction": 0.0}}
        smooth = gr.Scene.from_arrays([5.0, 10.0], [1.0, 1.0], 1.0, width=20.0, scene=alone)
        assert gr.solve(smooth, progress=False).certificate.undetermined == (0, 1)
    slab = gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9), contact=gr.Contact(friction=0.2))
    assert [one.undetermined for one in gr.solve(slab, progress=False).certificates] == [(), ()]


def alone(z: float, **changes):
    """A disk beside nothing: its problem, its static equations, and their trial where it is."""
    problem, state = free_disks([[500.0, z]], **changes)
    equations = StaticSystem(problem, state)
    known = equations.start(state)
    return problem, equations, equations.trial(known, known.q)


@pytest.mark.parametrize("force", [3e-9, 3e-8])
def test_a_contact_is_a_tie_from_the_force_that_an_event_leaves_on(force):
    """Up to 1e-8 mean weights it may open; its disk then lies on nothing."""
    _, equations, trial = alone(1.0 - force / 6000.0)
    assert (free.without_bare(equations, trial) is None) == (force > 1e-8)


@pytest.mark.parametrize("part", [0.03, 0.3])
def test_a_residual_along_a_null_direction_moves_nothing_and_the_lightest_disk_falls(part):
    """Of a disk in the air: forces up to a tenth of the least mass are taken out of its step."""
    _, equations, trial = alone(50.0)
    force = part * LEAST_MASS * np.array([0.0, 1.0, 0.0])
    step = equations.step(trial, force)
    by = free.solved_by(equations, equations.kept_factor(trial))
    left = np.abs(free.least_at_rest(equations, by, step, force)).max() / np.abs(step).max()
    assert left > 0.99 if part > 0.1 else left < 1e-6


@pytest.mark.parametrize("part", [3e-4, 3e-3])
def test_a_step_is_suspicious_from_a_thousandth_of_one_along_a_null_direction(part):
    problem, equations, trial = alone(50.0)
    fall = np.abs(equations.step(trial, external_force(problem, 0.0))).max()  # of a disk in the air, under its weight
    assert free.suspicious(equations, part * fall, 1.0) == (part > 1e-3)


@pytest.mark.parametrize(("stiffness", "rolls"), [(60.0, True), (80.0, False)])
def test_a_disk_rolls_freely_up_to_a_stiffness(stiffness, rolls):
    """Against springs of so many times the regularisation, which is 1e-10 of a contact's stiffness: 70 of them leave
    (1 + 70)^-3, 2.8e-6 of a random number of about 0.4, of its part along the rolling."""
    rough = {"wall__friction": 0.5, "wall__rolling_friction": 0.1, "wall__rolling_stiffness_ratio": 1e-10 * stiffness}
    _, equations, trial = alone(1.0 - 1.0 / 6000.0, contact__friction=0.5, **rough)
    assert free.free_disks(equations, trial) == ((0,) if rolls else ())


def test_a_periodic_slab_rolls_on_a_rough_floor_as_a_whole():
    """Without friction between its disks the bottom row rolls: all of it is free along x, and the load moves none."""
    scene = gr.Scene.from_dict(
        {
            "packing": {"kind": "slab", "layers": 3, "disks_per_row": 6, "sides": "periodic"},
            "contact": {"friction": 0.0}, "wall": {"friction": 0.5},
            "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
        }
    )  # fmt: skip
    found = [gr.solve(scene, load_factors=factors, progress=False) for factors in ([1.0], FAR)]
    assert len(found[0].certificate.undetermined) == len(found[0].rest.position)
    np.testing.assert_allclose(found[0].loaded[-1].position, found[1].loaded[-1].position, atol=1e-6)


def test_a_minimisation_that_snaps_is_an_event_with_its_side(monkeypatch):
    """A force of 300 mg breaks through two rows without friction; a saddle that was left is an event too."""
    load = [gr.Load(disk="top-centre", force=(0.0, -1.0))]
    scene = gr.Scene(packing=gr.Slab(layers=2, disks_per_row=7), contact=gr.Contact(friction=0.0), loads=load)
    calm, broken = (gr.solve(scene, load_factors=[force], progress=False) for force in (10.0, 300.0))
    assert not calm.events and calm.loaded[0].reached.method == "minimise"
    moved = broken.loaded[0].position - broken.rest.position
    side = "right" if moved[:, 0].sum() > 0.0 else "left"
    assert [event.kind for event in broken.events] == ["jump"] and broken.events[0].reason.endswith(f"to the {side}")
    assert "the load broke in: 1 dynamic jump" in str(broken)

    found = solution.minimise
    escaped = lambda *given, **named: with_escapes(found(*given, **named))  # noqa: E731
    monkeypatch.setattr(solution, "minimise", escaped)
    left = gr.solve(scene, load_factors=[10.0], progress=False)
    assert [(event.kind, event.reason.split(",")[0]) for event in left.events] == [("bifurcation", "unstable")]


@pytest.mark.filterwarnings("ignore:disk 5 comes to rest")
@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_mirror_images_snap_to_the_opposite_sides(way):
    """A disk is pushed between two of a row, left or right of its middle one; the row makes room on the other side."""
    x, z = [1.0, 3.0, 5.0, 7.0, 9.0, 5.0 + 0.05 * way], [1.0] * 5 + [3.0]
    smooth = {"contact": {"friction": 0.0}, "loads": [{"disk": 5, "force": [0.0, -1.0]}]}
    row = gr.Scene.from_arrays(x, z, 1.0, width=10.0, scene=smooth)
    result = gr.solve(row, load_factors=[50.0, 600.0], progress=False)
    (event,) = result.events
    moved = result.loaded[1].position - result.loaded[0].position
    side = "right" if moved[:, 0].sum() > 0.0 else "left"
    assert event.kind == "jump" and event.reason.endswith(f"to the {side}")
    assert side == ("left" if way > 0.0 else "right")


def test_a_minimum_far_from_the_one_before_is_a_jump(monkeypatch):
    """As where it has passed a saddle in one step."""
    load = [gr.Load(disk="top-centre", force=(0.0, -1.0))]
    scene = gr.Scene(packing=gr.Slab(layers=4, disks_per_row=7), contact=gr.Contact(friction=0.0), loads=load)
    monkeypatch.setattr(solution, "SNAPPED", 1e-4)
    assert [event.kind for event in gr.solve(scene, load_factors=[10.0], progress=False).events] == ["jump"]


def with_escapes(state: gr.State) -> gr.State:
    return replace(state, reached=replace(state.reached, escapes=1))


SINKS = gr.Scene(
    packing=gr.Poured(disks=20, width=12.0, polydispersity=0.2, seed=3),
    contact=gr.Contact(friction=0.2),
    loads=[gr.Load(disk="top-centre", force=(0.0, -30.0))],
)


def test_a_load_that_breaks_in_is_said_in_one_line(tmp_path):
    """Every state is stable, and the loaded disk has sunk by most of a row."""
    result = gr.solve(SINKS, load_factors=[0.5, 1.0], progress=False)
    assert all(one.stable for one in result.certificates)
    line = next(line for line in str(result).splitlines() if "the load broke in" in line)
    jumps = [event for event in result.events if event.lost and event.kind != "stepped over"]
    disk = int(result.loaded_disks[0])
    far = np.hypot(*(result.loaded[-1].position - result.rest.position)[disk])
    assert f"{len(jumps)} dynamic jumps" in line and f"loaded disk {disk} moved by {far:.2g}" in line and far > 1.0
    result.save(tmp_path / "sinks.nc")
    assert line in str(gr.open_result(tmp_path / "sinks.nc")).splitlines()
    small = gr.solve(SINKS, load_factors=[1e-4], progress=False)
    assert broke_in([small.rest, *small.loaded], small.loaded_disks) is None and "broke in" not in str(small)


def test_the_load_factors_of_all_events_are_solved():
    """The states at the events, losses of equilibrium among them, which are the last ones of their branches."""
    result = gr.solve(SINKS, load_factors=[0.5], progress=False)
    factors = sorted({event.load_factor for event in result.events})
    assert sum(event.lost for event in result.events) > 1
    again = gr.solve(SINKS, load_factors=factors, progress=False)
    assert again.load_factors == tuple(factors) and all(one.stable for one in again.certificates)


def test_a_motion_that_nothing_drives_goes_on_beyond_the_target(monkeypatch):
    """Where an equilibrium is lost just before the wanted load, motion under that load may take for ever."""
    from granular_response.solvers.path import losses
    from granular_response.solvers.settle import NotSettled

    result = gr.solve(SINKS, load_factors=[0.4], progress=False)
    jump = next(event for event in result.events if event.kind == "jump" and event.load_factor > 0.1)
    settle, asked = losses.settle, []

    def slow(*given, load, **named):
        asked.append(load[1])
        if abs(load[1] - load[0]) * 30.0 < 1e-3:
            raise NotSettled("the packing did not come to rest")
        return settle(*given, load=load, **named)

    monkeypatch.setattr(losses, "settle", slow)
    wanted = jump.load_factor + 1e-6
    near = gr.solve(SINKS, load_factors=[wanted], progress=False)
    assert near.certificate.stable and near.loaded[-1].load_factor == wanted
    assert any("reached from load factor" in event.reason for event in near.events)


def test_what_moves_elastically_breaks_in_nowhere():
    soft = scene(6, 13, contact__friction=0.0, contact__normal_stiffness=60.0, loads=pushed(0.0, -4.0))
    line = str(gr.solve(soft, load_factors=[0.5, 1.0], progress=False)).splitlines()[-1]
    assert line.strip().startswith("largest displacements: ") and "jump" not in line
