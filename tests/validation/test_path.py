"""Quasi-static load paths against slow dynamics and small increments, through lost equilibria, cut and continued."""

from itertools import pairwise

import numpy as np
import pytest
from small_scenes import at_rest, free_disks, pushed, scene

import granular_response as gr
from granular_response.observe.floor import floor_force
from granular_response.solvers import path
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.energy import minimise
from granular_response.solvers.equilibrium import finish
from granular_response.solvers.path import PathError, PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene
from granular_response.state import OPEN, SLIDING, STICKING, State

FLOOR = np.arange(13)
LOAD = pushed(0.0, -1.0)


@pytest.fixture(scope="module")
def settled():
    """A small frictional slab at rest, ready to be loaded with unit force."""
    return at_rest(scene(6, 13, loads=LOAD))


def test_dynamics_approaches_the_path_as_its_ramp_grows(settled):
    problem, rest = settled
    force = 8.0
    expected = floor_force(follow(problem, rest, [force])[0], FLOOR)
    difference = []
    for ramp in (5.0, 20.0, 80.0):
        state = finish(problem, relax(Dynamics(problem, rest, time_step=4e-4), Stop(1e-14), load=(0.0, force, ramp)))
        difference.append(np.abs(floor_force(state, FLOOR) - expected).max() / force)
    assert difference[0] < 4e-3
    assert difference[1] < 0.5 * difference[0]
    assert difference[2] < 0.7 * difference[1]


def test_an_equilibrium_that_is_left_slowly_is_not_called_stable():
    """A disk balanced on another, displaced by 1e-6, needs seconds to move: a look at once sees it at rest."""
    load = [{"disk": 1, "force": [0.0, -0.1]}]
    problem, state = free_disks([(10.0, 2.0), (10.0, 5.0)], [2.0, 1.0], contact__friction=0.0, loads=load)
    problem = problem.with_loads(state.position)
    balanced = finish(problem, state)
    assert balanced.certificate.negative_modes == 1
    record = PathRecord()
    with pytest.raises(PathError, match="no equilibrium beyond load factor 0"):
        follow(problem, balanced, [0.0], record=record)


def _walls(state):
    return np.concatenate([state.walls.normal_force, state.walls.tangential_force])


def test_a_contact_that_slides_for_a_moment_is_seen():
    """From 0.843 to 0.864 of the load."""
    rubs = {"normal_stiffness": 1042.1, "stiffness_ratio": 0.8, "friction": 0.011985, "damping_ratio": 0.156}
    slab = {"kind": "slab", "layers": 5, "disks_per_row": 9, "polydispersity": 0.25, "seed": 986}
    slab["lattice_constant"] = 2.0
    wall, load = {"friction": 2.89, "normal_stiffness": 928.7}, pushed(0.0134, -0.1184)
    problem, rest = at_rest(gr.Scene.from_dict({"packing": slab, "contact": rubs, "wall": wall, "loads": load}))
    (fine,), (state,) = follow(problem, rest, [1.0], together=5e-4 * problem.load_size), follow(problem, rest, [1.0])
    assert np.abs(_walls(state) - _walls(fine)).max() <= 3e-6 * problem.load_size


def test_a_small_load_is_not_crossed_in_one_increment():
    """Of a hundredth of a weight on seven disks the first increment was 0.85, and the response wrong by 7 % of it."""
    row = {"kind": "slab", "layers": 1, "disks_per_row": 7, "polydispersity": 0.05, "seed": 127}
    row["lattice_constant"] = "touching-largest"
    rubs = {"normal_stiffness": 1941.8, "stiffness_ratio": 0.8, "friction": 0.0}
    described = {"packing": row, "contact": rubs, "preparation": {"gravity": "frictionless"}}
    described |= {"wall": {"friction": 0.709, "normal_stiffness": 7966.0}, "loads": pushed(-0.002, -0.0101, 0.0018)}
    problem, rest = at_rest(gr.Scene.from_dict(described))
    fine = follow(problem, rest, [0.5, 1.5], together=1e-4 * problem.load_size)
    for state, other in zip(follow(problem, rest, [0.5, 1.5]), fine, strict=True):
        assert np.abs(_walls(state) - _walls(other)).max() <= 2e-3 * problem.load_size * state.load_factor


