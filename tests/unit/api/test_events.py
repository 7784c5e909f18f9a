"""Events of a load path: in a result, in its file, on the terminal, in exports, and as what find_event reads."""

import csv
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from printed import shown
from refusals import refusals, refuses
from small_scenes import scene
from spoilt import spoil

import granular_response as gr
from granular_response.solvers.solution import solve_scene
from granular_response.state import CONTACT_EVENTS
from granular_response.store.checked import checked, read_result
from granular_response.store.export import export
from granular_response.store.result import ResultError, chosen_states, state_from, to_dataset
from granular_response.studies import EventNotBracketed

LOAD = [{"disk": "top-centre", "force": [0.0, -6.0]}]
SCENE = scene(4, 9, contact__friction=0.2, loads=LOAD)
FACTORS = (0.5, 1.0, 0.25)


@pytest.fixture(scope="module")
def result():
    return gr.solve(SCENE, load_factors=FACTORS)


@pytest.fixture(scope="module")
def path(result, tmp_path_factory):
    path = tmp_path_factory.mktemp("events") / "result.nc"
    result.save(path)
    return path


def with_lost(result) -> gr.Result:
    """The result with a jump on the way to its second load, as if events had been taken together on the way there."""
    jump = gr.Event(0.75, "jump", 3, x=1.0, z=2.0, until=0.8, displacement=0.5, reason="no, that is: none, nearby")
    solution = result._solution
    one, two, three = solution.loaded
    reached = replace(two.reached, events=(*two.reached.events, jump), events_within=0.25, events_error=3e-5)
    return gr.Result(replace(solution, loaded=(one, replace(two, reached=reached), three)))


def test_a_result_has_its_events_in_order_and_by_kind(result):
    events = result.events
    assert len(events) == sum(len(state.reached.events) for state in result.loaded) == sum(events.counts().values())
    assert list(events.states) == sorted(events.states) and set(events.states) == {1, 2, 3}
    assert set(events.counts()) <= set(CONTACT_EVENTS) and "slides" in events.counts()
    slides = events.of("slides")
    assert [event.kind for event in slides] == ["slides"] * events.counts()["slides"]
    assert len(events.of("slides", "sticks")) == len(slides) + len(events.of("sticks"))
    assert events[0] == events[:1][0] == next(iter(events)) and isinstance(events[0], gr.Event)
    assert len(events.lost) == 0 and len(with_lost(result).events.lost) == 1
    refuses(ValueError, r"^kind = 'open': must be opens or .* or rolls back, did you mean opens\?$", events.of, "open")


def test_events_as_a_table(result):
    table = result.events.to_dataframe()
    assert list(table.columns)[:4] == ["state", "load_factor", "kind", "first"]
    assert len(table) == len(result.events)
    assert table["kind"].value_counts().to_dict() == result.events.counts()
    assert table["state"].tolist() == list(result.events.states)
    first = result.events[0]
    assert table.loc[0, ["load_factor", "kind", "x"]].tolist() == [first.load_factor, first.kind, first.x]
    none = gr.solve(SCENE.updated({"contact.friction": 0.0})).events
    assert len(none) == 0 and list(none.to_dataframe().columns) == list(table.columns)


def test_stored_events_come_back(result, tmp_path):
    both = (result, with_lost(result))
    for one in both:
        one.save(tmp_path / "result.nc")
        again = gr.open_result(tmp_path / "result.nc")
        assert again.events == one.events and len(one.events) > 0
        for k, state in enumerate(one.loaded, 1):
            back = state_from(read_result(tmp_path / "result.nc"), k).reached
            assert (back.events, back.events_within, back.events_error) == (
                state.reached.events, state.reached.events_within, state.reached.events_error,
            )  # fmt: skip
    with xr.open_dataset(tmp_path / "result.nc") as plain:
        assert plain["event_kind"].attrs["flag_meanings"].split()[:2] == ["opens", "closes"]
        assert plain.sizes["event"] == len(both[1].events)
    frictionless = to_dataset(solve_scene(SCENE.updated({"contact.friction": 0.0})))
    assert not any(str(name).startswith("event") for name in frictionless.variables)


def test_chosen_states_keep_the_events_that_lead_to_them(result):
    data = to_dataset(result._solution)
    for index in (1, 2, -1):
        chosen = chosen_states(data, [0, index])
        expected = (result.rest, *result.loaded)[index].reached.events
        assert len(expected) > 0 and state_from(chosen, 1).reached.events == expected
        assert state_from(chosen, 0).reached.events == ()


