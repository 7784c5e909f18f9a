"""States along a force, measures and events that the studies of Sec. V share."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import scene

from granular_response.state import OPEN, SLIDING, STICKING
from granular_response.state import Event as PathEvent
from granular_response_paper import slab_response
from granular_response_paper.groups.symmetry_breaking.simulate import copies
from granular_response_paper.records import table
from granular_response_paper.slab_response import (
    EXACT,
    NARROW,
    Event,
    Happening,
    LoadPath,
    Lost,
    Measures,
    asymmetry_sign,
    by_motion,
    events_dataset,
    first_change,
    half_maximum_width,
    happenings,
    locate,
    lost,
    measured,
    measured_dataset,
    states_picture,
)

UNIT_LOAD = [{"disk": "top-centre", "force": [0.0, -1.0]}]


@pytest.fixture(scope="module")
def path():
    return LoadPath.of(scene(5, 17, contact__friction=0.0, loads=UNIT_LOAD))


@pytest.fixture
def calls(monkeypatch):
    """What is asked of the solver: (load factor of the start, load factors)."""
    asked = []
    solver = slab_response.loaded_states

    def record(problem, start, factors):
        asked.append((start.load_factor, list(factors)))
        return solver(problem, start, factors)

    monkeypatch.setattr(slab_response, "loaded_states", record)
    return asked


def test_states_are_found_from_the_one_below_and_once(path, calls):
    path = LoadPath(path.scene, path.problem, path.rest)
    path.through([0.2, 0.4, 1.0])
    path.at(0.7)
    path.at(0.4)
    path.through([0.3, 0.4, 1.0, 1.2])
    assert calls == [(0.0, [0.2, 0.4, 1.0]), (0.4, [0.7]), (0.2, [0.3]), (1.0, [1.2])]
    assert path.at(0.7).load_factor == 0.7
    assert path.method == "minimise"


def test_a_state_on_the_way_is_the_one_found_alone(path):
    together = LoadPath(path.scene, path.problem, path.rest).through([0.5, 2.0])[1]
    alone = LoadPath(path.scene, path.problem, path.rest).at(2.0)
    np.testing.assert_allclose(together.position, alone.position, atol=1e-11)


def test_the_literal_protocol_starts_at_rest_every_time(calls):
    literal = scene(2, 5, loads=UNIT_LOAD, protocol__method="dynamics")
    path = LoadPath.of(literal)
    path.at(0.1)
    path.at(0.3)
    assert [start for start, _ in calls] == [0.0, 0.0]
    assert path.method == "dynamics"


def test_measures_know_the_symmetric_slab(path):
    measures = Measures(path)
    assert measures.x[len(measures.x) // 2] == pytest.approx(0.0, abs=1e-9)
    state = path.at(0.05)
    scalars = measures.scalars(state)
    assert scalars.asymmetry < 1e-9
    assert scalars.opened_contacts == scalars.sliding_contacts == scalars.network_asymmetry == 0
    assert scalars.response_at_centre == pytest.approx(scalars.peak_height)
    assert measures.response(state).sum() == pytest.approx(1.0, abs=1e-9)


def test_contacts_far_from_the_load_are_not_near(path):
    measures = Measures(path)
    pairs = path.rest.pairs
    middle = 0.5 * (path.rest.position[pairs.first, 0] + path.rest.position[pairs.second, 0])
    width = path.problem.packing.width
    np.testing.assert_array_equal(measures.near, (middle >= width / 3) & (middle <= 2 * width / 3))


def test_mobilised_contacts_are_near_the_coulomb_limit(path):
    state = path.rest
    touching = np.flatnonzero(state.pairs.touching)[:4]
    status = np.full(state.pairs.status.shape, OPEN, dtype=np.int8)
    status[touching] = STICKING
    normal, tangential = np.zeros(status.shape), np.zeros(status.shape)
    normal[touching] = 2.0
    tangential[touching] = 2.0 * 0.3 * np.array([-1.0, 0.985, 0.94, 0.0])
    pairs = replace(state.pairs, status=status, normal_force=normal, tangential_force=tangential)
    made = replace(state, pairs=pairs)
    assert [int(made.pairs.near_limit(0.3, margin).sum()) for margin in (1e-6, 0.02, 0.1)] == [1, 2, 3]
    assert int(made.pairs.near_limit(0.0, 0.1).sum()) == 0
    opened = replace(made, pairs=replace(pairs, status=np.zeros_like(status)))
    assert int(opened.pairs.near_limit(0.3, 0.1).sum()) == 0


def test_half_maximum_width():
    x = np.arange(-4.0, 5.0)
    assert half_maximum_width(x, 4.0 - np.abs(x)) == pytest.approx(4.0)
    assert half_maximum_width(x, np.where(x > -0.5, 4.0 - x, 0.0)) == pytest.approx(2.5)
    two = np.array([0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    assert half_maximum_width(x, two) == pytest.approx(5.0)
    assert np.isnan(half_maximum_width(x, x))


def test_asymmetry_sign():
    x = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    assert asymmetry_sign(x, np.array([0.0, 1.0, 9.0, 2.0, 0.0])) == 1
    assert asymmetry_sign(x, np.array([3.0, 1.0, 9.0, 2.0, 0.0])) == -1
    assert asymmetry_sign(x, np.array([1.0, 1.0, 9.0, 1.0, 1.0])) == 0


def test_first_change():
    assert first_change([1.0, 2.0, 3.0], [False, True, False]) == (1.0, 2.0)
    assert first_change([1.0, 2.0], [True, True]) == (0.0, 1.0)
    low, high = first_change([1.0, 2.0], [False, False])
    assert (low, np.isnan(high)) == (2.0, True)


@pytest.mark.parametrize(("threshold", "low", "high"), [(0.33, 0.3, 0.4), (0.055, 0.0, 0.1)])
def test_events_among_minima_of_the_energy_are_bisected(path, threshold, low, high):
    path = LoadPath(path.scene, path.problem, path.rest)
    forces = [0.1, 0.2, 0.5]
    path.through(forces)
    (event,) = locate(path, forces, {"event": Happening(lambda s: s.load_factor > threshold, "made up")}, 0.04)
    assert low <= event.low < threshold <= event.high <= high
    assert event.high - event.low <= 0.02
    assert event.friction == 0.0 and event.definition == "made up"


@pytest.fixture(scope="module")
def rough():
    path = LoadPath.of(scene(5, 17, contact__friction=0.2, loads=UNIT_LOAD))
    path.through([0.5, 3.0, 6.0])
    return path


def test_what_contacts_decide_happens_at_an_event_of_the_path_and_costs_no_state(rough, calls):
    measures = Measures(rough)
    asked = happenings(measures, rough.known[0.5], 0.2)
    known = dict(rough.known)
    for name in ("first_opening", "reaches_floor"):
        (event,) = locate(rough, [0.5, 3.0, 6.0], {name: asked[name]})
        (at,) = {
            e.load_factor for s in known.values() for e in s.reached.events if event.low < e.load_factor < event.high
        }
        assert event.high - event.low <= 2.001 * EXACT * at
        before, after = (LoadPath(rough.scene, rough.problem, rough.rest).at(at + d) for d in (-1e-5, 1e-5))
        assert [asked[name].happened(state) for state in (before, after)] == [False, True]
    assert rough.known == known


def test_what_forces_decide_is_narrowed_within_one_piece(rough):
    path = LoadPath(rough.scene, rough.problem, rough.rest)
    states = path.through([0.5, 3.0, 6.0])
    measures = Measures(path)
    half = 0.5 * (measures.centre(states[1]) + measures.centre(states[2]))
    side = measures.centre(states[1]) > half
    half_way = Happening(lambda s: (measures.centre(s) > half) != side, "made up")
    (event,) = locate(path, [3.0, 6.0], {"half way": half_way})
    assert 3.0 < event.low < event.high < 6.0
    assert event.high - event.low <= NARROW * event.high
    passed = [e.load_factor for e in states[2].reached.events]
    assert not any(event.low < load < event.high for load in passed)
    centres = [measures.centre(path.at(force)) for force in (event.low, event.high)]
    assert min(centres) <= half <= max(centres)


def test_an_event_in_a_lost_equilibrium_has_the_bracket_of_the_loss(rough):
    """There is no state of the path between."""
    path = LoadPath(rough.scene, rough.problem, rough.rest)
    states = path.through([3.0, 6.0])
    jump = PathEvent(4.0, "jump", 7, until=4.5, displacement=0.1, reason="unstable")
    path.through([3.9999, 4.0, 4.5])
    for force in (4.5, 6.0):
        path.known[force] = replace(path.known[force], reached=replace(path.known[force].reached, events=(jump,)))
    states[1] = path.known[6.0]
    for of_contacts in (False, True):
        what = Happening(lambda state: state.load_factor > 4.2, "made up", of_contacts)
        (event,) = locate(path, [3.0, 6.0], {"event": what})
        assert (event.low, event.high) == (4.0, 4.5)
    assert lost(states) == [jump] and [by_motion(state) for state in states] == [False, True]
    found = table([Lost.of(0.2, jump)], "lost")
    assert [found[name].item() for name in ("friction", "kind", "start", "until", "displacement")] == [
        0.2, "jump", 4.0, 4.5, 0.1,
    ]  # fmt: skip
    assert table([], "lost", kind=Lost).sizes["lost"] == 0


def test_events_become_a_table():
    found = events_dataset([Event("a", 0.2, 1.0, float("nan"), "never"), Event("b", 0.5, 1, 2, "x")])
    assert found["name"].values.tolist() == ["a", "b"]
    assert found["definition"].values.tolist() == ["never", "x"]
    assert np.isnan(found["high"].values[0])
    assert found["low"].values.tolist() == [1.0, 1.0]
    for name in found.variables:
        assert found[name].attrs["long_name"]
        assert found[name].attrs["units"] == "1"


def test_measurements_are_spread_over_a_grid(path):
    measures = Measures(path)
    states = path.through([0.1, 0.2, 0.3])
    both, one = measured(measures, states[:2]), measured(measures, states[2:])
    grid = measured_dataset(("a", "b"), [((0, [0, 2]), both), ((1, [1]), one)], (2, 3))
    centre = grid["response_at_centre"].values
    np.testing.assert_array_equal(np.isnan(centre), [[False, True, False], [True, False, True]])
    assert centre[0, 2] == measures.centre(states[1])
    np.testing.assert_array_equal(grid["floor_response"].values[1, 1], measures.response(states[2]))
    np.testing.assert_array_equal(both.isel(state=[1])["floor_response"][0], both["floor_response"][1])
    assert grid["certificate_force_residual"].values[0, 0] < 1e-9


def test_pictures_keep_what_they_need(path):
    states = [path.rest, path.at(0.3)]
    picture = states_picture(states, path.problem)
    assert picture["force"].values.tolist() == [0.0, 0.3]
    np.testing.assert_array_equal(picture["position"].values[1], states[1].position)
    assert int(picture["loaded_disk"]) == path.problem.load_disk[0]
    assert set(np.unique(picture["contact_status"])) <= {OPEN, STICKING, SLIDING}


def test_copies_of_a_packing_are_the_same_packing():
    packing = scene(4, 7).packing.build()
    image = copies.mirrored(packing)
    np.testing.assert_array_equal(np.sort(image.position, axis=0), np.sort(packing.position, axis=0))
    np.testing.assert_array_equal(image.position[0], packing.position[6])

    mixed = copies.shuffled(packing, 3)
    order = np.lexsort(packing.position.T)
    np.testing.assert_array_equal(mixed.position[np.lexsort(mixed.position.T)], packing.position[order])
    assert not np.array_equal(mixed.position, packing.position)
    np.testing.assert_allclose(mixed.position[mixed.row == 0][:, 1], 1.0)

    shift = np.zeros((packing.n, 2))
    shift[0] = [1e-3, 2e-3]
    moved = copies.displaced(packing, shift, mirror_image=True)
    np.testing.assert_allclose(moved.position[6] - packing.position[6], [-1e-3, 2e-3], atol=1e-15)
    np.testing.assert_array_equal(moved.position[:6], packing.position[:6])
