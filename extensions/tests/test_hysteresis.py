"""Loading and unloading a slab of 6 layers, through a file to the lines of the document."""

import numpy as np
import reduced
from small_scenes import at_rest

from granular_response.solvers.solution import loaded_states
from granular_response_extensions.hysteresis.parameters import Parameters
from granular_response_extensions.hysteresis.simulate.loops import keep_books

PARAMETERS = reduced.parameters("hysteresis")
#: Cases of the reduced parameters.
SMOOTH, ROUGH = 0, 1


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