def test_a_state_that_leaves_in_one_sense_alone_is_left_in_its_mirror_image_too():
    """With sliding contacts the tangent is that of one sense: it was tried, the other one was not."""
    peaks = []
    for sense, offset in ((1.0, 0), (-1.0, 1)):
        load = {"disk": {"row": "top", "offset": offset}, "force": [sense * 2.0641953231117673, -40.0]}
        solution = solve_scene(
            scene(
                5, 6, packing__lattice_constant=2.01, contact__friction=1.0, loads=[load], protocol__method="path",
                protocol__time_step="auto",
            ),
            load_factors=[0.594866],
        )  # fmt: skip
        (state,) = solution.loaded
        assert [event.kind for event in state.reached.events if event.lost] == ["jump"]
        assert state.certificate.stable
        added = floor_force(state, np.arange(6)) - floor_force(solution.rest, np.arange(6))
        peaks.append(added if sense > 0 else added[::-1])
    np.testing.assert_allclose(peaks[0], peaks[1], atol=1e-6)


def loaded(changes) -> tuple[Problem, State]:
    """A small scene at rest, its loads on their disks."""
    return at_rest(scene(**{"contact__friction": 0.2, "wall__friction": 0.2, **changes}))


KINDS = {
    "ordered": {"layers": 5, "disks_per_row": 9, "loads": pushed(0.3, -6.0)},
    "symmetric": {"layers": 5, "disks_per_row": 9, "loads": pushed(0.0, -6.0)},
    "torque": {"layers": 4, "disks_per_row": 8, "loads": pushed(0.0, -1.0, 0.5)},
    "disordered": {
        "layers": 4, "disks_per_row": 11, "packing__polydispersity": 0.1, "protocol__time_step": "auto",
        "packing__lattice_constant": "touching-largest", "packing__seed": 3, "loads": pushed(0.0, -1.0),
    },
    "periodic": {
        "layers": 4, "disks_per_row": 10, "packing__sides": "periodic", "packing__lattice_constant": 1.9995,
        "loads": pushed(0.4, -3.0),
    },
    "displaced": {"layers": 4, "disks_per_row": 9, "loads": [{"disk": "top-centre", "displacement": [None, -2e-3]}]},
    "3/2 law": {"layers": 4, "disks_per_row": 8, "contact__law": "hertz", "loads": pushed(0.05, -0.4)},
}  # fmt: skip


@pytest.mark.parametrize("changes", KINDS.values(), ids=KINDS)
def test_a_path_is_that_of_small_increments_but_for_their_error(changes):
    """What increments leave out falls with their length; what is left at the shortest one bounds the difference."""
    problem, rest = loaded(changes)
    (state,) = follow(problem, rest, [1.0])
    size = problem.load_size if not len(problem.held) else 1.0
    fine, finer = (follow(problem, rest, [1.0], together=part * problem.load_size)[0] for part in (1e-3, 2e-4))
    assert not any(event.lost for one in (state, fine, finer) for event in one.reached.events)
    left = np.abs(_walls(fine) - _walls(finer)).max()
    assert np.abs(_walls(state) - _walls(finer)).max() <= max(left, 1e-8 * size)


#: Statuses from which and to which each event leads; a contact that closes may slide at once.
LEADS = {
    "opens": ({STICKING, SLIDING}, {OPEN}),
    "closes": ({OPEN}, {STICKING, SLIDING}),
    "slides": ({STICKING}, {SLIDING}),
    "sticks": ({SLIDING}, {STICKING}),
    "reverses": ({SLIDING}, {SLIDING}),
}


@pytest.mark.parametrize("changes", KINDS.values(), ids=KINDS)
def test_events_lead_from_the_statuses_of_one_kept_state_to_those_of_the_next(changes):
    problem, rest = loaded(changes)
    states = [rest, *follow(problem, rest, [0.3, 0.9, 0.5, 1.0])]
    kinds = set()
    for before, after in pairwise(states):
        events = after.reached.events
        factors = [event.load_factor for event in events]
        assert factors == sorted(factors, reverse=after.load_factor < before.load_factor)
        low, high = sorted((before.load_factor, after.load_factor))
        assert all(low <= factor <= high for factor in factors)
        now = {contact: {status} for contact, status in statuses(before).items()}
        for event in events:
            kinds.add(event.kind)
            contact = (event.at_wall, event.first, event.second)
            expected, becomes = LEADS[event.kind]
            assert now.get(contact, {OPEN}) & expected
            now[contact] = becomes
        for contact, status in statuses(after).items():
            assert status in now.get(contact, {OPEN}), contact
    assert kinds


