"""Loading and unloading a slab of 6 layers, through a file to the lines of the document."""

import numpy as np
import pytest
import reduced
from small_scenes import at_rest

from granular_response.solvers.solution import loaded_states
from granular_response_extensions.hysteresis import simulate, tables
from granular_response_extensions.hysteresis.parameters import Parameters
from granular_response_extensions.hysteresis.simulate.loops import keep_books
from granular_response_paper.claims.claim import Data
from granular_response_paper.claims.table import claims_of
from granular_response_paper.claims.verdict import judge

PARAMETERS = reduced.parameters("hysteresis")
#: Cases of the reduced parameters.
SMOOTH, ROUGH, DISORDERED = 0, 1, 2


def part_of_work(loops, name):
    return (loops[name] / loops["work"]).values


def test_without_friction_nothing_is_lost_and_nothing_stays(datasets):
    loops = datasets["loops"].isel(case=SMOOTH, realization=0, turn=slice(0, 2))
    assert (loops["opened_contacts"] > 0).any() and (np.abs(loops["nonlinearity"]) > 0.05).any()
    for name in ("lost", "kept", "lost_again"):
        assert np.abs(part_of_work(loops, name)).max() < 1e-8
    assert (loops["floor_left"] < 1e-8).all() and (loops["slid"] == 0.0).all()


def test_what_is_neither_given_back_nor_kept_has_slid(datasets):
    loops = datasets["loops"]
    for again in ("", "_again"):
        slid = part_of_work(loops, f"slid{again}")
        left_over = part_of_work(loops, f"lost{again}") - part_of_work(loops, f"kept{again}") - slid
        quiet = loops[f"crossed{again}"].values == 0.0
        assert np.abs(left_over[quiet]).max() < 1e-3
        assert np.nanmax(np.abs(left_over[: ROUGH + 1])) < 1e-4
    assert np.nanmax(part_of_work(loops, "slid")) > 0.05


def test_books_close_better_with_smaller_increments():
    scene = Parameters.model_validate(PARAMETERS).of(Parameters.model_validate(PARAMETERS).cases[ROUGH], 0)
    problem, rest = at_rest(scene)

    def left_over(count):
        ways = np.linspace(0.0, 4.0, count + 1)
        states = [rest, *loaded_states(problem, rest, [*ways[1:], *ways[-2::-1]])[1]]
        books = keep_books(problem, states)
        return abs(books.work - books.stored - books.slid) / books.slid

    coarse, fine = left_over(6), left_over(48)
    assert fine < 1e-4 and fine < 0.2 * coarse


def test_sliding_stops_where_friction_is_high():
    """A load too small to slide anything, on a slab pressed together: the same springs going and coming."""
    scene = Parameters.model_validate(PARAMETERS).of(Parameters.model_validate(PARAMETERS).cases[ROUGH], 0)
    scene = scene.updated({"contact.friction": 100.0})
    problem, rest = at_rest(scene)
    states = [rest, *loaded_states(problem, rest, [0.05, 0.1, 0.05, 0.0])[1]]
    books = keep_books(problem, states)
    assert books.slid == pytest.approx(0.0, abs=1e-12) and abs(books.work) < 1e-12


def test_the_reversible_range_is_where_a_loop_begins_to_leave_something(datasets):
    events, loops = datasets["events"], datasets["loops"]
    for case in (ROUGH, DISORDERED):
        for realization in range(PARAMETERS["cases"][case].get("realizations", 1)):
            one = events.sel(event="reversible_range").isel(case=case, realization=realization)
            loop = loops.isel(case=case, realization=realization)
            force, left = loop["force"].values, loop["floor_left"].values
            assert (left[force < float(one["low"]) * (1 - 1e-9)] <= PARAMETERS["left"]).all()
            if np.isfinite(one["high"]):
                assert (left[force >= float(one["high"])][:1] > PARAMETERS["left"]).all()
    without = events.sel(event="reversible_range").isel(case=SMOOTH, realization=0)
    assert np.isnan(without["high"]) and without["low"] == PARAMETERS["cases"][SMOOTH]["forces"][-1]


def test_the_document_gets_a_line_for_each_packing_and_how_the_books_close(datasets):
    _, _, smooth, rough, disordered, _, count, lattices, disorder = tables.markdown(datasets).splitlines()
    opening = datasets["events"].isel(case=ROUGH, realization=0).sel(event="first_opening")
    assert float(opening["high"]) == pytest.approx(float(opening["low"]), rel=1e-6)
    assert smooth.startswith("| lattice, µ = 0 |") and smooth.endswith("| above 2 | 2 | nothing | nothing | nothing |")
    assert rough.startswith(f"| lattice, µ = 0.2 | {float(opening['high']):.3g} |")
    loops = datasets["loops"].isel(case=DISORDERED, turn=1)
    left = 100.0 * loops["floor_left"].values
    assert f"| 1 | {np.median(left):.2g} ({left.min():.2g} to {left.max():.2g}) % |" in disordered
    assert "median of 3 realizations" in count and "lattices" in lattices and "disorder" in disorder


def test_loads_of_all_ways_are_the_same():
    assert simulate.grid([1.0, 4.0], 2) == [0.0, 0.5, 1.0, 2.5, 4.0]


def test_the_claims_are_measured(datasets):
    found = [judge(claim, Data({"hysteresis": datasets})) for claim in claims_of("hysteresis")]
    assert all(entry.tests for entry in found)
    without = found[0].tests[0]
    assert without.outcome == "no" and without.found.low > 1.0