DAMAGE = {
    "no such kind": (lambda d: spoil(d, "event_kind", 11), "variable event_kind: holds 11, must be from 0 to 10"),
    "no such disk": (lambda d: spoil(d, "event_first", 99), "variable event_first: holds 99, must be from -1 to 33"),
    "no such partner": (lambda d: spoil(d, "event_second", -2), "variable event_second: holds -2, must be from -1"),
    "no such wall": (lambda d: spoil(spoil(d, "event_at_wall", 1), "event_second", 3), "event_second: holds 3"),
    "no load": (lambda d: spoil(d, "event_load_factor", np.nan), "variable event_load_factor: must be finite"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_events_that_cannot_be_are_refused(result, damage):
    change, said = DAMAGE[damage]
    assert said in refuses(ResultError, None, checked, change(to_dataset(result._solution)))


def test_show_counts_events_and_names_lost_equilibria(result, tmp_path):
    one = with_lost(result)
    one.save(tmp_path / "result.nc")
    lines = shown(tmp_path / "result.nc").splitlines()
    for kind, count in result.events.counts().items():
        row = next(line.split() for line in lines if line.startswith(kind))
        assert row[:2] == [kind, "0"] and sum(map(int, row[1:])) == count
    opening = result.events.of("opens")[0]
    assert f"first opening at load factor {opening.load_factor:.9g}, {opening.where}" in lines
    assert "events processed in batches within 0.25 mg, estimated error 3.0e-05 of the load" in lines
    row = next(line for line in lines if line.strip().startswith("0.75"))
    assert row.split()[:4] == ["0.75", "0.8", "jump", "0.5"] and "disk 3" in row
    result.save(tmp_path / "result.nc")
    plain = shown(tmp_path / "result.nc")
    assert "taken together" not in plain and "lost" not in plain


def test_events_are_exported_as_a_table(result, path, tmp_path):
    with export(path, tmp_path / "slab.events.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(result.events)
    for row, state, event in zip(rows, result.events.states, result.events, strict=True):
        assert (int(row["state"]), float(row["load_factor"]), row["kind"]) == (state, event.load_factor, event.kind)
        assert (int(row["first"]), int(row["second"]), float(row["x"])) == (event.first, event.second, event.x)
    with export(path, tmp_path / "one.events.csv", state=2).open() as file:
        assert [float(row["load_factor"]) for row in csv.DictReader(file)] == [
            event.load_factor for event in result.loaded[1].reached.events
        ]
    with_lost(result).save(tmp_path / "lost.nc")
    with export(tmp_path / "lost.nc", tmp_path / "lost.events.csv").open() as file:
        assert [row["reason"] for row in csv.DictReader(file) if row["kind"] == "jump"] == ["no, that is: none, nearby"]
    with pytest.warns(UserWarning, match="springs of friction"):
        export(path, tmp_path / "disks.csv")
    assert "x,z,radius,mass" in (tmp_path / "disks.csv").read_text()


def test_events_are_field_data_of_a_mesh(result, path, tmp_path):
    import meshio

    for state, loaded in enumerate(result.loaded, 1):
        fields = meshio.read(export(path, tmp_path / "slab.vtu", state=state)).field_data
        events = loaded.reached.events
        assert fields["event_load_factor"].tolist() == [event.load_factor for event in events]
        assert fields["event_first"].tolist() == [event.first for event in events]
    assert set(meshio.read(export(path, tmp_path / "rest.vtu", state=0)).field_data) == {"load_factor"}


def test_the_first_event_of_a_kind_is_found_at_its_load(result):
    for kind in ("slides", "opens"):
        bracket = gr.find_event(SCENE, kind, 0.0, 1.0, progress=False)
        first = next(event for event in result.events.of(kind))
        assert bracket.low == bracket.high == pytest.approx(first.load_factor, abs=1e-9)
        assert (bracket.at_low, bracket.evaluations) == (False, 1)
    at_floor = gr.find_event(SCENE, "sticks", 0.0, 1.0, where=lambda event: event.z > 4.0, progress=False)
    expected = [event.load_factor for event in gr.solve(SCENE).events.of("sticks") if event.z > 4.0]
    assert at_floor.low == expected[0]
    later = gr.find_event(SCENE, "slides", bracket.low, 1.0, progress=False)
    assert later.low >= bracket.low


def test_what_changes_at_an_event_is_bracketed_to_its_load():
    """However wide the tolerance, and although the function knows nothing of events."""
    calls = []

    def opened(one):
        calls.append(one.load_factors[-1])
        return bool((one.rest.pairs.touching & ~one.loaded[-1].pairs.touching).any())

    exact = gr.find_event(SCENE, "opens", 0.0, 1.0, progress=False).low
    bracket = gr.find_event(SCENE, opened, 0.01, 1.0, tolerance=0.1, progress=False)
    assert bracket.low < exact < bracket.high and bracket.width < 1e-6
    assert bracket.at_low is False and bracket.evaluations == len(calls) < 15


def test_what_changes_between_events_is_bracketed_in_one_piece():
    events = gr.solve(SCENE).events
    factors = sorted({event.load_factor for event in events})
    gap, low, high = max((after - before, before, after) for before, after in pairwise(factors))
    loaded = int(to_dataset(solve_scene(SCENE))["loaded_disk"][0])
    level = gr.solve(SCENE, load_factors=[low + 0.3 * gap]).loaded[-1].position[loaded, 1]

    def lower(one):
        return one.loaded[-1].position[loaded, 1] < level

    bracket = gr.find_event(SCENE, lower, 0.01, 1.0, tolerance=1e-7, progress=False)
    assert low < bracket.low <= low + 0.3 * gap + 1e-7 and bracket.high < high and bracket.width <= 1e-7
    assert bracket.low - 1e-9 <= low + 0.3 * gap <= bracket.high + 1e-9


def test_a_lost_equilibrium_spans_its_stretch_of_load(monkeypatch, result):
    lost = gr.Result(replace(with_lost(result)._solution, loaded=with_lost(result).loaded[:2]))
    monkeypatch.setattr("granular_response.api.event.solve", lambda *_, **__: lost)
    bracket = gr.find_event(SCENE, "jump", 0.0, 1.0, progress=False)
    assert (bracket.low, bracket.high) == (0.75, 0.8)
    # events taken together lie in the increment that ends at their load, which is at most a tenth longer than said
    together = gr.find_event(SCENE, "slides", 0.6, 1.0, progress=False)
    assert together.width == pytest.approx(1.1 * 0.25 / 6.0) and together.high in [e.load_factor for e in lost.events]


def test_an_event_along_a_key():
    """Friction above which no contact slides on the way to this load."""
    gentle = SCENE.updated({"loads.0.force": [0.0, -0.5]})
    bracket = gr.find_event(gentle, "slides", 0.1, 2.0, key="contact.friction", tolerance=0.5, progress=False)
    assert bracket.at_low is True and bracket.width <= 0.5
    found = [
        gr.solve(gentle.updated({"contact.friction": end})).events.of("slides") for end in (bracket.low, bracket.high)
    ]
    assert len(found[0]) > 0 and len(found[1]) == 0


def asked(*arguments, **more):
    return lambda: gr.find_event(SCENE, *arguments, progress=False, **more)


test_what_cannot_be_looked_for_is_refused = refusals(
    ValueError,
    (asked("open", 0.0, 1.0), r"^kind = 'open': must be opens or"),
    (asked("opens", -0.5, 1.0), r"^low = -0.5: must be 0 or greater"),
    (asked(bool, 0.0, 1.0), r"^low = 0.0: must be greater than 0"),
    (asked(bool, 0.1, 1.0, where=bool), r"^where: is asked of events, must be left out"),
    (asked(bool, 0.1, 1e9), r"^loads\[0\].force: 6e\+09 mg at the largest load"),
    (asked(bool, 0.1, 1.0, tolerance=0.0), r"^tolerance = 0.0: must be a finite number greater than 0"),
)
test_what_does_not_happen_is_said = refusals(
    EventNotBracketed,
    (asked("opens", 0.0, 1e-5), r"^no event 'opens' between load factors 0 and 1e-05$"),
    (asked("slides", 0.0, 1.0, where=lambda event: event.x > 99.0), r"of those asked for between"),
)


@pytest.mark.parametrize("method", ["auto", "dynamics"])
def test_events_are_not_known_without_a_path(method):
    friction = 0.0 if method == "auto" else 0.2
    without = SCENE.updated({"contact.friction": friction, "protocol.method": method})
    without = without.updated({"protocol.stop_kinetic_energy": 1e-6, "protocol.time_step": "auto"})
    said = f"^protocol.method = {method}: must be path where events are asked for, this scene's loads are followed by"
    refuses(gr.SceneError, said, gr.find_event, without, "opens", 0.0, 0.01, progress=False)