def statuses(state) -> dict[tuple[bool, int, int], int]:
    """Status of every contact that is listed."""
    return {
        (at_wall, int(i), int(j)): int(status)
        for at_wall, part in ((False, state.pairs), (True, state.walls))
        for i, j, status in zip(part.first, part.second, part.status, strict=True)
    }


def test_a_mirror_pair_changes_at_one_event():
    problem, rest = loaded(KINDS["symmetric"])
    (state,) = follow(problem, rest, [1.0])
    width, position = problem.packing.width, rest.position
    mirror = {i: int(np.argmin(np.hypot(*(position - [width - x, z]).T))) for i, (x, z) in enumerate(position)}
    turned = {0: 0, 1: 2, 2: 1}
    found = [(e.load_factor, e.kind, e.at_wall, e.first, e.second) for e in state.reached.events]
    assert len(found) > 4
    as_set = {(f, kind, wall, frozenset((i, j)) if not wall else (i, j)) for f, kind, wall, i, j in found}
    for f, kind, wall, i, j in found:
        other = (mirror[i], turned[j]) if wall else frozenset((mirror[i], mirror[j]))
        assert (f, kind, wall, other) in as_set


def test_without_friction_a_path_leads_back_and_to_the_minimum_of_the_energy():
    changes = {**KINDS["ordered"], "contact__friction": 0.0, "wall__friction": 0.0}
    problem, rest = loaded({**changes, "packing__lattice_constant": 1.9995})
    there, back = follow(problem, rest, [1.0, 0.0])
    assert there.reached.events and not any(e.lost for s in (there, back) for e in s.reached.events)
    assert back.position == pytest.approx(rest.position, abs=1e-12)
    lowest = minimise(problem, rest, load_factor=1.0)
    assert _walls(there) == pytest.approx(_walls(lowest), abs=1e-9)
    opened = {frozenset((e.first, e.second)) for e in there.reached.events if e.kind == "opens"}
    closed = {frozenset((e.first, e.second)) for e in back.reached.events if e.kind == "closes"}
    assert opened and opened == closed


def test_a_lost_equilibrium_is_an_event_with_its_displacement():
    changes = {**KINDS["disordered"], "contact__friction": 0.05, "loads": pushed(0.0, -8.0)}
    problem, rest = loaded(changes)
    (state,) = follow(problem, rest, [1.0])
    lost = [event for event in state.reached.events if event.lost]
    assert lost and state.certificate.stable
    for event in lost:
        assert event.second == -1 and event.reason and event.displacement > 0.0
        assert event.load_factor <= event.until <= 1.0


def prepared(packing, contact, wall, load):
    """A problem with a load on the top disk, and its rest state."""
    described = {"packing": {"kind": "slab", **packing}, "contact": contact, "wall": wall, "loads": pushed(*load)}
    return at_rest(gr.Scene.from_dict(described | {"protocol": {"time_step": "auto"}}))


@pytest.mark.parametrize("part", [1e-6, 1e-9])
def test_motion_leaves_a_lost_equilibrium_under_hardly_more_than_it_bears(part):
    """So little is out of balance there that the packing counts as at rest before it moves."""
    changes = {"packing__polydispersity": 0.1, "packing__lattice_constant": "touching-largest"}
    changes |= {"packing__realization": 1, "contact__friction": 0.2, "wall__friction": 0.0, "loads": LOAD}
    problem, rest = at_rest(scene(5, 13, **changes))
    (state,) = follow(problem, rest, [1.25])
    (lost,) = [event for event in state.reached.events if event.lost]
    (just_beyond,) = follow(problem, rest, [lost.load_factor * (1.0 + part)])
    assert just_beyond.certificate.balanced and just_beyond.certificate.stable
    assert [event.kind for event in just_beyond.reached.events if event.lost] == ["jump"]
    assert just_beyond.reached.events[-1].displacement > 1e-3


