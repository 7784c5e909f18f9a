"""Increments of a path: Newton's method on the true law, and minimisations with fixed Coulomb limits."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import at_rest, scene, started

from granular_response.solvers import increment as module
from granular_response.solvers.equilibrium import external_force
from granular_response.solvers.increment import Work, solve_increment
from granular_response.solvers.system import StaticSystem


@pytest.fixture(scope="module")
def start():
    problem, rest = at_rest(scene(6, 13, loads=[{"disk": "top-centre", "force": [0.0, -1.0]}]))
    system = StaticSystem(problem, rest)
    return problem, system, system.start(rest)


def test_increment_is_in_balance(start):
    problem, system, known = start
    work = Work()
    external = external_force(problem, 0.5)
    trial = solve_increment(system, known, external, known.q, work)
    assert np.abs(trial.contact_force + external).max() < 1e-10
    assert work.increments == 1
    assert 1 < work.factorisations <= 8


def test_fixed_limits_lead_to_the_same_equilibrium(start, monkeypatch):
    """With no try on the true law at first, rounds of fixed limits must find what Newton's method finds."""
    problem, system, known = start
    external = external_force(problem, 0.5)
    direct = solve_increment(system, known, external, known.q, Work())
    solve = module.newton
    calls = []

    def refusing(*args, **options):
        calls.append(1)
        trial, report = solve(*args, **options)
        if len(calls) == 1:
            report = type(report)(False, report.iterations, report.residual)
        return trial, report

    monkeypatch.setattr(module, "newton", refusing)
    monkeypatch.setattr(module, "OPTIONS", replace(module.OPTIONS, direct=10))
    work = Work()
    around = solve_increment(system, known, external, known.q, work)
    assert len(calls) == 2  # again after rounds of fixed limits
    assert around.configuration.q == pytest.approx(direct.configuration.q, abs=1e-11)
    assert np.array_equal(around.status, direct.status)
    calls.clear()
    monkeypatch.setattr(module, "OPTIONS", replace(module.OPTIONS, tries=0))
    assert solve_increment(system, known, external, known.q, Work()) is None


def test_hopeless_increment_returns_none():
    """A sideways pull far beyond what a frictionless-walled free surface holds."""
    problem, rest = at_rest(scene(2, 4, loads=[{"disk": "top-centre", "force": [0.0, 50.0]}]))
    system, known = started(problem, rest)
    assert solve_increment(system, known, external_force(problem, 1.0), known.q, Work()) is None
