"""Paths of a load, what is measured on them, and where something happens first."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import refusals, refuses
from small_scenes import scene

import granular_response as gr
from granular_response.observe.peaks import asymmetry_sign
from granular_response.state import Event as PathEvent
from granular_response.studies import (
    EventNotBracketed,
    Happening,
    LoadPath,
    Measures,
    bisect_event,
    by_motion,
    first_change,
    first_opening,
    lost,
    reaches_floor,
)
from granular_response.studies import path as paths
from granular_response.studies.path import EXACT, NARROW

UNIT_LOAD = [{"disk": "top-centre", "force": [0.0, -1.0]}]


@pytest.fixture(scope="module")
def path():
    return LoadPath.of(scene(5, 17, contact__friction=0.0, loads=UNIT_LOAD))


@pytest.fixture
def calls(monkeypatch):
    """What is asked of the solver: (load factor of the start, load factors)."""
    asked = []
    solver = paths.loaded_states

    def record(problem, start, factors):
        asked.append((start.load_factor, list(factors)))
        return solver(problem, start, factors)

    monkeypatch.setattr(paths, "loaded_states", record)
    return asked


def test_states_are_found_from_the_one_below_and_once(path, calls):
    path = LoadPath(path.scene, path.problem, path.rest)
    path.through([0.2, 0.4, 1.0])
    path.at(0.7)
    assert path.solution(0.7).load_factors == (0.2, 0.4, 0.7)
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
    found = path.first(forces, Happening(lambda s: s.load_factor > threshold, "made up"), 0.04)
    assert low <= found[0] < threshold <= found[1] <= high
    assert found[1] - found[0] <= 0.02


@pytest.fixture(scope="module")
def rough():
    path = LoadPath.of(scene(5, 17, contact__friction=0.2, loads=UNIT_LOAD))
    path.through([0.5, 3.0, 6.0])
    return path


def test_what_contacts_decide_happens_at_an_event_of_the_path_and_costs_no_state(rough, calls):
    measures = Measures(rough)
    known = dict(rough.known)
    for what in (first_opening(measures), reaches_floor(measures)):
        low, high = rough.first([0.5, 3.0, 6.0], what)
        (at,) = {e.load_factor for s in known.values() for e in s.reached.events if low < e.load_factor < high}
        assert high - low <= 2.001 * EXACT * at
        before, after = (LoadPath(rough.scene, rough.problem, rough.rest).at(at + d) for d in (-1e-5, 1e-5))
        assert [what.happened(state) for state in (before, after)] == [False, True]
    assert rough.known == known


def test_what_forces_decide_is_narrowed_within_one_piece(rough):
    path = LoadPath(rough.scene, rough.problem, rough.rest)
    states = path.through([0.5, 3.0, 6.0])
    measures = Measures(path)
    half = 0.5 * (measures.centre(states[1]) + measures.centre(states[2]))
    side = measures.centre(states[1]) > half
    half_way = Happening(lambda s: (measures.centre(s) > half) != side, "made up")
    low, high = path.first([3.0, 6.0], half_way)
    assert 3.0 < low < high < 6.0
    assert high - low <= NARROW * high
    assert not any(low < e.load_factor < high for e in states[2].reached.events)
    centres = [measures.centre(path.at(force)) for force in (low, high)]
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
        assert path.first([3.0, 6.0], what) == (4.0, 4.5)
    assert lost(states) == [jump] and [by_motion(state) for state in states] == [False, True]


@pytest.mark.parametrize("rising", [True, False])
def test_bracket_holds_the_event_within_the_tolerance(rising):
    bracket = bisect_event(lambda f: (f > math.pi) is rising, 0.0, 10.0, 0.01)
    assert bracket.low <= math.pi < bracket.high
    assert bracket.width <= 0.01
    assert bracket.low < bracket.middle < bracket.high
    assert bracket.at_low is not rising


def test_each_point_is_evaluated_once():
    seen = []

    def predicate(f):
        seen.append(f)
        return f >= 3.0

    bracket = bisect_event(predicate, 0.0, 8.0, 1.0)
    assert len(seen) == len(set(seen)) == bracket.evaluations == 5  # two ends, three halvings
    assert (bracket.low, bracket.high) == (2.0, 3.0)


def test_known_ends_are_not_evaluated():
    def predicate(f):
        assert 0.0 < f < 8.0
        return f >= 3.0

    assert bisect_event(predicate, 0.0, 8.0, 1.0, at_low=False, at_high=True).evaluations == 3


def test_tolerance_below_the_spacing_of_numbers_ends():
    bracket = bisect_event(lambda f: f > 1e9 + 0.3, 1e9, 1e9 + 1.0, 1e-12)
    assert bracket.high == math.nextafter(bracket.low, math.inf)


def within(low, high, tolerance):
    return lambda: bisect_event(lambda f: f > 3.0, low, high, tolerance)


test_equal_ends_are_an_error = refusals(EventNotBracketed, (within(0.0, 2.0, 0.1), r"False at both 0\.0 and 2\.0"))
test_bad_intervals_are_refused = refusals(
    ValueError, (within(1.0, 1.0, 0.1), "low"), (within(2.0, 1.0, 0.1), "low"), (within(0.0, 1.0, 0.0), "tolerance")
)


def test_where_nothing_happens_is_said_in_words():
    assert str(gr.studies.first_change([10.0, 20.0, 30.0], [False, False, False])) == "not up to 30"
    assert str(gr.studies.first_change([10.0, 20.0, 30.0], [False, True, True])) == "between 10 and 20"
    assert str(gr.studies.first_change([10.0], [True])) == "at 10 or below"
    assert str(gr.studies.First(20.19, 20.2)) == "from 20.2"
    assert str(gr.studies.linear_end([1.0], [np.nan], 0.01)) == "not known"
    assert not gr.studies.First(30.0, np.nan).happened


def test_two_peaks_have_a_prominence_that_is_asked_for():
    """A dip of 0.5 % is two peaks by a tenth of a percent, and one by one percent; the definition says which."""
    scene = gr.Scene(packing=gr.Slab(layers=6, disks_per_row=21), loads=[gr.Load(disk="top-centre", force=(0, -1))])
    path = gr.studies.LoadPath.of(scene.updated({"contact.friction": 0.2}))
    measures = gr.studies.Measures(path)
    forces = [1.0, 2.0, 4.0, 8.0, 16.0]
    by = {asked: path.first(forces, gr.studies.two_peaks(measures, prominence=asked)) for asked in (1e-3, 1e-2, 0.1)}
    assert by[1e-3] == path.first(forces, gr.studies.two_peaks(measures))
    assert by[1e-3].high < by[1e-2].high < by[0.1].high
    assert measures.dip(path.at(by[1e-2].high)) > 0.0099
    assert "0.01" in gr.studies.two_peaks(measures, prominence=0.01).definition
    refuses(ValueError, "prominence", gr.studies.two_peaks, measures, prominence=0.0)
    refuses(ValueError, "prominence = 1: must be below 1", gr.studies.two_peaks, measures, prominence=1)


def test_one_open_contact_is_a_first_opening():
    for opened in range(3):
        measures = SimpleNamespace(opened=lambda state, anywhere, opened=opened: opened)
        assert first_opening(measures).happened(None) == (opened > 0)