def test_an_equilibrium_that_is_lost_between_two_events_is_lost_there():
    """At 0.904 of the load, wherever states are kept; the packing moves by 5e-3 radii."""
    packing = {"layers": 3, "disks_per_row": 10, "sides": "periodic", "polydispersity": 0.02, "seed": 74}
    packing["lattice_constant"], rubs = "touching-largest", {"friction": 0.5}
    problem, rest = prepared(packing, rubs, rubs, (-0.868857798426316, -0.379878289386005))
    ends = []
    for programme in ([1.0], [0.92, 1.0]):
        record = PathRecord()
        ends.append(follow(problem, rest, programme, record=record)[-1])
        assert [event.load_factor for event in record.events if event.lost] == [pytest.approx(0.904, abs=1e-3)]
    assert _walls(ends[0]) == pytest.approx(_walls(ends[1]), abs=1e-6)


def test_slip_that_turns_round_between_two_events_is_seen():
    """With the 3/2 law rates change on the way: the contact of disks 14 and 15 sticks at 0.1039, not at 0.1185."""
    hertz = {"law": "hertz", "friction": 0.2}
    load = (-0.6549511091414716, -11.063131298210278)
    problem, rest = prepared({"layers": 5, "disks_per_row": 4}, hertz, {"friction": 0.2}, load)
    (state,) = follow(problem, rest, [0.15])
    sticks = [e.load_factor for e in state.reached.events if (e.kind, e.first, e.second) == ("sticks", 14, 15)]
    assert sticks == [pytest.approx(0.1039, abs=2e-4)]


def test_pieces_of_a_path_with_hertz_contacts_make_the_whole():
    """151 events, slip that turns round among them; no event is passed, and none beyond the target is gone to."""
    packing, hertz = {"layers": 4, "disks_per_row": 9}, {"law": "hertz", "friction": 0.2}
    problem, rest = prepared(packing, hertz, {"friction": 0.2}, (15.142146600609928, -19.622483928994026))
    whole, cut = PathRecord(), PathRecord()
    (end,) = follow(problem, rest, [1.0], record=whole)
    other = follow(problem, rest, np.linspace(0.0, 1.0, 101)[1:], record=cut)[-1]
    assert len(whole.events) == len(cut.events) > 100
    assert [event.kind for event in whole.events if event.lost] == []
    assert np.abs(_walls(end) - _walls(other)).max() < 3e-8 * problem.load_size


def test_the_load_never_goes_back():
    """An event that Newton's method finds at a smaller load is on another branch: no path goes back to it."""
    packing = {"kind": "slab", "layers": 8, "disks_per_row": 33, "sides": "periodic"}
    hertz = {"friction": 0.2, "law": "hertz"}
    problem, rest = at_rest(gr.Scene.from_dict({"packing": packing, "contact": hertz, "loads": pushed(0.0, -2.0)}))
    factors: list[float] = []

    def progress(factor):
        factors.append(factor)
        assert len(factors) < 500

    (state,) = follow(problem, rest, [0.3], progress=progress)
    assert state.certificate.stable
    assert np.diff(factors).min() > -1e-9


def test_what_increments_leave_out_is_measured_in_a_short_leg_too():
    """One that a single increment would take, so that one of twice the length is the same."""
    problem, rest = at_rest(scene(loads=pushed(1.0, -6.0)))
    (exact,) = follow(problem, rest, [0.4])
    (found,) = follow(problem, rest, [0.4], together=4.0)
    off = np.abs(exact.wall_force() - found.wall_force()).max() / (0.4 * problem.load_size)
    assert off > 1e-4 and found.reached.events_error > 0.3 * off
    assert found.reached.events_within == pytest.approx(0.5 * 0.4 * problem.load_size)


def test_a_path_does_not_step_for_ever_where_no_statuses_go_on(monkeypatch):
    """A disk that is pressed in by 0.79 radii: contacts change to and fro at one load, again and again."""
    stepped = []
    lost = path.events.lost

    def counting(kind, *args):
        stepped.append(kind)
        assert len(stepped) < 100
        return lost(kind, *args)

    monkeypatch.setattr(path.events, "lost", counting)
    load = [{"disk": "top-centre", "displacement": [None, -0.79]}]
    packing = {"kind": "slab", "layers": 4, "disks_per_row": 7}
    solution = solve_scene(gr.Scene.from_dict({"packing": packing, "contact": {"friction": 0.2}, "loads": load}))
    assert "stepped over" in stepped and solution.loaded[0].certificate.stable


def test_steps_change_no_point():
    """Taken again from the same point, also by motion to another list of candidates, they lead to the same one."""
    packing = {"packing__polydispersity": 0.1, "packing__seed": 1}
    problem, rest = at_rest(scene(5, 11, contact__friction=0.2, loads=pushed(0.0, -12.0), **packing))
    leg = path.Leg(problem, PathRecord(), rest, 1.0, -np.inf, None, path.OPTIONS)
    here = path.step(leg, leg.at(rest), False)
    moved = []
    for _ in range(2):
        leg.gone_on()
        moved.append(path.by_motion(leg, here, "jump", "for a test", None))
    assert moved[0].system is not moved[1].system and moved[0].factor == moved[1].factor > here.factor
    assert np.array_equal(moved[0].position, moved[1].position)
    first, again = (path.step(leg, here, False) for _ in range(2))
    assert first.system is here.system and first.factor > here.factor
    assert again.factor == pytest.approx(first.factor, rel=1e-9) and np.array_equal(again.due, first.due)


def test_progress_does_not_go_back():
    """Also where a path is followed twice, to measure what increments leave out."""
    problem, rest = at_rest(scene(3, 5, contact__friction=0.2, loads=LOAD))
    reported: list[float] = []
    follow(problem, rest, [1.0, 3.0], together=0.3, progress=reported.append)
    assert reported == sorted(set(reported)) and reported[-1] == 3.0


def lost_on(scene: gr.Scene, programme) -> list[tuple[str, float]]:
    """Kind and load factor of the equilibria that a path through the factors loses."""
    problem, rest = at_rest(scene)
    states = follow(problem, rest, programme)
    return [(event.kind, event.load_factor) for state in states for event in state.reached.events if event.lost]


@pytest.mark.parametrize("programme", [[1.0], [0.9, 1.0]])
def test_an_event_beyond_a_limit_point_is_none(programme):
    """The equilibrium of nine soft disks is lost where their load is largest, not at an event of the way back."""
    x = [3.00434, 3.17038, 2.24407, 4.10762, 1.38986, 2.65412, 3.87251, 1.33676, 3.44901]
    z = [0.70573, 2.29356, 3.99841, 3.34056, 0.88077, 5.78437, 4.78113, 2.50699, 7.28686]
    radius = [0.70573, 0.79356, 0.99841, 0.59056, 0.88077, 0.78437, 0.78113, 0.50699, 0.78686]
    contact = {"law": "hertz", "normal_stiffness": 56.215, "stiffness_ratio": 0.5, "friction": 0.0060915}
    wall = {"friction": 0.00027692, "normal_stiffness": 46.157}
    rest = {"contact": contact, "wall": wall, "loads": [{"disk": 2, "force": [0.067622, -0.32886]}]}
    found = lost_on(gr.Scene.from_arrays(x, z, radius, width=5.7923, scene=rest), programme)
    assert found == [("jump", pytest.approx(0.9006, abs=3e-4))]


def test_an_event_that_newtons_method_lets_go_is_no_lost_equilibrium():
    """Two rows that roll: the same is lost wherever the programme is cut."""
    rolls = {"friction": 0.82203, "rolling_friction": 0.11134, "rolling_stiffness_ratio": 0.1}
    contact = {"law": "hertz", "normal_stiffness": 222.906, "stiffness_ratio": 2.0, **rolls}
    packing = {"kind": "slab", "layers": 2, "disks_per_row": 3, "polydispersity": 0.25, "seed": 930}
    wall = {"friction": 0.49857, "normal_stiffness": 277.055}
    loads = [{"disk": 0, "force": [0.37469, -0.98461]}]
    scene = gr.Scene.from_dict({"packing": packing, "contact": contact, "wall": wall, "loads": loads})
    whole, cut = (lost_on(scene, np.linspace(0.0, 1.0, parts + 1)[1:]) for parts in (1, 43))
    assert whole == [("jump", pytest.approx(0.06209, abs=1e-4))]
    assert cut == [(kind, pytest.approx(factor, abs=1e-5)) for kind, factor in whole]
